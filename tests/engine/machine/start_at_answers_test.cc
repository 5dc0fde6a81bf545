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
