#pragma once

#include <string>

namespace rmlcell::cli {

// Of a request that may be repeated after a lost answer: it acts once.
std::string NewRequestId();

}  // namespace rmlcell::cli
