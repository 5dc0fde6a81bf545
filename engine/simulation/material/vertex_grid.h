#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>

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
  double cell() const { return field_.stock().cell; }
  // As they are below the bottom, too: of one vertex, and of some of a row from a column on.
  float Height(std::size_t column, std::size_t row) const {
    return field_.height(CellOf(column, field_.columns()), CellOf(row, field_.rows()));
  }
  // The height of a vertex is that at ToRow(row) of the line through its column, and at
  // ToColumn(column) of that through its row.
  const float* Line(std::size_t column, std::size_t row) const {
    return field_.heights().data() + CellOf(row, field_.rows()) * field_.columns() +
           CellOf(column, field_.columns());
  }
  std::size_t ToColumn(std::size_t column) const { return CellOf(column, field_.columns()); }
  std::size_t ToRow(std::size_t row) const { return CellOf(row, field_.rows()) * field_.columns(); }
  // A row within the ring, from its first vertex within on.
  const float* Inner(std::size_t row) const {
    return field_.heights().data() + (row - 1) * field_.columns();
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

// Both have the vertices where they meet.
inline std::pair<Patch, Patch> Halves(const Patch& patch, bool across_x) {
  Patch first = patch;
  Patch second = patch;
  if (across_x) {
    first.right = second.left = patch.left + (patch.right - patch.left) / 2;
  } else {
    first.back = second.front = patch.front + (patch.back - patch.front) / 2;
  }
  return {first, second};
}

}  // namespace rmlcell::simulation
