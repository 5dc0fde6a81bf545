// What becomes of what was asked for: an edit that is refused, a profile after another one, a way
// home that cannot begin.
#include <gmock/gmock.h>

#include "engine/machine/handbox.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

class MachineAnswers : public MachineTest {};

// LIVE-7.08: an edit that could not be stored is over: keys make another one.
TEST_F(MachineAnswers, AnEditThatIsRefusedIsOver) {
  Load({"DELAY 1\nDELAY 2\n"});
  Good(ChangeMode{Mode::kManual});
  const auto edits = [&] {
    bool made = false;
    for (const char* key : {"JOB", "0", "1", "NEXT", "2", "ENT", "DEL", "1"}) {
      const Result<KeyAnswer> answer = machine->PressKey(key);
      EXPECT_TRUE(answer) << key;
      made = answer && answer->edit;
    }
    return made;
  };
  ASSERT_TRUE(edits());
  ASSERT_TRUE(machine->settles());
  Good(RefuseEdit{.code = ErrorCode::kCellEtagMismatch});
  EXPECT_FALSE(machine->settles());
  EXPECT_TRUE(edits());
}

// Where no edit is open there is nothing that could be refused; a mill has no handbox for one.
TEST_F(MachineAnswers, ARefusalOfNoEditIsNotShown) {
  Load({"DELAY 1\n"});
  Good(RefuseEdit{.code = ErrorCode::kCellStoreUnavailable});
  EXPECT_EQ(machine->panel().message, std::nullopt);
}
class MillAnswers : public MachineTest {
 protected:
  MillAnswers() : MachineTest("rml1") {}
};
TEST_F(MillAnswers, AnEditThatIsRefusedIsNoneOfIts) {
  Load({"PA;PU1000,1000;"});
  Good(RefuseEdit{.code = ErrorCode::kCellStoreUnavailable});
  EXPECT_EQ(state(), MachineState::kIdle);
}

// OPT-4.50: ZERO from the console whose way home cannot begin has failed, and says why and where.
TEST_F(MachineAnswers, AWayHomeThatIsNotThereIsTold) {
  Load({"DELAY 1\n"});
  Good(ZeroAxes{});
  GoOn(At(300.0));
  const Outcome outcome = Over().outcome;
  EXPECT_EQ(outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(outcome.code, family_.info().empty_slot);
  EXPECT_EQ(outcome.detail, "no program is stored in slot 4");
  EXPECT_EQ(outcome.place.program, 4);
}

// LIVE-2.10: to switch on what is on changes nothing: a key that is down still moves it.
TEST_F(MachineAnswers, SwitchedOnWhileItIsOn) {
  Load({});
  Good(ChangeMode{Mode::kManual});
  Good(PressJog{.key = {JogAxis::kX, true}});
  GoOn(At(1.0));
  const double x = machine->status().run.axes.column.x();
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kJogging);
  GoOn(At(1.5));
  EXPECT_GT(machine->status().run.axes.column.x(), x);
}

// LIVE-8.02: an Optimo has one speed by hand: a key that is said to be fast is as any other, and
// adds to them.
TEST_F(MachineAnswers, NoKeyOfALaserIsFast) {
  Load({});
  Good(ChangeMode{Mode::kManual});
  Good(PressJog{.key = {JogAxis::kX, true}, .fast = true});
  GoOn(At(1.0));
  Good(PressJog{.key = {JogAxis::kY, true}});
  EXPECT_EQ(state(), MachineState::kJogging);
  const double y = machine->status().run.axes.column.y();
  GoOn(At(2.0));
  EXPECT_GT(machine->status().run.axes.column.y(), y);
}

// A machine that has more to do at an instant stands at that instant, not before.
TEST_F(MachineAnswers, ItsTimeIsThatOfItsRun) {
  Load({"DELAY 2\nVI[1] = 0\n10 VI[1] = VI[1] + 1\nIF VI[1] < 30000 THEN 10\nDELAY 1\n"});
  Start();
  int more = 0;
  while (machine->Advance(At(2.5)) == Progress::kMoreWork) {
    ++more;
    EXPECT_EQ(machine->time(), machine->status().run.time);
  }
  EXPECT_GT(more, 0);
  EXPECT_EQ(machine->time(), At(2.5));
}

// Values of a profile that another one took the place of are no changes of that one.
TEST(Profiles, AProfileAfterAnotherOneIsUnchanged) {
  for (const char* id : {"optimo", "rml1"}) {
    const MachineFamily& family = *families::FindFamily(id);
    Parameters parameters(family.parameters());
    for (const MachineProfile& profile : family.profiles()) {
      ASSERT_TRUE(parameters.Apply(profile)) << profile.id;
      const MachineUsed used = parameters.Used();
      EXPECT_EQ(used.profile, profile.id);
      EXPECT_EQ(used.ChangesText(), "") << profile.id;
    }
  }
}

}  // namespace
}  // namespace rmlcell::machine
