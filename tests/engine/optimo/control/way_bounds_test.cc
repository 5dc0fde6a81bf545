// The ends of ways: of each axis and of its travel, of chains that are changed on the way, of what
// stands still and goes on.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::way_bounds {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

constexpr double kHome[] = {-2000.0, 2.5, -50.0, 0.0, 0.0};

// All axes have a wide travel, but for one; X is below zero.
std::map<std::string, std::string> NarrowTravel(std::size_t narrow, double around) {
  const std::string names = "XYZAB";
  std::map<std::string, std::string> parameters{{"HOME_X", "-2000"}, {"HOME_Y", "2.5"}};
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    const double wide = axis < 3 ? 90000.0 : 900.0;
    const std::string name = std::string("TRAVEL_") + names[axis];
    const double middle = axis == narrow ? kHome[axis] : 0.0;
    const double by = axis == narrow ? around : wide;
    parameters[name + "_MIN"] = std::to_string(middle - by);
    parameters[name + "_MAX"] = std::to_string(axis == 0 && axis != narrow ? -1000.0 : middle + by);
  }
  return parameters;
}

// A MOVE of the axes to home, with one of them somewhere else.
std::string MoveOf(std::size_t axis, double by) {
  std::string text = "MOVE (";
  for (std::size_t i = 0; i < 5; ++i)
    text += (i > 0 ? "," : "") + std::to_string(kHome[i] + (i == axis ? by : 0.0));
  return text + ")\n";
}

// OPT-B.08: each axis has its own two ends, wherever the way to them begins.
TEST(WayBounds, EachAxisHasItsTravel) {
  for (std::size_t axis = 0; axis < 5; ++axis) {
    const double around = axis < 3 ? 400.0 : 2.0;
    const RunOptions options{.parameters = NarrowTravel(axis, around)};
    for (const double from : {-around + 0.3, 0.0, around - 0.3}) {
      const std::string there = "COORD ROBOT\n" + MoveOf(axis, from);
      for (const double inside : {-around + 0.1, around - 0.1})
        EXPECT_EQ(CodeOf(RunText(there + MoveOf(axis, inside), options)), 0) << axis << inside;
      for (const double beyond : {-around - 0.1, around + 0.1}) {
        const Ran ran = RunText(there + MoveOf(axis, beyond), options);
        EXPECT_EQ(CodeOf(ran), 7301) << axis << " " << from << " " << beyond;
        ASSERT_EQ(ran.violations.size(), 1U);
        EXPECT_EQ(ran.violations[0].axis, static_cast<int>(axis));
        EXPECT_NEAR(ran.violations[0].excess, 0.1, 2e-4);  // 24 bits
      }
    }
  }
}

// OPT-B.08: a tip that goes straight takes its column along, 300 mm above it.
TEST(WayBounds, EachAxisOfATipHasItsTravel) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const RunOptions options{.parameters = NarrowTravel(axis, 400.0)};
    for (const double from : {-399.7, -99.0, 99.0, 399.7}) {
      const std::string there = "COORD ROBOT\n" + MoveOf(axis, from);
      for (const double to : {-400.1, -399.9, 399.9, 400.1}) {
        std::string tip = "COORD ABSOL\nPATH LIN\nMOVE (";
        for (std::size_t i = 0; i < 3; ++i)
          tip += std::to_string(kHome[i] + (i == axis ? to : 0.0) - (i == 2 ? 300.0 : 0.0)) + ",";
        EXPECT_EQ(CodeOf(RunText(there + tip + "0.,0.)\n", options)),
                  std::abs(to) > 400.0 ? 7301 : 0)
            << axis << " " << from << " " << to;
      }
    }
  }
}

// OPT-B.08: a tip that goes straight with a steady head takes its column along: each end of each
// axis, with the head straight down and lying.
TEST(WayBounds, TheColumnOfAStraightWayHasItsTravel) {
  const auto run = [](double x, double y, double z, const std::string& b) {
    const auto point = [&](double px, double py, double pz) {
      return "MOVE (" + std::to_string(px) + "," + std::to_string(py) + "," + std::to_string(pz) +
             ",0.," + b + ")\n";
    };
    return CodeOf(RunText(kAbsol + point(1000.0, 1000.0, -400.0) + point(x, y, z)));
  };
  EXPECT_EQ(run(-599.5, 1000.0, -400.0, "0."), 0);
  EXPECT_EQ(run(-600.5, 1000.0, -400.0, "0."), 7301);
  EXPECT_EQ(run(3599.5, 1000.0, -400.0, "0."), 0);
  EXPECT_EQ(run(3600.5, 1000.0, -400.0, "0."), 7301);
  EXPECT_EQ(run(1000.0, -599.5, -400.0, "0."), 0);
  EXPECT_EQ(run(1000.0, -600.5, -400.0, "0."), 7301);
  EXPECT_EQ(run(1000.0, 3099.5, -400.0, "0."), 0);
  EXPECT_EQ(run(1000.0, 3100.5, -400.0, "0."), 7301);
  EXPECT_EQ(run(1000.0, 1000.0, -1599.5, "0."), 0);
  EXPECT_EQ(run(1000.0, 1000.0, -1600.5, "0."), 7301);
  EXPECT_EQ(run(1000.0, 1000.0, 799.5, "0."), 0);
  EXPECT_EQ(run(1000.0, 1000.0, 800.5, "0."), 7301);
  // B of a quarter turn: the column stands 300 mm off towards -Y. OPT-B.03
  EXPECT_EQ(run(1000.0, -299.0, -400.0, "1.570796"), 0);
  EXPECT_EQ(run(1000.0, -301.0, -400.0, "1.570796"), 7301);
  EXPECT_EQ(run(1000.0, 3399.0, -400.0, "1.570796"), 0);
  EXPECT_EQ(run(1000.0, 3401.0, -400.0, "1.570796"), 7301);
}

// OPT-3.58, OPT-4.49: an error while the machine settles behind the first axis of ZERO: it stays
// there.
TEST(WayBounds, AnErrorWhileItSettlesDropsTheRest) {
  const std::string text = "WORK 0,0/ON/START (1./IA[20] > 2.)/NEXT\nZERO\nWORK 0,0/OFF\n";
  const machine::InputChange one{SimTime(0), InputKind::kAnalogue, 20, 1.0};
  const Ran free = RunText(text, {.inputs = {one}});
  ASSERT_EQ(free.parts.size(), 2U);
  EXPECT_NEAR(free.end.axes.column.x(), 0.0, 1e-9);
  const double settled = ToSeconds(free.parts[0].done.end);
  const Ran ran = RunText(
      text, {.inputs = {one, {At(settled - 0.5 * kSettle_s), InputKind::kAnalogue, 20, 0.0}}});
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_NEAR(ran.end.axes.column.z(), 0.0, 1e-9);
  EXPECT_EQ(ran.end.axes.column.x(), 21.02);
  EXPECT_NEAR(ran.time_s, settled, 1e-6);
}

// OPT-4.49: a STOP while the machine settles behind the first axis of ZERO, and START: each group
// is told once, as without it.
TEST(WayBounds, AStopWhileZeroSettlesTellsNothingMore) {
  const Ran free = RunText("ZERO\n");
  const double settled = ToSeconds(free.parts[0].done.end);
  const Ran ran = RunText("ZERO\n", {.inputs = {{At(settled - 0.5 * kSettle_s), InputKind::kStop},
                                                {At(settled + 5.0), InputKind::kStart}}});
  EXPECT_EQ(ran.Count("halt STOP"), 1);
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_EQ(ran.moves[0].path, "ZERO_Z");
  EXPECT_EQ(ran.moves[1].path, "ZERO_AB");
  EXPECT_EQ(ran.moves[2].path, "ZERO_XY");
}

// OPT-B.30, OPT-4.18: while a STOP stands the time of a MOVE that waits for its /START stands, too:
// it is over as much later, whenever the condition is tested again.
TEST(WayBounds, TheTimeOfAWaitingMoveStandsStill) {
  const double stood = 10.0 * kCycle_s + 0.010;
  const Ran ran = RunText(
      "MOVE (121.02,2201.2,-50.,0.,0.)/START (IL[20])/TIME (2.,900)\nENDTASK\n900 OL[16]=ON\n"
      "RETURN\n",
      {.inputs = {{At(1.0), InputKind::kStop}, {At(1.0 + stood), InputKind::kStart}}});
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, std::ceil(2.0 / kCycle_s) * kCycle_s + stood, 1e-9);
}

// OPT-B.30, OPT-7.97: where the machine stands is an input: moved by hand, it ends a WAIT at START,
// and not a cycle later.
TEST(WayBounds, AWaitSeesThatItWasMoved) {
  const auto run = RunOfText("WAIT (IA[0] > 500.)\nDELAY 1\n");
  run->Advance(At(1.0));
  run->Apply({.kind = InputKind::kStop});
  ASSERT_TRUE(run->may_be_moved());
  motion::AxisPose axes = run->state().axes;
  axes.column.x() = 600.0;
  run->MoveTo(axes);
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(9.0)), RunPhase::kFinished);
  EXPECT_EQ(run->state().time, At(2.0));
}

// OPT-4.38: whenever the override falls, also while the machine slows down for a corner, the last
// move of the chain is ridden with the new one.
TEST(WayBounds, ALowerOverrideReachesTheLastMove) {
  const std::string text =
      kAbsol +
      "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 100\nOVERSH 20\n"
      "MOVE (1400.,1000.,-400.,0.,0.)/FLY\nMOVE (1400.,1400.,-400.,0.,0.)/FLY\n"
      "MOVE (1800.,1400.,-400.,0.,0.)/FLY\nMOVE (1800.,1800.,-400.,0.,0.)\n";
  const Ran free = RunText(text);
  const double begin = ToSeconds(free.moves.front().at);
  const double third = ToSeconds(free.moves[3].at) - begin;
  for (int n = 0; n <= 120; ++n) {
    const double at = third * n / 120.0;
    const Ran ran = RunText(text, {.inputs = {{At(begin + at), InputKind::kOverride, 0, 50.0}}});
    const Ran::Part& last = ran.parts.back();
    EXPECT_NEAR(last.SpeedAt(0.5 * last.duration_s()), 250.0, 1e-6) << at;
    EXPECT_NEAR(ran.end.tip.tip.y(), 1800.0, 1e-6) << at;
  }
}

// OPT-4.38: where the override changes on the last move of a chain, the machine settles at its end
// and nowhere before.
TEST(WayBounds, OnlyTheEndOfAChangedMoveSettles) {
  const std::string text =
      kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)\n";
  const Ran free = RunText(text);
  const double change = free.time_s - 1.0;
  const Ran ran = RunText(text, {.inputs = {{At(change), InputKind::kOverride, 0, 50.0}}});
  int settled = 0;
  for (const Ran::Part& part : ran.parts) {
    if (part.done.travelled < part.motion.path.length() - 1e-9) continue;
    if (part.motion.settling_s > 0.0) ++settled;
  }
  EXPECT_EQ(settled, 2);  // with the move to where the chain begins
  EXPECT_NEAR(ran.parts.back().motion.settling_s, kSettle_s, 1e-12);
}

// OPT-4.17: HOLD in the last moves of a chain, which are too short to brake on: it ends as it would
// have, at the last target, and halts there; before, at a target that is not the last.
TEST(WayBounds, HoldInTheLastMovesOfAChain) {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  for (int k = 1; k <= 60; ++k) {
    text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
    text += k < 60 ? "/FLY\n" : "\n";
  }
  const Ran free = RunText(text);
  // From 200 mm/s to rest in 0.15 s: moves before that, on that way, and where it has just begun.
  std::vector<double> before_s;
  for (int n = 1; n <= 40; ++n) before_s.push_back(0.01 * n + 1e-4);
  for (int n = -10; n <= 30; ++n) before_s.push_back(0.15 - 1e-4 * n);
  for (const double n : before_s) {
    const double hold = free.time_s - kSettle_s - n;
    const Ran ran = RunText(text, {.inputs = {{At(hold), InputKind::kHold},
                                              {At(free.time_s + 10.0), InputKind::kStart}}});
    const int step = ran.First("halt HOLD").step;
    if (step < 64) {
      EXPECT_GT(ran.First("halt HOLD").at_s, hold) << n;
      continue;
    }
    EXPECT_NEAR(ran.First("halt HOLD").at_s, free.time_s, 1e-9) << n;
    EXPECT_EQ(ran.parts.size(), free.parts.size()) << n;
  }
}

// OPT-3.06: a schedule that a WORKDEF names by a number is looked for, whatever stands behind it.
TEST(WayBounds, ScheduleNumbersBesideVariables) {
  for (const std::string text : {"WORKDEF 2,1 (20)\nVR[1]=VR[2]\n", "WORKDEF 2,1 (20)\nVR[1]=3.\n",
                                 "VR[1]=VR[2]\nWORKDEF 2,1 (20)\n"}) {
    std::map<int, machine::StoredProgram> memory;
    memory[1].object = machine::Bytes::Of(Compile(text, "", {}).object);
    machine::Parameters few(OptimoFamily().parameters());
    EXPECT_TRUE(few.Set("SCHEDULES", 11.0));
    const Status missing = OptimoFamily().CheckNeeds(memory, {}, few, 1);
    ASSERT_FALSE(missing) << text;
    EXPECT_EQ(missing.error().code, ErrorCode::kScheduleMissing);
    EXPECT_TRUE(OptimoFamily().CheckNeeds(memory, {{.number = 20}}, few, 1)) << text;
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::way_bounds
