#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace rmlcell::server {

// The beginning of what a client sent, for an error message: it may be of any length and content,
// and the message travels in a header of a few kilobytes.
inline std::string Readable(std::string_view text) {
  constexpr std::size_t kShown = 80;
  std::string shown(text.substr(0, kShown));
  std::ranges::replace_if(
      shown, [](unsigned char c) { return c < 0x20 || c > 0x7E; }, '?');
  if (text.size() > kShown) shown += "...";
  return shown;
}

}  // namespace rmlcell::server
