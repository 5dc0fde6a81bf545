#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "engine/simulation/material/corner_set.h"
#include "engine/simulation/material/parallel_for.h"
#include "engine/simulation/material/patch_table.h"
#include "engine/simulation/material/vertex_grid.h"

namespace rmlcell::simulation {

// The grid divided into patches that are as good as plane: the vertices of each lie between two
// parallel planes that are `tolerance_mm` apart in height, or it is one square of the grid. So
// whatever triangles are drawn between vertices of a patch differ from the surface by the tolerance
// at most, and patches need not know in how many triangles their neighbours are drawn.
//
// A patch that is not plane is halved across the direction in which it is the rougher: along a
// straight wall patches become long and narrow. Where the ranges of a table say so for certain, or
// some vertices do, no others are looked at. Kept are the table, 4 bits a vertex and two for its
// corners.
class SurfacePatches {
 public:
  // `wanted` is asked now and then; as soon as it says no the division is left as it is, and is not
  // complete. Precondition: the tolerance is not below 0. The grid must outlive this.
  SurfacePatches(const VertexGrid& grid, double tolerance_mm, const std::function<bool()>& wanted,
                 ParallelFor& parallel);

  bool complete() const { return complete_; }
  Patch Whole() const { return {0, grid_.columns() - 1, 0, grid_.rows() - 1}; }

  // The corners of patches. Precondition: complete().
  const CornerSet& corners() const { return corners_; }

  // Patches that follow each other, some ten thousand vertices at most unless it is one: sections
  // can be gone through each by itself.
  std::size_t sections() const { return sections_.size(); }

  // Of a section, in the same order each time. Precondition: complete().
  template <class Visit>
  void ForEach(std::size_t section, Visit visit) const {
    const Section& of = sections_[section];
    std::vector<Patch> open{of.patch};
    for (std::size_t next = 0; !open.empty(); next += 2) {
      const Patch patch = open.back();
      open.pop_back();
      if (!of.decisions[next]) {
        visit(patch);
        continue;
      }
      const auto [first, second] = Halves(patch, of.decisions[next + 1]);
      open.push_back(second);
      open.push_back(first);
    }
  }

 private:
  struct Open {
    Patch patch;
    PatchPlace place{};
  };
  // Two bits a patch, before those of its halves: whether it is halved, and that across X.
  struct Section {
    Patch patch;
    PatchPlace place;
    std::vector<bool> decisions{};
  };
  struct Decision {
    bool halved = false;
    bool across_x = false;
    std::size_t looked_at = 0;  // vertices
  };

  void FindSections(const std::function<bool()>& wanted);
  void DivideSections(const std::function<bool()>& wanted, ParallelFor& parallel);
  void Divide(Section& section) const;
  Decision Decide(const Open& open) const;
  static std::pair<Open, Open> HalvesOf(const Open& open, bool across_x);
  bool StillWanted(std::size_t looked_at, const std::function<bool()>& wanted);

  const VertexGrid& grid_;
  double tolerance_;
  PatchTable table_;
  std::vector<Section> sections_;
  CornerSet corners_;
  std::size_t looked_at_ = 0;  // vertices since it was asked
  bool complete_ = true;
};

}  // namespace rmlcell::simulation
