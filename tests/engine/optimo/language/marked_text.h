#pragma once

#include <string>
#include <string_view>

#include "engine/optimo/language/compiler.h"

// Program text with braces around what a finding is about; they are no part of the text.
namespace rmlcell::optimo {

struct Marked {
  std::string text;
  SourceSpan span;
};

inline Marked WithoutBraces(std::string_view marked) {
  Marked result{{}, {.line = 1, .column = 1}};
  bool inside = false, before = true;
  for (const char c : marked) {
    if (c == '{') {
      inside = true;
      before = false;
      result.span.byte_offset = static_cast<std::int64_t>(result.text.size());
      continue;
    }
    if (c == '}') {
      inside = false;
      continue;
    }
    if (inside) ++result.span.length;
    if (before && c == '\n') {
      ++result.span.line;
      result.span.column = 0;
    }
    if (before) ++result.span.column;
    result.text += c;
  }
  return result;
}

}  // namespace rmlcell::optimo
