#include "engine/optimo/offline/segment_grid.h"

#include <algorithm>
#include <array>
#include <functional>

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
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    length += (s.from - s.to).norm();
  }
  const ProgramVector spread = high_ - low_;
  std::array axes = {0, 1, 2};
  std::ranges::stable_sort(axes, std::ranges::greater{}, [&](int axis) { return spread[axis]; });
  axis_u_ = axes[0];
  axis_v_ = axes[1];
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
    const double from = segment.from[axis], d = along[axis];
    const double low = low_[axis] - 2.0 * reach_ - from;
    const double high = high_[axis] + 2.0 * reach_ - from;
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
