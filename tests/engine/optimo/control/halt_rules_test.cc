#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/engine/optimo/control/measured.h"
#include "tests/engine/optimo/control/run_text.h"

// HOLD and STOP on both sides of the way that braking takes, and the clocks that they stop. From
// 500 mm/s the machine comes to rest in 500/2000 + 2000/40000 = 0.3 s over 75 mm.
namespace rmlcell::optimo::testing::halt_rules {
namespace {

using machine::InputKind;
using machine::OutcomeKind;

constexpr double kTick_s = 0.048;

machine::InputChange Key(double at_s, InputKind kind) { return {At(at_s), kind}; }

std::string MoveX(double x_mm, const std::string& attributes) {
  return "MOVE (" + std::to_string(x_mm) + ",1000.,-400.,0.,0.)" + attributes + "\n";
}

// Steps 1 to 4, which bring the tip to X 0; at 500 mm/s from there on.
const std::string kFromZero = "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 100\n";
// Moves of 300 mm in one line as steps 5 to 8, with an instruction between.
const std::string kLine =
    kFromZero + MoveX(300, "/FLY") + MoveX(600, "/FLY") + MoveX(900, "/FLY") + MoveX(1200, "");

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// OPT-4.17: the move under way is finished if the way that is left is enough to brake, else the
// next one: 5 mm to either side of it, on each of three moves.
TEST(HaltRules, HoldFinishesTheFirstTargetThatCanBeReached) {
  const double begin = BeginOf(kLine);
  for (int k = 0; k < 3; ++k) {
    for (const double spare : {5.0, -5.0}) {
      const double at = 300.0 * (k + 1) - 75.0 - spare;  // where HOLD comes
      const Ran ran = RunText(kLine, {.inputs = {Key(begin + 0.15 + at / 500.0, InputKind::kHold),
                                                 Key(begin + 30.0, InputKind::kStart)}});
      SCOPED_TRACE(at);
      if (k == 2 && spare < 0.0) {  // the last target is the end of the program
        EXPECT_NEAR(ran.moves.back().tip.tip.x(), 1200.0, 1e-4);
        continue;
      }
      const int target = spare > 0.0 ? k : k + 1;
      EXPECT_EQ(ran.First("halt HOLD").step, 5 + target);
      EXPECT_NEAR(ran.First("halt HOLD").at_s,
                  begin + 300.0 * (target + 1) / 500.0 + 0.3 + kSettle_s, 1e-6);
      ExpectWithinLimits(ran, true, "HOLD at " + std::to_string(at));
      EXPECT_NEAR(ran.time_s,
                  begin + 30.0 + (1200.0 - 300.0 * (target + 1)) / 500.0 + 0.3 + kSettle_s, 1e-6);
    }
  }
}

// OPT-4.17: while it speeds up the acceleration is brought to zero first. 0.1 s after the start it
// is 5.833 mm on the way, at 150 mm/s and 2000 mm/s2: at rest after 30 mm. 0.03 s: 0.18 mm, 18 mm/s
// and 1200 mm/s2, at rest after 2.16 mm.
TEST(HaltRules, HoldWhileSpeedingUp) {
  struct Case {
    double after_s, rest_mm;
  };
  for (const Case& one : {Case{0.1, 30.0}, Case{0.03, 2.16}}) {
    for (const double spare : {0.05, -0.05}) {
      const double first = one.rest_mm + spare;
      const std::string text = kFromZero + MoveX(first, "/FLY") + MoveX(first + 300.0, "/FLY") +
                               MoveX(first + 600.0, "");
      const double begin = BeginOf(text);
      const Ran ran = RunText(text, {.inputs = {Key(begin + one.after_s, InputKind::kHold),
                                                Key(begin + 30.0, InputKind::kStart)}});
      EXPECT_EQ(ran.First("halt HOLD").step, spare > 0.0 ? 5 : 6) << first;
      EXPECT_NEAR(ran.moves.back().tip.tip.x(), first + 600.0, 1e-4);
      ExpectWithinLimits(ran, true, "first target at " + std::to_string(first));
    }
  }
}

// OPT-4.17, OPT-2.49: what stands behind a move that is still passed comes at its passage; what
// stands behind the one that became exact, with START.
TEST(HaltRules, EffectsOfPassagesBeforeAHold) {
  const std::string text = kFromZero + MoveX(300, "/FLY") + "OL[16]=ON\n" + MoveX(600, "/FLY") +
                           "OL[17]=ON\n" + MoveX(900, "");
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {Key(begin + 0.15 + 240.0 / 500.0, InputKind::kHold),
                                            Key(begin + 30.0, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt HOLD").step, 7);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, begin + 0.15 + 300.0 / 500.0, 1e-6);
  EXPECT_NEAR(ran.First("OL[17] 1").at_s, begin + 30.0, 1e-6);
  // The same where moves are too short to brake on one: each comes once, at its place.
  std::string many = kFromZero;
  for (int k = 1; k <= 60; ++k) {
    many += MoveX(10.0 * k, k < 60 ? "/FLY" : "");
    if (k < 60)
      many += "OL[" + std::to_string(20 + k % 50) + "]=" + (k <= 50 ? "ON" : "OFF") + "\n";
  }
  const double start = BeginOf(many);
  const Ran held = RunText(many, {.inputs = {Key(start + 0.15 + 203.0 / 500.0, InputKind::kHold),
                                             Key(start + 30.0, InputKind::kStart)}});
  EXPECT_EQ(held.First("halt HOLD").step, 5 + 2 * 27);  // 280 mm: 203 + 75 is beyond 270
  for (int k = 1; k <= 50; ++k) {
    const std::string output = "OL[" + std::to_string(20 + k % 50) + "] 1";
    EXPECT_EQ(held.Count(output), 1) << k;
    const double at = held.First(output).at_s - start;
    if (k >= 28) {
      EXPECT_GE(at, 30.0 - 1e-6) << k;
    } else {
      EXPECT_LT(at, 2.0) << k;
    }
    if (k >= 8 && k <= 20) {
      EXPECT_NEAR(at, 0.15 + 10.0 * k / 500.0, 1e-6) << k;
    }
  }
  EXPECT_NEAR(held.moves.back().tip.tip.x(), 600.0, 1e-4);
  ExpectWithinLimits(held, true, "many short moves");
}

// OPT-4.17, OPT-4.37: a chain of axes that runs at another override than it was planned with: HOLD
// finds its targets all the same, along each axis and in both directions.
TEST(HaltRules, HoldInCoordRobotAfterAChangeOfTheOverride) {
  struct Axis {
    int index;
    double speed_percent, full_speed, acceleration, jerk, from, step;
  };
  constexpr double kPi = M_PI;
  for (const Axis& axis :
       {Axis{0, 50, 500, 2000, 40000, 21.02, 300}, Axis{0, 50, 500, 2000, 40000, 921.02, -300},
        Axis{1, 50, 500, 2000, 40000, 2201.2, -300}, Axis{2, 50, 500, 2000, 40000, -50, -300},
        Axis{3, 50, 2 * kPi, 20, 400, 0, 4}, Axis{3, 50, 2 * kPi, 20, 400, 0, -4},
        Axis{4, 10, 2 * kPi, 20, 400, 0, -0.8}}) {
    const auto place = [&](double value) {
      double v[] = {21.02, 2201.2, -50.0, 0.0, 0.0};
      v[axis.index] = value;
      std::string text;
      for (const double x : v) text += (text.empty() ? "MOVE (" : ",") + std::to_string(x);
      return text + ")";
    };
    const auto ramp = [&](double change) {
      return change * axis.jerk < axis.acceleration * axis.acceleration
                 ? 2.0 * std::sqrt(change / axis.jerk)
                 : change / axis.acceleration + axis.acceleration / axis.jerk;
    };
    const std::string text =
        place(axis.from) + "\nDELAY 1\nSPEED " + std::to_string(axis.speed_percent) + "\n" +
        place(axis.from + axis.step) + "/FLY\n" + place(axis.from + 2 * axis.step) + "/FLY\n" +
        place(axis.from + 3 * axis.step) + "\n";
    const Ran there = RunText(place(axis.from) + "\n");
    const double begin = there.time_s + 1.0;
    const double speed = axis.full_speed * axis.speed_percent / 100.0;
    for (const double hold_at : {1.0, 2.5}) {
      const Ran ran = RunText(text, {.inputs = {{At(begin + 0.5), InputKind::kOverride, 0, 50.0},
                                                Key(begin + hold_at, InputKind::kHold),
                                                Key(begin + 30.0, InputKind::kStart)}});
      SCOPED_TRACE(text);
      const int target = hold_at < 2.0 ? 1 : 2;
      EXPECT_EQ(ran.First("halt HOLD").step, 3 + target);
      // At full speed until the change, then at half of it, and to rest from there.
      const double before = speed * (0.5 - 0.5 * ramp(speed));
      const double left = target * std::abs(axis.step) - before - 0.75 * speed * ramp(0.5 * speed) -
                          0.25 * speed * ramp(0.5 * speed);
      EXPECT_NEAR(ran.First("halt HOLD").at_s,
                  begin + 0.5 + 2.0 * ramp(0.5 * speed) + left / (0.5 * speed) + kSettle_s, 1e-5);
      const double reached = axis.from + target * axis.step;
      bool passed = false;
      for (const machine::MoveDone& move : ran.moves) {
        const motion::AxisPose& at = move.axes;
        const double all[] = {at.column.x(), at.column.y(), at.column.z(), at.a_rad, at.b_rad};
        passed =
            passed || std::abs(all[axis.index] - reached) < 1e-6 * std::max(1.0, std::abs(reached));
      }
      EXPECT_TRUE(passed);
      EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
      ExpectWithinLimits(ran, false, text);
    }
  }
}

// OPT-4.17, OPT-4.37: the same on a circle of three quarters, behind its half: radius 100, from
// (0,1000) over (100,1100) and (200,1000) to (100,900), and on along the tangent.
TEST(HaltRules, HoldOnACircleAfterAChangeOfTheOverride) {
  const std::string text =
      "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 10\nPATH CIR\n"
      "MOVE (100.,900.,-400.,0.,0.)/VIA (200.,1000.,-400.,0.,0.)/FLY\nPATH LIN\n"
      "MOVE (-100.,900.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {{At(begin + 7.0), InputKind::kOverride, 0, 50.0},
                                            Key(begin + 7.5, InputKind::kHold),
                                            Key(begin + 60.0, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt HOLD").step, 6);
  EXPECT_LT(ran.DistanceTo({100.0, 900.0, -400.0}), 1e-6);
  const double ramp = 2.0 * std::sqrt(50.0 / 40000.0);
  const double half = 2.0 * std::sqrt(25.0 / 40000.0);
  const double left = 150.0 * M_PI - 50.0 * (7.0 - 0.5 * ramp) - 37.5 * half - 12.5 * half;
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + 7.0 + 2.0 * half + left / 25.0 + kSettle_s,
              5e-3);
  EXPECT_NEAR(ran.moves.back().tip.tip.x(), -100.0, 1e-4);
  ExpectWithinLimits(ran, true, "circle");
}

// OPT-3.38, OPT-B.30: the clock of a WORK in the background stands while the machine is halted: its
// /END is tested at whole cycles of the time that the program had.
TEST(HaltRules, TheClockOfABackgroundWorkStandsWhileHalted) {
  const double stood = 2.01;
  const Ran ran = RunText("WORK 0,0/ON/END (IL[20])\nDELAY 10\n",
                          {.inputs = {Key(1.0, InputKind::kStop),
                                      Key(1.0 + stood, InputKind::kStart),
                                      {At(4.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_EQ(ran.Count("beam off"), 2);  // with the halt, and with /END
  EXPECT_NEAR(ran.events[ran.events.size() - 3].at_s, stood + 42 * kTick_s, 1e-9);
  EXPECT_EQ(ran.events[ran.events.size() - 3].what, "beam off");
}

// OPT-4.18, OPT-2.51: a STOP while /TIME brings the tip to rest, at 50 mm/s from 0.5 s on, 0.12 s
// long: what follows begins where the tip rests. From X 0 to 600 at 50 mm/s it is 12 s on its way,
// less what it went in the half second, 25 mm at most.
TEST(HaltRules, AStopWhileTimeBrakesLosesNoWay) {
  const std::string text = "COORD ABSOL\nPATH LIN\nMOVE (0.,1000.,-400.,0.,0.)\nSPEED 10\n" +
                           MoveX(500, "/TIME (.5,900)") + "900 DELAY 1\n" + MoveX(600, "");
  const double begin = BeginOf(text);
  for (const double after : {0.49, 0.52, 0.55, 0.58, 0.61, 0.8}) {
    const Ran ran = RunText(text, {.inputs = {Key(begin + after, InputKind::kStop),
                                              Key(begin + 5.0, InputKind::kStart)}});
    SCOPED_TRACE(after);
    EXPECT_EQ(ran.Count("halt STOP"), 1);
    ExpectWithinLimits(ran, true, "STOP at " + std::to_string(after));
    EXPECT_NEAR(ran.moves.back().tip.tip.x(), 600.0, 1e-4);
    EXPECT_GT(ran.time_s, begin + 5.0 + 575.0 / 50.0);
  }
}

// OPT-7.68, OPT-2.60: IL[95] is 1 until standstill, not until the machine has settled: 100 mm at 50
// mm/s are over after 2.0707 s, the tick behind that is 2.112 s.
TEST(HaltRules, TheMotionFlagIsOffAtStandstill) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)/NEXT\n"
      "WAIT NOT IL[95]\nOL[16]=ON\n");
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 44 * kTick_s, 1e-9);
}

// OPT-4.18, OPT-2.54, OPT-B.59: the clocks of /TIME and TIMER stand while the machine is halted:
// the one does not run out behind a STOP of 20 s, and the other calls as long after START as it
// would have without.
TEST(HaltRules, ClocksStandWhileItIsHalted) {
  const std::string text = kFromZero + "SPEED 10\nTIMER (4.,8)\n" +
                           "MOVE (100.,1000.,-400.,0.,0.)/TIME (5.,9)\n" + MoveX(200, "") +
                           "ENDTASK\n8 VI[1] = VI[1] + 1\nRETURN\n9 VI[2] = 1\nRETURN\n";
  RunOptions options{.variables = {"VI[1]", "VI[2]"}};
  const Ran whole = RunText(text, options);
  ASSERT_EQ(whole.variables.at("VI[1]"), "1");
  ASSERT_EQ(whole.variables.at("VI[2]"), "0");
  const SimTime begin = whole.moves.front().at;
  options.inputs = {Key(ToSeconds(begin) + 1.0, InputKind::kStop),
                    Key(ToSeconds(begin) + 21.0, InputKind::kStart)};
  const Ran halted = RunText(text, options);
  EXPECT_EQ(halted.variables.at("VI[1]"), "1");
  EXPECT_EQ(halted.variables.at("VI[2]"), "0");
  EXPECT_NEAR(halted.moves.back().tip.tip.x(), 200, 1e-4);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::halt_rules
