#pragma once

#include <string>
#include <string_view>

namespace rmlcell::server {

// Whether a caller knows a secret. How long the answer takes tells nothing of the secret but its
// length; an empty one is known to nobody.
bool KnowsSecret(std::string_view given, std::string_view secret);

// 32 hexadecimal digits that nobody can guess: a secret, or a name that nobody else has.
std::string RandomText();

}  // namespace rmlcell::server
