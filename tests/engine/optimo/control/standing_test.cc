// An Optimo between two runs: what is written, set and moved by hand, and what a power-up leaves.
#include "engine/machine/standing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "engine/core/units.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"

namespace rmlcell::optimo {
namespace {

using machine::StartAction;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class OptimoStands : public ::testing::Test {
 protected:
  OptimoStands() {
    EXPECT_TRUE(parameters.Set("GAS_CHANNELS", 3.0));
    Stand(NewMachine(Resolve(parameters)));
  }
  void Stand(const MachineState& state) {
    standing = *OptimoFamily().NewStanding(parameters, EncodeMachineState(state));
  }
  MachineState State() const { return DecodeMachineState(standing->Save()).value(); }
  std::string Read(std::string_view name) const { return standing->ReadVariable(name)->text; }
  // "OL[8] 1, OA[3] 2.5" as it is at the terminals.
  std::string On() const {
    std::string text;
    for (const machine::OutputNow& one : standing->outputs().on) {
      text += (text.empty() ? "" : ", ") + one.name + " " + std::to_string(one.value).substr(0, 3);
    }
    return text;
  }

  machine::Parameters parameters{OptimoFamily().parameters()};
  std::unique_ptr<machine::Standing> standing;
};

// OPT-7.59 to 7.64: each group takes what it can hold; outputs follow their images.
TEST_F(OptimoStands, VariablesAreWritten) {
  standing->WriteVariable("VR[99]", 1.5);
  standing->WriteVariable("VI[0]", -3.0);
  standing->WriteVariable("VL[5]", 1.0);
  standing->WriteVariable("OL[16]", 1.0);
  standing->WriteVariable("OA[7]", 2.5);
  EXPECT_EQ(Read("VR[99]"), "1.5");
  EXPECT_EQ(Read("VI[0]"), "-3");
  EXPECT_EQ(Read("VL[5]"), "1");
  EXPECT_EQ(Read("OL[16]"), "1");
  EXPECT_EQ(Read("OA[7]"), "2.5");
  EXPECT_EQ(On(), "OL[16] 1.0, OA[7] 2.5");
  standing->WriteVariable("VL[5]", 0.0);
  standing->WriteVariable("OL[16]", 0.0);
  standing->WriteVariable("VI[0]", 0.5);  // no whole number
  standing->WriteVariable("IL[3]", 1.0);  // an input
  standing->WriteVariable("VX[3]", 1.0);  // no variable
  EXPECT_EQ(Read("VL[5]") + Read("OL[16]") + Read("VI[0]") + Read("IL[3]"), "00-30");
  EXPECT_EQ(On(), "OA[7] 2.5");
}

// OPT-5.40: of two assist gases the second one keeps its image, and comes when it is written again
// behind the first.
TEST_F(OptimoStands, OneGasAtATime) {
  for (const auto& [first, second] : {std::pair{"OL[8]", "OL[9]"}, std::pair{"OL[9]", "OL[8]"}}) {
    const std::string one = std::string(first) + " 1.0";
    standing->WriteVariable(first, 1.0);
    standing->WriteVariable(second, 1.0);
    EXPECT_EQ(Read(second), "1");
    EXPECT_EQ(On(), one);
    standing->WriteVariable(second, 0.0);
    EXPECT_EQ(On(), one);
    standing->WriteVariable(first, 0.0);
    EXPECT_EQ(On(), "");
    standing->WriteVariable(second, 1.0);
    EXPECT_EQ(On(), std::string(second) + " 1.0");
    standing->WriteVariable(second, 0.0);
  }
}

// OPT-4.64, OPT-7.30, OPT-7.35: TCP takes six values, SYSDEF six or none.
TEST_F(OptimoStands, ToolAndWorkOffsetAreSet) {
  const std::array<double, 6> six = {1, 2, 3, 4, 5, 6};
  const std::span<const double> five = std::span(six).first(5);
  standing->SetModal("TCP", five);
  EXPECT_EQ(State().tool.offset, motion::ToolOffset());
  standing->SetModal("TCP", six);
  EXPECT_EQ(State().tool.offset, (motion::ToolOffset{1, 2, 3}));
  EXPECT_THAT(State().tool.reference, ElementsAre(4, 5, 6));
  EXPECT_FALSE(State().work_offset.active);
  standing->SetModal("SYSDEF", six);
  EXPECT_TRUE(State().work_offset.active);
  EXPECT_THAT(State().work_offset.values, ElementsAre(1, 2, 3, 4, 5, 6));
  standing->SetModal("SYSDEF", {});
  EXPECT_FALSE(State().work_offset.active);
  EXPECT_THAT(State().work_offset.values, ElementsAre(0, 0, 0, 0, 0, 0));
  std::vector<std::string> values;
  for (const machine::ModalValue& one : standing->modal_values())
    values.push_back(one.name + " " + one.value);
  EXPECT_THAT(values, ElementsAre("TCP (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)", "SYSDEF OFF"));
}

// Inputs beyond the last index act on the last one, those below the first on the first.
TEST_F(OptimoStands, InputsAndTheDoorAreKept) {
  for (const auto& [given, index] : {std::pair{-5, 0}, std::pair{7, 7}, std::pair{500, 99}}) {
    standing->Apply({.kind = machine::InputKind::kLogical, .index = given, .value = 1.0});
    standing->Apply({.kind = machine::InputKind::kAnalogue, .index = given, .value = 2.5});
    EXPECT_TRUE(State().data.il_physical[static_cast<std::size_t>(index)]);
    EXPECT_EQ(State().data.ia_physical[static_cast<std::size_t>(index)], 2.5F);
    standing->Apply({.kind = machine::InputKind::kLogical, .index = given, .value = 0.0});
    EXPECT_EQ(State().data.il_physical, Bits());
  }
  EXPECT_FALSE(standing->state().door_open);
  standing->Apply({.kind = machine::InputKind::kDoor, .value = 1.0});
  EXPECT_TRUE(standing->state().door_open);
  standing->Apply({.kind = machine::InputKind::kDoor, .value = 0.0});
  EXPECT_FALSE(State().door_open);
}

// It stands where it was moved to.
TEST_F(OptimoStands, ItsState) {
  standing->MoveTo({.column = {100, 200, -30}, .a_rad = 0.5, .b_rad = 0.0});
  const machine::RunState state = standing->state();
  EXPECT_EQ(state.phase, machine::RunPhase::kFinished);
  EXPECT_EQ(state.axes, (motion::AxisPose{{100, 200, -30}, 0.5, 0.0}));
  EXPECT_NEAR((state.tip.tip - motion::MachinePoint{100, 200, -330}).norm(), 0.0, 1e-9);
  EXPECT_TRUE(state.zeroed);
  EXPECT_EQ(State().axes, state.axes);
}

// OPT-4.35, OPT-4.55: the keys move at the step of the override: at 100 % at 21 % of full speed;
// Z of the tool is down where Z0 is below Z1.
TEST_F(OptimoStands, KeysMoveAtTheStepOfTheOverride) {
  const auto at = [&](double percent) { return *standing->ByHand(percent, false); };
  EXPECT_THAT(at(100.0).plus,
              ::testing::Pointwise(::testing::DoubleNear(1e-9),
                                   {105.0, 105.0, 105.0, 0.21 * kTurn, 0.21 * kTurn}));
  EXPECT_EQ(at(100.0).minus, at(100.0).plus);
  EXPECT_NEAR(at(10.0).plus[0], 0.25, 1e-9);
  EXPECT_NEAR(at(145.0).plus[4], 0.4 * kTurn, 1e-9);
  EXPECT_EQ(at(100.0).machine.tip_acceleration_mm_s2, 2000.0);
  EXPECT_EQ(at(100.0).machine.tip_jerk_mm_s3, 40'000.0);
  EXPECT_EQ(at(100.0).machine.axes.travel_max[0], 3600.0);
  EXPECT_FALSE(at(100.0).tool_z_down);
  for (const auto& [z, down] :
       {std::pair{4.5, true}, std::pair{5.0, false}, std::pair{5.5, false}}) {
    standing->SetModal("TCP", std::array{0.0, 0.0, z, 0.0, 0.0, 5.0});
    EXPECT_EQ(at(100.0).tool_z_down, down) << z;
  }
}

// OPT-4.35: X, Y and Z at a share of the speed of the tip, whatever their axes could do; A and B of
// that of their own axis.
TEST_F(OptimoStands, KeysMoveAtAShareOfTheTipOrOfTheHead) {
  EXPECT_TRUE(parameters.Set("VMAX", 200.0));
  EXPECT_TRUE(parameters.Set("AXIS_SPEED_A", 3.0));
  EXPECT_TRUE(parameters.Set("AXIS_SPEED_B", 5.0));
  Stand(NewMachine(Resolve(parameters)));
  EXPECT_THAT((*standing->ByHand(100.0, false)).plus,
              ::testing::Pointwise(::testing::DoubleNear(1e-9), {42.0, 42.0, 42.0, 0.63, 1.05}));
}

// OPT-4.68, OPT-6.08, OPT-6.30, OPT-7.63: off and on again: no reference, TCP, BREAK and SIMUL,
// outputs and images are 0; variables, inputs, SYSDEF and what is counted stay.
TEST_F(OptimoStands, APowerUp) {
  MachineState before = NewMachine(Resolve(parameters));
  const auto mark = [](Bits& bits, Numbers& numbers) {
    bits[5] = true;
    numbers[6] = 7.5F;
  };
  mark(before.data.vl, before.data.vr);
  mark(before.data.il, before.data.ia);
  mark(before.data.ol, before.data.oa);
  mark(before.data.il_physical, before.data.ia_physical);
  mark(before.outputs.logical, before.outputs.analogue);
  before.data.vi[7] = 8.0F;
  before.outputs.schedule = 15;
  before.outputs.table_deg = 90.0;
  before.tool = {.offset = {1, 2, 3}, .reference = {4, 5, 6}};
  before.work_offset = {.active = true, .values = {1, 2, 3, 4, 5, 6}};
  before.door_open = true;
  before.selected = 12;
  before.breakpoint = before.simul = machine::ProgramStep{.program = 12, .step = 3};
  Stand(before);
  EXPECT_EQ(standing->simulation_until(), before.simul);
  standing->CyclePower();
  const MachineState after = State();
  EXPECT_FALSE(after.zeroed);
  EXPECT_EQ(after.tool.offset, motion::ToolOffset());
  EXPECT_THAT(after.tool.reference, ElementsAre(0, 0, -5));
  EXPECT_EQ(after.breakpoint, std::nullopt);
  EXPECT_EQ(after.simul, std::nullopt);
  for (const Bits& zeros : {after.data.il, after.data.ol, after.outputs.logical})
    EXPECT_EQ(zeros, Bits());
  for (const Numbers& zeros : {after.data.ia, after.data.oa, after.outputs.analogue})
    EXPECT_EQ(zeros, Numbers());
  EXPECT_EQ(after.outputs.schedule, 0);
  EXPECT_EQ(after.outputs.table_deg, 90.0);
  EXPECT_EQ(after.data.vr, before.data.vr);
  EXPECT_EQ(after.data.vi, before.data.vi);
  EXPECT_EQ(after.data.vl, before.data.vl);
  EXPECT_EQ(after.data.il_physical, before.data.il_physical);
  EXPECT_EQ(after.data.ia_physical, before.data.ia_physical);
  EXPECT_TRUE(after.work_offset.active);
  EXPECT_TRUE(after.door_open);
  EXPECT_EQ(after.selected, 12);
  EXPECT_EQ(after.axes, before.axes);
}

// LIVE-6.02, LIVE-6.03: all that it keeps by its name, and what a start at a step does about it.
TEST_F(OptimoStands, ItsItems) {
  MachineState state = NewMachine(Resolve(parameters));
  state.outputs.schedule = 15;
  state.outputs.table_deg = -45.5;
  state.outputs.logical[9] = true;
  state.data.vr[99] = 1.5F;
  state.data.il_physical[0] = true;
  Stand(state);
  std::vector<std::string> wanted = {"pose", "TCP", "SYSDEF", "schedule", "gas", "table"};
  for (const std::string group : {"VR", "VI", "VL", "IL", "OL", "IA", "OA", "input IL", "input IA",
                                  "output OL", "output OA"}) {
    for (int n = 0; n < kVariableCount; ++n)
      wanted.push_back(group + "[" + std::to_string(n) + "]");
  }
  wanted.push_back("clamps");
  std::vector<std::string> names;
  std::map<std::string, std::string> values;
  for (const machine::StateItem& item : standing->items()) {
    constexpr const char* kActions[] = {"set", "switch", "move", "ask", "none"};
    const auto action = std::array{StartAction::kSet, StartAction::kSwitch, StartAction::kMove,
                                   StartAction::kAsk, StartAction::kNone};
    const auto at = std::ranges::find(action, item.action) - action.begin();
    names.push_back(item.name);
    values[item.name] = item.value + " " + kActions[at];
  }
  EXPECT_EQ(names, wanted);
  EXPECT_EQ(values["pose"], "X 21.02 Y 2201.2 Z -50 A 0 B 0 move");
  EXPECT_EQ(values["TCP"], "(0.0, 0.0, 0.0, 0.0, 0.0, -5.0) set");
  EXPECT_EQ(values["schedule"], "15 switch");
  EXPECT_EQ(values["gas"], "3 switch");
  EXPECT_EQ(values["table"], "-45.5 ask");
  EXPECT_EQ(values["VR[99]"], "1.5 set");
  EXPECT_EQ(values["OL[9]"], "0 set");
  EXPECT_EQ(values["output OL[9]"], "1 switch");
  EXPECT_EQ(values["output OA[99]"], "0 switch");
  EXPECT_EQ(values["input IL[0]"], "1 none");
  EXPECT_EQ(values["input IA[99]"], "0 none");
  EXPECT_EQ(values["clamps"], "not known ask");
  state.outputs.logical = {};
  state.outputs.logical[8] = true;
  state.outputs.table_deg = -1e-9;  // rounding has no sign
  Stand(state);
  EXPECT_EQ(standing->items()[5].value, "0");
  EXPECT_EQ(standing->items()[4].value, "2");
}

// OPT-4.35: each of the ten steps, in percent of 500 mm/s.
TEST_F(OptimoStands, EachStepOfTheOverrideHasItsSpeed) {
  for (const auto& [percent, share] :
       {std::pair{10.0, 0.05}, std::pair{25.0, 0.3}, std::pair{40.0, 1.0}, std::pair{55.0, 3.0},
        std::pair{70.0, 9.0}, std::pair{85.0, 15.0}, std::pair{100.0, 21.0}, std::pair{115.0, 27.0},
        std::pair{130.0, 33.0}, std::pair{145.0, 40.0}}) {
    const std::optional<machine::HandMotion> how = standing->ByHand(percent, false);
    ASSERT_TRUE(how.has_value());
    EXPECT_NEAR(how->plus[0], 5.0 * share, 1e-9) << percent;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
