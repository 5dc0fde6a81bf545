// The option "pause outside" (OVER_AREA = PAUSE), and what the spindle does meanwhile.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/rml1/profile.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using machine::RunPhase;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

machine::Parameters Pausing(const char* word = "PAUSE") {
  machine::Parameters parameters = ParametersOf("t1");
  EXPECT_TRUE(parameters.Set("OVER_AREA", word).ok());
  return parameters;
}

// Moves and halts; the operator presses START at every halt. The spindle is not permitted to turn.
std::vector<std::string> PathOf(const std::string& stream, const char* word = "PAUSE") {
  TestRun run(Pausing(word), "!MC0;" + stream);
  while (run.AdvanceToEnd() == RunPhase::kHalted) run.Press(InputKind::kStart);
  std::vector<std::string> path;
  for (const std::string& event : run.seen().Events()) {
    if (event.starts_with("move ") || event.starts_with("halt ")) path.push_back(event);
  }
  return path;
}

// RML1-5A.36: two-axis motion with the tool down pauses at the place of entry, at the tool height
// and before the rest of the way; once for each time that it was outside.
TEST(OutsidePause, ComesBeforeTheRestOfACut) {
  EXPECT_THAT(PathOf("PD19000,0,21000,0,19000,0,18000,0;"),
              ElementsAre("move 0.0,0.0,0.0", "move 19000.0,0.0,0.0", "move 20000.0,0.0,0.0",
                          "move 20000.0,0.0,500.0", "move 20000.0,0.0,0.0", "halt OVER_AREA",
                          "move 19000.0,0.0,0.0", "move 18000.0,0.0,0.0"));
}

// RML1-5A.36: with the tool up too, and where the way back leads through the whole range.
TEST(OutsidePause, ComesWithTheToolUp) {
  EXPECT_THAT(PathOf("PU21000,0,-1000,0,5000,0;"),
              ElementsAre("move 0.0,0.0,500.0", "move 20000.0,0.0,500.0", "halt OVER_AREA",
                          "move 0.0,0.0,500.0", "halt OVER_AREA", "move 5000.0,0.0,500.0"));
}

// RML1-5A.36: not while Z2 lies above the range; at its top it is still in it. T1 has Z0 20 mm
// below the top.
TEST(OutsidePause, IsLeftOutWhileZ2LiesAboveTheRange) {
  EXPECT_THAT(PathOf("@0,2000;PU21000,0,19000,0;"),
              ElementsAre("move 20000.0,0.0,2000.0", "halt OVER_AREA", "move 19000.0,0.0,2000.0"));
  EXPECT_THAT(PathOf("@0,2001;PU21000,0,19000,0;"),
              ElementsAre("move 20000.0,0.0,2000.0", "move 19000.0,0.0,2000.0"));
  EXPECT_THAT(PathOf("@0,2001;PD21000,0,19000,0;"),
              ElementsAre("move 0.0,0.0,0.0", "move 20000.0,0.0,0.0", "move 20000.0,0.0,2000.0",
                          "move 20000.0,0.0,0.0", "move 19000.0,0.0,0.0"));
  // Z2 counts from Z0: 1000 above a Z0 of 10 mm below the top is still in the range, 1001 is not.
  EXPECT_THAT(PathOf("!ZO-1000;@0,1000;PU21000,0,19000,0;"),
              ElementsAre("move 20000.0,0.0,1000.0", "halt OVER_AREA", "move 19000.0,0.0,1000.0"));
  EXPECT_THAT(PathOf("!ZO-1000;@0,1001;PU21000,0,19000,0;"),
              ElementsAre("move 20000.0,0.0,1000.0", "move 19000.0,0.0,1000.0"));
}

// RML1-5A.36: an entry without its pause is over; a lower Z2 afterwards asks for nothing.
TEST(OutsidePause, IsNotMadeUpFor) {
  EXPECT_THAT(PathOf("@0,3000;PU21000,0,19000,0;@0,2000;PU18000,0;Z17000,0,2000;"),
              ElementsAre("move 20000.0,0.0,2000.0", "move 19000.0,0.0,2000.0",
                          "move 18000.0,0.0,2000.0", "move 17000.0,0.0,2000.0"));
}

// RML1-5A.35: the height of Z2 is no matter of three-axis motion.
TEST(OutsidePause, OfThreeAxesKnowsNoZ2) {
  EXPECT_THAT(PathOf("@0,3000;Z21000,0,2000,19000,0,2000,18000,0,2000;"),
              ElementsAre("move 20000.0,0.0,2000.0", "halt OVER_AREA", "move 19000.0,0.0,2000.0",
                          "move 18000.0,0.0,2000.0"));
}

// RML1-5A.35, RML1-9.29: off by default.
TEST(OutsidePause, IsAnOption) {
  EXPECT_THAT(
      PathOf("PU21000,0,19000,0;", "CONTINUE"),
      ElementsAre("move 0.0,0.0,500.0", "move 20000.0,0.0,500.0", "move 19000.0,0.0,500.0"));
  EXPECT_FALSE(MakeProfile(ParametersOf("t1")).value().pause_outside);
}

// RML1-5A.33, RML1-5A.36: what only changes the tool state outside is no entry, nor is home.
TEST(OutsidePause, WantsAnEntry) {
  EXPECT_THAT(PathOf("PU21000,0;PD;PU;H;PU100,0;"),
              ElementsAre("move 0.0,0.0,500.0", "move 20000.0,0.0,500.0", "move 20000.0,0.0,2000.0",
                          "move 0.0,0.0,2000.0", "move 0.0,0.0,500.0", "move 100.0,0.0,500.0"));
}

// RML1-5A.39, RML1-5B.01: the spindle starts with the first motion, which waits behind the pause:
// until the resume key it stands, and a run that ends there tells no stop.
TEST(OutsidePause, LetsTheSpindleStandUntilTheMotion) {
  TestRun run(Pausing(), "Z0,0,3000;Z0,0,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_FALSE(run->state().spindle_on);
  EXPECT_EQ(run.variable("SPINDLE"), "off");
  EXPECT_NE(run->SaveMachine().find("spindle_on 0\n"), std::string::npos);
  EXPECT_EQ(run.seen().Events().back(), "diagnostic RML1-E8006");
  const std::size_t told = run.seen().Events().size();
  run->End(OutcomeKind::kCancelled, ErrorCode::kCellCancelled);
  EXPECT_EQ(run.seen().Events().size(), told);
}
TEST(OutsidePause, StartsTheSpindleBehindIt) {
  TestRun run(Pausing(), "Z0,0,3000;Z0,0,0;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  run.Press(InputKind::kStart);
  run->Advance(run->state().time + std::chrono::milliseconds(1));
  EXPECT_TRUE(run->state().spindle_on);
  EXPECT_EQ(run.variable("SPINDLE"), "on");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  const std::vector<std::string> events = run.seen().Events();
  EXPECT_THAT(std::vector<std::string>(events.end() - 3, events.end()),
              ElementsAre("resume", "spin 4500", "move 0.0,0.0,0.0"));
  EXPECT_EQ(run.variable("SPINDLE"), "on");  // RML1-5B.05: nothing has stopped it
}

// RML1-5B.05: IN stops the spindle when the tool is up; until then it turns, and an end of the run
// on the way stops it.
TEST(OutsidePause, TurnsUntilTheStopIsDue) {
  TestRun run(ParametersOf("t1"), "PD;IN;");
  run->Advance(FromSeconds(11.0));  // 20 mm down at 2 mm/s take 10.01 s
  EXPECT_TRUE(run->state().spindle_on);
  EXPECT_EQ(run.variable("SPINDLE"), "on");
  run.Press(InputKind::kEmergencyStop);
  EXPECT_EQ(run.seen().Events().back(), "stop");
  EXPECT_FALSE(run->state().spindle_on);
  EXPECT_EQ(run.variable("SPINDLE"), "off");
}

// RML1-5A.39, RML1-9.35: nothing moves, received bytes are kept, and ESC.K forgets them but not the
// rest of the segment.
TEST(OutsidePause, WorksLikeNr) {
  TestRun run(Pausing(), "!MC0;Z21000,0,2000,19000,0,2000,18000,0,2000;PU1,1;\x1b.KPU5,5;");
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run.seen().CountOf(ErrorCode::kRml1PausedAtEnd), 1);
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  std::vector<std::string> moves;
  for (const std::string& event : run.seen().Events()) {
    if (event.starts_with("move ")) moves.push_back(event);
  }
  EXPECT_THAT(moves, ElementsAre("move 20000.0,0.0,2000.0", "move 19000.0,0.0,2000.0",
                                 "move 19000.0,0.0,500.0", "move 5.0,5.0,500.0"));
}

// RML1-5A.30, RML1-5A.36: who leaves from the edge itself leaves: the tool goes up there, and the
// way back is an entry.
TEST(OutsidePause, ComesBehindAnExitFromTheEdge) {
  EXPECT_THAT(PathOf("PD20000,0,21000,0,19000,0;"),
              ElementsAre("move 0.0,0.0,0.0", "move 20000.0,0.0,0.0", "move 20000.0,0.0,500.0",
                          "move 20000.0,0.0,0.0", "halt OVER_AREA", "move 19000.0,0.0,0.0"));
}

}  // namespace
}  // namespace rmlcell::rml1
