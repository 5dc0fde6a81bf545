#include "engine/rml1/board/distance_field.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace rmlcell::rml1 {
namespace {

// The distance along each column, of which rows are swept up and down.
void SweepColumns(DistanceField& field) {
  const std::size_t width = field.width;
  for (std::size_t y = 1; y < field.height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      float& here = field.values[y * width + x];
      here = std::min(here, field.at(x, y - 1) + 1.0F);
    }
  }
  for (std::size_t y = field.height - 1; y-- > 0;) {
    for (std::size_t x = 0; x < width; ++x) {
      float& here = field.values[y * width + x];
      here = std::min(here, field.at(x, y + 1) + 1.0F);
    }
  }
}

// Room for one row, used again for each.
struct Envelope {
  explicit Envelope(std::size_t width) : heights(width), centres(width), begins(width + 1) {}
  std::vector<double> heights;       // squares of the distances along the columns
  std::vector<std::size_t> centres;  // of the parabolas of the lower envelope
  std::vector<double> begins;        // where each of them begins to be the lowest
};

// values[x] becomes the root of the least (x - q)^2 + values[q]^2 over all q.
void SolveRow(std::span<float> values, Envelope& room) {
  const auto square = [](double v) { return v * v; };
  std::size_t last = 0;
  bool any = false;
  for (std::size_t q = 0; q < values.size(); ++q) {
    if (values[q] >= kVeryFar) continue;
    const auto at = static_cast<double>(q);
    room.heights[q] = square(values[q]);
    double begin = -HUGE_VAL;
    while (any) {
      const std::size_t p = room.centres[last];
      const auto other = static_cast<double>(p);
      begin =
          (room.heights[q] + square(at) - room.heights[p] - square(other)) / (2.0 * (at - other));
      if (begin > room.begins[last]) break;
      if (last == 0) {
        any = false;
        begin = -HUGE_VAL;
      } else {
        --last;
      }
    }
    last = any ? last + 1 : 0;
    any = true;
    room.centres[last] = q;
    room.begins[last] = begin;
  }
  if (!any) return;
  std::size_t k = 0;
  for (std::size_t x = 0; x < values.size(); ++x) {
    const auto at = static_cast<double>(x);
    while (k < last && room.begins[k + 1] < at) ++k;
    const std::size_t p = room.centres[k];
    values[x] =
        static_cast<float>(std::sqrt(square(at - static_cast<double>(p)) + room.heights[p]));
  }
}

}  // namespace

DistanceField DistanceToCopper(const Bitmap& bitmap, std::size_t margin) {
  DistanceField field{.width = bitmap.width + 2 * margin, .height = bitmap.height + 2 * margin};
  field.values.assign(field.width * field.height, kVeryFar);
  if (field.values.empty()) return field;
  for (std::size_t y = 0; y < bitmap.height; ++y) {
    for (std::size_t x = 0; x < bitmap.width; ++x) {
      if (bitmap.at(x, y)) field.values[(y + margin) * field.width + x + margin] = 0.0F;
    }
  }
  SweepColumns(field);
  Envelope room(field.width);
  for (std::size_t y = 0; y < field.height; ++y) {
    SolveRow(std::span(field.values).subspan(y * field.width, field.width), room);
  }
  return field;
}

}  // namespace rmlcell::rml1
