#include "proto/bridge/files.h"

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "proto/bridge/encoding.h"
#include "proto/bridge/header_date.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/report.pb.h"
#include "tests/proto/bridge/message_text.h"

namespace rmlcell::bridge {
namespace {

TEST(ReadFile, WholeUpToTheLimit) {
  const std::string path = ::testing::TempDir() + "/rmlcell-read";
  const std::string bytes = std::string("a\0b", 3) + std::string(200'000, 'x');
  std::ofstream(path, std::ios::binary) << bytes;
  const auto size = static_cast<std::int64_t>(bytes.size());
  EXPECT_EQ(*ReadFile(path, size), bytes);
  EXPECT_EQ(ReadFile(path, size - 1).error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(ReadFile(path, size - 1).error().detail,
            path + " is larger than " + std::to_string(size - 1) + " bytes");
  std::filesystem::remove(path);
  EXPECT_EQ(ReadFile(path, size).error().code, ErrorCode::kCellFileUnreadable);
  EXPECT_EQ(ReadFile(::testing::TempDir(), size).error().code, ErrorCode::kCellFileUnreadable);
}

TEST(MachineFile, FamilyProfileAndParameters) {
  const auto machine = ParseMachineFile(
      "family = 'optimo'\nprofile = 'standard'\n[parameters]\nVMAX = 400\nCYCLE = 0.064\n"
      "LASER = 'EFA51'\n",
      "m.toml");
  ASSERT_TRUE(machine);
  EXPECT_EQ(machine->family, "optimo");
  EXPECT_EQ(machine->profile, "standard");
  EXPECT_EQ(machine->parameters, (std::map<std::string, std::string>{
                                     {"VMAX", "400"}, {"CYCLE", "0.064"}, {"LASER", "EFA51"}}));
}

// In any order, and with the word that built-in profiles have for the name.
TEST(MachineFile, NameAndSources) {
  for (const std::string key : {"name", "title"}) {
    const auto machine = ParseMachineFile(key +
                                              " = 'My mill'\nprofile = 'srm-20'\n[sources]\n"
                                              "x_max = 'measured'\n[parameters]\nX_MAX = 100\n",
                                          "m.toml");
    ASSERT_TRUE(machine) << key;
    EXPECT_EQ(machine->name, "My mill");
    EXPECT_EQ(machine->sources, (std::map<std::string, std::string>{{"x_max", "measured"}}));
  }
}

TEST(MachineFile, MistakesAreNamedWithTheirPlace) {
  for (
      const auto& [text, line, said] : std::vector<std::tuple<std::string, int, std::string>>{
          {"family = 'optimo'\ncolour = 'red'\n", 2,
           "m.toml:2: unknown key colour; there are family, profile, name, [parameters], [sources]"},
          {"profile = 1\n", 1,
           "m.toml:1: unknown key profile; there are family, profile, name, [parameters], [sources]"},
          {"family = 1\n", 1,
           "m.toml:1: unknown key family; there are family, profile, name, [parameters], [sources]"},
          {"parameters = 1\n", 1,
           "m.toml:1: unknown key parameters; there are family, profile, name, [parameters], [sources]"},
          {"[parameters]\nVMAX = true\n", 2, "m.toml:2: parameter VMAX takes a number or a text"},
          {"[sources]\nVMAX = 'x'\n", 2,
           "m.toml:2: a source of VMAX, which [parameters] does not have"},
          {"[parameters]\nVMAX = 1\n[sources]\nVMAX = 1\n", 4,
           "m.toml:4: the source of VMAX is a text"}}) {
    const auto machine = ParseMachineFile(text, "m.toml");
    ASSERT_FALSE(machine) << text;
    EXPECT_EQ(machine.error().code, ErrorCode::kCellBadText);
    EXPECT_EQ(machine.error().detail, said);
    EXPECT_EQ(machine.error().where->line, line);
  }
  const auto broken = ParseMachineFile("family = 'optimo'\nprofile = = 1\n", "m.toml");
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().where->line, 2);
  EXPECT_EQ(broken.error().where->column, 11);
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
  const auto logical = [](int index, double at, int value) {
    return "inputs { virtual_time_ns: " + std::to_string(FromSeconds(at).count()) +
           " kind: KIND_LOGICAL_INPUT index: " + std::to_string(index) +
           " value: " + std::to_string(value) + " } ";
  };
  ExpectMessage(
      options,
      logical(0, 0, 1) + logical(99, 0.5, 0) +
          "inputs { virtual_time_ns: 1000000000 kind: KIND_ANALOGUE_INPUT index: 7 value: -2.5 } "
          "inputs { virtual_time_ns: 2000000000 kind: KIND_DOOR value: 1 } inputs { virtual_time_ns: 3000000000 kind: KIND_DOOR } "
          "inputs { virtual_time_ns: 4000000000 kind: KIND_START } inputs { virtual_time_ns: 5000000000 kind: KIND_START } "
          "inputs { virtual_time_ns: 6000000000 kind: KIND_HOLD } inputs { virtual_time_ns: 7000000000 kind: KIND_STOP } "
          "inputs { virtual_time_ns: 8000000000 kind: KIND_EMERGENCY_STOP } "
          "inputs { virtual_time_ns: 9000000000 kind: KIND_OVERRIDE value: 145 } " +
          logical(1, 10, 1) + logical(1, 11, 1) + logical(1, 12, 1) + logical(1, 13, 0) +
          logical(1, 14, 0));
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
           {"1 IL[1] = maybe", 1, 0, "the value is no number, ON, OFF, OPEN or CLOSED"},
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

TEST(InputValue, AnaloguesAreNumbers) {
  v1::ScriptedInput input;
  input.set_kind(v1::ScriptedInput::KIND_ANALOGUE_INPUT);
  input.set_value(1e300);
  EXPECT_TRUE(CheckInputValue(input, 145.0));
  input.set_value(std::numeric_limits<double>::infinity());
  ASSERT_FALSE(CheckInputValue(input, 145.0));
  EXPECT_EQ(CheckInputValue(input, 145.0).error().code, ErrorCode::kCellInvalidArgument);
  input.set_kind(v1::ScriptedInput::KIND_OVERRIDE);
  EXPECT_FALSE(CheckInputValue(input, 145.0));
  input.set_value(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(CheckInputValue(input, 145.0));
}

// FIPS 180-4: the message "abc", the empty one, and one of more than a block.
TEST(Sha256, KnownDigests) {
  EXPECT_EQ(Sha256Hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256Hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  Sha256 digest;
  digest.Add("abcdbcdecdefdefgefghfghighij");
  digest.Add("hijkijkljklmklmnlmnomnopnopq");
  EXPECT_EQ(digest.Hex(), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, IsReadInEitherCase) {
  EXPECT_EQ(
      ReadSha256(std::string(32, 'A') + std::string(16, 'F') + std::string(8, '0') +
                 std::string(8, '9')),
      std::string(32, 'a') + std::string(16, 'f') + std::string(8, '0') + std::string(8, '9'));
  EXPECT_EQ(ReadSha256(std::string(64, 'f')), std::string(64, 'f'));
  EXPECT_FALSE(ReadSha256(std::string(63, 'a')));
  EXPECT_FALSE(ReadSha256(std::string(65, 'a')));
  for (const char wrong : {'g', 'G', '/', ':', '@', '`'}) {
    EXPECT_FALSE(ReadSha256(std::string(63, 'a') + wrong)) << wrong;
  }
}

// The same message gives the same bytes and text, whatever the order in which its map was filled.
TEST(Encoding, IsStable) {
  v1::RunReport one, other;
  for (const char* name : {"A", "B", "C", "D", "E"}) (*one.mutable_variables())[name] = name;
  for (const char* name : {"E", "C", "A", "D", "B"}) (*other.mutable_variables())[name] = name;
  EXPECT_EQ(StableBytes(one), StableBytes(other));
  v1::RunReport back;
  ASSERT_TRUE(back.ParseFromString(StableBytes(one)));
  EXPECT_EQ(back.variables().at("C"), "C");
  EXPECT_EQ(StableJson(one, false), StableJson(other, false));
  v1::Outcome outcome;
  outcome.set_code("X");
  EXPECT_EQ(
      StableJson(outcome, false),
      R"({"kind":"KIND_UNSPECIFIED","code":"X","symbol":"","message":"","advice":"","verdict":"VERDICT_UNSPECIFIED","reasons":[],"confirmation":"END_CONFIRMATION_UNSPECIFIED"})");
  EXPECT_NE(StableJson(outcome, true)->find("\n \"code\": \"X\""), std::string::npos);
}

// A list of 101 entries is printed entry by entry: the text is what the printer of protobuf makes.
TEST(StableJson, ALongListIsPrintedTheSame) {
  for (const int count : {99, 100, 101, 250}) {
    v1::RunReport report;
    report.set_family("a \"steps\":[ that is none, {");
    (*report.mutable_variables())["steps"] = "\"steps\":[]";
    report.mutable_outcome()->set_message("\"steps\":[");
    for (int n = 0; n < count; ++n) {
      report.add_steps()->set_step(n);
      auto& finding = *report.add_diagnostics();
      finding.set_message("one\n\"of\" {many]");
      finding.mutable_place()->set_line(n);
    }
    for (const bool whitespace : {false, true}) {
      google::protobuf::util::JsonPrintOptions options;
      options.always_print_primitive_fields = true;
      options.add_whitespace = whitespace;
      std::string whole;
      ASSERT_TRUE(google::protobuf::util::MessageToJsonString(report, &whole, options).ok());
      EXPECT_EQ(StableJson(report, whitespace), whole) << count;
    }
  }
}

// "Sun Nov 22 16:10:16 2026": 24 characters, and a date of our days.
TEST(HeaderDate, HasItsForm) {
  const std::string date = HeaderDate();
  std::tm read{};
  const char* end = ::strptime(date.c_str(), "%a %b %d %H:%M:%S %Y", &read);
  ASSERT_NE(end, nullptr) << date;
  EXPECT_EQ(*end, '\0');
  EXPECT_EQ(date.size(), 24U);
  EXPECT_GE(read.tm_year, 126);
}

}  // namespace
}  // namespace rmlcell::bridge
