#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Products that are a series (toolpath blocks, trace records) are kept as frames: four bytes of
// length, least significant first, then the bytes.
namespace rmlcell::bridge {

inline void AddFrame(std::string_view frame, std::string& bytes) {
  const auto size = static_cast<std::uint32_t>(frame.size());
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((size >> shift) & 0xFF);
  bytes += frame;
}

// Takes the first frame off; nothing at the end, or when the rest is cut off.
inline std::optional<std::string_view> TakeFrame(std::string_view& rest) {
  if (rest.size() < 4) return std::nullopt;
  std::uint32_t size = 0;
  for (int i = 3; i >= 0; --i)
    size = size << 8 | static_cast<unsigned char>(rest[static_cast<std::size_t>(i)]);
  if (rest.size() - 4 < size) return std::nullopt;
  const std::string_view frame = rest.substr(4, size);
  rest.remove_prefix(4 + std::size_t{size});
  return frame;
}

}  // namespace rmlcell::bridge
