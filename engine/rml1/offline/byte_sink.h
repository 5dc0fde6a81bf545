#pragma once

#include <functional>
#include <string_view>

namespace rmlcell::rml1 {

// Takes what a tool makes, part by part and in order, so that a stream of any length needs no
// memory of its length. What came is worth nothing when the tool ends with an error.
using ByteSink = std::function<void(std::string_view)>;

}  // namespace rmlcell::rml1
