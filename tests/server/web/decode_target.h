#pragma once

#include <string_view>

namespace rmlcell::web::testing {

// Takes the bytes for a request, with and without a body, and sends them through everything that
// decodes before a call is made. Ends the process when an invariant breaks; there is no wrong
// input.
void DecodeAnything(std::string_view bytes);

}  // namespace rmlcell::web::testing
