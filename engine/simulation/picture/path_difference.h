#pragma once

#include <cstdint>
#include <vector>

#include "engine/simulation/picture/path_sketch.h"

namespace rmlcell::simulation {

// Places no farther apart than this are one. Numbers of an object have 24 bits: at 4 m they are
// 0.0005 mm apart, and two programs may divide the same line at different ones.
inline constexpr double kSamePlace_mm = 2e-3;
// Pairs of elements that are looked at; enough for any two paths that are alike or far from each
// other. What is left then counts as different.
inline constexpr std::uint64_t kPairsMax = 20'000'000;

// Some lines and arcs of a path.
struct PathShare {
  std::vector<SketchElement> elements;
  std::vector<SketchCircle> circles;
  std::vector<SketchDot> dots;
  double cut_mm = 0.0;
  double travel_mm = 0.0;

  machine::Box box() const;  // of the elements; true extremes of lines, ends and middle of arcs
};

// What two paths have in common, and what only one of them has: by place, not by order. Where both
// run is common, however each divides it, in whichever direction and how often. Cuts are compared
// with cuts, travel with travel.
struct PathDifference {
  PathShare common;   // as the path after has it
  PathShare removed;  // of the path before alone
  PathShare added;    // of the path after alone
  bool exact = true;  // false: kPairsMax was not enough
};
// `pairs_max`: for the elements of each of them.
PathDifference Compare(const PathSketch& before, const PathSketch& after,
                       std::uint64_t pairs_max = kPairsMax);

}  // namespace rmlcell::simulation
