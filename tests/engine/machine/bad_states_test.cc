// States that are none, keys that there are not, a home that cannot be reached: each is refused
// where it is asked for, and what was so stays.
#include <gmock/gmock.h>

#include <memory>
#include <string>

#include "engine/machine/handbox.h"
#include "tests/engine/machine/held_bed.h"
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::StartsWith;

// LIVE-3.23: with a handbox whose state is none there is no machine, of a family without one
// neither.
TEST(BadStates, OfAHandboxMakeNoMachine) {
  RunObserver nobody;
  for (const char* id : {"optimo", "rml1"}) {
    const MachineFamily& family = *families::FindFamily(id);
    const auto made = [&](const std::string& state) {
      return Machine::Make(family, *MakeParameters(family, "", {}), {}, state, nobody);
    };
    const std::string good = (*made(""))->Save();
    const std::size_t at = good.find("family\n");
    ASSERT_NE(at, std::string::npos);
    const auto bad = made(good.substr(0, at) + "handbox none\n" + good.substr(at));
    ASSERT_FALSE(bad) << id;
    EXPECT_EQ(bad.error().code, ErrorCode::kCellBadText) << id;
  }
}

class BadStarts : public StartTest {};

// LIVE-6.01: with a base that is no state of this machine nothing is looked at, and nothing begins:
// the next run is the first.
TEST_F(BadStarts, WithoutAStateToBeginWith) {
  Load({"DELAY 1\nDELAY 2\n"});
  StartAtStep input = At1(2);
  const auto good = std::make_shared<const StartPreview>(*machine->Preview(input));
  input.base = StartBase{.machine_state = "no state"};
  const Result<StartPreview> preview = machine->Preview(input);
  ASSERT_FALSE(preview);
  EXPECT_EQ(preview.error().code, ErrorCode::kCellBadText);
  const Result<std::uint64_t> passes = machine->OccurrenceAt(input, At(1.0), {});
  ASSERT_FALSE(passes);
  EXPECT_EQ(passes.error().code, ErrorCode::kCellBadText);
  EXPECT_THAT(Refused(input), StartsWith("CELL-E9024"));
  input.prepared = good;
  EXPECT_THAT(Refused(input), StartsWith("CELL-E9024"));
  EXPECT_FALSE(machine->status().open);
  EXPECT_EQ(machine->status().last_run, 0);
  Start();
  EXPECT_EQ(machine->status().open->number, 1);
}

// LIVE-6.03: nor where the machine stands as no machine does.
TEST_F(BadStarts, WithoutAStateThatItStandsIn) {
  const Result<StartPreview> preview =
      PreviewStart(family_, Setup({"DELAY 1\nDELAY 2\n"}),
                   {.target = {.at = {1, 2}}, .machine_state = "no state"}, {});
  ASSERT_FALSE(preview);
  EXPECT_EQ(preview.error().code, ErrorCode::kCellBadText);
}

// LIVE-2.10: beside an open run no start is looked at.
TEST_F(BadStarts, BesideAnOpenRun) {
  Load({"DELAY 5\nDELAY 5\n"});
  Start();
  GoOn(At(1.0));
  const Result<StartPreview> preview = machine->Preview(At1(2));
  ASSERT_FALSE(preview);
  EXPECT_EQ(preview.error().code, ErrorCode::kCellMachineState);
}

class BadKeys : public HeldTest {};

// LIVE-7.01: a key that is none is refused, pressed or asked for.
TEST_F(BadKeys, AreRefused) {
  Load({"DELAY 1\n"});
  const Result<KeyAnswer> none = machine->PressKey("FIRE");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Refused(PressedKey{.key = "FIRE"}), "CELL-E9003 there is no key FIRE on the handbox");
  EXPECT_EQ(Refused(PressedKey{.key = "SHIFT"}), "it was taken");
}

// OPT-4.74, OPT-B.08: a home outside of the travel is told at once beside a run that is held, and
// nothing moves; the run stays open and goes on.
TEST_F(BadKeys, AHomeOutOfTravelIsToldAtOnce) {
  Load({kCorner});
  const std::string stands = machine->Save();
  MachineMemory memory = machine->memory();
  Parameters far =
      *MakeParameters(family_, std::string(family_.info().default_profile), {{"HOME_X", "99999"}});
  machine = *Machine::Make(family_, std::move(far), std::move(memory), stands, heard);
  HoldAt(5.0);
  const motion::AxisPose held = Axes();
  const Result<KeyAnswer> home = machine->PressKey("HOME", KeyAction::kPress);
  ASSERT_TRUE(home);
  EXPECT_EQ(home->message, ErrorCode::kTargetOutOfTravel);
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().by_hand, std::nullopt);
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kRelease));
  GoOnFor(1.0);
  EXPECT_EQ(Axes(), held);
  BackInRemote();
  Good(ResumeRun{});
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

class BadMillKeys : public MachineTest {
 protected:
  BadMillKeys() : MachineTest("rml1") {}
};

// A mill has no handbox, and no key of one.
TEST_F(BadMillKeys, AreRefused) {
  Load({"PU0,0;"});
  EXPECT_THAT(Refused(PressedKey{.key = "START"}), StartsWith("CELL-E9424"));
}

}  // namespace
}  // namespace rmlcell::machine
