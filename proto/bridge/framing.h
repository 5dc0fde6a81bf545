#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Products that are a series (toolpath blocks, trace records) are kept as frames: four bytes of
// length, least significant first, then the bytes.
namespace rmlcell::bridge {

inline std::array<char, 4> FrameLength(std::string_view frame) {
  const auto size = static_cast<std::uint32_t>(frame.size());
  std::array<char, 4> length{};
  for (std::size_t i = 0; i < length.size(); ++i)
    length[i] = static_cast<char>((size >> 8 * i) & 0xFF);
  return length;
}

// To a string, or to anything else that bytes are appended to.
template <class Bytes>
void AddFrame(std::string_view frame, Bytes& bytes) {
  const std::array<char, 4> length = FrameLength(frame);
  bytes.append(std::string_view(length.data(), length.size()));
  bytes.append(frame);
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
