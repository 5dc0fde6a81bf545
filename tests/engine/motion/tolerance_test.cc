// The tolerances of motion.md section 1 from both sides, and what a planner takes or refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/motion/geometry/hole.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

MoveCommand MoveAlong(const PathPiece& path, bool fly = false) {
  MoveCommand move;
  move.path = path;
  move.speed_fraction = 0.1;
  move.fly = fly;
  return move;
}
MoveCommand LineOf(const TipPose& from, const TipPose& to, bool fly = false) {
  return MoveAlong(PathPiece::Line(from, to), fly);
}

std::vector<PlannedMotion> Drained(Planner& planner) {
  planner.Stop();
  std::vector<PlannedMotion> motions;
  while (const auto item = planner.Next()) motions.push_back(std::get<PlannedMotion>(*item));
  return motions;
}

// Tip length zero: 1e-6 mm.
TEST(Tolerance, TipLengthZero) {
  EXPECT_EQ(PathPiece::Line({}, {{0.99e-6, 0, 0}}).length(), 0.0);
  EXPECT_EQ(PathPiece::Line({}, {{1e-6, 0, 0}}).length(), 0.0);
  EXPECT_EQ(PathPiece::Line({}, {{1.01e-6, 0, 0}}).length(), 1.01e-6);
  EXPECT_EQ(PathPiece::Line({}, {{0, 0.99e-6, 0}, 0, 1}).kind(), PathPiece::Kind::kRotary);
  EXPECT_EQ(PathPiece::Line({}, {{0, 0.99e-6, 0}, 1, 0}).kind(), PathPiece::Kind::kRotary);
  EXPECT_EQ(PathPiece::Line({}, {{0, 1.01e-6, 0}, 0, 1}).kind(), PathPiece::Kind::kLine);
}

// Arc points coincide within 1e-4 mm: start and target, via and either end. motion.md 3.2
TEST(Tolerance, ArcPoints) {
  using Case = PathPiece::ArcCase;
  const auto kind = [](const MachinePoint& via, const MachinePoint& to) {
    return PathPiece::ArcThrough({}, via, {to})->kind;
  };
  EXPECT_EQ(kind({5e-5, 5e-5, 0}, {0.99e-4, 0, 0}), Case::kNoTipMotion);
  EXPECT_EQ(kind({2, 2, 0}, {1.01e-4, 0, 0}), Case::kArc);
  EXPECT_FALSE(PathPiece::ArcThrough({}, {2, 2, 0}, {{0.99e-4, 0, 0}}));
  EXPECT_FALSE(PathPiece::ArcThrough({}, {0, 1.01e-4, 0}, {{0.5e-4, 0, 0}}));
  EXPECT_EQ(kind({0, 0.99e-4, 0}, {10, 0, 0}), Case::kLineWarned);
  EXPECT_EQ(kind({0, 1.01e-4, 0}, {10, 0, 0}), Case::kArc);
  EXPECT_EQ(kind({10, 0.99e-4, 0}, {10, 0, 0}), Case::kLineWarned);
  EXPECT_EQ(kind({10, 1.01e-4, 0}, {10, 0, 0}), Case::kArc);
  EXPECT_EQ(kind({5, 0.99e-4, 0}, {10, 0, 0}), Case::kLineWarned);
  // On the line, just outside the start or the target.
  EXPECT_FALSE(PathPiece::ArcThrough({}, {-1.1e-4, 0, 0}, {{10, 0, 0}}));
  EXPECT_FALSE(PathPiece::ArcThrough({}, {10 + 1.1e-4, 0, 0}, {{10, 0, 0}}));
  EXPECT_EQ(kind({1.1e-4, 0, 0}, {10, 0, 0}), Case::kLineWarned);
  EXPECT_EQ(PathPiece::ArcThrough({}, {5, 5, 0}, {}).error().detail,
            "the arc ends where it begins");
  EXPECT_EQ(PathPiece::ArcThrough({}, {15, 0, 0}, {{10, 0, 0}}).error().detail,
            "the via point is on the line through start and target, outside them");
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
    for (const Result<PathPiece::Arc3>& arc :
         {PathPiece::ArcThrough({{bad, 0, 0}}, {5, 5, 0}, {{10, 0, 0}}),
          PathPiece::ArcThrough({}, {5, bad, 0}, {{10, 0, 0}}),
          PathPiece::ArcThrough({}, {5, 5, 0}, {{10, 0, bad}})}) {
      ASSERT_FALSE(arc);
      EXPECT_EQ(arc.error().code, ErrorCode::kCellArcUndefined);
      EXPECT_EQ(arc.error().detail, "a coordinate is not a number");
    }
  }
}

// motion.md 3.3: a start within 1e-6 mm of the axis is on it; one within 1e-6 mm of the entry
// begins with the circle; a normal point within 1e-6 mm of the centre is none.
TEST(Tolerance, Holes) {
  const HoleCommand standard{
      .from = {{0, 0, 5}}, .centre = {{0, 0, 0}}, .normal_point = {0, 0, 1}, .radius_mm = 5.0};
  const auto with = [&](auto change) {
    HoleCommand hole = standard;
    change(hole);
    return HoleThrough(hole).value();
  };
  const HolePath on_axis = with([](HoleCommand& h) { h.from.tip = {0, 0.99e-6, 5}; });
  EXPECT_TRUE(on_axis.starts_on_axis);
  ExpectNear(on_axis.circle.from().point, {5, 0, 0});
  const HolePath off_axis = with([](HoleCommand& h) { h.from.tip = {0, 1.01e-6, 5}; });
  EXPECT_FALSE(off_axis.starts_on_axis);
  ExpectNear(off_axis.circle.from().point, {0, 5, 0});
  EXPECT_EQ(with([](HoleCommand& h) { h.from.tip = {5 + 0.99e-6, 0, 0}; }).lead.length(), 0.0);
  EXPECT_GT(with([](HoleCommand& h) { h.from.tip = {5 + 1.01e-6, 0, 0}; }).lead.length(), 0.0);
  HoleCommand hole = standard;
  hole.normal_point = {0, 0, 1.01e-6};
  EXPECT_TRUE(HoleThrough(hole));
  hole.normal_point = {0, 0, 0.99e-6};
  EXPECT_EQ(HoleThrough(hole).error().detail, "the normal point is the centre");
  hole.radius_mm = -1.5;
  EXPECT_EQ(HoleThrough(hole).error().detail, "radius is -1.5");
  hole.radius_mm = kNaN;
  EXPECT_EQ(HoleThrough(hole).error().code, ErrorCode::kCellHoleRadius);
}

// On the axis: X of the program, projected, unless |n X| > 0.9, then Y. OPT-B.12
TEST(Tolerance, EntryOfAHoleOnItsAxis) {
  for (const double sign : {1.0, -1.0}) {
    for (const double cosine : {0.899, 0.901}) {
      const double sine = std::sqrt(1.0 - cosine * cosine);
      const MachineVector normal{sign * cosine, 0, sine};
      const HolePath path =
          HoleThrough({.from = {}, .centre = {}, .normal_point = normal, .radius_mm = 2.0}).value();
      const MachineVector along_x = MachineVector{sine, 0, -sign * cosine} * 2.0;
      ExpectNear(path.circle.from().point, cosine < 0.9 ? along_x : MachineVector{0, 2, 0}, 1e-12);
      EXPECT_DOUBLE_EQ(path.circle.length(), 2.0 * kTurn);
    }
  }
}

// Coordinates and angles up to 1e12 in all are numbers to work with; more, or none, is refused.
// What takes more than 1e9 s is no motion. A start is looked at like a target. OPT-B.22
TEST(Tolerance, UsableNumbers) {
  const auto code = [](const TipPose& from, const TipPose& to) {
    MoveCommand move = LineOf(from, to);
    move.speed_fraction = 1.0;
    const Status status = Planner(StandardMachine()).Append(move);
    return status ? std::optional<ErrorCode>() : status.error().code;
  };
  EXPECT_EQ(code({}, {{4.9e11, 0, 0}}), std::nullopt);
  EXPECT_EQ(code({}, {{0, 5.1e11, 0}}), ErrorCode::kCellNoMotion);
  EXPECT_EQ(code({}, {{9.9e11, 0, 0}}), ErrorCode::kCellNoMotion);
  for (const TipPose& far :
       {TipPose{{1.01e12, 0, 0}}, TipPose{{0, -1.01e12, 0}}, TipPose{{0, 0, 1.01e12}},
        TipPose{{}, 1.01e12, 0}, TipPose{{}, 0, -1.01e12}, TipPose{{4e11, -4e11, 4e11}},
        TipPose{{kNaN, 0, 0}}, TipPose{{}, kNaN, 0},
        TipPose{{}, 0, std::numeric_limits<double>::infinity()}}) {
    EXPECT_EQ(code({}, far), ErrorCode::kCellTargetUnusable);
    EXPECT_EQ(code(far, {}), ErrorCode::kCellTargetUnusable);
    EXPECT_EQ(code(far, far), ErrorCode::kCellTargetUnusable);
  }
}

// motion.md 5.1: what is told of SPEED 0 and of too little ACCEL, and of what would take for ever.
TEST(Tolerance, NoMotion) {
  MoveCommand move = LineOf({}, {{10, 0, 0}});
  const auto detail = [&] { return Planner(StandardMachine()).Append(move).error().detail; };
  move.speed_fraction = 0.0;
  EXPECT_EQ(detail(), "the speed is 0");
  move.speed_fraction = 1e-11;  // 5e-9 mm/s: 2e9 s
  EXPECT_EQ(detail(), "the speed is too low to ever arrive");
  move.speed_fraction = 0.5;
  move.acceleration_fraction = 0.0005;
  EXPECT_EQ(detail(), "the acceleration is 0.05 %");
  move.speed_fraction = 3e-11;
  move.acceleration_fraction = 1.0;
  EXPECT_TRUE(Planner(StandardMachine()).Append(move));
}

// A line begins where the machine is, when that is up to 1e-3 mm from where it was told: moves too
// short to be made leave such gaps. A longer gap, or another angle, is not bridged.
TEST(Tolerance, LinesBeginWhereTheMachineIs) {
  for (const double gap : {0.9e-3, 1.1e-3}) {
    Planner planner(StandardMachine());
    ASSERT_TRUE(planner.Append(LineOf({}, {{10, 0, 0}})));
    ASSERT_TRUE(planner.Append(LineOf({{10 + gap, 0, 0}}, {{20, 0, 0}})));
    const auto motions = Drained(planner);
    ASSERT_EQ(motions.size(), 2u);
    EXPECT_EQ(motions[1].path.from().point.x(), gap < 1e-3 ? 10.0 : 10.0 + gap);
  }
  for (const TipPose& from :
       {TipPose{{10.0005, 0, 0}, 1e-9, 0}, TipPose{{10.0005, 0, 0}, 0, 1e-9}}) {
    Planner planner(StandardMachine());
    ASSERT_TRUE(planner.Append(LineOf({}, {{10, 0, 0}})));
    ASSERT_TRUE(planner.Append(LineOf(from, {{20, 0, 0}, from.a_rad, from.b_rad})));
    EXPECT_EQ(Drained(planner)[1].path.from(), from);
  }
  // A turn of the head, and a move to where it is believed to be already, bridge it as well.
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineOf({}, {{10, 0, 0}})));
  ASSERT_TRUE(planner.Append(LineOf({{10.0005, 0, 0}}, {{10.0005, 0, 0}, 0, 0.1})));
  ASSERT_TRUE(planner.Append(LineOf({{10.0009, 0, 0}, 0, 0.1}, {{10.0009, 0, 0}, 0, 0.1})));
  const auto motions = Drained(planner);
  ASSERT_EQ(motions.size(), 3u);
  EXPECT_NEAR(motions[1].path.length(), 5e-4, 1e-12);
  EXPECT_NEAR(motions[2].path.length(), 4e-4, 1e-12);
}

// In COORD ROBOT a move to where it is believed to be bridges it too; an arc, however short, stays
// where it is.
TEST(Tolerance, WhatBridgesAGapIsStraight) {
  Planner in_axes(StandardMachine());
  for (const PathPiece& path : {PathPiece::Joint({}, {{10, 0, 0}}),
                                PathPiece::Joint({{10.0005, 0, 0}}, {{10.0005, 0, 0}})}) {
    MoveCommand move = MoveAlong(path);
    move.kind = MoveCommand::Kind::kPointToPointAxes;
    ASSERT_TRUE(in_axes.Append(move));
  }
  const auto joints = Drained(in_axes);
  ASSERT_EQ(joints.size(), 2u);
  EXPECT_EQ(joints[1].path.from().point.x(), 10.0);
  EXPECT_EQ(joints[1].path.to().point.x(), 10.0005);

  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineOf({}, {{10, 0, 0}})));
  ASSERT_TRUE(planner.Append(MoveAlong(
      PathPiece::Circle({{10.0005, 0, 0}}, {10.0005, 0.5, 0}, {0, 0, 1}, 1.5, 0.0, 0.0))));
  const auto motions = Drained(planner);
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[1].path.kind(), PathPiece::Kind::kArc);
  EXPECT_EQ(motions[1].path.from().point.x(), 10.0005);
}

// The least ACCEL is enough, also where it makes little of a way that counts as one: 3 m in COORD
// ROBOT at 2 mm/s2.
TEST(Tolerance, TheLeastAccelerationIsEnough) {
  MoveCommand move = MoveAlong(PathPiece::Joint({}, {{3000, 0, 0}}));
  move.kind = MoveCommand::Kind::kPointToPointAxes;
  move.acceleration_fraction = 0.001;
  EXPECT_TRUE(Planner(StandardMachine()).Append(move));
}

// An arc that begins within 1e-6 mm of where the line ends goes on from it; farther off the
// machine stands between them.
TEST(Tolerance, ArcsGoOnFromWhereTheLineEnds) {
  for (const double gap : {0.9e-6, 1.1e-6}) {
    Planner planner(StandardMachine());
    ASSERT_TRUE(planner.Append(LineOf({}, {{50, 0, 0}}, true)));
    ASSERT_TRUE(planner.Append(
        MoveAlong(PathPiece::Circle({{50 + gap, 0, 0}}, {50 + gap, 20, 0}, {0, 0, 1}, 1.5, 0, 0))));
    for (const PlannedMotion& motion : Drained(planner)) {
      if (!motion.ends_move) continue;
      EXPECT_EQ(motion.corner.passage, gap < 1e-6 ? Passage::kBlend : Passage::kStop);
      break;
    }
  }
}

// A passage is one move when both limits agree to 1e-9: then OVERSH 100 leaves no knot there, and
// the curve behind may reach over it. What shows: the speeds of moves whose SPEED differs by more.
TEST(Tolerance, MovesThatAreOne) {
  for (const double factor : {1.0 + 0.5e-9, 1.0 + 1e-3}) {
    Planner planner(StandardMachine());
    MoveCommand second = LineOf({{10, 0, 0}}, {{20, 0, 0}});
    second.speed_fraction = 0.1 * factor;
    ASSERT_TRUE(planner.Append(LineOf({}, {{10, 0, 0}}, true)));
    ASSERT_TRUE(planner.Append(second));
    const auto motions = Drained(planner);
    ASSERT_EQ(motions.size(), 2u);
    EXPECT_EQ(motions[0].corner.passage, Passage::kThrough);
    EXPECT_EQ(motions[1].speed.peak_speed() > 50.01, factor > 1.0001);
  }
}

// motion.md section 6: a chain that goes on at a speed. 100 mm from 30 mm/s to rest; and 0.82 mm is
// what 30 mm/s take to rest (15 * 2 sqrt(30/40000) = 0.8216): less is too fast, and is told.
TEST(BeginMoving, GoesOnAtTheSpeed) {
  Planner planner(StandardMachine());
  planner.BeginMoving(30.0);
  ASSERT_TRUE(planner.Append(LineOf({}, {{100, 0, 0}})));
  const auto motions = Drained(planner);
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_FALSE(planner.starts_too_fast());
  EXPECT_EQ(motions[0].speed.At(0.0).speed, 30.0);
  const double up = 2.0 * std::sqrt(20.0 / 40000.0), down = 2.0 * std::sqrt(50.0 / 40000.0);
  EXPECT_NEAR(motions[0].speed.duration_s(), up + down + (100.0 - 40.0 * up - 25.0 * down) / 50.0,
              1e-12);
  for (const double length : {0.82, 0.823}) {
    Planner braking(StandardMachine());
    braking.BeginMoving(30.0);
    ASSERT_TRUE(braking.Append(LineOf({}, {{length, 0, 0}})));
    (void)Drained(braking);
    EXPECT_EQ(braking.starts_too_fast(), length < 0.8216);
  }
}

// Exactly the way that 30 mm/s take to rest, 30 sqrt(30 / 40000) mm, is enough; a part in 1e8 less
// is not. motion.md 5.2
TEST(BeginMoving, ExactlyTheWayToRestIsEnough) {
  for (const double share : {1.0, 1.0 - 1e-8}) {
    Planner braking(StandardMachine());
    braking.BeginMoving(30.0);
    const double length = 30.0 * std::sqrt(30.0 / 40000.0) * share;
    ASSERT_TRUE(braking.Append(LineOf({}, {{length, 0, 0}})));
    ASSERT_EQ(Drained(braking).size(), 1u);
    EXPECT_EQ(braking.starts_too_fast(), share < 1.0) << share;
  }
}

// In COORD ROBOT the speed is that of sigma: 0.1 of 1000 mm a second is 100 mm/s, 0.4 of full
// speed.
TEST(BeginMoving, InAxesBySigma) {
  Planner planner(StandardMachine());
  planner.BeginMoving(0.1);
  MoveCommand move = MoveAlong(PathPiece::Joint({}, {{1000, 0, 0}}));
  move.kind = MoveCommand::Kind::kPointToPointAxes;
  move.speed_fraction = 0.5;
  ASSERT_TRUE(planner.Append(move));
  const auto motions = Drained(planner);
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_DOUBLE_EQ(motions[0].path.length(), 4.0);
  EXPECT_DOUBLE_EQ(motions[0].speed.At(0.0).speed, 0.4);
  PlannedMotion measured = motions[0];
  measured.restart_speed = 3.0;
  measured.MeasureBy(0.5);
  EXPECT_DOUBLE_EQ(measured.path.length(), 2.0);
  EXPECT_DOUBLE_EQ(measured.speed.At(0.0).speed, 0.2);
  EXPECT_DOUBLE_EQ(measured.limits.speed, 0.5 * motions[0].limits.speed);
  EXPECT_DOUBLE_EQ(measured.limits.acceleration, 0.5 * motions[0].limits.acceleration);
  EXPECT_DOUBLE_EQ(measured.limits.jerk, 0.5 * motions[0].limits.jerk);
  EXPECT_DOUBLE_EQ(measured.restart_speed, 1.5);
  EXPECT_DOUBLE_EQ(measured.duration_s(), motions[0].duration_s());
  measured.restart_speed = kLargest;
  measured.MeasureBy(2.0);
  EXPECT_EQ(measured.restart_speed, kLargest);
}

// What lies exactly at a tolerance is within it: points 1e-4 mm apart are one, a via point 1e-4 mm
// from the chord lies on it. motion.md 1, 3.2; OPT-B.16, OPT-B.18
TEST(Tolerance, ArcPointsAtTheBoundItself) {
  using Case = PathPiece::ArcCase;
  const auto through = [](const MachinePoint& via, const MachinePoint& to) {
    return PathPiece::ArcThrough({}, via, {to});
  };
  const auto kind = [&](const MachinePoint& via, const MachinePoint& to) {
    const Result<PathPiece::Arc3> arc = through(via, to);
    return arc ? std::optional(arc->kind) : std::nullopt;
  };
  EXPECT_FALSE(through({5, 5, 0}, {1e-4, 0, 0}));  // ends where it begins
  EXPECT_EQ(kind({0, 1e-4, 0}, {1e-4, 0, 0}), Case::kNoTipMotion);
  EXPECT_EQ(kind({0, 1e-4, 0}, {10, 0, 0}), Case::kLineWarned);   // via is the start
  EXPECT_EQ(kind({10, 1e-4, 0}, {10, 0, 0}), Case::kLineWarned);  // via is the target
  EXPECT_EQ(kind({5, 1e-4, 0}, {10, 0, 0}), Case::kLineWarned);   // on the chord
  EXPECT_FALSE(through({15, 1e-4, 0}, {10, 0, 0}));               // behind it
}

// motion.md 3.3: |N - C| of 1e-6 is no direction, |q| of 1e-6 is on the axis, an entry 1e-6 mm away
// is reached, and X counts up to a cosine of 0.9 itself. OPT-B.12, OPT-B.13, OPT-2.32
TEST(Tolerance, HolesAtTheBoundItself) {
  HoleCommand hole{
      .from = {{0, 1e-6, 5}}, .centre = {}, .normal_point = {0, 0, 1e-6}, .radius_mm = 5.0};
  EXPECT_EQ(HoleThrough(hole).error().code, ErrorCode::kCellHoleNormal);
  hole.normal_point.z() = 1.0;
  EXPECT_TRUE(HoleThrough(hole)->starts_on_axis);
  // The smallest hole begins 1e-6 mm from its circle: the head turns over the circle.
  const HoleCommand tiny{.from = {{2e-6, 0, 0}, 0.1, 0.2},
                         .centre = {{}, 0.3, 0.4},
                         .normal_point = {0, 0, 1},
                         .radius_mm = 1e-6};
  EXPECT_EQ(HoleThrough(tiny)->circle.from().a_rad, 0.1);
  EXPECT_EQ(HoleThrough(tiny)->circle.from().b_rad, 0.2);
  // The program's X at a cosine of 0.9 to the axis; its part across the axis lies along Y.
  hole = {.from = {}, .centre = {}, .normal_point = {1, 0, 0}, .radius_mm = 5.0};
  hole.program_x = {0.9, std::sqrt(0.19), 0};
  hole.program_y = {0, 0, 1};
  ExpectNear(HoleThrough(hole)->circle.from().point, {0, 5, 0}, 1e-12);
}

// Numbers of exactly 1e12, times of exactly 1e9 s, gaps of exactly 1e-3 mm. OPT-B.22
TEST(Tolerance, MovesAtTheBoundItself) {
  const auto code = [](const PathPiece& path) {
    MoveCommand move = MoveAlong(path);
    move.speed_fraction = 1.0;
    const Status status = Planner(StandardMachine()).Append(move);
    return status ? std::optional<ErrorCode>() : status.error().code;
  };
  EXPECT_EQ(code(PathPiece::Line({}, {{5e11, 0, 0}})), std::nullopt);  // at 500 mm/s
  EXPECT_EQ(code(PathPiece::Line({}, {{1e12, 0, 0}})),
            ErrorCode::kCellNoMotion);  // a number, but far
  EXPECT_EQ(code(PathPiece::Line({{-1e12, 0, 0}}, {})), ErrorCode::kCellNoMotion);
  const PathPiece round = PathPiece::Circle({}, {1e11, 0, 0}, {0, 0, 1}, 10.0, 0, 0);
  ASSERT_EQ(round.length(), 1e12);
  EXPECT_EQ(code(round), ErrorCode::kCellNoMotion);

  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineOf({{-10, 0, 0}}, {})));
  ASSERT_TRUE(planner.Append(LineOf({{1e-3, 0, 0}}, {{10, 0, 0}})));
  const std::vector<PlannedMotion> motions = Drained(planner);
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[1].path.from().point, (MachineVector{0, 0, 0}));

  Planner round_on(
      StandardMachine());  // an arc that begins 1e-6 mm behind the line goes on from it
  ASSERT_TRUE(round_on.Append(LineOf({{-50, 0, 0}}, {}, true)));
  ASSERT_TRUE(round_on.Append(
      MoveAlong(PathPiece::Circle({{1e-6, 0, 0}}, {1e-6, 20, 0}, {0, 0, 1}, 1.5, 0, 0))));
  EXPECT_EQ(Drained(round_on)[1].corner.passage, Passage::kBlend);
}

// Both ends of any piece are those it was given, to the last digit, and so is what lies beyond.
// motion.md 3
TEST(PathPiece, EndsAreExact) {
  const TipPose from{{0.1, 0.2, 0.3}, 0.4, 0.5}, to{{7.7, -3.3, 1.9}, -1.1, 0.7};
  for (const PathPiece& path :
       {PathPiece::Line(from, to),
        PathPiece::Joint({from.tip, from.a_rad, from.b_rad}, {to.tip, to.a_rad, to.b_rad}),
        PathPiece::ArcThrough(from, {3.1, 4.7, -0.3}, to)->path,
        PathPiece::Line(from, {from.tip, 1.3, -0.9})}) {
    const PathPose end = path.to();
    EXPECT_EQ(path.At(0.0), from);
    EXPECT_EQ(path.At(-1.0), from);
    EXPECT_EQ(path.At(path.length()), end);
    EXPECT_EQ(path.At(path.length() + 1.0), end);
  }
}

}  // namespace
}  // namespace rmlcell::motion
