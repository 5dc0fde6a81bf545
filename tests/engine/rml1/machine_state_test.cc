#include "engine/rml1/machine_state.h"

#include <gtest/gtest.h>

#include "engine/core/number_text.h"
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

// RML1-9.11, RML1-9.23, RML1-3A.53: every value has its line and its range, ends included; what is
// outside names itself.
TEST(MachineState, KeepsEveryValueWithinItsRange) {
  struct Range {
    std::string key;
    double low, high;
  };
  const Range ranges[] = {{"x", -1e9, 1e9},       {"y", -1e9, 1e9},        {"z", -1e9, 1e9},
                          {"a", -1e9, 1e9},       {"z0", -1e9, 0.0},       {"z1", -1e9, 0.0},
                          {"z2", 0.0, 1e9},       {"xy_speed", 1e-3, 1e5}, {"z_speed", 1e-3, 1e5},
                          {"dwell_ms", 0, 32767}, {"rpm", 0, 1e6},         {"absolute", 0, 1},
                          {"tool_down", 0, 1},    {"rotation", 0, 1},      {"spindle_on", 0, 1}};
  const auto text_with = [&](const std::string& key, const std::string& value) {
    std::string text = "rml1 machine state 1\n";
    for (const Range& range : ranges) {
      text += range.key + " " + (range.key == key ? value : range.low <= 0.0 ? "0" : "1") + "\n";
    }
    return text;
  };
  for (const Range& range : ranges) {
    for (const double end : {range.low, range.high}) {
      const std::string text = text_with(range.key, ShortestText(end));
      const Result<MachineState> read = ReadMachineState(text, T1());
      ASSERT_TRUE(read) << text;
      EXPECT_EQ(WriteMachineState(*read), text);
    }
    const double little = (range.high - range.low) * 1e-6;
    for (const double beyond : {range.low - little, range.high + little}) {
      const auto read = ReadMachineState(text_with(range.key, ShortestText(beyond)), T1());
      ASSERT_FALSE(read) << range.key << beyond;
      EXPECT_EQ(read.error().detail, "machine state: " + range.key + " is out of range");
    }
  }
  EXPECT_EQ(ReadMachineState("rml1 machine state 1\ny 0\n", T1()).error().detail,
            "machine state: no line 'x'");
  const std::string whole = text_with("", "");
  EXPECT_EQ(ReadMachineState(whole.substr(0, whole.size() - 1), T1()).error().detail,
            "machine state: no line 'spindle_on'");
  for (const std::string other : {"rpn", "rpms", "rp"}) {
    std::string changed = whole;
    changed.replace(changed.find("rpm"), 3, other);
    EXPECT_EQ(ReadMachineState(changed, T1()).error().detail, "machine state: no line 'rpm'");
  }
  EXPECT_EQ(ReadMachineState("", T1()).error().detail,
            "machine state: it does not begin with 'rml1 machine state 1'");
}

// The XY origin that the panel has set stands behind all that.
TEST(MachineState, KeepsTheOriginOfThePanel) {
  MachineState state = SomeState();
  state.origin = Point{.x = 1e9, .y = -1e9};
  const Result<MachineState> read = ReadMachineState(WriteMachineState(state), T1());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->origin, state.origin);
  Profile profile = T1();
  EXPECT_FALSE(OriginOf(profile));
  UseOrigin(std::nullopt, profile);
  EXPECT_FALSE(OriginOf(profile));
  UseOrigin(Point{.x = 100, .y = 250}, profile);
  EXPECT_EQ(OriginOf(profile), (Point{.x = 100, .y = 250}));

  const auto with = [](const std::string& line) {
    const auto found = ReadMachineState(WriteMachineState(SomeState()) + line, T1());
    return found ? found->origin.value_or(Point{-1, -1}) : Point{-2, -2};
  };
  EXPECT_EQ(with("origin 100 250\n"), (Point{.x = 100, .y = 250}));
  EXPECT_EQ(with("origin -1000000000 1000000000\n"), (Point{.x = -1e9, .y = 1e9}));
  for (const char* wrong : {"origin 1000000001 0\n", "origin 0 -1000000001\n", "origin 5\n",
                            "origin 5 \n", "origin  5\n", "origin \n", "origin nan 0\n",
                            "origin 1 2", "origin 1 2\n\n", "origin1 2\n"})
    EXPECT_EQ(with(wrong), (Point{-2, -2})) << wrong;
}

}  // namespace
}  // namespace rmlcell::rml1
