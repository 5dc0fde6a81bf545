#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/motion/geometry/frames.h"

namespace rmlcell::optimo {

// Straight pieces of paths in space, mm, and which of them lie near another one. Private to the
// folder.
struct PathSegment {
  motion::ProgramVector from, to;
  std::size_t leg = 0;  // of which it is a part
};

// In the two axes of a grid.
using GridVector = Eigen::Vector2d;

// Where two segments are nearest to each other.
struct NearestPoints {
  double distance = 0.0;  // mm
  double on_a = 0.0;      // share of the length of each, 0 to 1
  double on_b = 0.0;
};
NearestPoints NearestPointsOf(const PathSegment& a, const PathSegment& b);

// Built once over segments that must outlive it; a query costs as much as there is nearby.
// The grid lies in the two axes in which the segments spread most.
class SegmentGrid {
 public:
  // `reach`: how far away a neighbour may be, mm, above 0.
  SegmentGrid(const std::vector<PathSegment>& segments, double reach);

  // Calls visit(index) for every segment that may lie within reach of `segment`, and for some that
  // do not; one may come several times. Every cell and every segment looked at takes 1 from
  // `budget`; false when nothing was left of it: then not all of them came.
  template <class Visit>
  bool ForEachNear(const PathSegment& segment, std::size_t& budget, const Visit& visit) const {
    if (entries_.empty()) return true;
    return Cover(Clipped(segment), reach_, [&](std::uint64_t cell) {
      if (budget == 0) return false;
      --budget;
      for (std::size_t at = FirstOf(cell); at < entries_.size() && entries_[at].first == cell;
           ++at) {
        if (budget == 0) return false;
        --budget;
        visit(entries_[at].second);
      }
      return true;
    });
  }

 private:
  // Calls cell(key) for the cells within `margin` of the segment, each piece of a cell's length of
  // it by its bounding box, until it gives false.
  template <class EachCell>
  bool Cover(const PathSegment& segment, double margin, const EachCell& cell) const;
  // The part of it that lies where there are segments, and a little more; a point when there is
  // none.
  PathSegment Clipped(const PathSegment& segment) const;
  GridVector InGrid(const motion::ProgramVector& p) const { return {p[axis_u_], p[axis_v_]}; }
  std::uint32_t CellOf(double value) const;
  std::size_t FirstOf(std::uint64_t cell) const;

  double reach_;
  double cell_ = 1.0;  // mm
  int axis_u_ = 0, axis_v_ = 1;
  motion::ProgramVector low_, high_;                              // of all segments
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;  // cell, segment; sorted
};

template <class EachCell>
bool SegmentGrid::Cover(const PathSegment& segment, double margin, const EachCell& cell) const {
  const GridVector from = InGrid(segment.from);
  const GridVector way = InGrid(segment.to) - from;
  const double pieces = std::fmax(1.0, std::ceil(std::hypot(way.x(), way.y()) / cell_));
  for (double p = 0.0; p < pieces; p += 1.0) {
    const GridVector begin = from + way * (p / pieces);
    const GridVector end = from + way * ((p + 1.0) / pieces);
    const std::uint32_t u_end = CellOf(std::fmax(begin.x(), end.x()) + margin);
    const std::uint32_t v_end = CellOf(std::fmax(begin.y(), end.y()) + margin);
    for (std::uint32_t u = CellOf(std::fmin(begin.x(), end.x()) - margin); u <= u_end; ++u) {
      for (std::uint32_t v = CellOf(std::fmin(begin.y(), end.y()) - margin); v <= v_end; ++v) {
        if (!cell(std::uint64_t{u} << 32 | v)) return false;
      }
    }
  }
  return true;
}

}  // namespace rmlcell::optimo
