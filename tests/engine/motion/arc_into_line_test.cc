// The curve between an arc and a line that leaves its plane, at the end where it joins the line: it
// is not bent there, but begins to be. motion.md 4.2, 4.3.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/corner_curve.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

struct ArcIntoLine {
  CurveEnd arc;
  CurveEnd line;
  double cut = 0.0;

  // The arc ends in the origin, where the line begins.
  ArcIntoLine(const MachinePoint& from, const MachinePoint& via, const MachinePoint& to, double at)
      : cut(at) {
    const PathPiece in = PathPiece::ArcThrough({from}, via, {})->path;
    arc = EndAt(in, in.length() - cut);
    line = EndAt(PathPiece::Line({}, {to}), cut);
  }
  CornerCurve There() const { return {arc, line, cut}; }
  CornerCurve Back() const {
    CurveEnd first = line, second = arc;
    first.tangent = -first.tangent;
    second.tangent = -second.tangent;
    return {first, second, cut};
  }
};

// The third derivative of the Hermite form of 4.2 at u = 1 is 60 h - 24 v0 - 36 v1 - 3 c0 + 9 c1.
// Where the curve joins a line kappa is 0 and c1 too, and of the rest what lies across the line,
// hence not v1 = L t, is L^3 kappa'.
TEST(ArcIntoLine, JerkOfTheCurveWhereItJoinsTheLine) {
  for (const MachinePoint& to : {MachinePoint{30, 10, 25}, {20, -40, 7}, {50, -13, -33}}) {
    const ArcIntoLine corner({-9, 2, 1}, {-4, 4, 0.5}, to, 2.0);
    const CurveEnd& arc = corner.arc;
    const CurveEnd& line = corner.line;
    const double half_cosine = std::sqrt(0.5 * (1.0 + arc.tangent.dot(line.tangent)));
    const double scale = 2.0 * std::sqrt(half_cosine) * corner.cut;  // L = rho d
    const MachineVector third = (line.pose.point - arc.pose.point) * 60.0 -
                                arc.tangent * (24.0 * scale) -
                                arc.curvature * (3.0 * scale * scale);
    const double want = third.cross(line.tangent).norm() / std::pow(scale, 3.0);
    EXPECT_NEAR(corner.There().JerkPerCube(1.0), want, 1e-9 * want);
    EXPECT_NEAR(corner.Back().JerkPerCube(0.0), want, 1e-9 * want);
  }
}

// Here that end is the slowest place of the curve, by 0.1 %: v = cbrt(j_n / kappa') with
// j_n = 32000 mm/s3, both ways.
TEST(ArcIntoLine, AsFastThereAsBack) {
  const ArcIntoLine corner({5, -18, -19}, {12, -18, -8}, {-9, 5, -6}, 3.0);
  const MachineLimits machine = StandardMachine();
  const double back = SpeedOnCurve(corner.Back(), Head{}, machine);
  EXPECT_NEAR(back, std::cbrt(32000.0 / corner.Back().JerkPerCube(0.0)), 1e-7);
  EXPECT_NEAR(SpeedOnCurve(corner.There(), Head{}, machine), back, 1e-7);
}

}  // namespace
}  // namespace rmlcell::motion
