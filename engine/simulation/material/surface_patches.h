#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// The surface of what is left of a block as a grid of vertices: one over the centre of each cell,
// and around them a ring at the outer edges of the cells, as high as the cell beside it. Nowhere
// below the bottom. The field must outlive it.
class VertexGrid {
 public:
  explicit VertexGrid(const HeightField& field) : field_(field) {}

  std::size_t columns() const { return field_.columns() + 2; }
  std::size_t rows() const { return field_.rows() + 2; }
  double x(std::size_t column) const {
    return field_.stock().x_min + CellsTo(column, field_.columns()) * field_.stock().cell;
  }
  double y(std::size_t row) const {
    return field_.stock().y_min + CellsTo(row, field_.rows()) * field_.stock().cell;
  }
  double z(std::size_t column, std::size_t row) const {
    return std::max(static_cast<double>(Height(column, row)), bottom());
  }
  double bottom() const { return field_.stock().bottom; }
  // As they are below the bottom, too: of one vertex, and of some of a row from a column on.
  float Height(std::size_t column, std::size_t row) const {
    return field_.height(CellOf(column, field_.columns()), CellOf(row, field_.rows()));
  }
  void Heights(std::size_t column, std::size_t count, std::size_t row, float* heights) const {
    const float* const cells =
        field_.heights().data() + CellOf(row, field_.rows()) * field_.columns();
    const std::size_t left = CellOf(column, field_.columns());
    const std::size_t right = CellOf(column + count - 1, field_.columns());
    heights[0] = cells[left];
    heights[count - 1] = cells[right];
    if (column == 0) ++heights;  // the ring is as high as what is within it
    std::copy(cells + left, cells + right + 1, heights);
  }

 private:
  static std::size_t CellOf(std::size_t vertex, std::size_t cells) {
    return std::min(std::max<std::size_t>(vertex, 1) - 1, cells - 1);
  }
  static double CellsTo(std::size_t vertex, std::size_t cells) {
    return std::clamp(static_cast<double>(vertex) - 0.5, 0.0, static_cast<double>(cells));
  }

  const HeightField& field_;
};

// A rectangle of vertices, both ends of its sides included.
struct Patch {
  std::size_t left = 0;
  std::size_t right = 0;
  std::size_t front = 0;
  std::size_t back = 0;

  bool operator==(const Patch&) const = default;
};

// The grid divided into patches that are as good as plane: the vertices of each lie between two
// parallel planes that are `tolerance_mm` apart in height, or it is one square of the grid. So
// whatever triangles are drawn between vertices of a patch differ from the surface by the tolerance
// at most, and patches need not know in how many triangles their neighbours are drawn.
//
// A patch that is not plane is halved across the direction in which it is the rougher: along a
// straight wall patches become long and narrow. Every vertex is looked at once for each of
// log2(columns) + log2(rows) halvings at most; kept are 4 bits a vertex and one for its corners.
class SurfacePatches {
 public:
  // `wanted` is asked now and then; as soon as it says no the division is left as it is, and is not
  // complete. Precondition: the tolerance is not below 0. The grid must outlive this.
  SurfacePatches(const VertexGrid& grid, double tolerance_mm, const std::function<bool()>& wanted);

  bool complete() const { return complete_; }

  // Whether a patch has a corner there.
  bool corner(std::size_t column, std::size_t row) const {
    return corners_[row * grid_.columns() + column];
  }

  // In the same order each time, until `visit` returns false. Precondition: complete().
  template <class Visit>
  void ForEach(Visit visit) const {
    std::vector<Patch> open{Whole()};
    for (std::size_t next = 0; !open.empty(); next += 2) {
      const Patch patch = open.back();
      open.pop_back();
      if (!decisions_[next]) {
        if (!visit(patch)) return;
        continue;
      }
      const auto [first, second] = Halves(patch, decisions_[next + 1]);
      open.push_back(second);
      open.push_back(first);
    }
  }

 private:
  Patch Whole() const { return {0, grid_.columns() - 1, 0, grid_.rows() - 1}; }
  static std::pair<Patch, Patch> Halves(const Patch& patch, bool across_x);
  void Divide(const Patch& whole, const std::function<bool()>& wanted);

  const VertexGrid& grid_;
  double tolerance_;
  std::vector<bool> decisions_;  // two a patch, before those of its halves: halved, and across X
  std::vector<bool> corners_;
  bool complete_ = true;
};

}  // namespace rmlcell::simulation
