// Keys and override in the middle of a chain: motion.md section 6, along chains of section 7.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/engine/rml1/chain_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::InputScript;
using machine::OutcomeKind;
using machine::RunPhase;
using ::testing::ElementsAre;
using namespace std::chrono_literals;

// T1 accelerates by 200 mm/s2; its axes jump by 3 mm/s.
constexpr double kLower = 20.0 / 2.0 + 2.0 / 200.0;  // 20 mm down at 2 mm/s

// An L of two lines of 10 mm, each in steps of 0.1 mm, at 10 mm/s: 0.05 s and 0.25 mm to speed, and
// 0.035 s and 0.2275 mm down to the 3 mm/s of the corner.
std::string StepsOfL() {
  std::string stream = "!MC0;VS10;PD;PD";
  for (int k = 10; k <= 1000; k += 10) stream += std::to_string(k) + ",0,";
  for (int k = 10; k <= 1000; k += 10) stream += "1000," + std::to_string(k) + ",";
  stream.back() = ';';
  return stream;
}
const double kLine = 0.05 + (10.0 - 0.25 - 0.2275) / 10.0 + 0.035;  // either of them
constexpr double kCornerX = 10.0;

// Every place that the tool was at lies on the L, and it went along it once.
void ExpectPathOfL(const TestRun& run) {
  motion::MachinePoint last{0.0, 0.0, -20.0};
  double length = 0.0;
  const auto& motions = run.seen().motions();
  for (std::size_t k = 1; k < motions.size(); ++k) {
    const RunRecord::Motion& m = motions[k];
    const motion::MachinePoint from = m.planned.path.from().point;
    const motion::MachinePoint to = m.planned.path.At(m.travelled).point;
    EXPECT_LE((from - last).norm(), 2e-9);
    for (const motion::MachinePoint& p : {from, to}) {
      EXPECT_LE(std::min(std::abs(p.y()), std::abs(p.x() - kCornerX)), 1e-9);
    }
    length += (from - to).norm();
    last = to;
  }
  EXPECT_NEAR(length, 20.0, 1e-7);
  EXPECT_NEAR(last.x(), kCornerX, 1e-9);
  EXPECT_NEAR(last.y(), 10.0, 1e-9);
  ASSERT_EQ(run.seen().moves().size(), 201U);  // each motion is told once
}

TEST(MillChainControl, RidesTheL) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  run.AdvanceToEnd();
  EXPECT_NEAR(run.time_s(), kLower + 2 * kLine, 2e-8);
  ExpectPathOfL(run);
}

// STOP 0.1 mm before the corner, at 7 mm/s and braking for it: 3 mm/s at the corner, and rest
// 0.0225 mm behind it, 0.035 s after the key. START: 9.9775 mm from rest.
TEST(MillChainControl, StopsBehindACorner) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  const double key = kLower + kLine - 0.035 + 3.0 / 200.0;
  run->Advance(FromSeconds(key));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 7.0, 1e-6);
  EXPECT_NEAR(run->state().tip.tip.x(), 9.9, 1e-8);
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run.time_s(), key + 0.035, 1e-8);
  EXPECT_NEAR(run->state().tip.tip.x(), 10.0, 1e-9);
  EXPECT_NEAR(run->state().tip.tip.y(), 0.0225, 1e-7);
  EXPECT_EQ(run->state().tip_speed_mm_s, 0.0);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), key + 0.035 + 9.9775 / 10.0 + 0.05, 1e-6);
  ExpectPathOfL(run);
}

// HOLD ends the motion in progress. Where the tool is too fast for that it ends the next ones too:
// 0.15 mm before the corner it has sqrt(9 + 400 x 0.15) mm/s, which take 0.1725 mm to brake, of
// which 0.05 mm are left of its motion and 0.1 mm of the next one.
TEST(MillChainControl, HoldsAtTheFirstEndThatCanBeReached) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  const double speed = std::sqrt(9.0 + 400.0 * 0.15);
  const double key = kLower + kLine - (speed - 3.0) / 200.0;
  run->Advance(FromSeconds(key));
  EXPECT_NEAR(run->state().tip.tip.x(), 9.85, 1e-7);
  run.Press(InputKind::kHold);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.tip.x(), 10.0, 1e-9);
  EXPECT_NEAR(run->state().tip.tip.y(), 0.1, 1e-9);
  EXPECT_EQ(run.seen().Events().back(), "halt HOLD");
  // Behind the corner up from 3 mm/s and down to rest in 0.1 mm: peak^2 = 4.5 + 20.
  const double peak = std::sqrt(24.5);
  EXPECT_NEAR(run.time_s(), kLower + kLine + (2 * peak - 3.0) / 200.0, 1e-7);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), kLower + kLine + (2 * peak - 3.0) / 200.0 + 9.9 / 10.0 + 0.05, 1e-7);
  ExpectPathOfL(run);

  // With time to spare it ends its own motion: the plan of the chain becomes one that stands there.
  TestRun early(ParametersOf("t1"), "!MC0;VS10;PD1000,0,1000,1000;");
  early->Advance(FromSeconds(kLower + 0.5));
  early.Press(InputKind::kHold);
  ASSERT_EQ(early.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(early->state().tip.tip.x(), 10.0, 1e-9);
  EXPECT_NEAR(early.time_s(), kLower + 1.05, 1e-7);
}

// A HOLD taken back before the tool stands leaves no trace.
TEST(MillChainControl, TakesBackAHold) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  run->Advance(FromSeconds(kLower + 0.5));
  run.Press(InputKind::kHold);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), kLower + 2 * kLine, 1e-7);
  EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1PausedAtEnd), 0);
  ExpectPathOfL(run);
}

// Override to 50 % at 5 mm: 0.1875 mm of braking run over the ends of two motions; then all at
// 5 mm/s, with the corner still at 3.
TEST(MillChainControl, BrakesOverTheEndsOfMotions) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  const double key = kLower + 0.05 + (5.0 - 0.25) / 10.0;
  run->Advance(FromSeconds(key));
  EXPECT_NEAR(run->state().tip.tip.x(), 5.0, 1e-8);
  run.Press(InputKind::kOverride, 50.0);
  run->Advance(FromSeconds(key + 0.025));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 5.0, 1e-6);
  EXPECT_NEAR(run->state().tip.tip.x(), 5.1875, 1e-7);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  const double to_corner = (25.0 - 9.0) / 400.0;  // mm from 5 to 3 mm/s
  const double rest = 5.0 / 200.0 + (5.0 - 0.1875 - to_corner) / 5.0 + 2.0 / 200.0;
  const double last = 2.0 / 200.0 + (10.0 - to_corner - 0.0625) / 5.0 + 5.0 / 200.0;
  EXPECT_NEAR(run.time_s(), key + rest + last, 1e-7);
  EXPECT_EQ(run.seen().moves().back().feed_mm_s, 5.0);
  ExpectPathOfL(run);
  for (const RunRecord::Motion& m : run.seen().motions()) {
    for (int i = 0; i <= 4; ++i) {
      const motion::PathState at = m.planned.speed.At(m.planned.speed.duration_s() * i / 4);
      EXPECT_LE(std::abs(at.acceleration), 200.0 * (1.0 + 1e-6));
      EXPECT_TRUE(m.start_s <= key + 0.025 || at.speed <= 5.0 + 1e-6);
    }
  }
}

// Override to 150 % at 5 mm: up at once, and the corner still at 3 mm/s.
TEST(MillChainControl, SpeedsUpInTheMiddleOfAChain) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  const double key = kLower + 0.05 + (5.0 - 0.25) / 10.0;
  run->Advance(FromSeconds(key));
  run.Press(InputKind::kOverride, 150.0);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  const double up = (225.0 - 100.0) / 400.0;
  const double corner = (225.0 - 9.0) / 400.0;
  const double first = 5.0 / 200.0 + (5.0 - up - corner) / 15.0 + 12.0 / 200.0;
  const double second = 12.0 / 200.0 + (10.0 - corner - 225.0 / 400.0) / 15.0 + 15.0 / 200.0;
  EXPECT_NEAR(run.time_s(), key + first + second, 1e-7);
  ExpectPathOfL(run);
}

// motion.md section 10, property 12: there and back again at one instant changes nothing; nor does
// an override that the tool is too near to the end to notice.
TEST(MillChainControl, ForgetsAnOverrideOfNoTime) {
  for (const double at : {0.02, 0.3, 0.9985, 1.0, 1.2, 2.01}) {
    TestRun run(ParametersOf("t1"), StepsOfL());
    run->Advance(FromSeconds(kLower + at));
    run.Press(InputKind::kOverride, 30.0);
    run.Press(InputKind::kOverride, 100.0);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    EXPECT_NEAR(run.time_s(), kLower + 2 * kLine, 2e-7) << at;
    ExpectPathOfL(run);
  }
}

// A new override counts for chains to come, also where it comes while the tool stands.
TEST(MillChainControl, KeepsTheOverrideForLaterChains) {
  TestRun run(ParametersOf("t1"), "!MC0;VS10;W1000;PD1000,0;W0;PD2000,0,3000,0;",
              {{.at = 500ms, .kind = InputKind::kOverride, .index = 0, .value = 50.0}});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  // Two dwells, 20 mm down at 1 mm/s, 10 mm at 5 mm/s with a joint at 5, 20 mm at 5.
  EXPECT_NEAR(run.time_s(), 2.0 + (20.0 + 0.005) + 30.0 / 5.0 + 0.025, 1e-7);
}

// SINGLE and a breakpoint need a tool that stands: the chain ends at their commands, and only
// there.
TEST(MillChainControl, EndsChainsWhereTheRunHalts) {
  const std::string stream = "!MC0;VS10;PD1000,0,2000,0;VS9;PD3000,0;PD4000,0;";
  const auto joints = [](const TestRun& run) {
    std::string text;
    for (const RunRecord::Motion& motion : run.seen().motions()) {
      text += motion.planned.speed.end().speed > 0.0 ? 'j' : '-';
    }
    return text;
  };
  machine::RunSetup single = SetupOf(ParametersOf("t1"), stream);
  single.mode = machine::Mode::kSingle;
  TestRun steps(std::move(single));
  while (steps.AdvanceToEnd() == RunPhase::kHalted) {
    EXPECT_EQ(steps->state().tip_speed_mm_s, 0.0);
    steps.Press(InputKind::kStart);
  }
  EXPECT_EQ(joints(steps), "-j---");

  for (const auto& [step, expected] : {std::pair{3, "-j-j-"}, {4, "-j-j-"}, {5, "-jj--"}}) {
    machine::RunSetup setup = SetupOf(ParametersOf("t1"), stream);
    setup.breakpoint = machine::ProgramStep{.program = 1, .step = step};
    TestRun run(std::move(setup));
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
    EXPECT_EQ(run->state().place.step, step);
    EXPECT_EQ(run->state().tip_speed_mm_s, 0.0);
    run.Press(InputKind::kStart);
    run.AdvanceToEnd();
    EXPECT_EQ(joints(run), expected);
  }
}

// !NR in a chain: the tool stands, whatever follows, and later bytes do not act before their time.
TEST(MillChainControl, PausesInAChain) {
  TestRun run(ParametersOf("t1"), "!MC0;VS10;PD1000,0;!NR;PD2000,0;!NR;XX;PD3000,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run.time_s(), kLower + 1.05, 1e-8);
  EXPECT_EQ(run.variable("ERR"), "0");
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run.time_s(), kLower + 2.1, 1e-8);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), kLower + 3.15, 1e-8);
}

// An emergency stop and the end of a budget on the way: what was ridden stays told.
TEST(MillChainControl, KeepsWhatWasRidden) {
  TestRun run(ParametersOf("t1"), StepsOfL());
  run->Advance(FromSeconds(kLower + 0.05 + (5.05 - 0.25) / 10.0));
  run.Press(InputKind::kEmergencyStop);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kStopped);
  EXPECT_EQ(run.seen().moves().size(), 51U);
  EXPECT_NEAR(run.figures().at("travel_length"), 20.0 + 5.05, 1e-7);  // along the surface
  EXPECT_NEAR(run->state().tip.tip.x(), 5.05, 1e-8);

  machine::RunSetup setup = SetupOf(ParametersOf("t1"), "!MC0;VS10;PD1000,0;PD2000,0;PD3000,0;");
  setup.budget.steps = 3;
  TestRun fewer(std::move(setup));
  fewer.AdvanceToEnd();
  EXPECT_EQ(fewer->outcome().code, ErrorCode::kCellStepBudget);
  EXPECT_EQ(fewer.variable("X"), "2000");  // the command that is one too many was carried out
}

// STOP, HOLD, START and the override at any times: the path is that of the undisturbed run.
TEST(MillChainControl, KeepsThePathWhateverKeysArePressed) {
  std::mt19937 random(31);
  for (int round = 0; round < 150; ++round) {
    InputScript inputs;
    SimTime at = FromSeconds(kLower);
    for (int k = 0; k < 12; ++k) {
      at += std::chrono::microseconds(random() % 400'000);
      constexpr std::array kKinds = {InputKind::kStop, InputKind::kHold, InputKind::kOverride,
                                     InputKind::kStart, InputKind::kStart};
      const InputKind kind = kKinds[random() % kKinds.size()];
      const double value = 10.0 + static_cast<double>(random() % 191);
      inputs.push_back({.at = at, .kind = kind, .index = 0, .value = value});
    }
    inputs.push_back({.at = at + 30s, .kind = InputKind::kStart});
    TestRun run(ParametersOf("t1"), StepsOfL(), inputs);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    ExpectPathOfL(run);
    const auto& motions = run.seen().motions();
    for (std::size_t k = 1; k < motions.size(); ++k) {
      const motion::PlannedMotion& m = motions[k].planned;
      for (int p = 0; p < m.speed.phase_count(); ++p) {
        EXPECT_LE(std::abs(m.speed.phase(p).start.acceleration), 200.0 * (1.0 + 1e-6));
      }
      // Nowhere the speed changes by itself: an axis jumps by 3 mm/s at the corner, and by nothing
      // where a motion is cut.
      const double before =
          motions[k - 1].planned.speed.At(motions[k - 1].end_s - motions[k - 1].start_s).speed;
      if (motions[k].start_s == motions[k - 1].end_s && before > 0.0) {
        EXPECT_NEAR(m.speed.At(0.0).speed, before, 1e-5);
      }
      const bool corner = std::abs(m.path.from().point.x() - kCornerX) < 1e-9 &&
                          std::abs(m.path.from().point.y()) < 1e-9;
      EXPECT_TRUE(!corner || m.speed.At(0.0).speed <= 3.0 + 1e-6);
    }
  }
}

// motion.md section 6: a turn by itself goes on from where it is as fast as it is. T1A turns by
// 60 deg/s; from 90 to 30 degrees it is at full speed in between.
TEST(MillChainControl, ATurnKeepsItsSpeedWhenTheOverrideChanges) {
  TestRun run(ParametersOf("t1a"), "!MC0;Z0,0,0;!ZE A90:A30;");
  const auto a_deg = [&] { return run->state().tip.a_rad / kRadPerDegree; };
  while (a_deg() < 90.0 - 1e-6) run->Advance(run->state().time + 10ms);
  while (a_deg() > 65.0) run->Advance(run->state().time + 10ms);
  const double left_deg = a_deg() - 30.0;
  run.Press(InputKind::kOverride, 50.0);
  run.AdvanceToEnd();
  EXPECT_NEAR(a_deg(), 30.0, 1e-6);
  const auto& motions = run.seen().motions();
  const auto pressed = std::ranges::find_if(motions, [](const RunRecord::Motion& m) {
    return m.planned.path.by_sigma() && VelocityAt(m, 0.0).a_deg_s < -1.0;
  });
  ASSERT_NE(pressed, motions.end());
  ASSERT_NE(pressed, motions.begin());
  const RunRecord::Motion& before = *std::prev(pressed);
  EXPECT_EQ(pressed->start_s, before.end_s);
  EXPECT_NEAR(VelocityAt(before, before.end_s - before.start_s).a_deg_s, -60.0, 1e-3);
  EXPECT_NEAR(VelocityAt(*pressed, 0.0).a_deg_s, -60.0, 1e-3);
  // The last 9 degrees are the ramp to rest, by 200 deg/s2 in 0.3 s; the turn has no mm/s that an
  // override could change.
  EXPECT_NEAR(motions.back().end_s - pressed->start_s, (left_deg - 9.0) / 60.0 + 0.3, 1e-9);
}

// A window of 65,536 vertices does not show the 90 mm that braking takes from 60 mm/s by 20 mm/s2,
// in steps of 1 um. What has been counted stays counted when an override plans anew.
TEST(MillChainControl, AnOverrideForgetsNoStarvedLookAhead) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("ACCELERATION", 20.0).ok());
  std::string stream = "!MC0;V60;Z0,0,0";
  for (int k = 1; k <= 190'000; ++k)
    stream += "," + std::to_string(k / 10) + "." + std::to_string(k % 10) + ",0,0";
  TestRun run(parameters, stream + ";");
  run.seen().keep_events = false;
  const auto starved = [&] { return run.figures().at("lookahead_starved"); };
  for (double x = 0.0; x < 50.0; x = run->state().tip.tip.x())
    run->Advance(run->state().time + 100ms);
  const double before = starved();
  EXPECT_GT(before, 0.0);
  run.Press(InputKind::kOverride, 50.0);
  EXPECT_GE(starved(), before);
  run->Advance(run->state().time + 1ms);
  run.Press(InputKind::kOverride, 60.0);
  EXPECT_GE(starved(), before);
  EXPECT_LT(starved(), before + 190'000.0);
}

}  // namespace
}  // namespace rmlcell::rml1
