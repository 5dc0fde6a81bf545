#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// The cells of a block whose centres a disc comes over on a straight way: in each row those from
// one to another, as the shape is convex. Centres on the very edge count, see kOnEdge_mm.
class SweptRows {
 public:
  SweptRows(const HeightField& field, const motion::MachinePoint& from,
            const motion::MachinePoint& to, double radius_mm);

  // Those that have cells, and perhaps some beside the block's columns.
  HeightField::Rows rows() const { return rows_; }

  static constexpr std::size_t kAtOnce = 32;
  struct Columns {
    std::array<std::int32_t, kAtOnce> begin;
    std::array<std::int32_t, kAtOnce> end;  // not above begin: none
  };
  // Of `count` rows from `first` on. Precondition: they lie within rows(), at most kAtOnce.
  void Find(std::size_t first, std::size_t count, Columns& columns) const;

 private:
  // The end of less Y is where it is counted from.
  double cells_to_mm_;
  double mm_to_cells_;
  double up_to_first_row_;  // mm
  double first_column_;     // cells from the first centre to where it is counted from, and 1
  double columns_;          // of the block
  double radius_2_;
  double length_;
  double way_x_;
  double way_y_;        // not below 0
  double steps_of_up_;  // along the way for each mm of Y
  double tangent_;      // from the centre of the disc up to where its left side runs along the way
  HeightField::Rows rows_;
};

}  // namespace rmlcell::simulation
