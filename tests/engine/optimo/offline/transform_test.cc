#include "engine/optimo/offline/transform.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/offline/offset_path.h"

namespace rmlcell::optimo {
namespace {

int FirstFinding(const Rewriting& rewriting) {
  return rewriting.diagnostics.empty() ? 0 : Lookup(rewriting.diagnostics[0].code).number;
}

// OPT-8.76: a rotation of 90 degrees about Z.
TEST(Transform, TurnsPointsAndHead) {
  const RigidMotion quarter = RigidMotion::Of({}, kPi / 2, 0, 0);
  const Rewriting turned = Transform("10 MOVE (10,0,-500,0,0.5)/FLY ; c\nSPEED 5\n", quarter);
  ASSERT_TRUE(turned.ok);
  EXPECT_EQ(turned.text, "10 MOVE (0.0,10.0,-500.0,1.570796,0.5)/FLY ; c\nSPEED 5\n");
  EXPECT_EQ(
      Transform("MOVE (1,2,3,0,0)/VIA (4,5,6,0,0)\n", RigidMotion::Of({100, 0, -1}, 0, 0, 0)).text,
      "MOVE (101.0,2.0,2.0,0.0,0.0)/VIA (104.0,5.0,5.0,0.0,0.0)\n");
}

// OPT-B.80
TEST(Transform, ChoosesTheNearestHeadAngles) {
  const RigidMotion quarter = RigidMotion::Of({}, kPi / 2, 0, 0);
  const HeadAngles negative = TurnHead({0.0, -0.5}, quarter);
  EXPECT_NEAR(negative.a, kPi / 2, 1e-12);
  EXPECT_NEAR(negative.b, -0.5, 1e-12);
  const HeadAngles far = TurnHead({12.0, 0.5}, quarter);
  EXPECT_NEAR(far.a, 12.0 + kPi / 2, 1e-9);
  const HeadAngles down = TurnHead({0.3, 0.0}, quarter);
  EXPECT_NEAR(down.a, 0.3 + kPi / 2, 1e-12);
  EXPECT_NEAR(down.b, 0.0, 1e-12);
}

// The head points where the turned tool points, whatever the angles are.
TEST(Transform, TheToolTurnsWithThePart) {
  for (const double a : {-3.0, 0.4, 2.8}) {
    for (const double b : {-1.5, -0.2, 0.7, 2.0}) {
      const RigidMotion motion = RigidMotion::Of({1, 2, 3}, 0.7, -0.3, 1.1);
      const HeadAngles head = TurnHead({a, b}, motion);
      const Vec3 expected = motion.Turn(ToolDirection(a, b)), found = ToolDirection(head.a, head.b);
      EXPECT_NEAR(motion::Distance(expected, found), 0.0, 1e-12);
    }
  }
}

// OPT-8.77, OPT-E.7851
TEST(Transform, NeedsPlainNumbers) {
  const Rewriting refused = Transform("MOVE (VR[1],0,0,0,0)\n", {});
  EXPECT_FALSE(refused.ok);
  EXPECT_TRUE(refused.text.empty());
  EXPECT_EQ(FirstFinding(refused), 7851);
}

// OPT-8.76: there and back is the same within the rounding of six decimals.
TEST(Transform, TheInverseBringsItBack) {
  const std::string text =
      "MOVE (100.25,-30.5,12.125,0.4,0.7) /VIA (1.5,2.5,3.5,-0.4,1.2)\nMOVE "
      "(1.0,2.0,3.0,3.1,1.5)\n";
  const RigidMotion motion = RigidMotion::Of({10, -20, 30}, 0.5, 0.0, 0.0);
  const Rewriting back = Transform(Transform(text, motion).text, motion.Inverse());
  ASSERT_TRUE(back.ok);
  Findings none;
  const ParsedProgram a = Parse(text, none), b = Parse(back.text, none);
  ASSERT_EQ(a.module.nodes.size(), b.module.nodes.size());
  for (std::size_t n = 0; n < a.module.nodes.size(); ++n) {
    EXPECT_NEAR(a.module.nodes[n].number, b.module.nodes[n].number, 1.1e-6) << n;
  }
}

// OPT-8.74, OPT-B.81
TEST(Shift, AddsToTheSystemVariables) {
  EXPECT_EQ(Shift("VR[86] = 0. ; X\nVR[87] = 1\nVR[85] = 1\nCALL 45\n", {30, 0.5, 0, 0, 0, 0}).text,
            "VR[86] = 30.0 ; X\nVR[87] = 1.5\nVR[85] = 1\nCALL 45\n");
  EXPECT_EQ(Shift("DECLARE OX = VR[86]\nLET OX = -5.\n", {30, 0, 0, 0, 0, 0}).text,
            "DECLARE OX = VR[86]\nLET OX = 25.0\n");
  EXPECT_EQ(Shift("VR[91] = 0.5\n", {0, 0, 0, 0, 0, 0.25}).text, "VR[91] = 0.75\n");
}

// OPT-8.75, OPT-B.81, OPT-E.7852
TEST(Shift, NeedsSomethingToShift) {
  EXPECT_EQ(FirstFinding(Shift("VR[86] = VR[10]\nVR[5] = 1.\n", {30, 0, 0, 0, 0, 0})), 7852);
  EXPECT_FALSE(Shift("SPEED 5\n", {30, 0, 0, 0, 0, 0}).ok);
}

}  // namespace
}  // namespace rmlcell::optimo
