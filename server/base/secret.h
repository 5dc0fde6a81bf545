#pragma once

#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::server {

// Whether a caller knows a secret. How long the answer takes tells nothing of the secret but its
// length; an empty one is known to nobody.
bool KnowsSecret(std::string_view given, std::string_view secret);

// 32 hexadecimal digits that nobody can guess: a secret, or a name that nobody else has.
std::string RandomText();

// The secret in this file, which only its user may read; made where there is none.
// Error: CellConfiguration, with the path.
Result<std::string> KeptSecret(const std::string& path);

}  // namespace rmlcell::server
