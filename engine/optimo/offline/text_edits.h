#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"

namespace rmlcell::optimo {

// Applies replacements to a text. They are ordered by place and do not overlap. Linear.
inline std::string ApplyEdits(std::string_view text, const std::vector<Fix>& edits) {
  std::string out;
  out.reserve(text.size() + 8 * edits.size());
  std::size_t at = 0;
  for (const Fix& edit : edits) {
    const auto offset = static_cast<std::size_t>(edit.byte_offset);
    out += text.substr(at, offset - at);
    out += edit.text;
    at = offset + static_cast<std::size_t>(edit.length);
  }
  out += text.substr(at);
  return out;
}

// The line end that the text uses: that of its first line.
inline std::string_view LineEndOf(std::string_view text) {
  const std::size_t end = text.find('\n');
  return end != std::string_view::npos && end > 0 && text[end - 1] == '\r' ? "\r\n" : "\n";
}

}  // namespace rmlcell::optimo
