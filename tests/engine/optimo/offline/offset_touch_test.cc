#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/optimo/offline/offset_path.h"
#include "tests/engine/optimo/offline/flat_leg.h"

namespace rmlcell::optimo {
namespace {

Leg FlatArc(ProgramVector from, ProgramVector via, ProgramVector to) {
  Leg leg = FlatLeg(from, to);
  leg.via = via;
  Prepare(leg);
  EXPECT_TRUE(leg.is_arc);
  return leg;
}

// OPT-B.79: offset curves that only touch meet where they do. The line y = 1 and the circle of
// radius 1 about (8,0) touch at (8,1).
TEST(OffsetTouch, ALineThatTouchesTheConcentricCircle) {
  std::size_t failed = 99;
  const auto moved = OffsetChain(
      {FlatLeg({0, 0, 0}, {10, 0, 0}), FlatArc({10, 0, 0}, {8, 2, 0}, {6, 0, 0})}, 1.0, failed);
  ASSERT_TRUE(moved);
  EXPECT_LT(((*moved)[0].to - ProgramVector(8, 1, 0)).norm(), 1e-9);
  // A little less room, and they do not meet.
  const auto apart = OffsetChain(
      {FlatLeg({0, 0, 0}, {10, 0, 0}), FlatArc({10, 0, 0}, {8, 2, 0}, {6, 0, 0})}, 1.001, failed);
  ASSERT_FALSE(apart);
  EXPECT_EQ(apart.error().code, ErrorCode::kCompCorner);
  EXPECT_EQ(failed, 0U);
}

// Two arcs of radius 3 and 4 that meet at a right angle have their centres 5 apart: offset by 1
// they touch, two of five parts from (10,3) to (6,0).
TEST(OffsetTouch, CirclesThatTouchEachOther) {
  std::size_t failed = 99;
  const std::vector<Leg> legs = {FlatArc({13, 3, 0}, {7, 3, 0}, {10, 0, 0}),
                                 FlatArc({10, 0, 0}, {6, 4, 0}, {2, 0, 0})};
  const auto moved = OffsetChain(legs, 1.0, failed);
  ASSERT_TRUE(moved);
  EXPECT_LT(((*moved)[0].to - ProgramVector(8.4, 1.8, 0)).norm(), 1e-9);
  EXPECT_FALSE(OffsetChain(legs, 1.001, failed));
}

// OPT-8.19: an arc whose start has no room is consumed, whatever the head does at its end.
TEST(OffsetTouch, ArcsAreConsumedAtEitherEnd) {
  for (const bool at_start : {true, false}) {
    Leg arc = FlatArc({1.6, -1.2, 0}, {1.2, 1.6, 0}, {-1.6, 1.2, 0});
    // A head along the radius moves the arc sideways, and not inwards.
    (at_start ? arc.tool_to : arc.tool_from) = {-0.8, 0.6, 0};
    std::size_t failed = 99;
    const auto moved = OffsetChain({arc}, 2.0, failed);
    ASSERT_FALSE(moved) << at_start;
    EXPECT_EQ(moved.error().code, ErrorCode::kCompArc);
    EXPECT_TRUE(OffsetChain({arc}, 1.99, failed)) << at_start;
    arc.tool_from = arc.tool_to = {-0.8, 0.6, 0};
    EXPECT_TRUE(OffsetChain({arc}, 2.0, failed)) << at_start;
  }
}

// OPT-8.79: a move without a direction beside an arc takes the normal of the arc.
TEST(OffsetTouch, AnArcAndAMoveWithoutDirection) {
  std::size_t failed = 99;
  const Leg arc = FlatArc({10, 0, 0}, {0, 10, 0}, {-10, 0, 0});
  const auto moved = OffsetChain({arc, FlatLeg({-10, 0, 0}, {-10, 0, 0})}, 1.0, failed);
  ASSERT_TRUE(moved);
  EXPECT_LT(((*moved)[0].to - ProgramVector(-9, 0, 0)).norm(), 1e-9);
  const auto before = OffsetChain({FlatLeg({10, 0, 0}, {10, 0, 0}), arc}, 1.0, failed);
  ASSERT_TRUE(before);
  EXPECT_LT(((*before)[0].to - ProgramVector(9, 0, 0)).norm(), 1e-9);
}

// OPT-B.79: a turn of a thousandth is a corner: the line y = 1 meets the concentric circle there,
// which is not where the tangents would meet.
TEST(OffsetTouch, ATurnOfAThousandthIsACorner) {
  const double turn = 1e-3, radius = 2.0;
  const ProgramVector centre(-radius * std::sin(turn), radius * std::cos(turn), 0);
  const auto at = [&](double angle) -> ProgramVector {
    return centre + ProgramVector(std::sin(turn + angle), -std::cos(turn + angle), 0) * radius;
  };
  std::size_t failed = 99;
  const auto moved = OffsetChain(
      {FlatLeg({-20, 0, 0}, {0, 0, 0}), FlatArc({0, 0, 0}, at(0.4), at(1.0))}, 1.0, failed);
  ASSERT_TRUE(moved);
  const double below = centre.y() - 1.0, x = centre.x() + std::sqrt(1.0 - below * below);
  EXPECT_NEAR((*moved)[0].to.x(), x, 1e-9);
  EXPECT_NEAR((*moved)[0].to.y(), 1.0, 1e-9);
  EXPECT_GT(std::fabs(x + std::tan(turn / 2.0)), 5e-5);
}

}  // namespace
}  // namespace rmlcell::optimo
