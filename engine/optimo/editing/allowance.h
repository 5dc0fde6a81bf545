#pragma once

#include <optional>
#include <string_view>

#include "engine/core/diagnostic.h"

namespace rmlcell::optimo::editing {

// "; rmlcell: allow 7033" on the line where the statement of a finding begins, into a directive
// that is there if there is one (engine/optimo/language/silence.h). Nothing for errors, which
// cannot be allowed, for what is no finding of the language, and where another comment has the
// line.
std::optional<Fix> Allowance(std::string_view text, const Diagnostic& finding);

}  // namespace rmlcell::optimo::editing
