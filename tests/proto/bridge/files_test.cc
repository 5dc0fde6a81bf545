#include "proto/bridge/files.h"

#include <google/protobuf/util/json_util.h>
#include <google/rpc/status.pb.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
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
          {"sources = 1\n", 1,
           "m.toml:1: unknown key sources; there are family, profile, name, [parameters], [sources]"},
          {"[colours]\nred = 1\n", 1,
           "m.toml:1: unknown key colours; there are family, profile, name, [parameters], [sources]"},
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
  for (const char* name : {"A", "B", "C", "D", "E"}) (*one.mutable_parameters())[name] = name;
  for (const char* name : {"E", "C", "A", "D", "B"}) (*other.mutable_parameters())[name] = name;
  EXPECT_EQ(StableBytes(one), StableBytes(other));
  v1::RunReport back;
  ASSERT_TRUE(back.ParseFromString(StableBytes(one)));
  EXPECT_EQ(back.parameters().at("C"), "C");
  EXPECT_EQ(StableJson(one, false), StableJson(other, false));
  v1::Outcome outcome;
  outcome.set_code("X");
  EXPECT_EQ(
      StableJson(outcome, false),
      R"({"kind":"KIND_UNSPECIFIED","code":"X","symbol":"","message":"","advice":"","verdict":"VERDICT_UNSPECIFIED","reasons":[],"confirmation":"END_CONFIRMATION_UNSPECIFIED","arguments":[]})");
  EXPECT_NE(StableJson(outcome, true)->find("\n \"code\": \"X\""), std::string::npos);
}

// A list of 101 entries is printed entry by entry: the text is what the printer of protobuf makes.
TEST(StableJson, ALongListIsPrintedTheSame) {
  for (const int count : {99, 100, 101, 250}) {
    v1::RunReport report;
    report.set_family("a \"steps\":[ that is none, {");
    (*report.mutable_parameters())["steps"] = "\"steps\":[]";
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

// Whichever list it is, and whatever stands before it.
TEST(StableJson, EachLongListIsPrintedTheSame) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  const auto expect_same = [&](const google::protobuf::Message& message, const std::string& name) {
    std::string whole;
    EXPECT_TRUE(google::protobuf::util::MessageToJsonString(message, &whole, options).ok());
    EXPECT_EQ(StableJson(message, false), whole) << name;
  };
  const google::protobuf::Descriptor& fields = *v1::RunReport::descriptor();
  for (int i = 0; i < fields.field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *fields.field(i);
    if (!field.is_repeated() || field.is_map() ||
        field.cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE)
      continue;
    v1::RunReport report;
    for (int n = 0; n < 101; ++n) report.GetReflection()->AddMessage(&report, &field);
    expect_same(report, field.name());
  }
  // Numbers are no list of messages, however many they are.
  v1::SeriesTable::Column column;
  for (int n = 0; n < 101; ++n) column.add_low(0.5F * static_cast<float>(n));
  expect_same(column, "low");
}

// Nor is a map.
TEST(StableJson, ALargeMapIsPrinted) {
  v1::RunReport report;
  for (int n = 0; n < 101; ++n) (*report.mutable_parameters())["P" + std::to_string(n)] = "v";
  const std::optional<std::string> json = StableJson(report, false);
  ASSERT_TRUE(json);
  v1::RunReport back;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(*json, &back).ok());
  EXPECT_EQ(StableBytes(back), StableBytes(report));
}

// A detail of a type that nobody here knows has no text, and neither has what it stands in, as an
// entry of a long list, too.
TEST(StableJson, AnUnknownTypeHasNone) {
  for (const int known : {0, 1, 200}) {
    google::rpc::Status rich;
    for (int n = 0; n < known; ++n) rich.add_details()->PackFrom(v1::Outcome());
    EXPECT_TRUE(StableJson(rich, false)) << known;
    google::protobuf::Any& unknown = *rich.add_details();
    unknown.set_type_url("types.example/shop.Detail");
    unknown.set_value("f");
    for (const bool whitespace : {false, true})
      EXPECT_EQ(StableJson(rich, whitespace), std::nullopt) << known;
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
