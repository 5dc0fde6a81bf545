// Keys at the instant of another one, where a run may begin, and what a machine
// tells of its origin.
#include <gtest/gtest.h>

#include <string>

#include "engine/machine/standing.h"
#include "engine/machine/step_entry.h"
#include "engine/rml1/machine_state.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::RunPhase;
using namespace std::chrono_literals;

// An override that is the one of now parts no motion.
TEST(KeysSides, TheSameOverrideChangesNothing) {
  const std::string stream = "!MC0;VS10;PD2000,0;";
  TestRun untouched(ParametersOf("t1"), stream);
  untouched.AdvanceToEnd();
  for (const double percent : {100.0, 50.0}) {
    TestRun run(ParametersOf("t1"), stream);
    run->Advance(11s);  // 20 mm down take some 10 s, 20 mm across 2 s
    ASSERT_EQ(run.seen().moves().size(), 1U);
    run.Press(InputKind::kOverride, percent);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    EXPECT_EQ(run.seen().motions().size() == untouched.seen().motions().size(), percent == 100.0);
    EXPECT_EQ(run.seen().text() == untouched.seen().text(), percent == 100.0);
  }
}

// motion.md 6: HOLD at the instant of the START behind a STOP lets the motion
// end that was stopped, and no other one begin, although the chain goes on.
TEST(KeysSides, HoldAtTheInstantOfStart) {
  TestRun run(ParametersOf("t1"), "!MC0;VS10;PD2000,0,4000,0;");
  run->Advance(11s);
  run.Press(InputKind::kStop);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  const double stopped_mm = run->state().tip.tip.x();
  ASSERT_GT(stopped_mm, 1.0);
  ASSERT_LT(stopped_mm, 19.0);
  run.Press(InputKind::kStart);
  run.Press(InputKind::kHold);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_NEAR(run->state().tip.tip.x(), 20.0, 1e-6);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(run->state().tip.tip.x(), 40.0, 1e-6);
}

// LIVE-6.01: a command by its number or by its first byte, that of the stream
// itself too; of where the run halts the command is known, and not its place in
// a text.
TEST(KeysSides, ARunBeginsAtAByte) {
  const std::string stream = "PU100,100;PU200,200;PU300,300;";
  for (const std::int64_t byte : {0, 10, 20}) {
    TestRun run(ParametersOf("t1"), stream);
    machine::EnterableRun* const entry = run->enterable();
    ASSERT_TRUE(entry->HaltBefore({.byte_offset = byte})) << byte;
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted) << byte;
    ASSERT_TRUE(entry->reached());
    const machine::StepFacts& facts = *entry->reached();
    EXPECT_EQ(facts.place,
              (machine::Place{.program = 1, .step = static_cast<int>(byte) / 10 + 1, .line = 0}))
        << byte;
    EXPECT_EQ(facts.may_pass, byte > 0) << byte;  // in front of the first one nothing moves
    EXPECT_TRUE(facts.clean()) << byte;
    EXPECT_EQ(run.seen().moves().size(), byte == 0 ? 0U : static_cast<std::size_t>(byte) / 10 + 1);
  }
}

// LIVE-6.01: a run begins with a whole command.
TEST(KeysSides, NoRunBeginsInsideACommand) {
  for (const std::int64_t byte : {1, 9, 999}) {
    TestRun run(ParametersOf("t1"), "PU100,100;PU200,200;");
    const Status halts = run->enterable()->HaltBefore({.byte_offset = byte});
    ASSERT_FALSE(halts) << byte;
    EXPECT_EQ(halts.error().code, ErrorCode::kCellStepUnreachable) << byte;
  }
}

// run.h, standing.h: program zero in the machine frame, mm; T1 has its Z0 20 mm
// below the top.
TEST(KeysSides, TheWorkOriginOfAMill) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 50.0));
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 30.0));
  const motion::MachinePoint wanted(50.0, 30.0, -20.0);
  TestRun run(parameters, "PU1,1;");
  ASSERT_TRUE(run->state().work_origin);
  EXPECT_LT((*run->state().work_origin - wanted).norm(), 1e-9);
  const auto standing = Rml1Family().NewStanding(parameters, {}).value();
  ASSERT_TRUE(standing->state().work_origin);
  EXPECT_LT((*standing->state().work_origin - wanted).norm(), 1e-9);
}

// A kept origin that no machine reaches is told by its name.
TEST(KeysSides, AnOriginThatIsTooFarIsNamed) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  const auto told = [&](double x, double y) {
    const MachineState state{
        .registers = Registers(profile), .at = {1, 2, 0, 0}, .origin = Point{.x = x, .y = y}};
    const Result<MachineState> read = ReadMachineState(WriteMachineState(state), profile);
    return read ? std::string() : static_cast<std::string>(read.error().detail);
  };
  EXPECT_EQ(told(100, 250), "");
  EXPECT_EQ(told(1e30, 250), "machine state: origin is out of range");
  EXPECT_EQ(told(100, -1e30), "machine state: origin is out of range");
}

// motion.md 6: START is for a run that halts or is about to: of one that goes it changes nothing,
// neither in a wait nor on the way, and takes a HOLD of the same instant back without a trace. The
// dwell lasts a second, 20 mm down some 10.
TEST(KeysSides, StartOfARunThatGoes) {
  const std::string stream = "!MC0;W1000;PD2000,0;W0;PU;";
  TestRun untouched(ParametersOf("t1"), stream);
  ASSERT_EQ(untouched.AdvanceToEnd(), RunPhase::kFinished);
  for (const SimTime at : {SimTime(400ms), SimTime(5s)}) {
    TestRun run(ParametersOf("t1"), stream);
    run->Advance(at);
    run.Press(InputKind::kStart);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    EXPECT_EQ(run.seen().text(), untouched.seen().text());
    EXPECT_EQ(run.seen().motions().size(), untouched.seen().motions().size());
  }
  TestRun held(ParametersOf("t1"), stream);
  held->Advance(400ms);
  held.Press(InputKind::kHold);
  held.Press(InputKind::kStart);
  ASSERT_EQ(held.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(held.seen().text(), untouched.seen().text());
}

// The override acts on no travel: one that is pressed on such a way parts no motion.
TEST(KeysSides, AnOverrideInTravelPartsNoMotion) {
  const std::string stream = "!MC0;PU6000,0;";
  TestRun untouched(ParametersOf("t1"), stream);
  ASSERT_EQ(untouched.AdvanceToEnd(), RunPhase::kFinished);
  TestRun run(ParametersOf("t1"), stream);
  run->Advance(8s);  // 15 mm down take 7.51 s
  ASSERT_EQ(run.seen().moves().size(), 1U);
  run.Press(InputKind::kOverride, 50.0);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.seen().motions().size(), untouched.seen().motions().size());
  EXPECT_EQ(run.seen().text(), untouched.seen().text());
}

}  // namespace
}  // namespace rmlcell::rml1
