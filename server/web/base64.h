#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rmlcell::web {

// The standard alphabet; grpc-web-text wants padding, details in Connect errors have none.
std::string Base64(std::string_view bytes, bool padded);

// Standard or URL-safe alphabet, padded or not. Several padded pieces may follow each other:
// clients of grpc-web-text encode frame by frame. Nothing on any other character, blanks included,
// or on a piece whose length cannot be.
std::optional<std::string> Base64Decode(std::string_view text);

}  // namespace rmlcell::web
