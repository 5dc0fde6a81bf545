#include "engine/rml1/machine_state.h"

#include <gtest/gtest.h>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

const Profile& T1() {
  static const Profile profile = MakeProfile(ParametersOf("t1")).value();
  return profile;
}

MachineState SomeState() {
  MachineState state{.registers = Registers(T1()), .at = {1.25, -0.1, -1e-7, 359.999}};
  state.registers.absolute = false;
  state.registers.tool_down = true;
  state.registers.xy_speed = 0.7;
  state.registers.dwell_ms = 32767;
  state.registers.z0 = -595.5;
  state.registers.rpm = 6600;
  state.registers.rotation = false;
  state.registers.spindle_on = true;
  return state;
}

TEST(MachineState, ReadsBackWhatItWrote) {
  const std::string text = WriteMachineState(SomeState());
  const Result<MachineState> read = ReadMachineState(text, T1());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->at, SomeState().at);
  EXPECT_EQ(WriteMachineState(*read), text);
  EXPECT_EQ(read->registers.z0, -595.5);
  EXPECT_TRUE(read->registers.tool_down);
  EXPECT_FALSE(read->registers.rotation);
}

// Every truncation, every lost line and figures out of range are refused.
TEST(MachineState, RefusesWhatIsNotOurs) {
  const std::string text = WriteMachineState(SomeState());
  for (std::size_t size = 0; size < text.size(); ++size) {
    EXPECT_FALSE(ReadMachineState(text.substr(0, size), T1())) << size;
  }
  EXPECT_FALSE(ReadMachineState(text + "more 1\n", T1()));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return ReadMachineState(changed, T1());
  };
  EXPECT_FALSE(with("state 1", "state 2"));
  EXPECT_FALSE(with("z0 -595.5", "z0 5"));
  EXPECT_FALSE(with("z0 -595.5", "z0 nan"));
  EXPECT_FALSE(with("dwell_ms 32767", "dwell_ms 32768"));
  EXPECT_EQ(with("rpm 6600", "rpm -1").error().code, ErrorCode::kCellBadText);
}

}  // namespace
}  // namespace rmlcell::rml1
