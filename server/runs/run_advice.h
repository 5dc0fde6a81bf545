#pragma once

#include <optional>

#include "engine/core/result.h"
#include "storage/store.h"

namespace rmlcell::server {

struct Config;

// What would end this RUN before anything moves if it began now, with the memory that its machine
// has; nothing: nothing is known. LIVE-5.02 (b)
std::optional<Error> WhyItWouldFail(storage::Store& store, const Config& config, std::int64_t job);

}  // namespace rmlcell::server
