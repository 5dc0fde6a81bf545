// What an off-line tool says of one file: for people, and as one object for programs.
#include "clients/cli/tool_answer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/clients/cli/cli_folder.h"
#include "tests/engine/core/untold.h"

namespace rmlcell::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;

Diagnostic FindingAt(int line, Severity severity) {
  return {.code = ErrorCode::kNameUndeclared,
          .severity = severity,
          .detail = "SPEDE",
          .file = "12.S",
          .where = {.line = line, .column = 1, .length = 5}};
}

class ToolAnswerTest : public testing::Test {
 protected:
  // The one line that an answer as JSON is.
  static json ObjectOf(const Told& told) {
    EXPECT_EQ(told.errors, "");
    EXPECT_EQ(told.output.find('\n'), told.output.size() - 1) << told.output;
    return json::parse(told.output, nullptr, false);
  }
  static std::vector<std::string> KeysOf(const json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.push_back(key);
    return keys;
  }
  using Keys = std::vector<std::string>;

  CliFolder folder;
  ToolAnswer plain{"12.S", false};
  ToolAnswer as_json{"12.S", true};
};

TEST_F(ToolAnswerTest, AResultGoesIntoItsFileWithAWordAboutIt) {
  const std::string output = folder.File("12.O");
  const Told told = Hear([&] { return plain.Deliver("bytes", output, "object of 5 bytes"); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, output + ": object of 5 bytes\n");
  EXPECT_EQ(told.errors, "");
  EXPECT_EQ(folder.Read("12.O"), "bytes");
}

TEST_F(ToolAnswerTest, AResultForStandardOutputStandsThereAlone) {
  const Told told =
      Hear([&] { return plain.Deliver(std::string("a\0b", 3), "-", "object of 3 bytes"); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, std::string("a\0b", 3));
  EXPECT_EQ(told.errors, "");
}

TEST_F(ToolAnswerTest, TheObjectSaysWhereTheResultIs) {
  const std::string output = folder.File("12.O");
  const Told told = Hear([&] { return as_json.Deliver("bytes", output, "object of 5 bytes"); });
  EXPECT_EQ(told.exit_code, 0);
  const json answer = ObjectOf(told);
  EXPECT_EQ(KeysOf(answer), (Keys{"bytes", "file", "findings", "ok", "output", "text"}));
  EXPECT_EQ(answer["file"], "12.S");
  EXPECT_EQ(answer["ok"], true);
  EXPECT_EQ(answer["output"], output);
  EXPECT_EQ(answer["bytes"], 5);
  EXPECT_EQ(answer["text"], "object of 5 bytes");
  EXPECT_EQ(answer["findings"]["ok"], true);
  EXPECT_EQ(answer["findings"]["diagnostics"], json::array());
  EXPECT_EQ(folder.Read("12.O"), "bytes");
}

TEST_F(ToolAnswerTest, TheObjectHoldsWhatGoesToStandardOutput) {
  const Told told = Hear([&] { return as_json.Deliver("SPEED 20\n\xFF", "-", "a source"); });
  EXPECT_EQ(told.exit_code, 0);
  const json answer = ObjectOf(told);
  EXPECT_EQ(KeysOf(answer), (Keys{"content", "file", "findings", "ok", "text"}));
  EXPECT_EQ(answer["content"], "SPEED 20\n?");  // JSON is UTF-8
  EXPECT_EQ(answer["ok"], true);
}

TEST_F(ToolAnswerTest, AFileThatCannotBeWrittenIsRefusedWithAndWithoutJson) {
  const std::string output = folder.File("none/12.O");
  for (ToolAnswer* answer : {&plain, &as_json}) {
    const Told told = Hear([&] { return answer->Deliver("bytes", output, "text"); });
    EXPECT_EQ(told.exit_code, 2);
    EXPECT_EQ(told.output, "");
    EXPECT_THAT(told.errors, HasSubstr("rmlcell: CELL-E9023: "));
    EXPECT_THAT(told.errors, HasSubstr(output));
  }
}

TEST_F(ToolAnswerTest, WhatIsWrittenAlreadyIsNotWrittenAgain) {
  const std::string output = folder.File("12.O");
  Told told = Hear([&] { return plain.Written("bytes", output, "as it was", 1); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, output + ": as it was\n");
  told = Hear([&] { return as_json.Written("bytes", output, "as it was", 1); });
  EXPECT_EQ(told.exit_code, 1);
  const json answer = ObjectOf(told);
  EXPECT_EQ(answer["ok"], false);  // whoever reads it alone sees the exit code
  EXPECT_EQ(answer["bytes"], 5);
  EXPECT_TRUE(folder.Names().empty());
}

TEST_F(ToolAnswerTest, FindingsOfPeopleGoToStandardErrorAtOnce) {
  const Told told = Hear([&] {
    plain.Found({FindingAt(2, Severity::kCompile)}, Untold(7, ErrorCode::kNameUndeclared, 9),
                "STOP\nSPEDE 20\n");
    return plain.Failed();
  });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("12.S:2:1: error OPT-E7011: SPEDE"));
  EXPECT_THAT(told.errors,
              HasSubstr("\n  SPEDE 20\n  ^~~~~\nand 7 more OPT-E7011, lines 9 to 15\n"));
}

TEST_F(ToolAnswerTest, FindingsOfSeveralFilesStandInOneObject) {
  const Told told = Hear([&] {
    as_json.Found({FindingAt(2, Severity::kAdvice)}, Untold(3), "");
    as_json.Found({FindingAt(5, Severity::kCompile), FindingAt(6, Severity::kAdvice)}, Untold(4),
                  "");
    return as_json.Failed();
  });
  EXPECT_EQ(told.exit_code, 1);
  const json answer = ObjectOf(told);
  EXPECT_EQ(KeysOf(answer), (Keys{"file", "findings", "ok"}));
  EXPECT_EQ(answer["ok"], false);
  const json& findings = answer["findings"];
  EXPECT_EQ(findings["ok"], false);
  EXPECT_EQ(findings["diagnosticsDropped"], "7");  // int64, as JSON of protobuf writes it
  ASSERT_EQ(findings["diagnostics"].size(), 3U);
  EXPECT_EQ(findings["diagnostics"][0]["place"]["line"], 2);
  EXPECT_EQ(findings["diagnostics"][1]["place"]["line"], 5);
  EXPECT_EQ(findings["diagnostics"][2]["code"], "OPT-E7011");
}

// An answer with advice is good; findings say what stands in the way, not what came of it.
TEST_F(ToolAnswerTest, AdviceStandsInNobodysWay) {
  const Told told = Hear([&] {
    as_json.Found({FindingAt(2, Severity::kWarning)}, {}, "");
    return as_json.Deliver("x", "-", {});
  });
  EXPECT_EQ(told.exit_code, 0);
  const json answer = ObjectOf(told);
  EXPECT_EQ(answer["ok"], true);
  EXPECT_EQ(answer["findings"]["ok"], true);
  EXPECT_FALSE(answer.contains("text"));  // none was given
}

TEST_F(ToolAnswerTest, AnErrorIsAFinding) {
  const Error error{ErrorCode::kObjectCorrupt, "ends early", SourceSpan{.line = 4, .column = 2}};
  Told told = Hear([&] { return plain.Failed(error); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("rmlcell: OPT-E7034: "));
  EXPECT_THAT(told.errors, HasSubstr("ends early"));
  told = Hear([&] { return as_json.Failed(error); });
  EXPECT_EQ(told.exit_code, 1);
  const json answer = ObjectOf(told);
  EXPECT_EQ(answer["ok"], false);
  ASSERT_EQ(answer["findings"]["diagnostics"].size(), 1U);
  const json& finding = answer["findings"]["diagnostics"][0];
  EXPECT_EQ(finding["code"], "OPT-E7034");
  EXPECT_EQ(finding["message"], "ends early");
  EXPECT_EQ(finding["place"]["line"], 4);
  EXPECT_EQ(answer["findings"]["ok"], false);
}

TEST_F(ToolAnswerTest, ALineWithoutResult) {
  Told told = Hear([&] { return plain.Say("12.S: as it should be", 0); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "12.S: as it should be\n");
  told = Hear([&] { return plain.Say("", 1); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  told = Hear([&] { return as_json.Say("12.S: would change", 1); });
  EXPECT_EQ(told.exit_code, 1);
  json answer = ObjectOf(told);
  EXPECT_EQ(KeysOf(answer), (Keys{"file", "findings", "ok", "text"}));
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["text"], "12.S: would change");
  EXPECT_EQ(answer["findings"]["ok"], true);
}

TEST_F(ToolAnswerTest, NamesOfAnyBytesAreText) {
  ToolAnswer odd("\xE4.S", true);
  const Told told = Hear([&] { return odd.Written("b", "\xE4.O", "x\xFC", 0); });
  const json answer = ObjectOf(told);
  EXPECT_EQ(answer["file"], "?.S");
  EXPECT_EQ(answer["output"], "?.O");
  EXPECT_EQ(answer["text"], "x?");
}

}  // namespace
}  // namespace rmlcell::cli
