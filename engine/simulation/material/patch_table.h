#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

#include "engine/simulation/material/parallel_for.h"
#include "engine/simulation/material/vertex_grid.h"

namespace rmlcell::simulation {

// Where a patch is among those that come of halving the whole grid: how often it was halved across
// X and Y, and the how many-th it is of those that were halved as often.
struct PatchPlace {
  unsigned across_x = 0;
  unsigned across_y = 0;
  std::size_t x = 0;
  std::size_t y = 0;
};

// What the vertices of a patch have between them.
struct PatchRange {
  float lowest = 0.0f;  // as they are below the bottom, too
  float highest = 0.0f;
  // Of the steps from a vertex to the next one along X and Y, not below the bottom, without the
  // ring of the grid, where they are 0.
  double least_x = 0.0;
  double most_x = 0.0;
  double least_y = 0.0;
  double most_y = 0.0;
};

// The ranges of all patches that are not smaller than some vertices, each vertex looked at once:
// whether such a patch is plane, and across what it is the rougher, most often follows from them.
class PatchTable {
 public:
  // `wanted` is asked after each `looks_max` vertices; when it says no the table is not complete.
  PatchTable(const VertexGrid& grid, std::size_t looks_max, const std::function<bool()>& wanted,
             ParallelFor& parallel);

  bool complete() const { return complete_; }
  // Null for one that is smaller. Precondition: complete().
  const PatchRange* Find(const PatchPlace& place) const {
    if (place.across_x > halvings_x_ || place.across_y > halvings_y_) return nullptr;
    return &RangesOf(place.across_x, place.across_y)[(place.y << place.across_x) + place.x];
  }
  // Of the smallest one in the table that it is part of, or its own.
  const PatchRange& FindAround(PatchPlace place) const {
    if (place.across_x > halvings_x_) place.x >>= place.across_x - halvings_x_;
    if (place.across_y > halvings_y_) place.y >>= place.across_y - halvings_y_;
    place.across_x = std::min(place.across_x, halvings_x_);
    place.across_y = std::min(place.across_y, halvings_y_);
    return *Find(place);
  }

 private:
  std::vector<PatchRange>& RangesOf(unsigned x, unsigned y) {
    return ranges_[x * (halvings_y_ + 1) + y];
  }
  const std::vector<PatchRange>& RangesOf(unsigned x, unsigned y) const {
    return ranges_[x * (halvings_y_ + 1) + y];
  }
  void FindRow(const VertexGrid& grid, std::size_t y);
  void JoinHalves();

  unsigned halvings_x_;  // of the smallest ones
  unsigned halvings_y_;
  std::vector<std::size_t> ends_x_;  // between the smallest ones, both outer ends included
  std::vector<std::size_t> ends_y_;
  std::vector<std::vector<PatchRange>> ranges_;  // by halvings, row by row
  bool complete_ = true;
};

}  // namespace rmlcell::simulation
