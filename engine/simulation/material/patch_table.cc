#include "engine/simulation/material/patch_table.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rmlcell::simulation {
namespace {

// The smallest patches of the table have as many steps along a side, and less than twice as many:
// it takes 3 bytes a vertex, of large grids 3/4.
std::size_t LeastSteps(const VertexGrid& grid) {
  constexpr std::size_t kLarge = std::size_t{1} << 24;
  return grid.columns() * grid.rows() > kLarge ? 16 : 8;
}

unsigned HalvingsOf(std::size_t steps, std::size_t least) {
  unsigned halvings = 0;
  while (steps >> (halvings + 1) >= least) ++halvings;
  return halvings;
}

// Where what is left of it after as many halvings ends, as Halves has it.
std::vector<std::size_t> EndsOf(std::size_t steps, unsigned halvings) {
  std::vector<std::size_t> ends{0, steps};
  for (unsigned k = 0; k < halvings; ++k) {
    std::vector<std::size_t> finer;
    for (std::size_t at = 0; at + 1 < ends.size(); ++at) {
      finer.push_back(ends[at]);
      finer.push_back(ends[at] + (ends[at + 1] - ends[at]) / 2);
    }
    finer.push_back(steps);
    ends = std::move(finer);
  }
  return ends;
}

PatchRange Join(const PatchRange& a, const PatchRange& b) {
  return {std::min(a.lowest, b.lowest),   std::max(a.highest, b.highest),
          std::min(a.least_x, b.least_x), std::max(a.most_x, b.most_x),
          std::min(a.least_y, b.least_y), std::max(a.most_y, b.most_y)};
}

// Of each of some columns what was found on the way along them: compilers compare several columns
// at a time, but not several vertices for one result.
class ColumnRanges {
 public:
  ColumnRanges(std::size_t columns, double bottom)
      : bottom_(bottom),
        lowest_(columns),
        highest_(columns),
        before_(columns),
        here_(columns),
        least_x_(columns),
        most_x_(columns),
        least_y_(columns),
        most_y_(columns) {}

  void Begin() {
    std::fill(lowest_.begin(), lowest_.end(), HUGE_VALF);
    std::fill(highest_.begin(), highest_.end(), -HUGE_VALF);
    for (std::vector<double>* least : {&least_x_, &least_y_})
      std::fill(least->begin(), least->end(), HUGE_VAL);
    for (std::vector<double>* most : {&most_x_, &most_y_})
      std::fill(most->begin(), most->end(), -HUGE_VAL);
  }

  // `step`: from the row that was added before.
  void Add(const float* heights, bool step) {
    const std::size_t count = lowest_.size();
    float* const lowest = lowest_.data();
    float* const highest = highest_.data();
    double* const here = here_.data();
    for (std::size_t k = 0; k < count; ++k) {
      lowest[k] = std::min(lowest[k], heights[k]);
      highest[k] = std::max(highest[k], heights[k]);
      here[k] = std::max(static_cast<double>(heights[k]), bottom_);
    }
    AddSteps(here, here + 1, count - 1, least_x_.data(), most_x_.data());
    if (step) AddSteps(before_.data(), here, count, least_y_.data(), most_y_.data());
    before_.swap(here_);
  }

  // Columns from one to another, both included.
  PatchRange Of(std::size_t first, std::size_t last) const {
    PatchRange range{lowest_[last], highest_[last], HUGE_VAL,
                     -HUGE_VAL,     least_y_[last], most_y_[last]};
    for (std::size_t k = first; k < last; ++k) {
      range =
          Join(range, {lowest_[k], highest_[k], least_x_[k], most_x_[k], least_y_[k], most_y_[k]});
    }
    return range;
  }

 private:
  static void AddSteps(const double* from, const double* to, std::size_t count, double* least,
                       double* most) {
    for (std::size_t k = 0; k < count; ++k) {
      const double step = to[k] - from[k];
      least[k] = std::min(least[k], step);
      most[k] = std::max(most[k], step);
    }
  }

  double bottom_;
  std::vector<float> lowest_;
  std::vector<float> highest_;
  std::vector<double> before_;  // the row that was added last
  std::vector<double> here_;
  std::vector<double> least_x_;  // from the column to the next one
  std::vector<double> most_x_;
  std::vector<double> least_y_;
  std::vector<double> most_y_;
};

}  // namespace

PatchTable::PatchTable(const VertexGrid& grid, std::size_t looks_max,
                       const std::function<bool()>& wanted, ParallelFor& parallel)
    : halvings_x_(HalvingsOf(grid.columns() - 1, LeastSteps(grid))),
      halvings_y_(HalvingsOf(grid.rows() - 1, LeastSteps(grid))),
      ends_x_(EndsOf(grid.columns() - 1, halvings_x_)),
      ends_y_(EndsOf(grid.rows() - 1, halvings_y_)),
      ranges_((halvings_x_ + 1) * (halvings_y_ + 1)) {
  const std::size_t count = ends_y_.size() - 1;
  RangesOf(halvings_x_, halvings_y_).resize((ends_x_.size() - 1) * count);
  const std::size_t at_once =
      std::max<std::size_t>(1, looks_max / (2 * LeastSteps(grid) * grid.columns()));
  std::size_t looked_at = 0;
  for (std::size_t first = 0; first < count; first += at_once) {
    const std::size_t end = std::min(count, first + at_once);
    const std::size_t pieces = std::min(end - first, 4 * parallel.width());
    parallel.Run(pieces, [&](std::size_t piece) {
      for (std::size_t y = first + piece; y < end; y += pieces) FindRow(grid, y);
    });
    looked_at += (ends_y_[end] - ends_y_[first]) * grid.columns();
    if (looked_at <= looks_max) continue;
    looked_at = 0;
    complete_ = wanted();
    if (!complete_) return;
  }
  JoinHalves();
}

// The vertices of the ring are as high as what is within it, and not looked at.
void PatchTable::FindRow(const VertexGrid& grid, std::size_t y) {
  const std::size_t columns = grid.columns() - 2;
  ColumnRanges ranges(columns, grid.bottom());
  ranges.Begin();
  const std::size_t first = std::max<std::size_t>(ends_y_[y], 1);
  const std::size_t last = std::min(ends_y_[y + 1], grid.rows() - 2);
  for (std::size_t row = first; row <= last; ++row) ranges.Add(grid.Inner(row), row > first);
  const std::size_t count = ends_x_.size() - 1;
  PatchRange* const found = &RangesOf(halvings_x_, halvings_y_)[y * count];
  for (std::size_t x = 0; x < count; ++x) {
    found[x] =
        ranges.Of(std::max<std::size_t>(ends_x_[x], 1) - 1, std::min(ends_x_[x + 1], columns) - 1);
  }
}

void PatchTable::JoinHalves() {
  for (unsigned y = halvings_y_; y-- > 0;) {
    const std::vector<PatchRange>& halves = RangesOf(halvings_x_, y + 1);
    std::vector<PatchRange>& joined = RangesOf(halvings_x_, y);
    const std::size_t columns = std::size_t{1} << halvings_x_;
    joined.resize(halves.size() / 2);
    for (std::size_t k = 0; k < joined.size(); ++k) {
      const std::size_t first = k / columns * 2 * columns + k % columns;
      joined[k] = Join(halves[first], halves[first + columns]);
    }
  }
  for (unsigned y = 0; y <= halvings_y_; ++y) {
    for (unsigned x = halvings_x_; x-- > 0;) {
      const std::vector<PatchRange>& halves = RangesOf(x + 1, y);
      std::vector<PatchRange>& joined = RangesOf(x, y);
      joined.resize(halves.size() / 2);
      for (std::size_t k = 0; k < joined.size(); ++k)
        joined[k] = Join(halves[2 * k], halves[2 * k + 1]);
    }
  }
}

}  // namespace rmlcell::simulation
