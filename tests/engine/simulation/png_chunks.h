#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// A PNG as its chunks, by the format's own rule: length, type, data, checksum. For tests.
namespace rmlcell::simulation {

struct PngChunk {
  std::string type;
  std::string data;
};

inline std::uint32_t BigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[k]);
  return value;
}

inline std::vector<PngChunk> ChunksOf(std::string_view png) {
  std::vector<PngChunk> chunks;
  png.remove_prefix(8);  // signature
  while (png.size() >= 12) {
    const std::size_t length = BigEndian(png);
    chunks.push_back({std::string(png.substr(4, 4)), std::string(png.substr(8, length))});
    png.remove_prefix(12 + length);
  }
  return chunks;
}

}  // namespace rmlcell::simulation
