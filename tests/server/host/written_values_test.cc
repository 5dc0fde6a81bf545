// What is written at a machine, and what is told of what was taught there (live.md 7.08, 7.09).
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/machine/tools.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class WrittenValues : public HostMachineTest {
 protected:
  v1::HostOrderAnswer WriteReals(const std::vector<std::pair<std::string, double>>& values) {
    v1::HostOrder order;
    order.mutable_write_variables()->set_control_token(token_);
    for (const auto& [name, value] : values) {
      v1::Variable& variable = *order.mutable_write_variables()->add_variables();
      variable.set_name(name);
      variable.mutable_value()->set_real(value);
    }
    return Do(order);
  }
  double Real(const std::string& name) {
    v1::HostOrder order;
    order.mutable_read_variables()->add_variables(name);
    return Do(order).variables().variables(0).value().real();
  }
  std::string OpenedHandbox() {
    v1::HostOrder open;
    open.mutable_create_session()->set_control_token(token_);
    return Do(open).session().name();
  }
};

// All of them or none.
TEST_F(WrittenValues, AreAllOfThemOrNone) {
  MakeAndTakeOptimo();
  const v1::HostOrderAnswer good = WriteReals({{"VR[3]", 2.5}, {"VR[4]", -7.25}});
  ASSERT_FALSE(good.has_refusal()) << good.refusal().message();
  ASSERT_EQ(good.written().variables_size(), 2);
  EXPECT_FALSE(good.written().variables(0).has_error());
  EXPECT_FALSE(good.written().variables(1).has_error());
  EXPECT_EQ(Real("VR[3]"), 2.5);
  EXPECT_EQ(Real("VR[4]"), -7.25);
  const v1::HostOrderAnswer wrong = WriteReals({{"VR[3]", 3.5}, {"NONE", 1.0}, {"VR[4]", 8.0}});
  ASSERT_EQ(wrong.written().variables_size(), 3);
  EXPECT_FALSE(wrong.written().variables(0).has_error());
  EXPECT_TRUE(wrong.written().variables(1).has_error());
  EXPECT_FALSE(wrong.written().variables(2).has_error());
  EXPECT_EQ(Real("VR[3]"), 2.5);
  EXPECT_EQ(Real("VR[4]"), -7.25);
}

// What is read is told value by value: what there is, and of the rest that there is no such thing.
TEST_F(WrittenValues, WhatThereIsNotIsToldAsThat) {
  MakeAndTakeOptimo();
  ASSERT_FALSE(WriteReals({{"VR[3]", 2.5}}).has_refusal());
  v1::HostOrder order;
  for (const char* name : {"NONE", "VR[3]"}) order.mutable_read_variables()->add_variables(name);
  const v1::ReadVariablesResponse read = Do(order).variables();
  ASSERT_EQ(read.variables_size(), 2);
  EXPECT_EQ(read.variables(0).name(), "NONE");
  EXPECT_FALSE(read.variables(0).has_value());
  EXPECT_EQ(read.variables(0).error().code(), CodeText(ErrorCode::kCellInvalidArgument));
  EXPECT_EQ(read.variables(0).error().message(), "the machine has no such variable");
  EXPECT_FALSE(read.variables(1).has_error());
  EXPECT_EQ(read.variables(1).value().real(), 2.5);
}

// LIVE-7.09: what recorded points are, and what was in force, is told with each entry, by its name.
TEST_F(WrittenValues, OfWhatIsTaughtHaveTheirNames) {
  MakeAndTakeOptimo();
  const v1::TeachEntry taught =
      Taught(OpenedHandbox(), "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC").taught();
  std::vector<std::string> names;
  for (const v1::ModalValue& one : taught.values()) names.push_back(one.name());
  EXPECT_THAT(names, testing::ElementsAre("COORD", "TCP", "SYSDEF", "MODES"));
  for (const v1::ModalValue& one : taught.values()) {
    if (one.name() == "SYSDEF") {
      EXPECT_EQ(one.value(), "OFF");
    }
  }
  EXPECT_EQ(taught.act(), v1::TeachEntry::ACT_CREATE);
  EXPECT_EQ(taught.step().program(), 12);
  EXPECT_EQ(taught.caller(), "anna");
}

// OPT-1.15: what was made of an object before comes with it, and is what runs.
TEST_F(WrittenValues, WhatWasMadeOfAProgramComesWithIt) {
  MakeAndTakeOptimo();
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  const machine::Parameters parameters(family.parameters());
  const auto object_of = [&](std::string_view text) {
    return family.Translate({.name = "a.S", .bytes = text}, parameters, {}).object;
  };
  const std::string before = object_of("DELAY 1\n");
  const auto made = family.tools()->Link(
      12, [&](int) { return std::optional<std::string_view>(before); }, parameters);
  ASSERT_TRUE(made) << made.error().detail;
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(12);
  program.set_content(object_of("DELAY 60\n"));
  program.set_executable(made->executable);
  host_->Change(memory, now_);
  ASSERT_FALSE(Do(Start("", 12)).has_refusal());
  Pass(10s, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-7.08: the store did not take the first that was taught: the control says so.
TEST_F(WrittenValues, TheFirstThatIsNotStoredIsTold) {
  MakeAndTakeOptimo();
  Taught(OpenedHandbox(), "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  v1::HostEditAnswer refused;
  refused.set_number(1);
  refused.mutable_refusal()->set_code("CELL-E9108");
  host_->EditAnswered(refused, now_);
  EXPECT_EQ(host_->Handbox()->message_code(), "CELL-E9108");
}

}  // namespace
}  // namespace rmlcell::server
