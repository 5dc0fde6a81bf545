#include "engine/rml1/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::MotionUse;
using machine::OutcomeKind;
using machine::RunPhase;
using ::testing::ElementsAre;
using namespace std::chrono_literals;

// From rest to rest along a line: motion.md 5.2 with infinite jerk.
double TrapezoidTime(double length, double speed, double acceleration) {
  if (length < speed * speed / acceleration) return 2.0 * std::sqrt(length / acceleration);
  return length / speed + speed / acceleration;
}

machine::Parameters With(std::initializer_list<std::pair<const char*, double>> values,
                         std::string_view profile = "t1") {
  machine::Parameters parameters = ParametersOf(profile);
  for (const auto& [name, value] : values) EXPECT_TRUE(parameters.Set(name, value).ok()) << name;
  return parameters;
}

// RML1-9.45, RML1-3B.19: times from speed and acceleration. 15 mm down to Z2 at 2 mm/s, 10 mm
// across at the travel speed, 5 mm down to Z1, 20 mm of cut at 9 mm/s.
TEST(MillRun, TakesTrapezoidTimes) {
  TestRun run(ParametersOf("t1"), "VS9;PU1000,0;PD3000,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  const double expected = TrapezoidTime(15, 2, 200) + TrapezoidTime(10, 60, 200) +
                          TrapezoidTime(5, 2, 200) + TrapezoidTime(20, 9, 200);
  EXPECT_NEAR(run.time_s(), expected, 1e-8);
  TestRun slow(With({{"ACCELERATION", 20.0}}), "PU1000,0;");
  slow.AdvanceToEnd();
  EXPECT_NEAR(slow.time_s(), TrapezoidTime(15, 2, 20) + TrapezoidTime(10, 60, 20), 1e-8);
}

// The one line of case R04 of motion.md section 12: 10 mm at 15 mm/s take 0.741667 s.
TEST(MillRun, AgreesWithTheReferenceLine) {
  TestRun run(ParametersOf("t1"), "VS15;PD1000,0;");
  run.AdvanceToEnd();
  const RunRecord::Motion& cut = run.seen().motions().back();
  EXPECT_NEAR(cut.end_s - cut.start_s, 0.741666666667, 1e-8);
}

// RML1-9.33, RML1-5B.01, RML1-3C.02: run-up before the first motion, no wait when it turns, !MC 0
// waits until it stands, IN and H do not.
TEST(MillRun, WaitsForTheSpindle) {
  TestRun run(With({{"SPIN_UP", 2.0}, {"SPIN_DOWN", 1.5}}), "PD;PU;!MC0;!MC1;PD;IN;");
  run.AdvanceToEnd();
  EXPECT_THAT(
      run.seen().Events(),
      ElementsAre("step 1 PD", "spin 4500", "spindle wait 2.0", "move 0.0,0.0,0.0", "step 2 PU",
                  "move 0.0,0.0,500.0", "step 3 !MC", "stop", "spindle wait 1.5", "step 4 !MC",
                  "step 5 PD", "spin 4500", "spindle wait 2.0", "move 0.0,0.0,0.0", "step 6 IN",
                  "move 0.0,0.0,500.0", "stop"));
  EXPECT_DOUBLE_EQ(run.figures().at("spindle_time"), 5.5);
}

// RML1-3A.56: dwell is standstill for as long as it says.
TEST(MillRun, DwellsForMilliseconds) {
  TestRun run(ParametersOf("t1"), "!MC0;W250;PD1000,0;");
  run.AdvanceToEnd();
  EXPECT_NEAR(run.time_s(), 0.5 + TrapezoidTime(20, 2, 200) + TrapezoidTime(10, 2, 200), 1e-8);
  EXPECT_DOUBLE_EQ(run.figures().at("dwell_time"), 0.5);
}

// RML1-3D.29: the rotary axis turns in step and slows the group: 90 degrees at 60 deg/s and 200
// deg/s2 take 1.8 s, with or without 10 mm of X.
TEST(MillRun, SlowsTheGroupToTheRotaryAxis) {
  const double turn = 90.0 / 60.0 + 60.0 / 200.0;
  TestRun alone(ParametersOf("t1a"), "!MC0;!ZE A90;");
  alone.AdvanceToEnd();
  EXPECT_NEAR(alone.time_s(), turn, 1e-8);
  TestRun together(ParametersOf("t1a"), "!MC0;V60;!ZE X1000A90;");
  together.AdvanceToEnd();
  EXPECT_NEAR(together.time_s(), turn, 1e-8);
  EXPECT_NEAR(together.seen().moves()[0].feed_mm_s, 60.0 / 9.0, 1e-9);
  EXPECT_NEAR(together->state().tip.a_rad, kPi / 2, 1e-12);
}

// RML1-3D.29, RML1-9.22: sense of rotation and resolution are values of the profile; step counts
// are rounded half away from zero.
TEST(MillRun, CountsStepsOfTheProfile) {
  machine::Parameters parameters = With({{"STEP", 0.05}, {"A_STEP", 0.5}}, "t1a");
  ASSERT_TRUE(parameters.Set("A_SENSE", "LEFT").ok());
  TestRun run(parameters, "!ZE X12.5Z-2002.5A-30.25;");
  run.AdvanceToEnd();
  EXPECT_NEAR(run->state().tip.a_rad, 30.25 * kRadPerDegree, 1e-12);
  EXPECT_EQ(run.variable("A"), "-30.25");
  EXPECT_EQ(run.variable("XSTEPS"), "3");     // 2.5
  EXPECT_EQ(run.variable("ZSTEPS"), "-801");  // machine -40.025 mm: -800.5
  EXPECT_EQ(run.variable("ASTEPS"), "-61");   // -60.5
}

// RML1-1.08, RML1-8.39, RML1-9.12: 40 units per mm on older machines; the numbers stay.
TEST(MillRun, TakesTheUnitOfTheProfile) {
  TestRun run(ParametersOf("mdx-20"), "PU400,-0;@-40;PD400,800;");
  run.AdvanceToEnd();
  EXPECT_EQ(run.variable("X"), "400");
  EXPECT_NEAR(run->state().tip.tip.x(), 10.0, 1e-9);
  EXPECT_NEAR(run->state().tip.tip.y(), 20.0, 1e-9);
  EXPECT_EQ(run.figures().at("cut_length"), 21.0);  // with 1 mm of plunge
  EXPECT_EQ(run.figures().at("programmed.cut_length"), 840.0);
}

// RML1-8.42: a minimum of 0.1 mm/s takes the place of 0.5.
TEST(MillRun, TakesTheSpeedRangeOfTheProfile) {
  TestRun run(ParametersOf("srm-20"), "F0.1;V0;");
  run.AdvanceToEnd();
  EXPECT_EQ(run.variable("VS"), "0.1");
  EXPECT_EQ(run.variable("VZ"), "0.1");
}

// motion.md section 7: no axis exceeds its own maximum; a PNC-3200 travels at 60 but lifts at 30.
TEST(MillRun, KeepsEveryAxisBelowItsMaximum) {
  TestRun run(ParametersOf("pnc-3200"), "Z0,0,-1000;H;");
  run.AdvanceToEnd();
  EXPECT_DOUBLE_EQ(run.seen().moves().back().feed_mm_s, 30.0);
}

// What the tool does, for reports and pictures; a kCut needs material or a tool that is down.
TEST(MillRun, TellsWhatMotionsAreFor) {
  TestRun run(ParametersOf("t1"), "PU100,0;PD200,0;PU;Z200,0,-10,300,0,-10,300,0,10,400,0,10;H;");
  run.AdvanceToEnd();
  std::vector<MotionUse> uses;
  for (const RunRecord::Motion& motion : run.seen().motions()) uses.push_back(motion.use);
  EXPECT_THAT(uses, ElementsAre(MotionUse::kTravel,  // from the top down to Z2
                                MotionUse::kTravel, MotionUse::kPlunge, MotionUse::kCut,
                                MotionUse::kRetract, MotionUse::kPlunge, MotionUse::kCut,
                                MotionUse::kRetract, MotionUse::kTravel, MotionUse::kRetract,
                                MotionUse::kTravel));
  // In the work: 5.1 down and 1 across. What is done at Z 0, 5 down and 1 across, cuts nothing.
  EXPECT_EQ(run.figures().at("plunges"), 1);
  EXPECT_NEAR(run.figures().at("cut_length"), 5.1 + 1, 1e-9);
  EXPECT_NEAR(run.figures().at("travel_length"), 15 + 1 + 5 + 1 + 5 + 0.2 + 1 + 19.9 + 4, 1e-9);
}

// RML1-7.05: a place is the slot, the number of the command, its line and first byte.
TEST(MillRun, TellsThePlaceOfEveryMotion) {
  TestRun run(ParametersOf("t1"), "PA;\n ^PU1,1,\n2,2;\r\nPU3,3;");
  run.AdvanceToEnd();
  const auto& moves = run.seen().moves();
  ASSERT_EQ(moves.size(), 3U);
  EXPECT_EQ(moves[1].place, (machine::Place{.program = 1, .step = 2, .line = 2, .byte_offset = 6}));
  EXPECT_EQ(moves[1].path, "PU");
  EXPECT_EQ(moves[2].place,
            (machine::Place{.program = 1, .step = 3, .line = 4, .byte_offset = 19}));
  ASSERT_EQ(run.seen().diagnostics().size(), 3U);  // "2,2" on its own line: RML1-2.40
  const Diagnostic& stray = run.seen().diagnostics()[0];
  EXPECT_EQ(stray.where, (SourceSpan{.line = 3, .column = 1, .length = 1, .byte_offset = 13}));
  EXPECT_EQ(stray.step, 0);
  EXPECT_EQ(stray.program, 1);
}

// RML1-9.42, RML1-7.04: incomplete at the end of the data: told, not executed, no error.
TEST(MillRun, AdvisesOnAnIncompleteCommand) {
  for (const char* stream :
       {"PU5,5;PD2", "PU5,5;P", "PU5,5;^", "PU5,5;\x1b.", "PU5,5;!ZE X1", "PU5,5;IN"}) {
    TestRun run(ParametersOf("t1"), stream);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    EXPECT_EQ(run->outcome().kind, OutcomeKind::kCompleted);
    EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1IncompleteCommand), 1) << stream;
    EXPECT_EQ(run.variable("X"), "5");
    EXPECT_EQ(run.variable("ERR"), "0");
  }
  TestRun good(ParametersOf("t1"), "PU5,5;");
  good.AdvanceToEnd();
  EXPECT_TRUE(good.seen().diagnostics().empty());
}

// RML1-3C.08, RML1-9.35: !NR halts until START; without one in the script the run stands.
TEST(MillRun, PausesUntilStart) {
  TestRun run(ParametersOf("t1"), "!MC0;PU;!NR;PU0,100;!NR;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  const double halted_at = run.time_s();
  EXPECT_NEAR(halted_at, TrapezoidTime(15, 2, 200), 1e-8);
  EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1PausedAtEnd), 1);
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);  // time stands
  EXPECT_EQ(run.time_s(), halted_at);
  run.Press(InputKind::kHold);  // no other key resumes
  run.Press(InputKind::kStop);
  run.Press(InputKind::kOverride, 50.0);
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run.variable("Y"), "100");
  run.Press(InputKind::kStart);
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kCompleted);
}

// A START in the script ends a pause at its time; one that comes too early does nothing.
TEST(MillRun, ResumesByScript) {
  TestRun run(ParametersOf("t1"), "!MC0;PU;!NR;PU0,100;",
              {{.at = 1s, .kind = InputKind::kStart}, {.at = 20s, .kind = InputKind::kStart}});
  EXPECT_EQ(run->Advance(15s), RunPhase::kRunning);
  EXPECT_EQ(run.variable("Y"), "0");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), 20.0 + TrapezoidTime(1, 60, 200), 1e-8);
  EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1PausedAtEnd), 0);
  EXPECT_NEAR(run.figures().at("halted_time"), 20.0 - TrapezoidTime(15, 2, 200), 1e-8);
}

// RML1-4.09, RML1-7.06: while it is paused the sender fills the buffer, and ESC.K empties it.
TEST(MillRun, LetsEscapeKOvertakeBufferedData) {
  TestRun run(ParametersOf("t1"), "!NR;PU0,100;\x1b.KPU0,200;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  ASSERT_EQ(run.seen().moves().size(), 2U);
  EXPECT_EQ(run.seen().moves()[1].program_point.y(), 200.0);
}

// RML1-9.35: flow control stops the sender when the buffer is full, and nothing is lost; an ESC.K
// behind it comes too late.
TEST(MillRun, StopsTheSenderWhenTheBufferIsFull) {
  const std::string filling(300, ';');
  TestRun run(With({{"BUFFER", 256.0}}), "!NR;PU0,100;" + filling + "\x1b.K;PU0,200;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_LT(run->state().progress, 0.05);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().moves().size(), 3U);
  EXPECT_EQ(run.variable("COM"), "0");
}

// RML1-5A.39, RML1-9.29: a pause at the edge works like !NR, in the middle of a segment.
TEST(MillRun, PausesAtTheEdgeOfTheRange) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("OVER_AREA", "PAUSE").ok());
  TestRun run(parameters, "!MC0;Z21000,0,2000;Z19000,0,1000;PU0,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_THAT(run.seen().Events(),
              ElementsAre("step 1 !MC", "step 2 Z", "move 20000.0,0.0,2000.0", "step 3 Z",
                          "move 20000.0,0.0,1500.0", "halt OVER_AREA", "diagnostic RML1-E8006"));
  EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().moves()[2].program_point, (motion::ProgramPoint{19000, 0, 1000}));
  EXPECT_EQ(run.variable("X"), "0");
}

// RML1-6.08: errors never end a run.
TEST(MillRun, CompletesThroughErrors) {
  std::string stream;
  for (int i = 0; i < 10000; ++i) stream += "XX;PU" + std::to_string(i % 100) + ";";
  TestRun run(ParametersOf("t1"), stream + "PU7,7;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().kind, OutcomeKind::kCompleted);
  EXPECT_FALSE(run->outcome().code.has_value());
  EXPECT_EQ(run.variable("X"), "7");
  EXPECT_EQ(run.figures().at("errors.1"), 10000);
  EXPECT_EQ(run.figures().at("errors.2"), 10000);
  EXPECT_EQ(run.figures().at("error_register"), 1);
}

// RML1-3D.29: a turn of one degree by itself is one by 200 deg/s2, up to half of it and down again.
TEST(MillRun, TurnsByOneDegree) {
  TestRun run(ParametersOf("t1a"), "!MC0;!ZE A1;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run.time_s(), 2.0 * std::sqrt(1.0 / 200.0), 1e-8);
  EXPECT_EQ(run.variable("A"), "1");
}

}  // namespace
}  // namespace rmlcell::rml1
