#pragma once

#include <string>
#include <string_view>

#include "engine/core/diagnostic.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

struct Formatting {
  std::string text;
  bool changed = false;
};

// The text in canonical layout (OPT-B.40): every statement in one line in its canonical form,
// comments and blank lines kept in their place. A comment inside a continued statement moves above
// it. A text with syntax errors is returned unchanged. Idempotent; what the program does is
// unchanged. Line ends become LF, unless the text uses CR LF. What stands behind the end of text
// (1Ah) stays as it is.
Formatting Format(std::string_view text);

}  // namespace rmlcell::optimo
