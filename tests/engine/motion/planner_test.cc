#include "engine/motion/planner/planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/engine/motion/random_chain.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

MoveCommand LineTo(const MachinePoint& from, const MachinePoint& to, std::uint64_t tag,
                   bool fly = false) {
  MoveCommand move;
  move.path = PathPiece::Line({from}, {to});
  move.speed_fraction = 0.1;
  move.tag = tag;
  move.fly = fly;
  return move;
}

// "1 m7 2": motions by tag, marks with an m before it.
std::string TagsOfRest(Planner& planner) {
  std::string text;
  while (const std::optional<PlannedItem> item = planner.Next()) {
    if (!text.empty()) text += ' ';
    if (const auto* mark = std::get_if<PlannedMark>(&*item)) {
      text += 'm';
      text += std::to_string(mark->tag);
    } else {
      text += std::to_string(std::get<PlannedMotion>(*item).tag);
    }
  }
  return text;
}

// OPT-B.20: 500 mm at SPEED 10 takes 500/50 + 2 sqrt(50/40000) + 0.048 = 10.119 s.
TEST(Planner, MoveWithoutFlySettles) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {500, 0, 0}, 5)));
  const std::optional<PlannedItem> item = planner.Next();
  ASSERT_TRUE(item);
  const auto& motion = std::get<PlannedMotion>(*item);
  EXPECT_EQ(motion.tag, 5u);
  EXPECT_NEAR(motion.duration_s(), 10.0 + 2.0 * std::sqrt(50.0 / 40000.0) + 0.048, 1e-12);
}

// OPT-2.47: /FLY before a stop is as if absent, so the machine settles; before another move it does
// not.
TEST(Planner, FlySettlesOnlyWhereTheMachineStands) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
  ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {10, 10, 0}, 2, true)));
  planner.Stop();
  std::vector<double> settling(3, -1.0);
  while (const std::optional<PlannedItem> item = planner.Next()) {
    const auto& motion = std::get<PlannedMotion>(*item);
    if (motion.ends_move) settling[motion.tag] = motion.settling_s;
  }
  EXPECT_EQ(settling[1], 0.0);
  EXPECT_EQ(settling[2], 0.048);
}

TEST(Planner, KeepsTheOrderOfMotionsAndMarks) {
  Planner planner(StandardMachine());
  planner.Mark(9);
  ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
  planner.Mark(10);
  planner.Mark(11);
  ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {20, 0, 0}, 2)));
  planner.Mark(12);
  planner.Stop();
  // Straight on with equal limits: nothing between the two but the marks.
  EXPECT_EQ(TagsOfRest(planner), "m9 1 m10 m11 2 m12");
}

// OPT-B.22: SPEED 0 and ACCEL below 0.1 are refused, and the planner is as before.
TEST(Planner, RefusesWhatWouldNeverArrive) {
  Planner planner(StandardMachine());
  MoveCommand move = LineTo({}, {10, 0, 0}, 1);
  move.speed_fraction = 0.0;
  EXPECT_EQ(planner.Append(move).error().code, ErrorCode::kCellNoMotion);
  move.speed_fraction = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(planner.Append(move).error().code, ErrorCode::kCellNoMotion);
  move.speed_fraction = 1.0;
  move.acceleration_fraction = 0.00099;
  EXPECT_EQ(planner.Append(move).error().code, ErrorCode::kCellNoMotion);
  move.acceleration_fraction = 0.001;
  EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  EXPECT_EQ(TagsOfRest(planner), "1");
}

// A path of length zero adds nothing, whatever the speed. OPT-2.02
TEST(Planner, NothingToDoIsNoError) {
  Planner planner(StandardMachine());
  MoveCommand move = LineTo({1, 2, 3}, {1, 2, 3}, 1);
  move.speed_fraction = 0.0;
  EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  EXPECT_EQ(TagsOfRest(planner), "");
}

TEST(Planner, RefusesWhatIsNotANumber) {
  Planner planner(StandardMachine());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    EXPECT_EQ(planner.Append(LineTo({}, {bad, 0, 0}, 1)).error().code,
              ErrorCode::kCellTargetUnusable);
  }
  EXPECT_FALSE(planner.Next());
}

// Coordinates to 1e12, lengths too: those are so far away that the move never arrives, and beyond
// them nothing is usable. motion.md 5.1
TEST(Planner, TheFarthestThatIsUsable) {
  const auto code = [](const PathPiece& path) {
    Planner planner(StandardMachine());
    const Status done = planner.Append({.path = path});
    return done ? "good" : CodeText(done.error().code);
  };
  const std::string never = CodeText(ErrorCode::kCellNoMotion);
  const std::string unusable = CodeText(ErrorCode::kCellTargetUnusable);
  const double beyond = std::nextafter(1e12, 2e12);
  EXPECT_EQ(code(PathPiece::Line({}, {{1e12, 0, 0}})), never);
  EXPECT_EQ(code(PathPiece::Line({}, {{-1e12, 0, 0}})), never);
  EXPECT_EQ(code(PathPiece::Line({}, {{beyond, 0, 0}})), unusable);
  EXPECT_EQ(code(PathPiece::Line({}, {{6e11, 6e11, 0}})), unusable);  // together
  EXPECT_EQ(code(PathPiece::Line({{1e12, 0, 0}}, {})), never);
  EXPECT_EQ(code(PathPiece::Line({{0, 0, beyond}}, {})), unusable);
  const auto rounds = [](double sweep_rad) {
    return PathPiece::Circle({{1, 0, 0}}, {0, 0, 0}, {0, 0, 1}, sweep_rad, 0, 0);
  };
  EXPECT_EQ(code(rounds(1e12)), never);
  EXPECT_EQ(code(rounds(beyond)), unusable);
  // At 500 mm/s for 1e9 s, and farther.
  EXPECT_EQ(code(PathPiece::Line({}, {{5e11, 0, 0}})), "good");
  EXPECT_EQ(code(PathPiece::Line({}, {{std::nextafter(5e11, 6e11), 0, 0}})), never);
}

// An axis that cannot move at all lets nothing arrive that it would have to move for. Limits that
// the caller gives are above zero. OPT-B.22
TEST(Planner, WithoutSpeedAccelerationOrJerkNothingArrives) {
  const MoveCommand up = LineTo({}, {0, 0, 10}, 1), east = LineTo({}, {10, 0, 0}, 1);
  for (int limit = 0; limit < 3; ++limit) {
    MachineLimits machine = StandardMachine();
    (limit == 0   ? machine.axes.speed
     : limit == 1 ? machine.axes.acceleration
                  : machine.axes.jerk)[2] = 0.0;
    Planner planner(machine);
    const Status done = planner.Append(up);
    ASSERT_FALSE(done) << limit;
    EXPECT_EQ(done.error().code, ErrorCode::kCellNoMotion);
    EXPECT_EQ(done.error().detail, "the speed is too low to ever arrive");
    EXPECT_TRUE(planner.Append(east)) << limit;
    MoveCommand given = east;
    given.limits = PathLimits{.speed = 1.0, .acceleration = 1.0, .jerk = 1.0};
    (limit == 0   ? given.limits->speed
     : limit == 1 ? given.limits->acceleration
                  : given.limits->jerk) = 0.0;
    EXPECT_DEATH((void)planner.Append(given), "IsAboveZero") << limit;
  }
  Planner planner(StandardMachine());
  MoveCommand weak = east;
  weak.acceleration_fraction = 0.0005;
  EXPECT_EQ(planner.Append(weak).error().detail, "the acceleration is 0.05 %");
}

// A mark between two /FLY moves comes out between the halves of the blend. OPT-B.28, OPT-2.49
TEST(Planner, MarksActHalfWayThroughTheBlend) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
  planner.Mark(7);
  ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {10, 10, 0}, 2)));
  EXPECT_EQ(TagsOfRest(planner), "1 1 m7 2 2");
}

// The halves meet at the point of the curve nearest to the corner: OPT-B.24 gives its
// distance, 1.3588 mm, at 50 mm/s in a right angle, and 4.0505 mm for the cut.
TEST(Planner, BlendOfARightAngle) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {100, 0, 0}, 1, true)));
  ASSERT_TRUE(planner.Append(LineTo({100, 0, 0}, {100, 100, 0}, 2)));
  std::vector<PlannedMotion> motions;
  while (const std::optional<PlannedItem> item = planner.Next()) {
    motions.push_back(std::get<PlannedMotion>(*item));
  }
  ASSERT_EQ(motions.size(), 4u);
  EXPECT_NEAR(motions[0].path.to().point.x(), 100.0 - 4.0505, 5e-5);
  EXPECT_FALSE(motions[0].ends_move);
  EXPECT_TRUE(motions[1].ends_move);
  EXPECT_EQ(motions[1].corner.passage, Passage::kBlend);
  EXPECT_NEAR((motions[1].path.to().point - MachinePoint{100, 0, 0}).norm(), 1.3588, 5e-5);
  EXPECT_EQ(motions[1].path.to(), motions[2].path.from());
  EXPECT_DOUBLE_EQ(motions[1].speed.duration_s(), motions[1].path.length() / 50.0);
  EXPECT_EQ(motions[2].tag, 2u);
  EXPECT_EQ(motions[3].path.to().point, (MachineVector{100, 100, 0}));
}

// What stands against a blend; motion.md 4.4. OPT-B.25, OPT-B.27, OPT-2.39
TEST(Planner, PassagesThatAreNotBlended) {
  const auto passage = [](MoveCommand first, const MoveCommand& second) {
    first.fly = true;
    Planner planner(StandardMachine());
    EXPECT_TRUE(planner.Append(first));
    EXPECT_TRUE(planner.Append(second));
    planner.Stop();
    while (const std::optional<PlannedItem> item = planner.Next()) {
      const auto& motion = std::get<PlannedMotion>(*item);
      if (motion.ends_move && motion.tag == 1) {
        EXPECT_EQ(motion.settling_s, motion.corner.passage == Passage::kStop ? 0.048 : 0.0);
        if (IsStop(motion.corner.passage)) {
          EXPECT_EQ(motion.speed.end().speed, 0.0);
        }
        return motion.corner.passage;
      }
    }
    return Passage::kStop;
  };
  const MoveCommand east = LineTo({}, {10, 0, 0}, 1);
  const MoveCommand north = LineTo({10, 0, 0}, {10, 10, 0}, 2);
  EXPECT_EQ(passage(east, north), Passage::kBlend);
  EXPECT_EQ(passage(east, LineTo({10, 0, 0}, {20, 0, 0}, 2)), Passage::kThrough);
  // 174.9 and 175.1 degrees.
  EXPECT_TRUE(IsBlend(passage(east, LineTo({10, 0, 0}, {10 - 9.96041, 0.88894, 0}, 2))));
  EXPECT_EQ(passage(east, LineTo({10, 0, 0}, {10 - 9.96346, 0.85417, 0}, 2)),
            Passage::kStopReversal);
  MoveCommand still = east;
  still.overshoot_fraction = 0.0;
  EXPECT_EQ(passage(still, north), Passage::kStopNoSpeed);
  MoveCommand turn = north;
  turn.path = PathPiece::Line({{10, 0, 0}, 0, 0}, {{10, 0, 0}, 1, 0});
  EXPECT_EQ(passage(east, turn), Passage::kStopNeighbour);
  MoveCommand other_tool = north;
  other_tool.head = GantryHead{.tool = {.z_mm = 3.0}};
  EXPECT_EQ(passage(east, other_tool), Passage::kStop);  // as if /FLY were absent, OPT-2.48
  // A short neighbour: at most half of it, so the bend is slower than the 50 mm/s of both moves.
  EXPECT_EQ(passage(east, LineTo({10, 0, 0}, {10, 1, 0}, 2)), Passage::kBlendCapped);
  EXPECT_EQ(passage(east, LineTo({10, 0, 0}, {10, 1.9e-4, 0}, 2)), Passage::kStopShort);
}

// motion.md 4.4: a curve beside an arc that comes to a point on its way is a stop, as with OVERSH
// 0.
TEST(Planner, CurvesWithACuspAreStops) {
  struct Corner2 {
    PathPiece in;
    PathPiece out;
    double speed;
  };
  const auto arc = [](const MachinePoint& from, const MachinePoint& via, const MachinePoint& to) {
    return PathPiece::ArcThrough({from}, via, {to}).value().path;
  };
  const std::vector<Corner2> corners = {
      // The corner itself turns by 151 degrees, the cut points by 180.
      {PathPiece::Line({{0, 0, 0}}, {{30, 0, 0}}),
       arc({30, 0, 0}, {16.7910347625062, -3.372802547013361, 0},
           {19.22102315613114, -16.78726176359408, 0}),
       0.4},
      // Two arcs whose curve nearly stands still in its middle.
      {arc({11.482, 12.304, 0}, {9.102, 3.016, 0}, {0, 0, 0}),
       arc({0, 0, 0}, {9.102, -3.016, 0}, {11.482, -12.304, 0}), 0.4},
      // The same a hundred times as small.
      {arc({0.11482, 0.12304, 0}, {0.09102, 0.03016, 0}, {0, 0, 0}),
       arc({0, 0, 0}, {0.09102, -0.03016, 0}, {0.11482, -0.12304, 0}), 0.4}};
  for (const Corner2& corner : corners) {
    const auto plan = [&](double overshoot) {
      std::vector<MoveCommand> chain(2);
      chain[0] = {.path = corner.in, .speed_fraction = corner.speed, .fly = true};
      chain[0].overshoot_fraction = overshoot;
      chain[1] = {.path = corner.out, .speed_fraction = corner.speed};
      return Plan(chain);
    };
    const std::vector<PlannedMotion> fly = plan(1.0), stop = plan(0.0);
    EXPECT_EQ(fly[0].corner.passage, Passage::kStopReversal);
    EXPECT_EQ(fly[0].corner.cut_mm, 0.0);
    double fly_s = 0.0, stop_s = 0.0;
    for (const PlannedMotion& motion : fly) fly_s += motion.duration_s();
    for (const PlannedMotion& motion : stop) stop_s += motion.duration_s();
    EXPECT_NEAR(fly_s, stop_s, 1e-12);
  }
}

// A move that goes nowhere is dropped; without /FLY it makes the passage before it a stop.
// motion.md 3.1
TEST(Planner, MoveToWhereTheMachineIs) {
  for (const bool fly : {true, false}) {
    Planner planner(StandardMachine());
    ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
    ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {10, 0, 0}, 2, fly)));
    ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {10, 10, 0}, 3)));
    EXPECT_EQ(TagsOfRest(planner), fly ? "1 1 3 3" : "1 3");
  }
}

// Steps below 1e-6 mm add up: a thousand of them are a way of 1e-4 mm.
TEST(Planner, TinyStepsAreNotLost) {
  Planner planner(StandardMachine());
  MachinePoint at;
  for (int k = 1; k <= 1000; ++k) {
    const MachinePoint to{1e-7 * k, 0, 0};
    ASSERT_TRUE(planner.Append(LineTo(at, to, 1, true)));
    at = to;
  }
  planner.Stop();
  double length = 0.0;
  TipPose last;
  while (const std::optional<PlannedItem> item = planner.Next()) {
    const PathPiece& path = std::get<PlannedMotion>(*item).path;
    EXPECT_LE((path.from().point - last.tip).norm(), 1e-15);
    last = path.tip_to();
    length += path.length();
  }
  EXPECT_NEAR(length, 1e-4, 1.1e-6);  // the last step of up to 1e-6 mm is dropped
}

// Without a limit on jerk a line goes over into an arc without a curve; the bend behind a short arc
// must not reach back into the line, which lies elsewhere than the arc's tangent. OPT-B.25
TEST(Planner, BendKeepsToTheArcBehindIt) {
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  const MoveCommand north = LineTo({0, -20, 0}, {}, 1, true);
  MoveCommand arc = north;  // 0.05 mm of a circle of 1000 mm, then a line
  arc.path = PathPiece::Circle({}, {-1000, 0, 0}, {0, 0, 1}, 5e-5, 0, 0);
  const MachinePoint end = arc.path.to().point;
  Planner planner(machine);
  for (const MoveCommand& move : {north, arc, LineTo(end, end + MachineVector{30, 0, 0}, 3)}) {
    ASSERT_TRUE(planner.Append(move));
  }
  planner.Stop();
  TipPose last{{0, -20, 0}};
  while (const std::optional<PlannedItem> item = planner.Next()) {
    const PathPiece& path = std::get<PlannedMotion>(*item).path;
    EXPECT_LE((path.from().point - last.tip).norm(), 1e-12);
    EXPECT_LE((path.At(0.0).point - last.tip).norm(), 1e-9);
    last = path.tip_to();
  }
  EXPECT_EQ(last.tip, end + (MachineVector{30, 0, 0}));
}

// Behind a bend come more points straight on, each with another SPEED, than the window holds, and
// the bend takes its part of them: what is decided early then must not cut into it. OPT-2.46,
// OPT-B.29
TEST(Planner, WindowFullOfPointsThatABendSwallows) {
  for (const double step_mm : {1e-3, 1e-2, 1e-1}) {
    for (const int count : {20, 31, 33, 40, 64, 80}) {
      Planner planner(StandardMachine(), 64);
      MachinePoint at{1000, 900, -200};
      double way = 0.0, planned = 0.0;
      TipPose last{at};
      const auto go = [&](const MachineVector& step, double speed, bool fly) {
        MoveCommand move = LineTo(at, at + step, 1, fly);
        move.speed_fraction = speed;
        at = at + step;
        way += step.norm();
        ASSERT_TRUE(planner.Append(move));
        while (const std::optional<PlannedItem> item = planner.Next()) {
          const PathPiece& path = std::get<PlannedMotion>(*item).path;
          ASSERT_LE((path.from().point - last.tip).norm(), 1e-9);
          last = path.tip_to();
          planned += path.length();
        }
      };
      go({100, 0, 0}, 0.5, true);
      for (int k = 0; k < count; ++k) go({0, step_mm, 0}, k % 2 == 0 ? 0.4 : 0.5, true);
      for (int k = 0; k < count; ++k) go({0, 1, 0}, k % 2 == 0 ? 0.4 : 0.5, true);
      go({100, 0, 0}, 0.5, false);
      EXPECT_EQ(last.tip, at);
      EXPECT_LE(planned, way);
    }
  }
}

// A bend that ends exactly at a point passed straight on keeps the speed of that point: with a line
// of a length like that before, half of the run is just that line. motion.md 4.3, OPT-2.35
TEST(Planner, PointAtTheVeryEndOfABend) {
  for (const std::size_t lines : {1, 2, 5}) {
    for (const double more : {-1e-3, 0.0, 1e-3}) {
      std::vector<MoveCommand> chain = {LineTo({1000, 0, 0}, {1300, 0, 0}, 1, true)};
      chain.back().speed_fraction = 1.0;
      const auto go = [&](double length, double speed, bool fly) {
        const MachinePoint from = chain.back().path.to().point;
        chain.push_back(LineTo(from, from + MachineVector{0, length, 0}, 1, fly));
        chain.back().speed_fraction = speed;
      };
      for (std::size_t k = 0; k < lines; ++k)
        go(10.0 / static_cast<double>(lines), k % 2 == 0 ? 1.0 : 0.9, true);
      go(10.0 + more, 0.02, false);
      double slow_s = 0.0;
      for (const PlannedMotion& motion : Plan(chain)) {
        if (motion.path.from().point.y() < 10.0 - 1e-6) continue;
        EXPECT_LE(motion.speed.peak_speed(), 10.0) << lines << ' ' << more;
        slow_s += motion.speed.duration_s();
      }
      EXPECT_GE(slow_s, (10.0 + more) / 10.0) << lines << ' ' << more;
    }
  }
}

// A copy goes on by itself.
TEST(Planner, CopyIsASnapshot) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
  Planner copy = planner;
  ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {10, 10, 0}, 2)));
  copy.Stop();
  EXPECT_EQ(TagsOfRest(planner), "1 1 2 2");
  EXPECT_EQ(TagsOfRest(copy), "1");
}

}  // namespace
}  // namespace rmlcell::motion
