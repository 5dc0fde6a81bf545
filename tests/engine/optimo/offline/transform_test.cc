#include "engine/optimo/offline/transform.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/offline/offset_path.h"

namespace rmlcell::optimo {
namespace {

using motion::MachineVector;
using motion::RigidMotion;
using motion::RigidMotionOf;
using motion::ToolDirection;

int FirstFinding(const Rewriting& rewriting) {
  return rewriting.diagnostics.empty() ? 0 : Lookup(rewriting.diagnostics[0].code).number;
}

// OPT-8.76: a rotation of 90 degrees about Z.
TEST(Transform, TurnsPointsAndHead) {
  const RigidMotion quarter = RigidMotionOf({}, kPi / 2, 0, 0);
  const Rewriting turned = Transform("10 MOVE (10,0,-500,0,0.5)/FLY ; c\nSPEED 5\n", quarter);
  ASSERT_TRUE(turned.ok);
  EXPECT_EQ(turned.text, "10 MOVE (0.0,10.0,-500.0,1.570796,0.5)/FLY ; c\nSPEED 5\n");
  EXPECT_EQ(
      Transform("MOVE (1,2,3,0,0)/VIA (4,5,6,0,0)\n", RigidMotionOf({100, 0, -1}, 0, 0, 0)).text,
      "MOVE (101.0,2.0,2.0,0.0,0.0)/VIA (104.0,5.0,5.0,0.0,0.0)\n");
}

// OPT-8.76, OPT-B.40: a number in parentheses has the sign before them.
TEST(Transform, NumbersInParenthesesHaveTheirSign) {
  EXPECT_EQ(Transform("MOVE (-(10),-(-20),-(30),0,0)\n", RigidMotionOf({1, 2, 40}, 0, 0, 0)).text,
            "MOVE (-(9.0),-(-22.0),-(-10.0),0.0,0.0)\n");
}

// OPT-B.80
TEST(Transform, ChoosesTheNearestHeadAngles) {
  const RigidMotion quarter = RigidMotionOf({}, kPi / 2, 0, 0);
  const motion::HeadAngles negative = TurnHead({0.0, -0.5}, quarter.linear());
  EXPECT_NEAR(negative.a_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(negative.b_rad, -0.5, 1e-12);
  const motion::HeadAngles far = TurnHead({12.0, 0.5}, quarter.linear());
  EXPECT_NEAR(far.a_rad, 12.0 + kPi / 2, 1e-9);
  const motion::HeadAngles down = TurnHead({0.3, 0.0}, quarter.linear());
  EXPECT_NEAR(down.a_rad, 0.3 + kPi / 2, 1e-12);
  EXPECT_NEAR(down.b_rad, 0.0, 1e-12);
}

// OPT-B.80, OPT-8.76: B stays positive if it was, whatever the turn about Z; half a turn goes the
// way it is meant for all moves, and back again.
TEST(Transform, ATurnAboutZLeavesB) {
  for (const double turn : {2.0, 3.0, kPi, -kPi, 3.14159265, -2.5}) {
    const RigidMotion motion = RigidMotionOf({}, turn, 0, 0);
    for (const double b : {0.02, 0.3, 1.5, 1.6, 2.3, -0.3, -2.0}) {
      for (const double a : {-9.0, -kPi, 0.0, 0.2, kPi, 3.5256}) {
        const motion::HeadAngles head = TurnHead({a, b}, motion.linear());
        EXPECT_NEAR(head.b_rad, b, 1e-12);
        EXPECT_NEAR(head.a_rad, a + turn, 1e-9);
      }
    }
  }
}

// The head points where the turned tool points, whatever the angles are.
TEST(Transform, TheToolTurnsWithThePart) {
  for (const double a : {-3.0, 0.4, 2.8}) {
    for (const double b : {-1.5, -0.2, 0.7, 2.0}) {
      const RigidMotion motion = RigidMotionOf({1, 2, 3}, 0.7, -0.3, 1.1);
      const motion::HeadAngles head = TurnHead({a, b}, motion.linear());
      const MachineVector expected = motion.linear() * (ToolDirection(a, b)),
                          found = ToolDirection(head.a_rad, head.b_rad);
      EXPECT_NEAR((expected - found).norm(), 0.0, 1e-12);
    }
  }
}

// OPT-7.33, OPT-7.34: a system that is turned about Z does not act on ROBOT moves: a turn by 0.5
// about X tilts the head about the machine's X, to (A,B) = (0,0.5). In ABSOL it is about the
// system's X, which is the machine's Y: u becomes (sin 0.5, 0, cos 0.5), A = pi/2.
TEST(Transform, SysdefActsOnAbsolMovesOnly) {
  const std::string head = "SYSDEF (0,0,0,1.5707963268,0,0)\nCOORD ";
  const RigidMotion tilt = RigidMotionOf({}, 0, 0, 0.5);
  EXPECT_EQ(Transform(head + "ROBOT\nMOVE (100,0,0,1,0)\n", tilt).text,
            head + "ROBOT\nMOVE (100.0,0.0,0.0,0.0,0.5)\n");
  EXPECT_EQ(Transform(head + "ABSOL\nMOVE (100,0,0,1,0)\n", tilt).text,
            head + "ABSOL\nMOVE (100.0,0.0,0.0,1.570796,0.5)\n");
}

// OPT-8.77, OPT-E.7851
TEST(Transform, NeedsPlainNumbers) {
  const Rewriting refused = Transform("MOVE (VR[1],0,0,0,0)\n", {});
  EXPECT_FALSE(refused.ok);
  EXPECT_TRUE(refused.text.empty());
  EXPECT_EQ(FirstFinding(refused), 7851);
  for (const std::string rotations : {"VR[1],0,0", "0,VR[1],0", "0,0,VR[1]"}) {
    const Rewriting turned = Transform("SPEED 5\nSYSDEF (1,2,3," + rotations + ")\n", {});
    EXPECT_FALSE(turned.ok);
    EXPECT_EQ(FirstFinding(turned), 7851);
    EXPECT_EQ(turned.diagnostics[0].where.line, 2);
  }
}

// OPT-7.62, OPT-E.7004: what the control cannot hold is not written.
TEST(Transform, NumbersThatAreNoneAreNotWritten) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e19}) {
    const Rewriting moved = Transform("MOVE (1,2,3,0,0)\n", RigidMotionOf({bad, 0, 0}, 0, 0, 0));
    EXPECT_FALSE(moved.ok) << bad;
    EXPECT_EQ(FirstFinding(moved), 7004) << bad;
    EXPECT_EQ(FirstFinding(Shift("VR[86] = 1.\n", {bad, 0, 0, 0, 0, 0})), 7004) << bad;
  }
  EXPECT_EQ(FirstFinding(Transform("MOVE (1,2,3,0,0)\n", RigidMotionOf({}, 0, std::nan(""), 0))),
            7004);
  EXPECT_TRUE(Shift("VR[86] = 1.\n", {9e18, 0, 0, 0, 0, 0}).ok);
  const double max = std::ldexp(1.0, 63);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(Shift("VR[86] = 0.\n", {sign * max, 0, 0, 0, 0, 0}).ok);
    EXPECT_FALSE(Shift("VR[86] = 0.\n", {sign * std::nextafter(max, HUGE_VAL), 0, 0, 0, 0, 0}).ok);
  }
}

// OPT-8.76: there and back is the same within the rounding of six decimals.
TEST(Transform, TheInverseBringsItBack) {
  const std::string text =
      "MOVE (100.25,-30.5,12.125,0.4,0.7) /VIA (1.5,2.5,3.5,-0.4,1.2)\nMOVE "
      "(1.0,2.0,3.0,3.1,1.5)\n";
  const RigidMotion motion = RigidMotionOf({10, -20, 30}, 0.5, 0.0, 0.0);
  const Rewriting back = Transform(Transform(text, motion).text, motion.inverse());
  ASSERT_TRUE(back.ok);
  Findings none;
  const ParsedProgram a = Parse(text, none), b = Parse(back.text, none);
  ASSERT_EQ(a.module.nodes.size(), b.module.nodes.size());
  for (std::size_t n = 0; n < a.module.nodes.size(); ++n) {
    EXPECT_NEAR(a.module.nodes[n].number, b.module.nodes[n].number, 1.1e-6) << n;
  }
}

// A program of moves with six decimals between other lines, as a CAD system would not write it.
class RandomMoves {
 public:
  explicit RandomMoves(std::uint32_t seed) : random_(seed) {}

  // millionths in [-range, range]
  double Number(int range) {
    const auto span = static_cast<std::uint32_t>(2 * range) + 1;
    return (static_cast<double>(static_cast<std::uint32_t>(random_()) % span) - range) * 1e-6;
  }
  // The head well away from straight down, where A would be free.
  std::string Pose() {
    std::string text;
    for (int axis = 0; axis < 3; ++axis) text += FixedText(Number(900'000'000), 6) + ", ";
    const double b = 0.2 + 0.5 * (Number(1'000'000) + 1.0);
    return "(" + text + FixedText(Number(3'000'000), 6) + "," + FixedText(b, 6) + ")";
  }
  std::string Make(int moves) {
    std::string text = "COORD ABSOL ; start\n";
    for (int n = 0; n < moves; ++n) {
      text += std::to_string(n) + "\tMOVE " + Pose() + " /";
      if (n % 3 == 0) text += "VIA" + Pose() + "/";
      text += "FLY ; " + std::to_string(n) + "\nSPEED 1.5E1\n";
    }
    return text;
  }

 private:
  std::mt19937 random_;
};

struct MoveNumbers {
  std::vector<std::array<double, 5>> poses;  // targets and via points
  std::string rest;                          // the text without their numbers
};

MoveNumbers NumbersOf(const std::string& text) {
  Findings none;
  const ParsedProgram program = Parse(text, none);
  EXPECT_EQ(none.error_count(), 0U);
  MoveNumbers found;
  std::size_t at = 0;
  for (const Instruction& i : program.module.instructions) {
    if (i.op != Op::kMove) continue;
    for (std::uint32_t e = 0; e < program.module.ExpressionCount(i); ++e) {
      const ExprRange range = program.module.Range(i.first_expression + e);
      const NodePlace& place = program.node_places[range.first];
      if (e % 5 == 0) found.poses.emplace_back();
      found.poses.back()[e % 5] = std::stod(text.substr(place.offset, place.length));
      found.rest += text.substr(at, place.offset - at) + '#';
      at = place.offset + place.length;
    }
  }
  found.rest += text.substr(at);
  return found;
}

// One unit of the sixth decimal: half of one is lost on the way there, the inverse turns that by at
// most its length (half times the root of three), and the nearest six decimals to what comes back
// are the old ones or their neighbours.
constexpr double kOneDecimal = 1e-6 + 1e-9;

// OPT-8.76, OPT-8.77
TEST(Transform, RandomProgramsComeBackFromTheInverse) {
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomMoves random(seed);
    const std::string text = random.Make(20);
    const MachineVector shift{random.Number(500'000'000), random.Number(500'000'000),
                              random.Number(500'000'000)};
    const double turn = random.Number(1'500'000);
    // About Z alone the head keeps its B, and A turns with the part; else the tool's direction says
    // whether the head is right.
    const bool about_z = seed % 2 == 0;
    const RigidMotion motion =
        about_z ? RigidMotionOf(shift, turn, 0, 0)
                : RigidMotionOf(shift, turn, random.Number(3'000'000), random.Number(3'000'000));
    const Rewriting there = Transform(text, motion);
    ASSERT_TRUE(there.ok);
    const Rewriting back = Transform(there.text, motion.inverse());
    ASSERT_TRUE(back.ok);
    const MoveNumbers a = NumbersOf(text), b = NumbersOf(there.text), c = NumbersOf(back.text);
    ASSERT_EQ(b.rest, a.rest);
    ASSERT_EQ(c.rest, a.rest);
    ASSERT_EQ(c.poses.size(), a.poses.size());
    for (std::size_t n = 0; n < a.poses.size(); ++n) {
      // The distance of two points is that of the moved ones.
      const auto point = [](const MoveNumbers& m, std::size_t k) {
        return MachineVector{m.poses[k][0], m.poses[k][1], m.poses[k][2]};
      };
      EXPECT_NEAR((point(b, 0) - point(b, n)).norm(), (point(a, 0) - point(a, n)).norm(), 2e-6);
      for (std::size_t v = 0; v < (about_z ? 5U : 3U); ++v)
        EXPECT_NEAR(c.poses[n][v], a.poses[n][v], kOneDecimal) << n << ' ' << v;
      const motion::MachinePoint old = ToolDirection(a.poses[n][3], a.poses[n][4]);
      const MachineVector turned = ToolDirection(b.poses[n][3], b.poses[n][4]);
      EXPECT_NEAR((motion.linear() * (old)-turned).norm(), 0.0, 1e-6);
      EXPECT_NEAR((ToolDirection(c.poses[n][3], c.poses[n][4]) - old).norm(), 0.0, 2e-6);
    }
  }
}

// OPT-8.77: near straight down six decimals of B hold A to 1e-6 / sin B only; the tool points where
// it did all the same. About Z alone A comes back whatever B is.
TEST(Transform, NearStraightDownTheDirectionComesBack) {
  for (const std::string b : {"0.1", "0.01", "0.001", "0.000016"}) {
    const std::string text = "MOVE (100.0,50.0,-20.0,0.7," + b + ")\n";
    for (const bool about_z : {false, true}) {
      const RigidMotion motion =
          about_z ? RigidMotionOf({1, 2, 3}, 0.5, 0, 0) : RigidMotionOf({1, 2, 3}, 0.5, 0.4, 0.3);
      const Rewriting back = Transform(Transform(text, motion).text, motion.inverse());
      ASSERT_TRUE(back.ok);
      const std::array<double, 5> pose = NumbersOf(back.text).poses[0];
      const double old_b = std::stod(b);
      EXPECT_NEAR((ToolDirection(pose[3], pose[4]) - ToolDirection(0.7, old_b)).norm(), 0.0, 2e-6);
      EXPECT_NEAR(pose[3], 0.7, about_z ? kOneDecimal : 1.5e-6 / std::sin(old_b) + kOneDecimal)
          << b;
      EXPECT_NEAR(pose[0], 100.0, kOneDecimal);
    }
  }
}

// OPT-8.74, OPT-B.81
TEST(Shift, AddsToTheSystemVariables) {
  EXPECT_EQ(Shift("VR[86] = 0. ; X\nVR[87] = 1\nVR[85] = 1\nCALL 45\n", {30, 0.5, 0, 0, 0, 0}).text,
            "VR[86] = 30.0 ; X\nVR[87] = 1.5\nVR[85] = 1\nCALL 45\n");
  EXPECT_EQ(Shift("DECLARE OX = VR[86]\nLET OX = -5.\n", {30, 0, 0, 0, 0, 0}).text,
            "DECLARE OX = VR[86]\nLET OX = 25.0\n");
  EXPECT_EQ(Shift("VR[91] = 0.5\n", {0, 0, 0, 0, 0, 0.25}).text, "VR[91] = 0.75\n");
  // What is not shifted stays as it is written.
  EXPECT_EQ(Shift("VR[86] = 1\nVR[88] = 1\n", {30, 0.5, 0, 0, 0, 0}).text,
            "VR[86] = 31.0\nVR[88] = 1\n");
}

// OPT-8.75, OPT-B.81, OPT-E.7852
TEST(Shift, NeedsSomethingToShift) {
  EXPECT_EQ(FirstFinding(Shift("VR[86] = VR[10]\nVR[5] = 1.\n", {30, 0, 0, 0, 0, 0})), 7852);
  EXPECT_FALSE(Shift("SPEED 5\n", {30, 0, 0, 0, 0, 0}).ok);
}

// OPT-B.80: A turns as smoothly behind a rotation as it did before: a head that swung by half a
// turn between two moves would leave the part.
TEST(Transform, AContourStaysSmooth) {
  std::string text = "COORD ABSOL\nPATH LIN\n";
  for (int k = 0; k <= 60; ++k) {
    text += "MOVE (" + std::to_string(k) + ".0,0.0,0.0," + std::to_string(0.1 * k) + "," +
            std::to_string(1.2 + 0.01 * k) + ")\n";
  }
  const RigidMotion motion = RigidMotionOf({1, 2, 3}, 2.2, 0.1, -0.2);
  const Rewriting turned = Transform(text, motion);
  ASSERT_TRUE(turned.ok);
  const auto poses = NumbersOf(turned.text).poses;
  ASSERT_EQ(poses.size(), 61U);
  for (std::size_t k = 1; k < poses.size(); ++k) {
    EXPECT_LT(std::fabs(poses[k][3] - poses[k - 1][3]), 0.2) << k;
    EXPECT_LT(std::fabs(poses[k][4] - poses[k - 1][4]), 0.1) << k;
  }
  const Rewriting back = Transform(turned.text, motion.inverse());
  ASSERT_TRUE(back.ok);
  const auto wanted = NumbersOf(text).poses, found = NumbersOf(back.text).poses;
  ASSERT_EQ(wanted.size(), found.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    for (std::size_t axis = 0; axis < 5; ++axis) {
      EXPECT_NEAR(found[k][axis], wanted[k][axis], 3e-6) << k;
    }
  }
}

}  // namespace
}  // namespace rmlcell::optimo
