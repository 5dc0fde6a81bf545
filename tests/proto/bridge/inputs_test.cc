#include "proto/bridge/inputs.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>

#include <limits>

#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

using machine::InputKind;
using testing::HasSubstr;

v1::SimulationOptions Options(const std::string& text) {
  v1::SimulationOptions options;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &options)) << text;
  return options;
}
v1::ScriptedInput Scripted(const std::string& input, std::int64_t at_ns = 0) {
  return Options("inputs { virtual_time_ns: " + std::to_string(at_ns) + " input { " + input +
                 " } }")
      .inputs(0);
}
// What it does: kind, index, value; or why it is refused.
std::string Taken(const v1::ScriptedInput& input) {
  const auto change = FromProto(input, 145.0);
  if (!change) {
    EXPECT_EQ(change.error().code, ErrorCode::kCellInvalidArgument);
    return change.error().detail;
  }
  return std::to_string(static_cast<int>(change->kind)) + " " + std::to_string(change->index) +
         " " + std::to_string(change->value);
}
std::string Taken(const std::string& input) { return Taken(Scripted(input)); }
std::string Does(InputKind kind, int index = 0, double value = 0.0) {
  return std::to_string(static_cast<int>(kind)) + " " + std::to_string(index) + " " +
         std::to_string(value);
}
std::string Outside(const std::string& name, const std::string& value) {
  return "from_outside { input { name: '" + name + "' value { " + value + " } } }";
}

TEST(ScriptedInputs, EachThatASimulationTakes) {
  EXPECT_EQ(Taken("start {}"), Does(InputKind::kStart));
  EXPECT_EQ(Taken("resume {}"), Does(InputKind::kStart));
  EXPECT_EQ(Taken("hold: HOLD_REASON_HOLD"), Does(InputKind::kHold));
  EXPECT_EQ(Taken("stop: HOLD_REASON_UNSPECIFIED"), Does(InputKind::kStop));
  EXPECT_EQ(Taken("emergency_stop: true"), Does(InputKind::kEmergencyStop));
  EXPECT_EQ(Taken("override_percent: 145"), Does(InputKind::kOverride, 0, 145.0));
  EXPECT_EQ(Taken("from_outside { door_open: true }"), Does(InputKind::kDoor, 0, 1.0));
  EXPECT_EQ(Taken("from_outside { door_open: false }"), Does(InputKind::kDoor, 0, 0.0));
  EXPECT_EQ(Taken(Outside("IL[99]", "logical: true")), Does(InputKind::kLogical, 99, 1.0));
  EXPECT_EQ(Taken(Outside("il[0]", "logical: false")), Does(InputKind::kLogical, 0, 0.0));
  EXPECT_EQ(Taken(Outside("IA[7]", "real: -2.5")), Does(InputKind::kAnalogue, 7, -2.5));
  EXPECT_EQ(Taken(Outside("IA[7]", "integer: 3")), Does(InputKind::kAnalogue, 7, 3.0));
  EXPECT_EQ(ToSeconds(FromProto(Scripted("stop: 0", 1'500'000'000), 145.0)->at), 1.5);
}

TEST(ScriptedInputs, OthersAreRefused) {
  EXPECT_EQ(Taken(Scripted("stop: 0", -1)), "virtual_time_ns must be 0 or later");
  EXPECT_EQ(Taken(""), "an input says nothing");
  for (const char* live : {"abort: 0", "factor: 2", "power: true", "emergency_stop: false",
                           "from_outside { gate: 1 }", "from_outside {}", "mode: 1"})
    EXPECT_THAT(Taken(live), HasSubstr("a simulation takes start, resume")) << live;
  for (const char* name : {"IL[100]", "IL[-1]", "IL[x]", "OL[1]", "IL", "", "IA[1"})
    EXPECT_THAT(Taken(Outside(name, "logical: true")), HasSubstr("is no input")) << name;
  const std::string inputs = " is no input: use IL[0] to IL[99] or IA[0] to IA[99]";
  EXPECT_EQ(Taken(Outside(std::string(40, 'x'), "")), "'" + std::string(40, 'x') + "'" + inputs);
  EXPECT_EQ(Taken(Outside(std::string(41, 'x'), "")), "a long name" + inputs);
  EXPECT_EQ(Taken(Outside("IL[1]", "real: 1")), "IL[1] needs a logical value");
  EXPECT_EQ(Taken(Outside("IA[1]", "logical: true")), "IA[1] needs a number");
  EXPECT_EQ(Taken(Outside("IA[1]", "real: inf")), "IA[1] needs a number");
  EXPECT_EQ(Taken("override_percent: 146"), "the value is 146; allowed are above 0 to 145 %");
  EXPECT_EQ(Taken("override_percent: 0"), "the value is 0; allowed are above 0 to 145 %");
  EXPECT_THAT(Taken("override_percent: nan"), HasSubstr("allowed are above 0"));
}

TEST(ScriptedInputs, EachAsAMessage) {
  const auto told = [](const machine::InputChange& change) {
    return ToProto(change).ShortDebugString();
  };
  const std::string outside = "from_outside { input { name: ";
  EXPECT_EQ(told({.kind = InputKind::kLogical, .index = 7, .value = 1.0}),
            outside + "\"IL[7]\" value { logical: true } } }");
  EXPECT_EQ(told({.kind = InputKind::kLogical, .index = 7, .value = 0.0}),
            outside + "\"IL[7]\" value { logical: false } } }");
  EXPECT_EQ(told({.kind = InputKind::kAnalogue, .index = 8, .value = -2.5}),
            outside + "\"IA[8]\" value { real: -2.5 } } }");
  EXPECT_EQ(told({.kind = InputKind::kDoor, .value = 1.0}), "from_outside { door_open: true }");
  EXPECT_EQ(told({.kind = InputKind::kDoor}), "from_outside { door_open: false }");
  EXPECT_EQ(told({.kind = InputKind::kStart}), "resume { }");
  EXPECT_EQ(told({.kind = InputKind::kStart, .value = 1.0}), "resume { restore_process: true }");
  EXPECT_EQ(told({.kind = InputKind::kHold}), "hold: HOLD_REASON_HOLD");
  EXPECT_EQ(told({.kind = InputKind::kStop}), "stop: HOLD_REASON_STOP");
  EXPECT_EQ(told({.kind = InputKind::kEmergencyStop}), "emergency_stop: true");
  EXPECT_EQ(told({.kind = InputKind::kOverride, .value = 55.0}), "override_percent: 55");
  EXPECT_EQ(told({.kind = InputKind::kVariable, .value = 2.5, .name = "VR[1]"}),
            "variable { name: \"VR[1]\" value { real: 2.5 } }");
  EXPECT_EQ(Taken("resume { restore_process: true }"), Does(InputKind::kStart, 0, 1.0));
}

TEST(ScriptedInputs, InOrderOfTimeThoseOfOneInstantAsGiven) {
  const auto script =
      InputsOf(Options("inputs { virtual_time_ns: 2 input { stop: 0 } }"
                       "inputs { virtual_time_ns: 1 input { hold: 0 } }"
                       "inputs { virtual_time_ns: 2 input { resume {} } }"));
  ASSERT_TRUE(script);
  ASSERT_EQ(script->size(), 3U);
  EXPECT_EQ(script->at(0).kind, InputKind::kHold);
  EXPECT_EQ(script->at(1).kind, InputKind::kStop);
  EXPECT_EQ(script->at(2).kind, InputKind::kStart);
}

// One that is not understood, as of a job of another version, is never left out in silence.
TEST(ScriptedInputs, NoneIsLeftOut) {
  for (const char* unknown : {"inputs { virtual_time_ns: 1 }", "inputs { input { power: true } }"})
    EXPECT_FALSE(InputsOf(Options(unknown))) << unknown;
}

TEST(InputFile, EveryInput) {
  v1::SimulationOptions options;
  const Status read = ParseInputFile(
      "# what comes from outside\n"
      "0 IL[0] = 1\n 0.5\til[99] = off # and back\n\n1 IA[7] = -2.5\r\n2 DOOR = OPEN\n3 door = "
      "closed\n"
      "4 START\n5 RESUME\n6 HOLD\n7 STOP\n8 EMERGENCY\n9 OVERRIDE = 145\n"
      "10 IL[1] = on\n11 IL[1] = true\n12 IL[1] = yes\n13 IL[1] = false\n14 IL[1] = no",
      "in.txt", 145.0, options);
  ASSERT_TRUE(read) << read.error().detail;
  const std::pair<double, std::string> expected[] = {{0, Does(InputKind::kLogical, 0, 1.0)},
                                                     {0.5, Does(InputKind::kLogical, 99, 0.0)},
                                                     {1, Does(InputKind::kAnalogue, 7, -2.5)},
                                                     {2, Does(InputKind::kDoor, 0, 1.0)},
                                                     {3, Does(InputKind::kDoor, 0, 0.0)},
                                                     {4, Does(InputKind::kStart)},
                                                     {5, Does(InputKind::kStart)},
                                                     {6, Does(InputKind::kHold)},
                                                     {7, Does(InputKind::kStop)},
                                                     {8, Does(InputKind::kEmergencyStop)},
                                                     {9, Does(InputKind::kOverride, 0, 145)},
                                                     {10, Does(InputKind::kLogical, 1, 1.0)},
                                                     {11, Does(InputKind::kLogical, 1, 1.0)},
                                                     {12, Does(InputKind::kLogical, 1, 1.0)},
                                                     {13, Does(InputKind::kLogical, 1, 0.0)},
                                                     {14, Does(InputKind::kLogical, 1, 0.0)}};
  ASSERT_EQ(options.inputs_size(), static_cast<int>(std::size(expected)));
  for (int i = 0; i < options.inputs_size(); ++i) {
    EXPECT_EQ(options.inputs(i).virtual_time_ns(), FromSeconds(expected[i].first).count()) << i;
    EXPECT_EQ(Taken(options.inputs(i)), expected[i].second) << i;
  }
}

TEST(InputFile, MistakesAreNamedWithTheirPlace) {
  const std::string time = "a line begins with the time in seconds, from 0: 0.5 IL[20] = 1";
  const std::string kinds =
      "' is none of IL[n], IA[n], DOOR, START, HOLD, STOP, EMERGENCY, OVERRIDE";
  for (const auto& [text, line, column, said] :
       std::vector<std::tuple<std::string, int, int, std::string>>{
           {"START", 1, 1, time},
           {"1", 1, 1, time},
           {"-1 START", 1, 1, time},
           {"nan START", 1, 1, time},
           {"\n\n1 GO", 3, 3, "'GO" + kinds},
           {"12 " + std::string(50, 'G'), 1, 4, "'" + std::string(40, 'G') + kinds},
           {"1 IL[100] = 1", 1, 3, "'IL[100]" + kinds},
           {"1 IL[-1] = 1", 1, 3, "'IL[-1]" + kinds},
           {"1 IL[x] = 1", 1, 3, "'IL[x]" + kinds},
           {"1 IA[1 = 1", 1, 3, "'IA[1" + kinds},
           {"1 IL[1]", 1, 3, "IL[1] needs '= VALUE'"},
           {"1 DOOR", 1, 3, "DOOR needs '= VALUE'"},
           {"1 IA[1]", 1, 3, "IA[1] needs '= VALUE'"},
           {"1 OVERRIDE", 1, 3, "OVERRIDE needs '= VALUE'"},
           {"1 START = 1", 1, 3, "START takes no value"},
           {"1 IL[1] = maybe", 1, 11, "the value is no number, ON, OFF, OPEN or CLOSED"},
           {"1 IL[1] = 2", 1, 3, "the value is 2; allowed are 0 and 1"},
           {"1 DOOR = 0.5", 1, 3, "the value is 0.5; allowed are 0 and 1"},
           {"1 OVERRIDE = 146", 1, 3, "the value is 146; allowed are above 0 to 145 %"},
           {"1 OVERRIDE = 0", 1, 3, "the value is 0; allowed are above 0 to 145 %"}}) {
    v1::SimulationOptions options;
    const Status read = ParseInputFile(text, "in.txt", 145.0, options);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
    EXPECT_EQ(read.error().detail, "in.txt:" + std::to_string(line) + ": " + said);
    EXPECT_EQ(read.error().where->line, line) << text;
    EXPECT_EQ(read.error().where->column, column) << text;
    EXPECT_EQ(options.inputs_size(), 0);
  }
}

TEST(Variables, AreTyped) {
  using machine::VariableKind;
  const auto shown = [](VariableKind kind, const std::string& text) {
    const v1::Variable made = ToProto(machine::NamedVariable{"name", {kind, text}});
    EXPECT_EQ(made.name(), "name");
    EXPECT_EQ(made.text(), text);
    return made.value().ShortDebugString();
  };
  EXPECT_EQ(shown(VariableKind::kReal, "2.5"), "real: 2.5");
  EXPECT_EQ(shown(VariableKind::kInteger, "-32768"), "integer: -32768");
  EXPECT_EQ(shown(VariableKind::kLogical, "1"), "logical: true");
  EXPECT_EQ(shown(VariableKind::kLogical, "on"), "logical: true");
  EXPECT_EQ(shown(VariableKind::kLogical, "0"), "logical: false");
  EXPECT_EQ(shown(VariableKind::kLogical, "off"), "logical: false");
  EXPECT_EQ(shown(VariableKind::kWord, "abs"), "word: \"abs\"");
}

}  // namespace
}  // namespace rmlcell::bridge
