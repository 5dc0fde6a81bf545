// Spindles that a key stopped, streams that are refused or empty, and what a whole set counts for.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/rml1/device.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::RunPhase;

// run.h: a key turns the spindle on again until the program stops it: then the program has not
// started it.
TEST(StopSides, ASpindleThatTheProgramStoppedStaysOff) {
  TestRun run(ParametersOf("t1"), "!MC1;PU100,0;!NR;!MC0;PU200,0;!NR;PU300,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  ASSERT_TRUE(run->state().spindle_on);
  ASSERT_TRUE(run->SwitchSpindle());
  EXPECT_FALSE(run->state().spindle_on);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  const Status switched = run->SwitchSpindle();
  ASSERT_FALSE(switched);
  EXPECT_EQ(switched.error().code, ErrorCode::kCellMachineState);
  EXPECT_FALSE(run->state().spindle_on);
}

// What refuses a whole stream names its file, and no program: it has none.
TEST(StopSides, RefusalsNameTheirFile) {
  for (const std::size_t size : {0U, 300U}) {
    const std::string bytes(size, '$');
    const machine::Translation made =
        Rml1Family().Translate({.name = "part.rml", .bytes = bytes}, ParametersOf("t1"), {});
    EXPECT_FALSE(made.ok);
    ASSERT_FALSE(made.diagnostics.empty());
    EXPECT_EQ(made.diagnostics.front().file, "part.rml");
    EXPECT_EQ(made.diagnostics.front().program, 0);
  }
}

// Each set is one act, read in one go as byte by byte.
TEST(StopSides, ActsOfWholeSets) {
  class Deaf final : public DeviceListener {
   public:
    void OnFinding(const Finding&) override {}
  } deaf;
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  const auto acts = [&](std::string_view stream) {
    Device device(profile);
    for (std::size_t at = 0; at < stream.size();) {
      at +=
          device.Read(stream.substr(at), static_cast<std::int64_t>(at), Device::kAnyCommands, deaf)
              .bytes;
      do {
        while (!device.actions().empty()) device.actions().Pop();
      } while (device.Step(deaf));
    }
    return device.registers().act;
  };
  const std::string behind(40, ';');
  const std::uint64_t none = acts(behind);
  EXPECT_EQ(acts("PU1,1;" + behind) - none, 1U);
  EXPECT_EQ(acts("PU1,1,2,2;PD3,3;" + behind) - none, 3U);
  EXPECT_EQ(acts("Z1,1,1,2,2,2;PD;" + behind) - none, 3U);
}

// Of nothing all has been read.
TEST(StopSides, ProgressOfAStreamOfSeparators) {
  TestRun run(ParametersOf("t1"), ";;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->state().progress, 1.0);
}

// RML1-3C.02: !MC 0 stops a spindle that turns: one that a key has stopped stands already, so that
// nothing is told and nobody waits.
TEST(StopSides, ASpindleThatStandsIsNotStoppedAgain) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("SPIN_DOWN", 1.5));
  TestRun run(parameters, "!MC1;PU100,0;!NR;!MC0;PU200,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  ASSERT_TRUE(run->SwitchSpindle());
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "stop"), 1);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "spindle wait 1.5"), 0);
}

// Right behind START a run is no halted one any more, whenever it is asked to go on.
TEST(StopSides, ARunThatWasResumedRuns) {
  TestRun run(ParametersOf("t1"), "!MC0;!NR;PU100,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run->state().halted_by, machine::HaltReason::kProgram);
  run.Press(InputKind::kStart);
  EXPECT_EQ(run->state().phase, RunPhase::kRunning);
  EXPECT_FALSE(run->state().halted_by);
}

// RML1-3A.42, RML1-9.33: H stops the spindle, and nobody waits until it stands.
TEST(StopSides, HomeDoesNotWaitForTheSpindle) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("SPIN_DOWN", 1.5));
  TestRun run(parameters, "PD;H;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "stop"), 1);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "spindle wait 1.5"), 0);
}

// DEV-3.12: what the cover has stopped goes on with the run; what a key has stopped does not, also
// where the run was resumed before.
TEST(StopSides, WhatAKeyStoppedNoResumeStarts) {
  TestRun run(ParametersOf("t1"), "!MC1;PU100,0;!NR;PU200,0;!NR;PU300,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  ASSERT_TRUE(run->state().spindle_on);
  ASSERT_TRUE(run->SwitchSpindle());
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_FALSE(run->state().spindle_on);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "spin 4500"), 1);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "stop"), 1);
}

// DEV-3.12: a cover that is open stops the spindle where the run comes to rest, and not before; one
// that does nothing to a run does not stop it there either.
TEST(StopSides, ACoverThatIsOpenStopsTheSpindleInAHalt) {
  for (const std::string_view cover : {"PAUSE", "NONE"}) {
    machine::Parameters parameters = ParametersOf("t1");
    ASSERT_TRUE(parameters.Set("COVER", cover));
    TestRun run(parameters, "!MC1;PU6000,0;!NR;PU100,0;");
    run->Advance(std::chrono::seconds(8));  // across
    ASSERT_TRUE(run->state().spindle_on);
    run.Press(InputKind::kDoor, 1.0);
    EXPECT_TRUE(run->state().spindle_on);
    ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
    EXPECT_EQ(run->state().spindle_on, cover == "NONE");
    EXPECT_EQ(std::ranges::count(run.seen().Events(), "stop"), cover == "NONE" ? 0 : 1);
  }
}

// RML1-5B.01, DEV-3.12: a spindle that the cover stopped starts again with the run, and has its
// whole run-up before the next motion: in the run-up that STOP interrupted as in a dwell that has
// less of it left. One that has more goes on meanwhile.
TEST(StopSides, ASpindleThatStartsAgainRunsUpWhole) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("SPIN_UP", 2.0));
  ASSERT_TRUE(parameters.Set("COVER", "PAUSE"));
  const auto begins_s = [&](const std::string& stream, std::size_t motion, double stop_s) {
    TestRun run(parameters, stream,
                {{.at = FromSeconds(stop_s), .kind = InputKind::kStop, .index = 0, .value = 0.0}});
    EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
    run.Press(InputKind::kDoor, 1.0);
    run.Press(InputKind::kDoor, 0.0);
    EXPECT_FALSE(run->state().spindle_on);
    run.Press(InputKind::kStart);
    EXPECT_TRUE(run->state().spindle_on);
    EXPECT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
    EXPECT_GT(run.seen().motions().size(), motion);
    return run.seen().motions()[motion].start_s;
  };
  EXPECT_NEAR(begins_s("!MC1;PU100,0;", 0, 1.5), 3.5, 1e-9);
  for (const double wait_s : {1.0, 5.0}) {
    const std::string stream =
        "!MC1;W" + std::to_string(static_cast<int>(wait_s * 1000)) + ";PD;PD100,0;";
    TestRun undisturbed(parameters, stream);
    ASSERT_EQ(undisturbed.AdvanceToEnd(), RunPhase::kFinished);
    const double end_s = undisturbed.seen().motions()[0].end_s;
    ASSERT_NEAR(undisturbed.seen().motions()[1].start_s, end_s + wait_s, 1e-9);
    EXPECT_NEAR(begins_s(stream, 1, end_s + 0.4), end_s + 0.4 + std::max(wait_s - 0.4, 2.0), 1e-9);
  }
}

// Where as much of a dwell is left as the run-up lasts, it is the run-up that is waited for: 2 s of
// it, 1 s of the dwell of 3 s, and 2 s of the run-up again. 20 mm down begin behind that.
TEST(StopSides, ARunUpTakesThePlaceOfADwellAsLong) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("SPIN_UP", 2.0));
  ASSERT_TRUE(parameters.Set("COVER", "PAUSE"));
  TestRun run(parameters, "!MC1;W3000;PD;",
              {{.at = FromSeconds(3.0), .kind = InputKind::kStop, .index = 0, .value = 0.0}});
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run.Press(InputKind::kDoor, 1.0);
  run.Press(InputKind::kDoor, 0.0);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "spindle wait 2.0"), 2);
  EXPECT_EQ(std::ranges::count(run.seen().Events(), "dwell 1.0"), 1);
  EXPECT_NEAR(run.figures().at("dwell_time"), 1.0, 1e-9);
  EXPECT_NEAR(run.figures().at("spindle_time"), 4.0, 1e-9);
  EXPECT_NEAR(run.seen().motions().at(0).start_s, 5.0, 1e-9);
}

// Of a stream of one byte nothing is read before it begins.
TEST(StopSides, ProgressOfAStreamOfOneByte) {
  TestRun run(ParametersOf("t1"), ";");
  EXPECT_EQ(run->state().progress, 0.0);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run->state().progress, 1.0);
}

}  // namespace
}  // namespace rmlcell::rml1
