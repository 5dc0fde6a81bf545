// A run that begins at a step: its mode on the way, programs that are gone, what was looked at
// before.
#include <gmock/gmock.h>

#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

class StartAtAnswers : public StartTest {};

// LIVE-2.12: in REMOTE the instruction PAUSE ends a run: what lies behind it is not reached.
TEST_F(StartAtAnswers, GoesThereInItsMode) {
  Load({"VI[2]=1\nPAUSE\nVI[3]=2\nDELAY 1\n"});
  EXPECT_THAT(Refused(At1(4)), HasSubstr("CELL-E9426 step 1/4 is not reached"));
  Good(ChangeMode{Mode::kCycle});
  StartAtStep input = At1(4);
  input.source = StartSource::kPanel;
  Good(input);
}

// LIVE-6.09: its work is what it does from there on, and neither what lies before nor the way
// there: who cuts it off on the way has none of it. That of a whole run is all of it.
TEST_F(StartAtAnswers, ItsWorkBeginsAtTheStep) {
  const std::string program =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\nDELAY 10\nDELAY 7\n";
  Load({program});
  Good(At1(6));
  GoOn(At(120.0));
  const RunOver entered = Over();
  EXPECT_EQ(entered.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(ToSeconds(entered.worked), 7.0, 0.01);
  EXPECT_GT(entered.lasted, At(18.0));
  Load({program});
  Good(At1(6));
  GoOn(At(0.2));
  ASSERT_TRUE(machine->status().run.approaching);
  Good(AbortRun{});
  GoOn(At(10.0));
  EXPECT_EQ(Over().worked, SimTime(0));
  Load({"DELAY 3\n"});
  Start();
  GoOn(At(10.0));
  EXPECT_EQ(Over().worked, At(3.0));
}

// OPT-1.13: a FUNCTION that was deleted since it was linked is told of here, too.
TEST_F(StartAtAnswers, ADeletedFunctionIsStale) {
  Load({"FUNCTION 2\nDELAY 1\n", "VI[1]=VI[1]+1\nRETURN\n"});
  Start(1);
  GoOn(At(5.0));
  Over();
  Good(DeleteProgram{2});
  heard.told.clear();
  Good(At1(2));
  GoOn(At(60.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_THAT(heard.told, testing::Contains(testing::EndsWith("finding OPT-E7110")));
}

}  // namespace
}  // namespace rmlcell::machine
