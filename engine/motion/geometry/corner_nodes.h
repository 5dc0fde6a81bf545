#pragma once

#include <array>
#include <cstddef>

#include "engine/motion/geometry/corner_table.h"

// What the tables of corner_table.cc have at their nodes. It is worked out when the engine is built
// (corner_nodes_maker.cc): doing so at the first corner took longer than most programs do.
namespace rmlcell::motion {

// By q = sqrt(cos(theta/2)) = rho / 2, in which the length is smooth at both ends.
struct LengthNodes {
  static constexpr int kCount = 1025;
  static constexpr double kFirst = 0.2088;  // sqrt(cos 87.5 degrees), rounded down
  static constexpr double kStep = (1.0 - kFirst) / (kCount - 1);
  std::array<double, kCount> length;
};

// By theta/2: the peak of path jerk, as a share of JerkScale.
struct JerkNodes {
  static constexpr int kCount = 2049;
  static constexpr double kHalfTurnMax = 1.5272;  // 87.5 degrees, rounded up
  std::array<double, kCount> share;
};

// By theta/2, as JerkNodes.
struct HalfNodes {
  static constexpr int kCount = 1025;
  static constexpr double kHalfTurnMax = 1.5272;  // 87.5 degrees, rounded up
  static constexpr double kMost = 1e3;            // where the curve is straight
  struct Node {
    std::array<float, HalfCorner::kSteps + 1> by_curvature;
    std::array<float, HalfCorner::kSteps + 1> by_jerk;
  };
  std::array<Node, kCount> nodes;
};

// By sin^2(theta/2). The curve is symmetric: with y = 2 share - 1 and w = 2 u - 1, w is odd in y,
// and (w/y - 1) / (1 - y^2) is smooth in y^2. It is met at Chebyshev's places.
struct MeasureNodes {
  using Terms = std::array<double, PlainMeasure::kTerms>;
  static constexpr int kCount = 257;
  static constexpr double kSquareMax = 0.9096;                // sin^2 of 72.5 degrees
  static constexpr double kStep = kSquareMax / (kCount - 2);  // one node beyond
  std::array<Terms, kCount> terms;
};

// About what the peak of path jerk is, at every angle, and smooth: J has corners, which straight
// lines between the nodes of a table would cut.
inline double JerkScale(double tangent, double curvature) {
  return 3.0 * tangent + curvature * curvature;
}

extern const LengthNodes kLengthNodes;
extern const JerkNodes kJerkNodes;
extern const HalfNodes kHalfNodes;
extern const MeasureNodes kMeasureNodes;

}  // namespace rmlcell::motion
