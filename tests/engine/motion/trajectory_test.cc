#include "engine/motion/ride/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Velocities and accelerations of tip and axes are the derivatives of the positions, on every kind
// of piece. motion.md 2.4
TEST(MotionView, DerivativesAgreeWithPositions) {
  std::vector<MoveCommand> chain = RandomChain(7, 30, {.shortest_mm = 1.0});
  MoveCommand joint;
  joint.kind = MoveCommand::Kind::kPointToPointAxes;
  joint.path = PathPiece::Joint({{0, 0, 0}, 0, 0}, {{100, 50, -20}, 1.0, 0.7});
  chain.push_back(joint);
  const double h = 1e-4;
  for (const PlannedMotion& motion : Plan(chain)) {
    const MotionView view(motion);
    const double moving = motion.speed.duration_s();
    if (moving < 10 * h) continue;
    for (const double share : {0.13, 0.5, 0.77}) {
      const double t = share * moving;
      const TrajectoryPoint before = view.At(t - h), here = view.At(t), after = view.At(t + h);
      // A jerk of 40000 over h = 1e-4: speeds are off by 7e-5, accelerations at a phase edge by 4.
      ExpectNear(here.tip_velocity, (after.tip.tip - before.tip.tip) * (0.5 / h), 1e-3);
      ExpectNear(here.tip_acceleration,
                 (after.tip.tip - here.tip.tip * 2.0 + before.tip.tip) * (1.0 / (h * h)), 8.0);
      for (std::size_t i = 0; i < kAxisCount; ++i) {
        EXPECT_NEAR(here.axis_velocity[i], (after.axes[i] - before.axes[i]) * 0.5 / h, 1e-2);
        EXPECT_NEAR(here.axis_acceleration[i],
                    (after.axis_velocity[i] - before.axis_velocity[i]) * 0.5 / h, 10.0);
      }
      ExpectNear(view.PoseAt(t).tip, here.tip.tip, 1e-12);
    }
  }
}

TEST(MotionView, StandsWhileItSettles) {
  const std::vector<PlannedMotion> motions = Plan(RandomChain(1, 1));
  const MotionView view(motions[0]);
  EXPECT_EQ(view.At(view.duration_s()).tip_speed(), 0.0);
  EXPECT_EQ(view.At(view.duration_s() - 0.02).tip, motions[0].path.to());
}

// At its very end a motion that passes on has its speed still.
TEST(MotionView, PassesOnAtItsSpeed) {
  MoveCommand first, second;
  first.path = PathPiece::Line({}, {{100, 0, 0}});
  first.speed_fraction = second.speed_fraction = 0.1;
  second.acceleration_fraction = 0.5;
  first.fly = true;
  second.path = PathPiece::Line({{100, 0, 0}}, {{200, 0, 0}});
  const std::vector<PlannedMotion> plan = Plan({first, second});
  ASSERT_EQ(plan.size(), 2u);
  const MotionView view(plan[0]);
  EXPECT_NEAR(view.At(view.duration_s()).tip_speed(), 50.0, 1e-9);
  EXPECT_EQ(view.At(view.duration_s()).tip.tip, (MachineVector{100, 0, 0}));
}

// Adding 0.1 ten million times loses 1.6e-4 in plain arithmetic.
TEST(LongSum, LosesNothing) {
  LongSum sum;
  for (int k = 0; k < 10'000'000; ++k) sum.Add(0.1);
  EXPECT_NEAR(sum.value(), 1e6, 1e-9);
}

// Samples lie at k / rate whatever the durations; none is lost or doubled at a seam. motion.md
// section 9
TEST(SampleTimes, AreExactMultiples) {
  SampleTimes times(1000.0);
  std::vector<double> seen;
  double end = 0.0;
  for (const double duration : {0.0105, 0.0, 0.0003, 0.0004, 0.0288, 0.001}) {
    end += duration;
    times.Through(duration, [&](double time, double t) {
      EXPECT_GE(t, 0.0);
      EXPECT_LE(t, duration);
      seen.push_back(time);
    });
  }
  ASSERT_EQ(seen.size(), 41u);  // 0 .. 0.040, the end at 0.041 excluded
  for (std::size_t k = 0; k < seen.size(); ++k) EXPECT_EQ(seen[k], static_cast<double>(k) / 1000.0);
  EXPECT_NEAR(times.elapsed_s(), end, 1e-15);
}

double DistanceToChord(const MachinePoint& p, const MachineVector& a, const MachineVector& b) {
  const MachineVector ab = b - a;
  const double square = ab.dot(ab);
  const double share = square > 0.0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
  return (p - (a + ab * share)).norm();
}

// The polyline keeps its tolerance on lines, arcs and blends, and ends where the path ends.
TEST(Polyline, StaysWithinItsTolerance) {
  for (const double tolerance : {0.001, 0.01, 0.5}) {
    for (const PlannedMotion& motion : Plan(RandomChain(11, 40, {.shortest_mm = 0.1}))) {
      std::vector<MachinePoint> points;
      AppendPolyline(motion.path, tolerance, points);
      ASSERT_GE(points.size(), 2u);
      EXPECT_EQ(points.front(), motion.path.from().point);
      EXPECT_EQ(points.back(), motion.path.to().point);
      const PathPiece& path = motion.path;
      for (int k = 1; k < 60; ++k) {
        const MachinePoint p = path.At(path.length() * k / 60).point;
        double nearest = HUGE_VAL;
        for (std::size_t i = 1; i < points.size(); ++i) {
          nearest = std::min(nearest, DistanceToChord(p, points[i - 1], points[i]));
        }
        EXPECT_LE(nearest, 1.05 * tolerance);
      }
    }
  }
}

// ceil(phi / (2 acos(1 - tol/R))): a circle of radius 100 at 0.01 needs 223 chords.
TEST(Polyline, ArcHasAsManyChordsAsNeeded) {
  std::vector<MachinePoint> points;
  AppendPolyline(PathPiece::Circle({{100, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0, 0), 0.01, points);
  EXPECT_EQ(points.size(),
            1 + static_cast<std::size_t>(std::ceil(kTurn / (2 * std::acos(1 - 1e-4)))));
}

// No chord spans more than a quarter turn, however coarse the tolerance; an arc of a quarter turn
// and a little more has two.
TEST(Polyline, CoarseArcs) {
  for (const auto& [sweep, chords] :
       {std::pair{kTurn, 4u}, {0.5 * kTurn, 2u}, {0.24 * kTurn, 1u}, {0.26 * kTurn, 2u}}) {
    for (const double tolerance : {60.0, 99.0, 100.0, 1e6}) {
      std::vector<MachinePoint> points;
      AppendPolyline(PathPiece::Circle({{100, 0, 0}}, {0, 0, 0}, {0, 0, 1}, sweep, 0, 0), tolerance,
                     points);
      EXPECT_EQ(points.size(), 1 + chords) << sweep << " " << tolerance;
    }
  }
}

// Without any tolerance an arc has as many chords as one may have, and no more.
TEST(Polyline, AnArcHasNoMoreThanAMillionChords) {
  std::vector<MachinePoint> points;
  AppendPolyline(PathPiece::Circle({{100, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0, 0), 0.0, points);
  EXPECT_EQ(points.size(), 1u + 1'048'576u);
}

// A blend is halved twice however coarse the tolerance, and twelve times at most.
TEST(Polyline, HalvesABlend) {
  MoveCommand first, second;
  first.path = PathPiece::Line({}, {{100, 0, 0}});
  first.fly = true;
  second.path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  const std::vector<PlannedMotion> plan = Plan({first, second});
  ASSERT_EQ(plan[1].path.kind(), PathPiece::Kind::kBlend);
  for (const auto& [tolerance, chords] : {std::pair{1e6, 4u}, {-1.0, 4096u}}) {
    std::vector<MachinePoint> points;
    AppendPolyline(plan[1].path, tolerance, points);
    EXPECT_EQ(points.size(), 1 + chords);
    EXPECT_EQ(points.back(), plan[1].path.to().point);
  }
}

// Pieces one behind the other share their point; what does not move the tip adds none.
TEST(Polyline, GoesOn) {
  std::vector<MachinePoint> points;
  AppendPolyline(PathPiece::Line({}, {{10, 0, 0}}), 0.01, points);
  AppendPolyline(PathPiece::Line({{10, 0, 0}}, {{10, 5, 0}}), 0.01, points);
  AppendPolyline(PathPiece::Line({{10, 5, 0}}, {{10, 5, 0}, 1, 0}), 0.01, points);
  AppendPolyline(PathPiece::Line({{10, 5, 0}}, {{10, 5, 0}}), 0.01, points);
  EXPECT_EQ(points, (std::vector<MachinePoint>{{0, 0, 0}, {10, 0, 0}, {10, 5, 0}}));
  AppendPolyline(PathPiece::Joint({{20, 5, 0}}, {{20, 5, 7}}), 0.01, points);
  EXPECT_EQ(points,
            (std::vector<MachinePoint>{{0, 0, 0}, {10, 0, 0}, {10, 5, 0}, {20, 5, 0}, {20, 5, 7}}));
}

// A number next to which the sum so far is small is not lost, nor what it hides.
TEST(LongSum, KeepsWhatALargeNumberHides) {
  LongSum sum;
  for (const double value : {1.0, 1e100, 1.0, -1e100}) sum.Add(value);
  EXPECT_EQ(sum.value(), 2.0);
}

// Whether a motion has a sample: those at 0.010 and 0.020 belong to the motions that begin there.
TEST(SampleTimes, TellWhetherThereIsOne) {
  SampleTimes times(100.0);
  std::vector<double> seen;
  const auto through = [&](double duration) {
    const bool one = times.NextWithin(duration);
    const std::size_t before = seen.size();
    times.Through(duration, [&](double, double t) { seen.push_back(t); });
    EXPECT_EQ(one, seen.size() > before);
    return one;
  };
  EXPECT_TRUE(through(0.010));  // at 0
  EXPECT_TRUE(through(0.004));  // at 0.010
  EXPECT_FALSE(through(0.005));
  EXPECT_TRUE(through(0.002));  // at 0.020
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0], 0.0);
  EXPECT_EQ(seen[1], 0.0);
  EXPECT_NEAR(seen[2], 0.001, 1e-15);
}

// motion.md 2.4 and 2.2: the same instant told of the tip and of the column, in either kind of
// move.
TEST(MotionView, TipAndColumnAgree) {
  for (const bool joint : {true, false}) {
    MoveCommand move;
    const TipPose from{{10, 20, 30}, 0.2, 0.3}, to{{110, -40, 70}, 1.2, -0.8};
    move.path =
        joint ? PathPiece::Joint({from.tip, from.a_rad, from.b_rad}, {to.tip, to.a_rad, to.b_rad})
              : PathPiece::Line(from, to);
    if (joint) move.kind = MoveCommand::Kind::kPointToPointAxes;
    move.head = GantryHead{.length_mm = 120.0, .tool = {3.0, -5.0, 8.0}};
    const std::vector<PlannedMotion> plan = Plan({move});
    const MotionView view(plan[0]);
    const double h = 1e-5, t = 0.4 * plan[0].speed.duration_s();
    const TrajectoryPoint here = view.At(t), before = view.At(t - h), after = view.At(t + h);
    const AxisPose column = move.head.ColumnOf(here.tip);
    ExpectNear({here.axes[0], here.axes[1], here.axes[2]}, column.column, 1e-10);
    EXPECT_EQ(here.axes[3], here.tip.a_rad);
    EXPECT_EQ(here.axes[4], here.tip.b_rad);
    ExpectNear(here.tip_velocity, (after.tip.tip - before.tip.tip) * (0.5 / h), 1e-4);
    ExpectNear(here.tip_acceleration, (after.tip_velocity - before.tip_velocity) * (0.5 / h), 0.5);
    for (std::size_t i = 0; i < kAxisCount; ++i) {
      EXPECT_NEAR(here.axis_velocity[i], (after.axes[i] - before.axes[i]) * 0.5 / h, 1e-4);
      EXPECT_NEAR(here.axis_acceleration[i],
                  (after.axis_velocity[i] - before.axis_velocity[i]) * 0.5 / h, 0.5);
    }
    EXPECT_NEAR(here.tip_speed(), here.tip_velocity.norm(), 1e-12);
    ExpectNear(view.PoseAt(t).tip, here.tip.tip, 1e-12);
  }
}

}  // namespace
}  // namespace rmlcell::motion
