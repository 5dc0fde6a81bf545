#pragma once

#include <string>

#include "engine/core/result.h"

namespace rmlcell::server {

// Sets up spdlog for this process: text for people, or one JSON object a line. `who` stands in
// every line. Error: CellFileUnwritable.
Status StartLog(const std::string& who, const std::string& level, const std::string& format,
                const std::string& file);

}  // namespace rmlcell::server
