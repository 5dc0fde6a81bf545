// What a refusal is about is known as numbers and words, each with its own name: whoever says it in
// another language reads no text (detail.h).
#include <gmock/gmock.h>

#include "engine/machine/profile_files.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/machine/held_bed.h"
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::StartsWith;

std::string WordsOf(const Status& done) {
  return done ? std::string("taken") : ArgumentsText(done.error().detail);
}

class LaserWords : public HeldTest {
 protected:
  std::string Words(const MachineInput& input) { return WordsOf(machine->Apply(input)); }
};

class MillWords : public MachineTest {
 protected:
  MillWords() : MachineTest("rml1") {}

  std::string Words(const MachineInput& input) { return WordsOf(machine->Apply(input)); }
  std::string Title() const { return "machine='" + std::string(family_.info().title) + "'"; }
};

// LIVE-2.10, LIVE-2.11: the mode that refuses it, the gate, the alarm, the input.
TEST_F(LaserWords, OfOrders) {
  Load({"DELAY 1\n"});
  EXPECT_EQ(Words(StartRun{.program = 1, .source = StartSource::kPanel}), "mode='REMOTE'");
  EXPECT_EQ(Words(PressJog{.key = kHeldXPlus}), "mode='REMOTE'");
  EXPECT_EQ(Words(Acknowledge{.alarm = 7}), "alarm=7");
  EXPECT_EQ(Words(PressGate{.gate = 3}), "gate=3");
  EXPECT_EQ(Words(PressGate{.gate = 2}), "gate=2");
  EXPECT_EQ(Words(SetGates{.programs = {5, 100}}), "program=100");
  EXPECT_EQ(Words(StoreProgram{.slot = 100}), "program=100");
  EXPECT_EQ(Words(ChangeInput{InputKind::kAnalogue, 7, 1e39}), "input='IA[7]'");
  EXPECT_EQ(Words(ChangeInput{InputKind::kAnalogue, 107, 1.0}), "input='IA[107]'");
  Good(ChangeMode{Mode::kSingle});
  EXPECT_EQ(Words(StartRun{.program = 1}), "mode='SINGLE'");
  EXPECT_EQ(Words(ResumeRun{}), "state='IDLE'");
}

// LIVE-5.06: each axis by its own name, with its unit.
TEST_F(LaserWords, OfADisplacement) {
  LoadHeld(kCorner, 5.0);
  for (const JogAxis axis : {JogAxis::kX, JogAxis::kB}) Jog({axis, true}, 0.5);
  BackInRemote();
  EXPECT_EQ(Words(ResumeRun{}), "X=100 mm B=1.2566 rad");
}

// What a mill does not have is told with its name, and the key that it does not have, too.
TEST_F(MillWords, OfWhatItDoesNotHave) {
  Load({"PU100,100;"});
  EXPECT_EQ(Words(ChangeMode{Mode::kRepeat}), Title());
  EXPECT_EQ(Words(SetSimulation{ProgramStep{1, 2}}), Title());
  EXPECT_EQ(Words(ZeroAxes{}), Title());
  EXPECT_EQ(Words(PressPanel{PanelKey::kZ0}), "key='Z0'");
  EXPECT_EQ(Words(PressJog{.key = {JogAxis::kC, true}}), "key='C+' axes='X Y Z A'");
  EXPECT_EQ(Words(PressJog{.key = {JogAxis::kA, true}}), "axis='A'");
  const Result<KeyAnswer> pressed = machine->PressKey("ENT", KeyAction::kPress);
  ASSERT_FALSE(pressed);
  EXPECT_EQ(ArgumentsText(pressed.error().detail), Title());
  const Result<std::string> undone = family_.UndoEdit({}, "PU;");
  ASSERT_FALSE(undone);
  EXPECT_EQ(ArgumentsText(undone.error().detail), Title());
  EXPECT_EQ(WordsOf(family_.CheckWrite(parameters(), "QQ", 1.0)), "variable='QQ'");
}

// Of a project, too.
TEST_F(MillWords, OfAProject) {
  const auto words = [&](const ProjectBundle& project) {
    const TransferPlan plan = family_.PlanTransfer(project, parameters(), {});
    EXPECT_FALSE(plan.ok);
    return plan.diagnostics.empty() ? std::string("none")
                                    : ArgumentsText(plan.diagnostics.front().detail);
  };
  EXPECT_EQ(words({.schedules = {LaserSchedule{}}}), Title());
  EXPECT_EQ(words({.processes = {ProcessDefinition{}}}), Title());
}

// A profile that there is not: its name, and those that there are or that may be meant.
TEST_F(MillWords, OfProfiles) {
  const auto words = [&](const std::string& name) {
    const Result<Parameters> made = MakeParameters(family_, name, {});
    return made ? std::string("made") : ArgumentsText(made.error().detail);
  };
  EXPECT_THAT(words("lathe"), StartsWith("name='lathe' known='"));
  EXPECT_EQ(words("smr-20"), "name='smr-20' near='srm-20'");
  EXPECT_EQ(words("my.toml"), "name='my.toml'");
}

TEST(ProfileWords, OfFiles) {
  const auto words = [](std::string_view text) {
    const ProfileText files[] = {{"mine", text}};
    const Result<ProfileFiles> read = ProfileFiles::Read(files);
    return read ? std::string("read") : ArgumentsText(read.error().detail);
  };
  EXPECT_EQ(words("title = 'A'\n[parameters]\nX_MAX = 1\n"), "profile='mine' line=3 name='X_MAX'");
  EXPECT_EQ(words("title = 'A'\n[parameters]\nX = [1]\n"), "profile='mine' line=3 name='X'");
  EXPECT_EQ(words("title = 'A'\nspeed = 1\n"), "profile='mine' line=2 key='speed'");
}

class StartWords : public StartTest {
 protected:
  std::string Words(const std::string& program, const StepTarget& target,
                    ApproachWay way = ApproachWay::kDirect) const {
    const StartPreview preview = PreviewOf(Setup({program}), target, false, way);
    if (preview.may_begin()) return "none";
    return ArgumentsText(preview.refusals.front().detail);
  }
};

// LIVE-6.06: the path, the axis with its excess and unit, the code that it would end with; each
// with the clean steps beside it.
TEST_F(StartWords, OfADirectStart) {
  const std::string moves =
      "COORD ABSOL\nPATH LIN\nMOVE (500.,2200.,-350.,0.,0.)\nPATH CIR\n"
      "MOVE (560.,2200.,-350.,0.,0.)/VIA (530.,2230.,-350.,0.,0.)\n";
  EXPECT_THAT(Words(moves, {.at = {1, 5}}), StartsWith("path='CIR'"));
  const auto turned = [&](const std::string& pose) {
    return Words("COORD ABSOL\nPATH LIN\nMOVE (500.,2200.,-350.,0.,0.)\nMOVE (" + pose + ")\n",
                 {.at = {1, 4}});
  };
  EXPECT_THAT(turned("560.,2200.,-350.,13.,0."), StartsWith("axis='A' excess=0.4 rad"));
  EXPECT_THAT(Words("COORD ABSOL\nPATH LIN\nMOVE (500.,2100.,-350.,0.,0.)\nPATH CIR\n"
                    "MOVE (560.,2201.2,-350.,0.,0.)/VIA (600.,2201.2,-350.,0.,0.)\nVI[1]=1\n",
                    {.at = {1, 5}}),
              StartsWith("code='OPT-E"));
}

// LIVE-6.01: the step and its pass, the code that the run ends with, the last step that it came to.
TEST_F(StartWords, OfAStepThatIsNotReached) {
  EXPECT_THAT(
      Words("VI[2]=1\nVI[2]=0\nVR[1]=1/VI[2]\nVI[2]=2\n", {.at = {1, 4}, .occurrence = 6}),
      testing::MatchesRegex("program=1 step=4 occurrence=6 code='OPT-E[0-9]+' program=1 step=3.*"));
  EXPECT_THAT(Words("VI[2]=1\n", {.at = {1, 0}}), StartsWith("step=0"));
}

// LIVE-6.08: what nobody has seen to.
TEST_F(StartWords, OfWhatIsToBeSeenTo) {
  Observe({"COORD ABSOL\nPATH LIN\nOL[8]=ON\nMOVE (500.,2200.,-350.,0.,0.)\nVI[1]=1\n"});
  StartAtStep input = At1(5);
  input.acknowledged.clear();
  EXPECT_EQ(WordsOf(machine->Apply(input)), "item='clamps'");
}

}  // namespace
}  // namespace rmlcell::machine
