#include "engine/motion/corner/corner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

struct Bend {
  PathPiece in, out;
  Corner corner;
  CornerCurve curve;
};

// Two lines that meet at the origin under `degrees`, the curve cut at 1 mm.
Bend Of(double degrees, double cut = 1.0) {
  const double turn = degrees * kPi / 180.0;
  Bend bend;
  bend.in = PathPiece::Line({{-50, 0, 0}}, {{0, 0, 0}});
  bend.out = PathPiece::Line({{0, 0, 0}}, {{50 * std::cos(turn), 50 * std::sin(turn), 0}});
  bend.corner = Corner::Between(bend.in, bend.out);
  bend.curve = CornerCurve(EndAt(bend.in, 50.0 - cut), EndAt(bend.out, cut), cut);
  return bend;
}

// Peak curvature K/d in the middle and deviation d sin(theta/2) (1 - 5 rho/16); motion.md 4.2.
// OPT-B.24
TEST(Corner, CurvatureAndDeviationFollowTheFormulas) {
  for (const double degrees : {0.5, 10.0, 45.0, 90.0, 135.0, 170.0}) {
    const double half = degrees * kPi / 360.0;
    const double rho = 2.0 * std::sqrt(std::cos(half));
    const double k =
        0.75 * rho * std::sin(half) / std::pow(std::cos(half) * (15.0 / 8 - 7 * rho / 16), 2);
    const Bend bend = Of(degrees, 2.0);
    const double middle = bend.curve.SecondByLength(0.5).point.norm();
    EXPECT_NEAR(middle, k / 2.0, 1e-9 * k);
    double peak = 0.0;
    for (int i = 0; i <= 2000; ++i)
      peak = std::max(peak, bend.curve.SecondByLength(i / 2000.0).point.norm());
    EXPECT_NEAR(peak, k / 2.0, 1e-9 * k) << degrees;
    const double deviation = 2.0 * std::sin(half) * (1 - 5 * rho / 16);
    EXPECT_NEAR(bend.corner.PlainDeviation(2.0), deviation, 1e-12);
    EXPECT_NEAR(bend.curve.DistanceFrom({0, 0, 0}), deviation, 1e-9);
  }
}

// J(theta)/d^2 bounds sqrt(kappa'^2 + kappa^4) from above by at most 6 %, so a corner of full size
// is never slower than wanted: motion.md 4.3. The speed of a capped one is the bound itself, to
// 1e-6, but 2e-5 where the peak of jerk passes from the ends of the curve to its middle.
TEST(Corner, UncappedCornersNeedNoBound) {
  const MachineLimits machine = StandardMachine();
  for (double degrees = 0.5; degrees < 175.0; degrees += 0.137) {
    const Bend bend = Of(degrees);
    const double exact = SpeedOnCurve(bend.curve, Head{}, machine);
    const double table = bend.corner.PlainSpeed(1.0, machine);
    EXPECT_LE(table, exact * (1 + 1e-9)) << degrees;
    EXPECT_GE(table, exact * (1 - (std::abs(degrees - 136.6) < 0.2 ? 2e-5 : 2e-6))) << degrees;
    for (const double w : {1.0, 40.0, 300.0}) {
      const double cut = bend.corner.CutFor(w, machine);
      EXPECT_GE(bend.corner.PlainSpeed(cut, machine), w * (1 - 1e-12)) << degrees;
      EXPECT_LE(bend.corner.PlainSpeed(cut, machine), w * 1.03)
          << degrees;  // cbrt(1.06), sqrt(1.04)
    }
  }
}

// The same up to the sharpest turn that is a bend, where its table ends.
TEST(Corner, ThePeakOfJerkUpTo175Degrees) {
  const MachineLimits machine = StandardMachine();
  for (const double degrees : {174.93, 174.96, 174.99}) {
    const Bend bend = Of(degrees);
    const double exact = SpeedOnCurve(bend.curve, Head{}, machine);
    EXPECT_LE(bend.corner.PlainSpeed(1.0, machine), exact * (1 + 1e-9)) << degrees;
    EXPECT_GE(bend.corner.PlainSpeed(1.0, machine), exact * (1 - 2e-6)) << degrees;
  }
}

// Length by the table and by quadrature agree; the curve lies inside the triangle of its control
// points.
TEST(Corner, LengthAndTriangle) {
  for (double degrees = 0.3; degrees < 175.0; degrees += 2.9) {
    const Bend bend = Of(degrees);
    EXPECT_NEAR(bend.corner.PlainLength(1.0), CornerLength(bend.curve).total(), 1e-10) << degrees;
    double chords = 0.0;
    for (int k = 1; k <= 20000; ++k) {
      chords += (bend.curve.At((k - 1) / 20000.0).point - bend.curve.At(k / 20000.0).point).norm();
    }
    EXPECT_NEAR(CornerLength(bend.curve).total(), chords, 2e-8) << degrees;
    const double turn = degrees * kPi / 180.0;
    for (int k = 0; k <= 100; ++k) {
      const MachinePoint p = bend.curve.At(k / 100.0).point;
      // Coordinates along both legs, from the corner: -x * in + y * out.
      const double y = p.y() / std::sin(turn);
      const double x = y * std::cos(turn) - p.x();
      EXPECT_GE(x, -1e-12);
      EXPECT_GE(y, -1e-12);
      EXPECT_LE(x + y, 1.0 + 1e-12);
    }
  }
}

// u(s) inverts the arc length to 1e-9 mm, also in sharp corners. motion.md section 9
TEST(CornerCurve, ParameterInvertsTheLength) {
  for (const double degrees : {1.0, 90.0, 150.0, 174.9}) {
    const CornerCurve curve = Of(degrees, 30.0).curve;
    const CornerLength length(curve);
    MachinePoint last = curve.At(0.0).point;
    const int steps = 3000;
    for (int k = 1; k <= steps; ++k) {
      const MachinePoint here =
          curve.At(length.ParameterAt(curve, length.total() * k / steps)).point;
      // Chord against arc: kappa^2 s^3 / 24, with kappa at most 18 / 30 and s of 0.02.
      EXPECT_NEAR((last - here).norm(), length.total() / steps, 2e-7) << degrees << " " << k;
      last = here;
    }
  }
}

// Ends meet the pieces in place, direction, curvature and head rates: line into a turning arc.
TEST(CornerCurve, MeetsBothPieces) {
  const PathPiece in = PathPiece::Line({{0, 0, 0}, 0.0, 0.5}, {{50, 0, 0}, 0.4, 0.5});
  const Result<PathPiece::Arc3> arc =
      PathPiece::ArcThrough({{50, 0, 0}, 0.4, 0.5}, {64, 7, 3}, {{70, 20, 8}, 0.1, 0.9});
  ASSERT_TRUE(arc);
  const CurveEnd from = EndAt(in, 48.0), to = EndAt(arc->path, 2.0);
  const CornerCurve curve(from, to, 2.0);
  for (const auto& [u, end] : {std::pair{0.0, from}, std::pair{1.0, to}}) {
    EXPECT_LE((curve.At(u).point - end.pose.point).norm(), 1e-12);
    EXPECT_NEAR(curve.At(u).a_rad, end.pose.a_rad, 1e-14);
    EXPECT_LE((curve.FirstByLength(u).point - end.tangent).norm(), 1e-13);
    EXPECT_LE((curve.SecondByLength(u).point - end.curvature).norm(), 1e-13);
    EXPECT_NEAR(curve.FirstByLength(u).b, end.b_rate, 1e-14);
    EXPECT_NEAR(curve.SecondByLength(u).b, 0.0, 1e-13);
  }
}

// motion.md 4.4: rates of the head that differ by rounding alone, 1e-12 rad/mm or 1e-9 of them,
// meet.
TEST(Corner, RatesThatMeet) {
  const auto passage = [](double before, double after, bool a) {
    const auto line = [a](double from_x, double from, double to) {
      return PathPiece::Line({{from_x, 0, 0}, a ? from : 0.0, a ? 0.0 : from},
                             {{from_x + 1.0, 0, 0}, a ? to : 0.0, a ? 0.0 : to});
    };
    return Corner::Between(line(-1.0, -before, 0.0), line(0.0, 0.0, after)).passage();
  };
  for (const bool a : {true, false}) {
    EXPECT_EQ(passage(0.0, 1e-12, a), Passage::kThrough);
    EXPECT_EQ(passage(0.0, 1.001e-12, a), Passage::kBlend);
    EXPECT_EQ(passage(-1e-12, 0.0, a), Passage::kThrough);
    EXPECT_EQ(passage(0.5, 0.5 * (1 + 0.9e-9), a), Passage::kThrough);
    EXPECT_EQ(passage(0.5, 0.5 * (1 + 1.1e-9), a), Passage::kBlend);
    EXPECT_EQ(passage(0.5, -0.5, a), Passage::kBlend);
  }
}

// A corner that is assigned anew is as if it were new: nothing is left of a bend beside an arc.
TEST(Corner, IsReusedForOthers) {
  const PathPiece in = PathPiece::Line({{0, 0, 0}, 0.0, 0.5}, {{50, 0, 0}, 0.4, 0.9});
  const PathPiece arc =
      PathPiece::Circle({{50, 0, 0}, 0.4, 0.9}, {50, 20, 0}, {0, 0, 1}, 1.5, 0, 0);
  const MachineLimits machine = StandardMachine();
  Corner corner = Corner::Between(in, arc);
  ASSERT_EQ(corner.cut_max_mm(), 10.0);
  ASSERT_FALSE(corner.plain());
  // A turn of a degree is cut by so little that a jump of what was before would decide.
  for (const double degrees : {90.0, 1.0, 0.0}) {
    const Bend bend = Of(degrees);
    corner.Assign(in, arc);
    corner.Assign(bend.in, bend.out);
    EXPECT_EQ(corner.passage(), degrees > 0.0 ? Passage::kBlend : Passage::kThrough);
    EXPECT_EQ(corner.straight(), degrees == 0.0);
    EXPECT_TRUE(corner.plain());
    EXPECT_TRUE(corner.lines());
    EXPECT_EQ(corner.cut_max_mm(), HUGE_VAL);
    if (degrees > 0.0) {
      EXPECT_EQ(corner.CutFor(60.0, machine), bend.corner.CutFor(60.0, machine));
      EXPECT_EQ(corner.CutFor(300.0, machine), bend.corner.CutFor(300.0, machine));
    }
  }
}

// Line into an arc of radius 20, straight on, at 60 mm/s: d = 1.2 / 20 * 60^3 / 32000 = 0.405.
// OPT-B.26
TEST(Corner, CurvatureJumpDecidesTheCut) {
  const PathPiece in = PathPiece::Line({{0, 0, 0}}, {{50, 0, 0}});
  const PathPiece out = PathPiece::Circle({{50, 0, 0}}, {50, 20, 0}, {0, 0, 1}, 1.5, 0, 0);
  const Corner corner = Corner::Between(in, out);
  EXPECT_EQ(corner.passage(), Passage::kBlend);
  EXPECT_TRUE(corner.straight());
  EXPECT_NEAR(corner.CutFor(60.0, StandardMachine()), 0.405, 1e-9);
  EXPECT_EQ(corner.cut_max_mm(), 10.0);
  // Two parts of one circle pass into each other.
  EXPECT_EQ(Corner::Between(out.Part(0, 10), out.Part(10, 20)).passage(), Passage::kThrough);
}

}  // namespace
}  // namespace rmlcell::motion
