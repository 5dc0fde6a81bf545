#include "engine/optimo/offline/segment_grid.h"

#include <algorithm>
#include <array>

namespace rmlcell::optimo {
namespace {

using motion::ProgramVector;

constexpr double kNoLength2 = 1e-18;
// A coordinate is a cell number between 0 and twice this: 31 bits, far from the ends of a uint32_t.
constexpr double kCellsMax = 1'000'000'000.0;

constexpr double kCellsPerSegment = 4.0;

double Share(double value) { return std::clamp(value, 0.0, 1.0); }

}  // namespace

NearestPoints NearestPointsOf(const PathSegment& a, const PathSegment& b) {
  const ProgramVector along_a = a.to - a.from, along_b = b.to - b.from, between = a.from - b.from;
  const double aa = along_a.dot(along_a), bb = along_b.dot(along_b);
  const double b_between = along_b.dot(between), a_between = along_a.dot(between);
  NearestPoints nearest;
  if (aa <= kNoLength2 && bb > kNoLength2) {
    nearest.on_b = Share(b_between / bb);
  } else if (aa > kNoLength2 && bb <= kNoLength2) {
    nearest.on_a = Share(-a_between / aa);
  } else if (aa > kNoLength2) {
    const double ab = along_a.dot(along_b), parallel = aa * bb - ab * ab;
    // Parallel ones: anywhere on a will do to begin with.
    if (parallel > 1e-12 * aa * bb)
      nearest.on_a = Share((ab * b_between - a_between * bb) / parallel);
    nearest.on_b = (ab * nearest.on_a + b_between) / bb;
    if (nearest.on_b < 0.0 || nearest.on_b > 1.0) {
      nearest.on_b = Share(nearest.on_b);
      nearest.on_a = Share((ab * nearest.on_b - a_between) / aa);
    }
  }
  nearest.distance = (between + along_a * nearest.on_a - along_b * nearest.on_b).norm();
  return nearest;
}

SegmentGrid::SegmentGrid(const std::vector<PathSegment>& segments, double reach) : reach_(reach) {
  if (segments.empty()) return;
  low_ = high_ = segments.front().from;
  double length = 0.0;
  for (const PathSegment& s : segments) {
    for (const ProgramVector& p : {s.from, s.to}) {
      low_ = {std::min(low_.x(), p.x()), std::min(low_.y(), p.y()), std::min(low_.z(), p.z())};
      high_ = {std::max(high_.x(), p.x()), std::max(high_.y(), p.y()), std::max(high_.z(), p.z())};
    }
    length += (s.from - s.to).norm();
  }
  std::array<std::pair<double, int>, 3> spread = {
      {{high_.x() - low_.x(), 0}, {high_.y() - low_.y(), 1}, {high_.z() - low_.z(), 2}}};
  std::ranges::stable_sort(spread, [](const auto& a, const auto& b) { return a.first > b.first; });
  axis_u_ = spread[0].second;
  axis_v_ = spread[1].second;
  // A part of the mean length: then there are a few entries a segment, whatever their lengths, and
  // long ones that lie side by side do not share all of their cells.
  cell_ = std::max(2.0 * reach, length / (kCellsPerSegment * static_cast<double>(segments.size())));
  entries_.reserve(3 * segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    Cover(segments[i], 0.0, [&](std::uint64_t cell) {
      entries_.emplace_back(cell, static_cast<std::uint32_t>(i));
      return true;
    });
  }
  std::ranges::sort(entries_);
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
}

PathSegment SegmentGrid::Clipped(const PathSegment& segment) const {
  const ProgramVector along = segment.to - segment.from;
  double first = 0.0, last = 1.0;
  for (const int axis : {axis_u_, axis_v_}) {
    const double from = Coordinate(segment.from, axis), d = Coordinate(along, axis);
    const double low = Coordinate(low_, axis) - 2.0 * reach_ - from;
    const double high = Coordinate(high_, axis) + 2.0 * reach_ - from;
    // Along an axis in which it does not go these are infinite: all of it lies inside, or nothing.
    first = std::fmax(first, std::fmin(low / d, high / d));
    last = std::fmin(last, std::fmax(low / d, high / d));
  }
  if (first > last) return {segment.from, segment.from, segment.leg};
  return {segment.from + along * first, segment.from + along * last, segment.leg};
}

std::uint32_t SegmentGrid::CellOf(double value) const {
  return static_cast<std::uint32_t>(
      std::clamp(std::floor(value / cell_) + kCellsMax, 0.0, 2.0 * kCellsMax));
}

std::size_t SegmentGrid::FirstOf(std::uint64_t cell) const {
  return static_cast<std::size_t>(
      std::ranges::lower_bound(entries_, std::pair<std::uint64_t, std::uint32_t>(cell, 0U)) -
      entries_.begin());
}

}  // namespace rmlcell::optimo
