// `rmlcell parameters`: what it prints is a machine file that says the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "clients/cli/local.h"
#include "engine/core/catalogue.h"
#include "engine/families/families.h"
#include "proto/bridge/files.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Name and value of each parameter, as text.
std::map<std::string, std::string> ValuesOf(const Result<machine::Parameters>& parameters) {
  std::map<std::string, std::string> values;
  if (!parameters) {
    ADD_FAILURE() << parameters.error().detail;
    return values;
  }
  for (const machine::ParameterInfo& info : parameters->table()) {
    const machine::ParameterValue value{
        .name = info.name,
        .value = info.choices.empty()
                     ? std::variant<double, std::string_view>(parameters->Number(info.name))
                     : parameters->Word(info.name)};
    values.emplace(info.name, value.Text());
  }
  return values;
}

std::string Listed(const std::string& family, const std::string& profile, bool as_json = false) {
  const Told told = Hear([&] { return ListParameters(family, profile, as_json); });
  EXPECT_EQ(told.exit_code, 0) << family << " " << profile;
  EXPECT_EQ(told.errors, "");
  return told.output;
}

// docs/files.md, "Machine file".
TEST(ListParameters, EveryProfileIsPrintedAsAMachineFileThatSaysTheSame) {
  for (const machine::MachineFamily* family : families::Families()) {
    const std::string id(family->info().id);
    std::vector<std::string> profiles{""};
    for (const machine::MachineProfile& profile : family->profiles())
      profiles.emplace_back(profile.id);
    for (const std::string& profile : profiles) {
      SCOPED_TRACE(id + " " + profile);
      const auto file = bridge::ParseMachineFile(Listed(id, profile), "printed.toml");
      ASSERT_TRUE(file) << file.error().detail;
      EXPECT_EQ(file->family, id);
      EXPECT_EQ(file->profile, profile);
      EXPECT_EQ(file->parameters.size(), family->parameters().size());
      const auto meant = ValuesOf(machine::MakeParameters(*family, profile, {}));
      EXPECT_EQ(ValuesOf(machine::MakeParameters(*family, profile, file->parameters)), meant);
      // The values stand there by themselves, not for what the profile adds to them.
      EXPECT_EQ(ValuesOf(machine::MakeParameters(*family, "", file->parameters)), meant);
    }
  }
}

TEST(ListParameters, EachIsToldWithUnitAndRange) {
  const std::string optimo = Listed("optimo", "pw-1993");
  EXPECT_THAT(optimo, HasSubstr("\nfamily = \"optimo\"\nprofile = \"pw-1993\"\n"));
  EXPECT_THAT(optimo,
              HasSubstr("# tip speed of SPEED 100 (1 to 2000 mm/s; OPT-2.34)\nVMAX = 500\n"));
  EXPECT_THAT(optimo, HasSubstr("(one of ROBOT ABSOL; OPT-2.09)\nCOORD_DEFAULT = \"ABSOL\"\n"));
  // Without a profile those that there are stand in comments.
  const std::string none = Listed("optimo", "");
  EXPECT_THAT(none, HasSubstr("\n# profile = \"pw-1993\"   # "));
  EXPECT_THAT(none, HasSubstr("\nCOORD_DEFAULT = \"ROBOT\"\n"));
}

TEST(ListParameters, WithoutAFamilyAllFamiliesAndProfilesAreListed) {
  const std::string text = Listed("", "");
  const json object = json::parse(Listed("", "", true), nullptr, false);
  std::vector<std::string> ids;
  for (const json& family : object["families"]) ids.push_back(family["family"]);
  EXPECT_EQ(ids, (std::vector<std::string>{"optimo", "rml1"}));
  for (const machine::MachineFamily* family : families::Families()) {
    EXPECT_THAT(text, HasSubstr(std::string(family->info().id) + "  " +
                                std::string(family->info().title) + "\n"));
    for (const machine::MachineProfile& profile : family->profiles())
      EXPECT_THAT(text, HasSubstr("# profile = \"" + std::string(profile.id) + "\""));
  }
  EXPECT_EQ(object["families"][1]["profiles"].size(), families::Families()[1]->profiles().size());
}

TEST(ListParameters, AsJsonNumbersHaveRangesAndWordsChoices) {
  const json mill = json::parse(Listed("rml1", "srm-20", true), nullptr, false);
  EXPECT_EQ(mill["family"], "rml1");
  EXPECT_EQ(mill["profile"], "srm-20");
  std::map<std::string, json> values;
  for (const json& one : mill["parameters"]) values[one["name"]] = one;
  EXPECT_EQ(values.at("X_MAX")["value"], 203.2);
  EXPECT_EQ(values.at("X_MAX")["unit"], "mm");
  EXPECT_EQ(values.at("Z_MIN")["minimum"], -10000.0);
  EXPECT_EQ(values.at("Z_MIN")["maximum"], 0.0);
  EXPECT_EQ(values.at("AXES")["value"], "XYZ");
  EXPECT_EQ(values.at("AXES")["choices"], "XYZ XYZA XZA");
  EXPECT_FALSE(values.at("AXES").contains("minimum"));
  EXPECT_FALSE(json::parse(Listed("rml1", "", true), nullptr, false).contains("profile"));
}

TEST(ListParameters, WhatThereIsNotIsRefused) {
  Told told = Hear([] { return ListParameters("lathe", "", false); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9008"));
  told = Hear([] { return ListParameters("rml1", "pw-1993", true); });  // of the other family
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9003"));
}

// A file that is not there keeps nobody from hearing of the others; alone it is wrong use.
TEST(CheckFiles, EachIsHeardOf) {
  const CliFolder folder;
  CheckOptions options;
  options.files = {folder.File("none.S"), folder.Put("a.S", "SPEED 20\n")};
  Told told = Hear([&] { return Check(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9022"));
  EXPECT_THAT(told.output, HasSubstr(folder.File("a.S") + ": GOOD\n"));
  options.json = true;
  told = Hear([&] { return Check(options); });
  EXPECT_EQ(told.exit_code, 1);
  const std::size_t end = told.output.find('\n');
  ASSERT_NE(end, std::string::npos);
  const json none = json::parse(told.output.substr(0, end), nullptr, false);
  EXPECT_EQ(none["ok"], false);
  EXPECT_EQ(none["file"], folder.File("none.S"));
  EXPECT_EQ(none["family"], "optimo");
  EXPECT_EQ(none["diagnostics"][0]["code"], "CELL-E9022");
  EXPECT_EQ(none["diagnostics"][0]["severity"], "SEVERITY_REQUEST");
  EXPECT_EQ(none["diagnostics"][0]["place"]["file"], folder.File("none.S"));
  EXPECT_EQ(json::parse(told.output.substr(end + 1), nullptr, false)["ok"], true);
  options.files.pop_back();
  told = Hear([&] { return Check(options); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
}

// What an error is called, what happened, what the machine does then and what to do about it.
TEST(ExplainCodes, ACodeIsToldInFourLines) {
  const CatalogueEntry& entry = Lookup(ErrorCode::kHoleRadiusZero);
  Told told = Hear([] { return Explain({"348"}, false); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.errors, "");
  EXPECT_EQ(told.output, "OPT-E348  HOLE_RADIUS_ZERO  (" +
                             std::string(SeverityName(entry.severity)) +
                             ")\n  what happened:  " + std::string(entry.when) +
                             "\n  the machine:    " + std::string(SeverityEffect(entry.severity)) +
                             "\n  what to do:     " + std::string(entry.advice) + "\n");
  // One that is none is wrong use, and the others are told all the same.
  told = Hear([] { return Explain({"HOLE_RADIUS_ZER", "348"}, false); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.errors,
            "rmlcell: no error 'HOLE_RADIUS_ZER'; did you mean HOLE_RADIUS_ZERO?; rmlcell explain "
            "without a code lists them all\n");
  EXPECT_THAT(told.output, HasSubstr("OPT-E348  HOLE_RADIUS_ZERO  ("));
  told = Hear([] { return Explain({"348"}, true); });
  EXPECT_EQ(json::parse(told.output, nullptr, false)["code"], "OPT-E348");
  // Without a code all of them, a line each.
  told = Hear([] { return Explain({}, false); });
  EXPECT_EQ(told.exit_code, 0);
  std::size_t lines = 0;
  for (const char c : told.output) lines += c == '\n' ? 1U : 0U;
  EXPECT_EQ(lines, Catalogue().size());
  EXPECT_THAT(told.output,
              HasSubstr("\nOPT-E348  HOLE_RADIUS_ZERO: " + std::string(entry.when) + "\n"));
}

}  // namespace
}  // namespace rmlcell::cli
