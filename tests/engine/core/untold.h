#pragma once

#include "engine/core/untold_findings.h"

namespace rmlcell {

// So many findings of one code, one a line from `line` on.
inline UntoldFindings Untold(int count, ErrorCode code = ErrorCode::kNameUndeclared, int line = 1) {
  UntoldFindings untold;
  for (int k = 0; k < count; ++k)
    untold.Add({.code = code, .severity = Lookup(code).severity, .where = {.line = line + k}});
  return untold;
}

}  // namespace rmlcell
