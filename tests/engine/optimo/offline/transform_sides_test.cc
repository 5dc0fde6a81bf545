#include <gtest/gtest.h>

#include <string>

#include "engine/core/units.h"
#include "engine/optimo/offline/transform.h"

namespace rmlcell::optimo {
namespace {

// OPT-7.33, OPT-8.21: where no COORD says otherwise the coordinates are ABSOL: SYSDEF acts on them.
TEST(TransformSides, WithoutACoordItIsAbsol) {
  const std::string moves = "SYSDEF (0,0,0,1.5707963268,0,0)\nMOVE (1,2,3,0,0.4)\n";
  const motion::RigidMotion turn = motion::RigidMotionOf({}, 0, 0, 0.5);
  const auto body = [&](const std::string& coord) {
    return Transform(coord + moves, turn).text.substr(coord.size());
  };
  EXPECT_EQ(body(""), body("COORD ABSOL\n"));
  EXPECT_NE(body(""), body("COORD ROBOT\n"));
}

// OPT-8.74: assignments are shifted, and nothing else that stands beside these variables.
TEST(TransformSides, OnlyAssignmentsAreShifted) {
  EXPECT_EQ(Shift("VR[86] = 1.\nMOVE (VR[86],5.,0.,0.,0.)\n", {30, 0, 0, 0, 0, 0}).text,
            "VR[86] = 31.0\nMOVE (VR[86],5.,0.,0.,0.)\n");
  EXPECT_EQ(Shift("VR[86] = 1.\nSYSDEF (VR[86],5.,0.,0.,0.,0.)\n", {30, 0, 0, 0, 0, 0}).text,
            "VR[86] = 31.0\nSYSDEF (VR[86],5.,0.,0.,0.,0.)\n");
}

// OPT-8.75, OPT-E.7852: VR[86] to VR[91] are the offset, and no neighbour of theirs.
TEST(TransformSides, NeighboursOfTheOffsetAreNotShifted) {
  for (const std::string variable : {"VR[85]", "VR[92]", "VI[86]", "VI[91]"}) {
    const Rewriting shifted = Shift(variable + " = 1\n", {1, 1, 1, 1, 1, 1});
    EXPECT_FALSE(shifted.ok) << variable;
    ASSERT_EQ(shifted.diagnostics.size(), 1U) << variable;
    EXPECT_EQ(shifted.diagnostics[0].code, ErrorCode::kShiftNothing) << variable;
  }
}

// The signs of B of two moves at A = 0, turned by 3 rad about Z after 0.01 about X.
std::string SignsOf(const std::string& first_b, const std::string& second_b) {
  const motion::RigidMotion turn = motion::RigidMotionOf({}, 3.0, 0, 0.01);
  const std::string text =
      Transform("MOVE (1,2,3,0," + first_b + ")\nMOVE (1,2,3,0," + second_b + ")\n", turn).text;
  std::string signs;
  for (std::size_t at = text.find(')'); at != std::string::npos; at = text.find(')', at + 1))
    signs += text[text.rfind(',', at) + 1] == '-' ? '-' : '+';
  return signs;
}

// OPT-8.76, OPT-B.80: the nearest angles of a small B have it turned over, those of a large one
// have not; but the head goes on as it began, where B says where A is.
TEST(TransformSides, TheHeadGoesOnAsItBegan) {
  EXPECT_EQ(SignsOf("0.3", "0.3"), "--");
  EXPECT_EQ(SignsOf("1.57", "1.57"), "++");
  EXPECT_EQ(SignsOf("0.3", "1.57"), "--");
  EXPECT_EQ(SignsOf("1.57", "0.3"), "++");
  // Nearly straight down, before the turn or behind it, says nothing.
  EXPECT_EQ(SignsOf("0.009", "1.57").back(), '+');
  EXPECT_EQ(SignsOf("0.02", "1.57").back(), '-');
  EXPECT_EQ(SignsOf("-0.0105", "1.57").back(), '+');
}

// OPT-8.76, OPT-B.80: a turn about Z leaves Z where it is, to rounding; with a tilt of a
// ten-millionth it is none, and the nearest angles are taken, with B turned over.
TEST(TransformSides, ATurnThatTiltsIsNoneAboutZ) {
  const auto b_of = [](double tilt) {
    const motion::RigidMotion turn = motion::RigidMotionOf({}, 3.0, 0, tilt);
    return TurnHead({0.0, 0.3}, turn.linear()).b_rad;
  };
  EXPECT_NEAR(b_of(1e-10), 0.3, 1e-6);
  EXPECT_NEAR(b_of(1e-7), -0.3, 1e-6);
}

// OPT-B.80: nearest to the old angles, and not to where a turn about Z would have led: half a turn
// about X leads A to pi - A and B to pi - B, the turn about Z behind it A on by 3.
TEST(TransformSides, TheNearestAnglesLieBesideTheOldOnes) {
  const motion::RigidMotion turn = motion::RigidMotionOf({}, 3.0, 0, kPi);
  const motion::HeadAngles head = TurnHead({0.68, 1.5}, turn.linear());
  EXPECT_NEAR(head.a_rad, 3.0 - kPi - 0.68, 1e-9);
  EXPECT_NEAR(head.b_rad, kPi - 1.5, 1e-9);
}

// transform.h: what the list of findings has no room for is counted.
TEST(TransformSides, FindingsWithoutRoomAreCounted) {
  std::string text;
  for (int n = 0; n < 1100; ++n) text += "MOVE (VR[1],0,0,0,0)\n";
  const Rewriting refused = Transform(text, {});
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.diagnostics.size() + refused.diagnostics_dropped.count(), 1100U);
  EXPECT_TRUE(refused.diagnostics_dropped.kinds().contains(ErrorCode::kTransformVariable));
}

}  // namespace
}  // namespace rmlcell::optimo
