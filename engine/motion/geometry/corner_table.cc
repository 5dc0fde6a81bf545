#include "engine/motion/geometry/corner_table.h"

#include "engine/core/indices.h"
#include "engine/motion/geometry/corner_nodes.h"

namespace rmlcell::motion {
namespace {

// The weights of four neighbouring nodes for a place `t` behind the second one: the cubic through
// them.
struct CubicWeights {
  double before, here, after, beyond;
  explicit CubicWeights(double t)
      : before(-t * (t - 1.0) * (t - 2.0) / 6.0),
        here((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0),
        after(-(t + 1.0) * t * (t - 2.0) / 2.0),
        beyond((t + 1.0) * t * (t - 1.0) / 6.0) {}
};

// Between the nodes of a table by theta/2: behind node `k`, by the share `t` of the way to the
// next.
struct BetweenNodes {
  std::size_t k;
  double t;
  BetweenNodes(double half_sine, double half_cosine, double half_turn_max, int count) {
    const double x = std::atan2(half_sine, half_cosine) / half_turn_max * (count - 1);
    const int node = std::clamp(static_cast<int>(x), 0, count - 2);
    k = static_cast<std::size_t>(node);
    t = x - node;
  }
};

MeasureNodes::Terms MeasureTerms(double half_sine_square) {
  const double x = half_sine_square / MeasureNodes::kStep;
  const int k = std::clamp(static_cast<int>(x), 1, MeasureNodes::kCount - 3);
  const CubicWeights w(x - k);
  const MeasureNodes::Terms* at = &kMeasureNodes.terms[static_cast<std::size_t>(k)];
  MeasureNodes::Terms terms;
  for (const std::size_t i : IndicesOf(terms)) {
    terms[i] = at[-1][i] * w.before + at[0][i] * w.here + at[1][i] * w.after + at[2][i] * w.beyond;
  }
  return terms;
}

}  // namespace

double CornerJerkPeak(double half_sine, double half_cosine, double curvature) {
  constexpr double kRoom = 1e-6;  // what straight lines between nodes may lack
  const BetweenNodes at(half_sine, half_cosine, JerkNodes::kHalfTurnMax, JerkNodes::kCount);
  const auto& share = kJerkNodes.share;
  return (share[at.k] * (1.0 - at.t) + share[at.k + 1] * at.t) * (1.0 + kRoom) *
         JerkScale(half_sine / half_cosine, curvature);
}

HalfCorner CornerHalf(double half_sine, double half_cosine) {
  constexpr double kRoom = 1.0 - 3e-4;  // what straight lines between nodes may lack
  const BetweenNodes between(half_sine, half_cosine, HalfNodes::kHalfTurnMax, HalfNodes::kCount);
  const auto t = static_cast<float>(between.t);
  const HalfNodes::Node* at = &kHalfNodes.nodes[between.k];
  HalfCorner half;
  for (const std::size_t i : IndicesOf(half.by_curvature)) {
    half.by_curvature[i] =
        kRoom * (at[0].by_curvature[i] + (at[1].by_curvature[i] - at[0].by_curvature[i]) * t);
    half.by_jerk[i] = kRoom * (at[0].by_jerk[i] + (at[1].by_jerk[i] - at[0].by_jerk[i]) * t);
  }
  return half;
}

double CornerArcLength(double rho) {
  const double x = (0.5 * rho - LengthNodes::kFirst) / LengthNodes::kStep;
  const int k = std::clamp(static_cast<int>(x), 1, LengthNodes::kCount - 3);
  const CubicWeights w(x - k);
  const auto at = [&](int i) { return kLengthNodes.length[static_cast<std::size_t>(k + i)]; };
  return at(-1) * w.before + at(0) * w.here + at(1) * w.after + at(2) * w.beyond;
}

PlainMeasure::PlainMeasure(const PlainCorner& corner) {
  const MachineVector turn = corner.tangent_out - corner.tangent_in;
  const double half_sine_square = 0.25 * turn.dot(turn);
  known_ = half_sine_square <= MeasureNodes::kSquareMax;
  if (known_) coefficients_ = MeasureTerms(half_sine_square);
}

}  // namespace rmlcell::motion
