// Ways of the ride that are worked out beforehand: to a lower speed, to the ends of the travel, to
// the first target of a HOLD, and from where the machine was moved to by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "engine/optimo/ride/lead.h"
#include "engine/optimo/ride/lead_along.h"
#include "tests/engine/optimo/control/measured.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::ride_ways {
namespace {

using machine::InputKind;
using machine::RunPhase;

double Ramp_s(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }
// From rest to rest at 50 mm/s.
double Time_s(double way_mm) { return way_mm / 50.0 + Ramp_s(50.0); }

// motion.md 6: first the acceleration is brought to zero, at 10,000 mm/s3; then the speed goes down
// where it is higher, here by 100 mm/s in 2 sqrt(100/10000) s.
TEST(RideWays, TheLeadToALowerSpeed) {
  const motion::PathLimits limits{.speed = 500.0, .acceleration = 2000.0, .jerk = 10'000.0};
  const auto lead = [&](double speed, double acceleration, double to) {
    return LeadFrom({.s = 7.0, .speed = speed, .acceleration = acceleration}, limits, to);
  };
  const Lead faster = lead(100.0, 1000.0, 200.0);  // 150 mm/s after 0.1 s
  EXPECT_NEAR(faster.length, 10.0 + 0.1 * 100.0 / 3.0, 1e-9);
  EXPECT_NEAR(faster.speed, 150.0, 1e-9);
  const Lead down = lead(100.0, 1000.0, 50.0);
  EXPECT_NEAR(down.length, 10.0 + 0.1 * 100.0 / 3.0 + 100.0 * 0.2, 1e-9);
  EXPECT_NEAR(down.speed, 50.0, 1e-9);
  const Lead braking = lead(100.0, -1000.0, 80.0);  // 50 mm/s after 0.1 s
  EXPECT_NEAR(braking.length, 10.0 - 0.1 * 100.0 / 3.0, 1e-9);
  EXPECT_NEAR(braking.speed, 50.0, 1e-9);
  const Lead to_rest = lead(50.0, -1000.0, 80.0);
  EXPECT_NEAR(to_rest.length, 5.0 - 0.1 * 100.0 / 3.0, 1e-9);
  EXPECT_NEAR(to_rest.speed, 0.0, 1e-9);
  EXPECT_EQ(lead(30.0, -1000.0, 80.0).speed, 0.0);
  const Lead steady = lead(150.0, 0.0, 50.0);
  EXPECT_NEAR(steady.length, 100.0 * 0.2, 1e-9);
}

constexpr motion::PathLimits kOf50{.speed = 50.0, .acceleration = 2000.0, .jerk = 40'000.0};

// Of the standard machine.
motion::AxisLimits Axes() {
  return Resolve(machine::Parameters(OptimoParameterTable())).limits.axes;
}

// A straight one, passed at 50 mm/s.
motion::PlannedMotion Straight(double length_mm, const motion::PathLimits& limits = kOf50) {
  motion::PlannedMotion made;
  made.path = motion::PathPiece::Line({.tip = {0.0, 0.0, 0.0}}, {.tip = {length_mm, 0.0, 0.0}});
  made.speed = motion::SpeedProfile::Steady(length_mm, 50.0);
  made.limits = limits;
  made.settling_s = kSettle_s;
  made.corner.passage = motion::Passage::kBlend;
  made.corner.speed = 50.0;
  return made;
}

// motion.md 6: over motions that are each shorter than the 1.875 mm from 50 to 25 mm/s: from 0.25
// mm of the first one on it ends on the third, 0.125 mm behind its begin.
TEST(RideWays, TheWayDownOverSeveralMotions) {
  LeadAlong way(Straight(1.0), {.s = 0.25, .speed = 50.0});
  EXPECT_FALSE(way.EndOnLast(25.0).has_value());
  way.Add(Straight(1.0));
  EXPECT_FALSE(way.EndOnLast(25.0).has_value());
  way.Add(Straight(1.0));
  const std::optional<LeadAlong::End> end = way.EndOnLast(25.0);
  ASSERT_TRUE(end.has_value());
  EXPECT_NEAR(end->s, 0.125, 1e-9);
  EXPECT_NEAR(end->speed, 25.0, 1e-9);
  const std::vector<motion::PlannedMotion> motions = way.MotionsTo(*end, Axes());
  ASSERT_EQ(motions.size(), 3U);
  constexpr double kLengths[] = {0.75, 1.0, 0.125};
  double speed = 50.0;
  double lasts_s = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const motion::PlannedMotion& one = motions[k];
    EXPECT_NEAR(one.path.length(), kLengths[k], 1e-9) << k;
    EXPECT_NEAR(one.speed.At(0.0).speed, speed, 1e-6) << k;
    EXPECT_NEAR(one.limits.speed, speed, 1e-6) << k;  // START on the way goes no faster again
    EXPECT_EQ(one.settling_s, 0.0) << k;
    EXPECT_EQ(one.ends_move, k < 2) << k;
    speed = one.speed.end().speed;
    EXPECT_NEAR(one.corner.speed, k < 2 ? speed : 0.0, 1e-9) << k;
    lasts_s += one.duration_s();
  }
  EXPECT_NEAR(motions[0].path.from().point.x(), 0.25, 1e-9);
  EXPECT_EQ(motions[1].corner.passage, motion::Passage::kBlend);
  EXPECT_EQ(motions[2].corner.passage, motion::Passage::kStop);
  EXPECT_NEAR(speed, 25.0, 1e-6);
  EXPECT_NEAR(lasts_s, Ramp_s(25.0), 1e-6);
}

// motion.md 6: it may end with a motion, and where one begins, which is as it was then.
TEST(RideWays, TheWayDownToTheEndsOfMotions) {
  const double down_mm = LeadFrom({.speed = 50.0}, kOf50, 25.0).length;
  const LeadAlong on_one(Straight(down_mm), {.speed = 50.0});
  const std::optional<LeadAlong::End> at_end = on_one.EndOnLast(25.0);
  ASSERT_TRUE(at_end.has_value());
  EXPECT_EQ(at_end->s, down_mm);
  LeadAlong way(Straight(1.0), {.s = 0.25, .speed = 50.0});
  way.Add(Straight(1.25));
  way.Add(Straight(1.0));
  const std::optional<LeadAlong::End> at_begin = way.EndOnLast(25.0);
  ASSERT_TRUE(at_begin.has_value());
  EXPECT_EQ(at_begin->s, 0.0);
  const std::vector<motion::PlannedMotion> motions = way.MotionsTo(*at_begin, Axes());
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_NEAR(motions[1].path.length(), 1.25, 1e-9);
  EXPECT_TRUE(motions[1].ends_move);
  EXPECT_NEAR(motions[1].corner.speed, 25.0, 1e-6);
  EXPECT_NEAR(motions[0].duration_s() + motions[1].duration_s(), Ramp_s(25.0) + 0.125 / 25.0, 1e-6);
}

// motion.md 6: nor is there one over a motion that is no way at all.
TEST(RideWays, AMotionWithoutAWay) {
  LeadAlong way(Straight(1.0), {.s = 0.25, .speed = 50.0});
  way.Add(Straight(0.5 * motion::kTipLengthZero_mm));
  way.Add(Straight(2.0));
  const std::optional<LeadAlong::End> end = way.EndOnLast(25.0);
  ASSERT_TRUE(end.has_value());
  EXPECT_NEAR(end->s, 1.125, 1e-9);
  EXPECT_TRUE(way.MotionsTo(*end, Axes()).empty());
}

// motion.md 6: the weakest motion sets the ramp: by a jerk of 10,000 mm/s3, or by 500 mm/s2, it is
// so much longer.
TEST(RideWays, TheWeakestMotionSetsTheRamp) {
  const auto way_mm = [](const motion::PathLimits& weak) {
    LeadAlong way(Straight(1.0), {.s = 0.25, .speed = 50.0});
    way.Add(Straight(10.0, weak));
    return 0.75 + way.EndOnLast(25.0).value_or(LeadAlong::End{}).s;
  };
  EXPECT_NEAR(way_mm(kOf50), 1.875, 1e-9);
  EXPECT_NEAR(way_mm({.speed = 50.0, .acceleration = 2000.0, .jerk = 10'000.0}), 3.75, 1e-9);
  EXPECT_NEAR(way_mm({.speed = 50.0, .acceleration = 500.0, .jerk = 40'000.0}),
              37.5 * (25.0 / 500.0 + 500.0 / 40'000.0), 1e-9);
}

// motion.md 6: there is no such way where a motion may not be passed so fast, a START on it may
// not, or what comes behind it begins slower.
TEST(RideWays, MotionsThatMayNotBePassedSoFast) {
  const auto count = [](const motion::PlannedMotion& second) {
    LeadAlong way(Straight(1.0), {.s = 0.25, .speed = 50.0});
    way.Add(second);
    way.Add(Straight(1.0));
    const std::optional<LeadAlong::End> end = way.EndOnLast(25.0);
    EXPECT_TRUE(end.has_value());
    return way.MotionsTo(end.value_or(LeadAlong::End{}), Axes()).size();
  };
  EXPECT_EQ(count(Straight(1.0)), 3U);
  EXPECT_EQ(count(Straight(1.0, {.speed = 30.0, .acceleration = 2000.0, .jerk = 40'000.0})), 0U);
  motion::PlannedMotion slow_start = Straight(1.0);
  slow_start.restart_speed = 30.0;
  EXPECT_EQ(count(slow_start), 0U);
  motion::PlannedMotion slow_end = Straight(1.0);
  slow_end.speed = motion::SpeedProfile::Steady(1.0, 20.0);
  EXPECT_EQ(count(slow_end), 0U);
}

// motion.md 6: nor where the axes cannot brake so on a bend: here X cannot.
TEST(RideWays, TheAxesMustBeAbleToBrakeOnABend) {
  const Ran ran =
      RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  const auto bend = std::ranges::find_if(ran.parts, [](const Ran::Part& part) {
    return part.motion.path.kind() == motion::PathPiece::Kind::kBlend;
  });
  ASSERT_NE(bend, ran.parts.end());
  motion::PlannedMotion passed = Straight(bend->motion.path.length());
  passed.path = bend->motion.path;
  passed.head = bend->motion.head;
  const LeadAlong way(passed, {.speed = 50.0});
  const std::optional<LeadAlong::End> end = way.EndOnLast(25.0);
  ASSERT_TRUE(end.has_value());
  motion::AxisLimits axes = Axes();
  axes.acceleration.fill(1e6);
  EXPECT_EQ(way.MotionsTo(*end, axes).size(), 1U);
  axes.acceleration[0] = 100.0;
  EXPECT_TRUE(way.MotionsTo(*end, axes).empty());
}

// motion.md 6: it slows down to what it is faster than when its acceleration is at an end; by then
// it may not be faster than the motion allows, but for rounding.
TEST(RideWays, WhatCanSlowDown) {
  const auto slows = [](double speed, double acceleration, double to) {
    return LeadAlong(Straight(1.0), {.speed = speed, .acceleration = acceleration}).SlowsTo(to);
  };
  EXPECT_TRUE(slows(50.0, 0.0, 25.0));
  EXPECT_FALSE(slows(50.0, 0.0, 50.0));
  EXPECT_TRUE(slows(30.0, 1000.0, 42.0));  // 42.5 mm/s after 0.025 s
  EXPECT_FALSE(slows(30.0, 1000.0, 43.0));
  EXPECT_FALSE(slows(40.0, 1000.0, 25.0));  // 52.5 mm/s
  EXPECT_FALSE(slows(10.0, -1000.0, 0.0));  // at rest before
  EXPECT_TRUE(slows(50.0 * (1.0 + 1e-9), 0.0, 25.0));
  EXPECT_FALSE(slows(50.0 * (1.0 + 1e-7), 0.0, 25.0));
}

struct End {
  int axis;
  motion::MachinePoint tip;  // 10 mm before it the column is beyond the end
  motion::MachineVector back;
  std::string angles;
};

// OPT-B.08: with a head that is held steady the column goes 300 mm beside the tip: each end of X, Y
// and Z binds it, and 10 mm before that it does not.
TEST(RideWays, EachEndOfTheTravelBindsTheColumn) {
  const double down = 300.0 * std::cos(2.3);
  for (const End& end : {End{0, {3310.0, 1000.0, -400.0}, {-1, 0, 0}, "1.570796,1.570796"},
                         End{0, {-310.0, 1000.0, -400.0}, {1, 0, 0}, "-1.570796,1.570796"},
                         End{1, {1000.0, 2810.0, -400.0}, {0, -1, 0}, "3.141593,1.570796"},
                         End{1, {1000.0, -310.0, -400.0}, {0, 1, 0}, "0.,1.570796"},
                         End{2, {1000.0, 1000.0, 810.0}, {0, 0, -1}, "0.,0."},
                         End{2, {1000.0, 1000.0, -1310.0 - down}, {0, 0, 1}, "0.,2.3"}}) {
    for (const bool inside : {false, true}) {
      const motion::MachinePoint to = inside ? end.tip + 20.0 * end.back : end.tip;
      const Ran ran = RunText(kAbsol + "MOVE (1000.,1000.,-400.," + end.angles + ")\nMOVE (" +
                              std::to_string(to.x()) + "," + std::to_string(to.y()) + "," +
                              std::to_string(to.z()) + "," + end.angles + ")\n");
      EXPECT_EQ(CodeOf(ran), inside ? 0 : 7301) << end.axis << " " << end.angles;
      ASSERT_EQ(ran.violations.size(), inside ? 0U : 1U) << end.axis << " " << end.angles;
      if (inside) continue;
      EXPECT_EQ(ran.violations[0].axis, end.axis);
      EXPECT_NEAR(ran.violations[0].excess, 10.0, 1e-3);
      EXPECT_TRUE(ran.violations[0].at_target);
    }
  }
}

// OPT-4.17: 12 mm before the end of a move at 200 mm/s, from which it comes to rest in 15 mm, with
// 5 mm of the next move behind it and one more move to come: it halts on the target of the next.
TEST(RideWays, HoldNeedsTheNextMoveAndNoMore) {
  const std::string text =
      "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n"
      "MOVE (1200.,1000.,-400.,0.,0.)/FLY\nMOVE (1205.,1000.,-400.,0.,0.)/FLY\n"
      "MOVE (1255.,1000.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  const double hold = begin + 188.0 / 200.0 + 0.075;
  const Ran ran = RunText(
      text, {.inputs = {{At(hold), InputKind::kHold}, {At(begin + 20.0), InputKind::kStart}}});
  EXPECT_EQ(ran.First("halt HOLD").step, 6);
  ASSERT_EQ(ran.moves.size(), 4U);
  EXPECT_NEAR(ran.moves[2].tip.tip.x(), 1205.0, 1e-9);
  EXPECT_LE(ToSeconds(ran.moves[2].at), ran.First("halt HOLD").at_s + 1e-9);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1255.0, 1e-9);
}

// OPT-4.17, motion.md 6: near the end of a move behind a bend, where what is left of it is too
// short to brake on, no limit is broken.
TEST(RideWays, HoldNearTheEndOfALegBehindABend) {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  double x = 1000.0;
  double y = 1000.0;
  for (int k = 0; k < 4; ++k) {
    x += 100.0 * std::cos(0.35 * k);
    y += 100.0 * std::sin(0.35 * k);
    text += "MOVE (" + std::to_string(x) + "," + std::to_string(y) + ",-400.,0.,0.)";
    text += k < 3 ? "/FLY\n" : "\n";
  }
  const double begin = ToSeconds(RunText(text).moves.front().at);
  for (int n = 0; n < 16; ++n) {
    const double hold = begin + 0.94 + 0.01 * n;
    const Ran ran = RunText(
        text, {.inputs = {{At(hold), InputKind::kHold}, {At(begin + 9.0), InputKind::kStart}}});
    ASSERT_EQ(ran.Count("halt HOLD"), 1) << n;
    ExpectWithinLimits(ran, true, "HOLD " + std::to_string(n));
    EXPECT_NEAR((ran.end.tip.tip - motion::MachinePoint(x, y, -400.0)).norm(), 0.0, 1e-4) << n;
  }
}

// OPT-4.17, OPT-2.49: outputs between moves that are too short to brake on come once, in order and
// each at its target, wherever HOLD is pressed on the way.
TEST(RideWays, OutputsBetweenShortMovesOverAHold) {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  std::vector<std::string> wanted;
  for (int k = 1; k <= 90; ++k) {
    text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
    text += k < 90 ? "/FLY\nOL[16]=" + std::string(k % 2 == 1 ? "ON" : "OFF") + "\n" : "\n";
    if (k < 90) wanted.push_back(k % 2 == 1 ? "OL[16] 1" : "OL[16] 0");
  }
  const double begin = ToSeconds(RunText(text).moves.front().at);
  for (int n = 1; n < 40; ++n) {
    const double hold = begin + 0.0131 * n;
    const Ran ran = RunText(
        text, {.inputs = {{At(hold), InputKind::kHold}, {At(begin + 20.0), InputKind::kStart}}});
    std::vector<std::string> outputs = ran.told;
    std::erase_if(outputs, [](const std::string& what) { return !what.starts_with("OL"); });
    EXPECT_EQ(outputs, wanted) << n;
    EXPECT_EQ(ran.moves.size(), 91U) << n;
    EXPECT_NEAR(ran.end.tip.tip.x(), 1090.0, 1e-6) << n;
  }
}

// A run that a key has halted at this time, moved by hand by so much.
class Moved {
 public:
  Moved(const std::string& text, double stop_s, const motion::MachineVector& by,
        InputKind key = InputKind::kStop) {
    machine::RunSetup setup = SetupOf(text);
    run = *OptimoFamily().NewRun(std::move(setup), told);
    run->Advance(At(stop_s));
    run->Apply({.at = run->state().time, .kind = key});
    EXPECT_EQ(run->Advance(At(stop_s + 5.0)), RunPhase::kHalted);
    left = run->state().tip.tip;
    motion::AxisPose to = run->state().axes;
    to.column += by;
    EXPECT_TRUE(run->may_be_moved());
    run->MoveTo(to);
    told.feeds.clear();
    told.moves = 0;
  }
  void Press(InputKind kind, double value = 1.0) {
    run->Apply({.at = run->state().time, .kind = kind, .value = value});
  }
  // From START to the end.
  double GoOn_s() {
    const SimTime from = run->state().time;
    Press(InputKind::kStart);
    while (run->Advance(run->state().time + At(1000.0)) == RunPhase::kRunning) {
    }
    return ToSeconds(run->state().time - from);
  }

  class Told final : public machine::RunObserver {
   public:
    void OnMotion(const machine::MotionDone& done) override {
      feeds.push_back(done.programmed_mm_s);
    }
    void OnMove(const machine::MoveDone&) override { ++moves; }
    std::vector<double> feeds;
    int moves = 0;
  } told;
  std::unique_ptr<machine::Run> run;
  motion::MachinePoint left{};
};

// OPT-4.17: the first target that can be reached at rest is the same one, however many instructions
// stand between the moves.
TEST(RideWays, HoldHaltsOnTheFirstTargetWhateverStandsBetween) {
  std::vector<std::ptrdiff_t> reached;
  for (int outputs = 0; outputs <= 4; ++outputs) {
    std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
    for (int k = 1; k <= 200; ++k) {
      text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
      text += k < 200 ? "/FLY\n" : "\n";
      for (int n = 0; n < outputs && k < 200; ++n)
        text += "OL[" + std::to_string(22 + n) + "]=" + (k % 2 == 1 ? "ON\n" : "OFF\n");
    }
    const double begin = ToSeconds(RunText(text).moves.front().at);
    const Ran ran = RunText(text, {.inputs = {{At(begin + 0.5025), InputKind::kHold},
                                              {At(begin + 20.0), InputKind::kStart}}});
    const double halt_s = ran.First("halt HOLD").at_s;
    reached.push_back(std::ranges::count_if(ran.moves, [&](const machine::MoveDone& move) {
      return ToSeconds(move.at) <= halt_s + 1e-9;
    }));
  }
  EXPECT_THAT(reached, ::testing::Each(reached.front()));
  EXPECT_LT(reached.front(), 200);
}

// OPT-6.42: back to where the circle was left, without settling there, and round the rest of it;
// the MOVE is over once, at its end.
TEST(RideWays, AHoleThatWasLeft) {
  const std::string text = kThere +
                           "PATH HOLE (10.)\n"
                           "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  Moved moved(text, begin + Time_s(90.0) + 0.5, {0.0, 0.0, 20.0});
  ASSERT_NEAR(std::hypot(moved.left.x() - 1100.0, moved.left.y() - 1000.0), 10.0, 1e-6);
  double turned = std::atan2(moved.left.y() - 1000.0, moved.left.x() - 1100.0) - M_PI;
  if (turned < 0.0) turned += 2.0 * M_PI;
  ASSERT_GT(turned, 1.0);
  ASSERT_LT(turned, 4.0);
  const double rest = 10.0 * (2.0 * M_PI - turned);
  EXPECT_NEAR(moved.GoOn_s(), Time_s(20.0) + Time_s(rest) + kSettle_s, 2e-3);
  EXPECT_EQ(moved.told.moves, 1);
  EXPECT_EQ(moved.run->outcome().kind, machine::OutcomeKind::kCompleted);
  EXPECT_NEAR(moved.run->state().tip.tip.x(), 1090.0, 1e-6);
}

// OPT-6.42: a hole that a HOLD kept back, from its own circle: what stands before it comes first,
// then the way back to where it begins, and the turn.
TEST(RideWays, AHoleThatWasKeptBack) {
  const std::string text = kThere +
                           "MOVE (1090.,1000.,-400.,0.,0.)/FLY\nOL[16]=ON\nPATH HOLE (10.)\n"
                           "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  Moved moved(text, begin + 0.5, {0.0, 0.0, 20.0}, InputKind::kHold);
  EXPECT_NEAR(moved.left.x(), 1090.0, 1e-6);
  EXPECT_EQ(moved.run->outputs().on.size(), 0U);
  const double taken = moved.GoOn_s();
  EXPECT_EQ(moved.run->outcome().kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(moved.run->outputs().on.size(), 1U);
  EXPECT_NEAR(taken, Time_s(20.0) + Time_s(20.0 * M_PI) + kSettle_s, 3e-3);
  EXPECT_NEAR(moved.run->state().tip.tip.x(), 1090.0, 1e-6);
}

// OPT-6.42, OPT-4.17: moved by hand behind a HOLD, the machine goes to its next target from where
// it stands: of a MOVE that was kept back, behind which one that was not read yet begins where it
// ends, and where a mere output was kept back, of a MOVE that comes later.
TEST(RideWays, TheNextMoveBehindAHoldThatWasMoved) {
  struct Row {
    std::string behind;
    double taken_s;
    int outputs;
  };
  const double slope_s = Time_s(std::hypot(100.0, 20.0)) + kSettle_s;
  for (const Row& row :
       {Row{"MOVE (1200.,1000.,-400.,0.,0.)\nMOVE (1200.,1100.,-400.,0.,0.)\n",
            slope_s + Time_s(100.0) + kSettle_s, 0},
        Row{"OL[16]=ON\nDELAY 1\nMOVE (1200.,1000.,-400.,0.,0.)\n", 1.0 + slope_s, 1}}) {
    const std::string text = kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n" + row.behind;
    const double begin = ToSeconds(RunText(text).moves.front().at);
    Moved moved(text, begin + 0.5, {0.0, 0.0, 20.0}, InputKind::kHold);
    EXPECT_NEAR(moved.left.x(), 1100.0, 1e-6) << row.behind;
    EXPECT_EQ(moved.run->outputs().on.size(), 0U) << row.behind;
    EXPECT_NEAR(moved.GoOn_s(), row.taken_s, 1e-3) << row.behind;
    EXPECT_EQ(moved.run->outcome().kind, machine::OutcomeKind::kCompleted) << row.behind;
    EXPECT_EQ(moved.run->outputs().on.size(), static_cast<std::size_t>(row.outputs));
    EXPECT_NEAR(moved.run->state().tip.tip.x(), 1200.0, 1e-6) << row.behind;
    EXPECT_NEAR(moved.run->state().tip.tip.z(), -400.0, 1e-6) << row.behind;
  }
}

// OPT-6.42, OPT-E.7305: an arc through its via point: from a place on the line of via and target,
// with the via point outside, there is none.
TEST(RideWays, AnArcThatIsNoneFromThere) {
  const std::string text = kThere +
                           "PATH CIR\n"
                           "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1050.,1050.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  const Ran free = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kStop}}});
  const motion::MachineVector to(1075.0, 1025.0, -400.0);
  Moved moved(text, begin + 1.0, to - free.end.tip.tip);
  moved.GoOn_s();
  EXPECT_EQ(moved.run->outcome().code, ErrorCode::kArcUndefined);
  EXPECT_EQ(moved.run->outcome().place.step, 6);
  EXPECT_NEAR((moved.run->state().tip.tip - to).norm(), 0.0, 1e-6);
}

// OPT-B.55, OPT-6.42: the same where the program has run ahead to an error, which waits for the
// machine to stand: the first error counts, at its own step.
TEST(RideWays, TheFirstErrorCounts) {
  const std::string text = kThere +
                           "PATH CIR\n"
                           "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1050.,1050.,-400.,0.,0.)/FLY\n"
                           "VR[0]=1./VR[9]\nPATH LIN\nMOVE (1200.,1000.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  const Ran free = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kStop}}});
  const motion::MachineVector to(1075.0, 1025.0, -400.0);
  Moved moved(text, begin + 1.0, to - free.end.tip.tip);
  moved.GoOn_s();
  EXPECT_EQ(moved.run->outcome().code, ErrorCode::kDivisionByZero);
  EXPECT_EQ(moved.run->outcome().place.step, 7);
  EXPECT_NEAR((moved.run->state().tip.tip - to).norm(), 0.0, 1e-6);
}

// OPT-6.42, OPT-4.37, OPT-B.08: at SPEED 1, too, the way from there goes by the override, and is
// looked at before it begins.
TEST(RideWays, SlowMovesThatWereMoved) {
  const std::string text = kThere + "SPEED 1\nMOVE (1100.,1000.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  Moved moved(text, begin + 10.0, {-20.0, 0.0, 0.0});
  moved.Press(InputKind::kOverride, 50.0);
  const double way = 1100.0 - moved.left.x() + 20.0;
  EXPECT_NEAR(moved.GoOn_s(), way / 2.5 + Ramp_s(2.5) + kSettle_s, 1e-4);
  EXPECT_NEAR(moved.told.feeds.back(), 2.5, 1e-9);
  Moved outside(text, begin + 10.0, {0.0, 0.0, 2000.0});
  outside.GoOn_s();
  EXPECT_EQ(outside.run->outcome().code, ErrorCode::kTargetOutOfTravel);
}

// OPT-4.37: at SPEED 1 another override acts on the move under way: 2.5 mm/s from 40 mm on.
TEST(RideWays, TheOverrideActsOnASlowMove) {
  const std::string text = kThere + "SPEED 1\nMOVE (1050.,1000.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  const double change = begin + 8.0 + 0.5 * Ramp_s(5.0);  // 40 mm
  const Ran ran = RunText(text, {.inputs = {{At(change), InputKind::kOverride, 0, 50.0}}});
  // The ramp down takes a little more than it would at the lower speed.
  EXPECT_NEAR(ran.time_s, change + 10.0 / 2.5 + 0.5 * Ramp_s(2.5) + kSettle_s, 0.02);
  EXPECT_GT(ran.time_s, change + 3.9);
}

// OPT-4.37: a higher override at full speed acts without a way before it: no part of no length is
// told.
TEST(RideWays, AHigherOverrideTellsNoPartOfNothing) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1200.,1000.,-400.,0.,0.)/FLY\n"
      "MOVE (1300.,1000.,-400.,0.,0.)\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  const Ran ran = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kOverride, 0, 130.0}}});
  EXPECT_NEAR(ran.end.tip.tip.x(), 1300.0, 1e-9);
  double way = 0.0;
  for (const Ran::Part& part : ran.parts) {
    EXPECT_GT(part.done.end, part.done.start);
    EXPECT_GT(part.done.travelled, part.done.from);
    if (part.done.start >= ran.moves.front().at) way += part.done.travelled - part.done.from;
  }
  EXPECT_NEAR(way, 300.0, 1e-6);
}

// OPT-4.38: in a chain, too, the feed rate that is told is never over 500 mm/s; and one of 0.5 mm/s
// goes down to a half.
TEST(RideWays, FeedRatesOfAChain) {
  const auto last_feed = [](const std::string& speed, double step_mm, double percent) {
    std::string text = kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED " + speed + "\n";
    for (int k = 1; k <= 4; ++k) {
      text += "MOVE (" + std::to_string(1000.0 + step_mm * k) + ",1000.,-400.,0.,0.)";
      text += k < 4 ? "/FLY\n" : "\n";
    }
    const double begin = ToSeconds(RunText(text).moves.front().at);
    const Ran ran =
        RunText(text, {.inputs = {{At(begin + 0.5), InputKind::kOverride, 0, percent}}});
    return ran.parts.back().done.programmed_mm_s;
  };
  EXPECT_NEAR(last_feed("100", 400.0, 145.0), 500.0, 1e-9);
  EXPECT_NEAR(last_feed("80", 400.0, 145.0), 500.0, 1e-9);
  EXPECT_NEAR(last_feed("80", 400.0, 115.0), 460.0, 1e-9);
  EXPECT_NEAR(last_feed(".1", 1.0, 55.0), 0.275, 1e-6);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::ride_ways
