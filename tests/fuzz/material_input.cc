#include "tests/fuzz/material_input.h"

#include <cmath>
#include <cstdint>

#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/target_files.h"

namespace rmlcell::simulation {
namespace {

constexpr Stock kFuzzBlock{.x_min = -2.0,
                           .x_max = 4.0,
                           .y_min = -1.0,
                           .y_max = 3.0,
                           .bottom = -3.0,
                           .top = 0.0,
                           .cell = 0.25};

std::uint32_t Checksum(std::string_view bytes) {
  std::uint32_t sum = 0xFFFFFFFF;
  for (const char c : bytes) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (0xEDB88320 & (0 - (sum & 1)));
  }
  return ~sum;
}

std::string WithChecksums(std::string_view png) {
  std::string made(png);
  std::size_t at = 8;
  while (at + 12 <= made.size()) {
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k)
      length = length << 8 | static_cast<unsigned char>(made[at + k]);
    if (length > made.size() - at - 12) break;
    const std::uint32_t sum = Checksum(std::string_view(made).substr(at + 4, length + 4));
    for (std::size_t k = 0; k < 4; ++k)
      made[at + 8 + length + k] =
          static_cast<char>(static_cast<unsigned char>(sum >> (24 - 8 * k)));
    at += 12 + length;
  }
  return made;
}

std::string TryFile(std::string_view bytes) {
  const Result<std::vector<float>> target = ReadTarget(bytes, kFuzzBlock);
  if (!target) return target.error().detail.empty() ? "refused without a reason" : "";
  if (target->size() != 24 * 16) return "a target of other cells than its block";
  for (const float height : *target) {
    if (std::isinf(height)) return "a target that is nowhere";
  }
  if (!IsPng(bytes)) return {};
  // What was read of a map says where it is: a block of those cells.
  const Result<HeightMap> map = ReadHeightMap(bytes);
  if (!map) return "a target is no map";
  if (map->heights.size() != map->columns * map->rows) return "a map without its cells";
  if (!CheckStock(map->stock)) return "a map of a block that cannot be";
  return {};
}

std::string TryText(std::string_view bytes) {
  const std::size_t line = bytes.find('\n');
  if (const Result<Stock> stock = ParseStock(bytes.substr(0, line)); !stock) {
    if (stock.error().detail.empty()) return "a block is refused without a reason";
  }
  if (line == std::string_view::npos) return {};
  const Result<MillTool> tool = ParseTool(bytes.substr(line + 1));
  if (!tool) return tool.error().detail.empty() ? "a tool is refused without a reason" : "";
  if (!CheckTool(*tool)) return "a tool that cannot be";
  HeightField field = HeightField::Of(kFuzzBlock).value();
  const double shank = field.ShankDepthOf(*tool, {-1, 0, 0}, {3, 2, -2});
  const double cut = field.Cut(*tool, {-1, 0, 0}, {3, 2, -2});
  if (!(shank >= 0.0 && shank <= 3.0 && cut >= 0.0 && cut <= 3.0)) return "depths beyond the block";
  return {};
}

}  // namespace

std::string TryMaterial(std::string_view bytes) {
  if (bytes.empty()) return {};
  const char kind = bytes.front();
  bytes.remove_prefix(1);
  if (kind == 't') return TryText(bytes);
  return kind == 'c' ? TryFile(WithChecksums(bytes)) : TryFile(bytes);
}

}  // namespace rmlcell::simulation
