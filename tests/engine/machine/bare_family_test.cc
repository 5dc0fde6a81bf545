// A family that brings nothing but a name: what each machine has, and refuses, without it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "engine/machine/handbox.h"
#include "engine/machine/machine.h"
#include "engine/machine/standing.h"

namespace rmlcell::machine {
namespace {

// Its runs cannot begin.
class BareFamily final : public MachineFamily {
 public:
  const FamilyInfo& info() const override {
    static constexpr FamilyInfo info{.id = "bare", .title = "Bare machine", .axes = "X"};
    return info;
  }
  std::span<const ParameterInfo> parameters() const override { return {}; }
  Translation Translate(const SourceFile& /*file*/, const Parameters& /*parameters*/,
                        const CheckOptions& /*options*/) const override {
    return {};
  }
  Result<std::unique_ptr<Run>> NewRun(RunSetup /*setup*/,
                                      RunObserver& /*observer*/) const override {
    return Error{ErrorCode::kCellUnavailable, "not today", {}};
  }
};

class BareMachine : public testing::Test {
 protected:
  BareMachine() { Make({}); }

  void Make(const std::string& state) {
    MachineMemory memory;
    memory.programs[1] = {.name = "1", .object = Bytes::Of(std::string("go"))};
    Result<std::unique_ptr<Machine>> made =
        Machine::Make(family_, Parameters(family_.parameters()), std::move(memory), state, nobody_);
    ASSERT_TRUE(made) << made.error().detail;
    machine_ = *std::move(made);
  }
  std::string Refused(const MachineInput& input) {
    const Status done = machine_->Apply(input);
    return done ? std::string("it was taken")
                : CodeText(done.error().code) + " " + std::string(done.error().detail);
  }

  BareFamily family_;
  RunObserver nobody_;
  std::unique_ptr<Machine> machine_;
};

// LIVE-2.03: a run that cannot begin is none: no number is used up, and nothing is open.
TEST_F(BareMachine, ARunThatCannotBeginIsNone) {
  for (int n = 0; n < 2; ++n) {
    EXPECT_EQ(Refused(StartRun{.program = 1}), "CELL-E9002 not today");
    EXPECT_EQ(machine_->status().last_run, 0);
    EXPECT_FALSE(machine_->status().open);
    EXPECT_EQ(machine_->state(), MachineState::kIdle);
  }
}

TEST_F(BareMachine, RefusesWhatItDoesNotHave) {
  EXPECT_EQ(Refused(PressJog{.key = {JogAxis::kX, true}}),
            "CELL-E9424 Bare machine has no keys that move its axes");
  EXPECT_EQ(Refused(SetBreakpoints{.breakpoints = {{.at = {1, 1}}}}),
            "CELL-E9424 Bare machine has no breakpoints");
  EXPECT_EQ(Refused(PressedKey{.key = "START"}), "CELL-E9424 Bare machine has no handbox");
  EXPECT_EQ(machine_->run_on(), std::nullopt);
  EXPECT_EQ(machine_->ReadVariable("X"), std::nullopt);
}

// LIVE-3.23: it keeps the bytes of its family as they are, and that an emergency stop is pressed.
TEST_F(BareMachine, KeepsWhatItWasGiven) {
  const std::string state = machine_->Save() + "its own\nbytes";
  Make(state);
  EXPECT_EQ(machine_->Save(), state);
  EXPECT_EQ(Refused(EmergencyStop{}), "it was taken");
  Make(machine_->Save());
  EXPECT_EQ(machine_->state(), MachineState::kAlarm);
  EXPECT_THAT(machine_->Save(), testing::EndsWith("its own\nbytes"));
}

// That it has power is all that is to be seen of it.
TEST_F(BareMachine, ShowsItsPower) {
  EXPECT_THAT(machine_->panel().lamps, testing::ElementsAre("POWER"));
  EXPECT_EQ(Refused(SwitchPower{false}), "it was taken");
  EXPECT_THAT(machine_->panel().lamps, testing::IsEmpty());
}

}  // namespace
}  // namespace rmlcell::machine
