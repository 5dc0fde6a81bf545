// Repairs in place, and the patch that shows them.
#include "clients/cli/fix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "clients/cli/local.h"
#include "engine/families/families.h"
#include "proto/bridge/findings.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// SPEDE has a fix, WRONG has none, STYLE is advice without one.
machine::Translation CheckWords(const machine::SourceFile& file) {
  machine::Translation found{.ok = true};
  const auto look = [&](std::string_view word, Severity severity, const std::string& better) {
    for (std::size_t at = file.bytes.find(word); at != std::string_view::npos;
         at = file.bytes.find(word, at + 1)) {
      Diagnostic finding{.code = ErrorCode::kNameUndeclared,
                         .severity = severity,
                         .detail = std::string(word),
                         .file = file.name,
                         .where = {.line = 1, .column = 1}};
      const int length = static_cast<int>(word.size());
      if (!better.empty()) finding.fixes.push_back({static_cast<std::int64_t>(at), length, better});
      found.ok = found.ok && !IsError(severity);
      found.diagnostics.push_back(std::move(finding));
    }
  };
  look("SPEDE", Severity::kCompile, "SPEED");
  look("WRONG", Severity::kCompile, "");
  look("STYLE", Severity::kAdvice, "");
  return found;
}

const machine::MachineFamily& Optimo() { return *families::FindFamily("optimo"); }

// Judged as a check does, of a program without motion.
FixCheck Check(const std::function<machine::Translation(const machine::SourceFile&)>& translate,
               const simulation::MotionCheck& motion = {}) {
  return {translate, [motion](const machine::Translation& left) -> Result<FixCheck::Left> {
            simulation::CheckedProgram check{
                .family = &Optimo(), .slot = 1, .translation = left, .motion = motion};
            const machine::Judgement judgement = simulation::JudgeCheck(check);
            return FixCheck::Left{check, bridge::FindingsOf(check, judgement)};
          }};
}

class FixFileTest : public testing::Test {
 protected:
  // Fixes a file with this text in the folder.
  Told Fix(const std::string& text, const FixOptions& options) {
    const std::string file = folder.Put("a.S", text);
    return Hear([&] { return FixFile(file, text, Check(CheckWords), options); });
  }
  CliFolder folder;
};

TEST_F(FixFileTest, WritesWhatIsRepairedAndSaysSo) {
  const Told told = Fix("SPEDE 20\r\n\tSPEDE 30 ; slow", {});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(folder.Read("a.S"), "SPEED 20\r\n\tSPEED 30 ; slow");
  EXPECT_THAT(told.output, HasSubstr("fixed  " + folder.File("a.S") + ":1:1: error OPT-E7011"));
  EXPECT_TRUE(told.output.ends_with(folder.File("a.S") + ": 2 fixed, GOOD\n")) << told.output;
  EXPECT_EQ(told.errors, "");
}

TEST_F(FixFileTest, TheExitCodeIsThatOfACheckOfTheResult) {
  Told told = Fix("SPEDE 20\nWRONG\n", {});
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(folder.Read("a.S"), "SPEED 20\nWRONG\n");
  EXPECT_THAT(told.output,
              HasSubstr("a.S: 1 fixed, BAD, 1 finding\n  WRONG (OPT-E7011, line 1); "));
  told = Fix("SPEDE 20\nSTYLE\n", {});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr("a.S: 1 fixed, GOOD, 1 finding\n"));
  told = Fix("SPEED 20\n", {});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr("a.S: 0 fixed, GOOD\n"));
}

// The words and the exit code are those of a check of the result, its motion included.
TEST_F(FixFileTest, IsJudgedAsACheckIs) {
  simulation::MotionCheck motion;
  motion.findings = {{.code = ErrorCode::kTargetOutOfTravel,
                      .severity = Severity::kWarning,
                      .detail = "X goes too far",
                      .where = {.line = 1}}};
  motion.reasons = {{.code = ErrorCode::kTargetOutOfTravel,
                     .verdict = machine::Verdict::kDoubtful,
                     .said = "X goes too far"}};
  const std::string file = folder.Put("b.S", "SPEDE 20\n");
  const auto fix = [&](const FixOptions& options) {
    return Hear([&] { return FixFile(file, "SPEDE 20\n", Check(CheckWords, motion), options); });
  };
  const Told told = fix({});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr("1: DOUBTFUL OPT-E7301: X goes too far\n"));
  EXPECT_THAT(told.output,
              HasSubstr("b.S: 1 fixed, DOUBTFUL, 1 finding\n  X goes too far (OPT-E7301)"));
  EXPECT_EQ(fix({.strict = true}).exit_code, 1);
  const json answer = json::parse(fix({.json = true}).output, nullptr, false);
  EXPECT_EQ(answer["findings"]["verdict"], "VERDICT_DOUBTFUL");
}

// The file is not there: writing it would fail, or make it.
TEST_F(FixFileTest, WritesOnlyWhenSomethingChanged) {
  const std::string nowhere = folder.File("none/a.S");
  const auto fix = [&](const std::string& text, const FixOptions& options) {
    return Hear([&] { return FixFile(nowhere, text, Check(CheckWords), options); });
  };
  EXPECT_EQ(fix("SPEED 20\n", {}).exit_code, 0);
  EXPECT_EQ(fix("WRONG\n", {}).exit_code, 1);
  const Told told = fix("SPEDE 20\n", {});
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9023"));
  EXPECT_EQ(fix("SPEDE 20\n", {.dry_run = true}).exit_code, 1);
  EXPECT_TRUE(folder.Names().empty());
}

TEST_F(FixFileTest, ADryRunShowsThePatchAndWritesNothing) {
  const std::string text = "STOP\nSPEDE 20\n";
  Told told = Fix(text, {.dry_run = true});
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(folder.Read("a.S"), text);
  const std::string file = folder.File("a.S");
  EXPECT_EQ(told.output, "--- " + file + "\n+++ " + file + "\n@@ -2 +2 @@\n-SPEDE 20\n+SPEED 20\n");
  told = Fix("SPEED 20\nSTYLE\n", {.dry_run = true});  // nothing would change
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "");
  told = Fix("WRONG\n", {.dry_run = true});
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
}

TEST_F(FixFileTest, AnswersAsAMessage) {
  for (const bool dry_run : {false, true}) {
    const Told told = Fix("SPEDE\nSTYLE", {.dry_run = dry_run, .json = true});
    EXPECT_EQ(told.exit_code, dry_run ? 1 : 0);
    EXPECT_EQ(folder.Read("a.S"), dry_run ? "SPEDE\nSTYLE" : "SPEED\nSTYLE");
    const json answer = json::parse(told.output, nullptr, false);
    EXPECT_EQ(answer["content"], "U1BFRUQKU1RZTEU=");  // SPEED, line end, STYLE
    ASSERT_EQ(answer["fixed"].size(), 1U);
    EXPECT_EQ(answer["fixed"][0]["message"], "SPEDE");
    EXPECT_EQ(answer["findings"]["ok"], true);
    ASSERT_EQ(answer["findings"]["diagnostics"].size(), 1U);
    EXPECT_EQ(answer["findings"]["diagnostics"][0]["message"], "STYLE");
  }
  const json bad =
      json::parse(Fix("WRONG", {.dry_run = false, .json = true}).output, nullptr, false);
  EXPECT_EQ(bad["findings"]["ok"], false);
}

TEST_F(FixFileTest, WhatIsNoTextIsRefusedUnlookedAt) {
  const auto never = [](const machine::SourceFile&) -> machine::Translation {
    ADD_FAILURE() << "it was checked";
    return {};
  };
  const std::map<std::string, std::string> files = {{"a.rml", "PU;"},
                                                    {"a.S", std::string("SPEDE\0", 6)}};
  for (const auto& row : files) {
    const std::string& name = row.first;
    const std::string& text = row.second;
    const std::string file = folder.Put(name, text);
    const Told told = Hear([&] { return FixFile(file, text, Check(never), {}); });
    EXPECT_EQ(told.exit_code, 2) << name;
    EXPECT_EQ(told.output, "");
    EXPECT_TRUE(told.errors.starts_with("rmlcell: CELL-E")) << told.errors;
    EXPECT_EQ(folder.Read(name), text);
  }
}

std::string Hunks(std::string_view before, std::string_view after) {
  const std::string patch = PatchText("f", before, after);
  constexpr std::string_view kHead = "--- f\n+++ f\n";
  EXPECT_TRUE(patch.starts_with(kHead)) << patch;
  return patch.substr(std::min(kHead.size(), patch.size()));
}

// The form of `diff -U0`: a range without lines is named by the line before it.
TEST(PatchText, NamesTheLinesThatDiffer) {
  EXPECT_EQ(PatchText("f", "a\nb\n", "a\nb\n"), "");
  EXPECT_EQ(PatchText("f", "", ""), "");
  EXPECT_EQ(Hunks("a\nb\nc\n", "a\nB\nc\n"), "@@ -2 +2 @@\n-b\n+B\n");
  EXPECT_EQ(Hunks("a\nc\n", "a\nb\nc\n"), "@@ -1,0 +2 @@\n+b\n");
  EXPECT_EQ(Hunks("a\nb\nc\n", "a\nc\n"), "@@ -2 +1,0 @@\n-b\n");
  EXPECT_EQ(Hunks("", "a\nb\n"), "@@ -0,0 +1,2 @@\n+a\n+b\n");
  EXPECT_EQ(Hunks("a\nb\n", ""), "@@ -1,2 +0,0 @@\n-a\n-b\n");
  // Behind a line more, both sides count for themselves.
  EXPECT_EQ(Hunks("a\nb\nc\nd\n", "new\na\nb\nc\nD\n"),
            "@@ -0,0 +1 @@\n+new\n@@ -4 +5 @@\n-d\n+D\n");
}

TEST(PatchText, LineEndsAreLinesOfTheirOwnKind) {
  EXPECT_EQ(Hunks("a\r\n", "a\n"), "@@ -1 +1 @@\n-a\r\n+a\n");
  EXPECT_EQ(Hunks("a", "b"),
            "@@ -1 +1 @@\n-a\n\\ No newline at end of file\n+b\n\\ No newline at end of file\n");
  EXPECT_EQ(Hunks("a", "a\n"), "@@ -1 +1 @@\n-a\n\\ No newline at end of file\n+a\n");
}

// What such a patch makes of a text. Its lines end in line feeds.
std::string Patched(const std::string& before, const std::string& patch) {
  std::vector<std::string> lines;
  std::istringstream text(before), hunks(patch);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  std::string after, line;
  std::size_t taken = 0;
  while (std::getline(hunks, line)) {
    if (line.starts_with("@@ -")) {
      const auto first = static_cast<std::size_t>(std::stoi(line.substr(4)));
      const bool none = line.substr(4, line.find(' ', 4) - 4).ends_with(",0");
      while (taken + (none ? 0 : 1) < first) after += lines.at(taken++) + "\n";
    } else if (line.starts_with("-") && !line.starts_with("---")) {
      EXPECT_EQ(lines.at(taken++), line.substr(1));
    } else if (line.starts_with("+") && !line.starts_with("+++")) {
      after += line.substr(1) + "\n";
    }
  }
  while (taken < lines.size()) after += lines[taken++] + "\n";
  return after;
}

// However far the texts are apart: also beyond the lines that are searched for where they agree.
TEST(PatchText, MakesTheOneTextOfTheOther) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    std::string before, after;
    const unsigned lines = round % 20 == 0 ? 500 : 12;
    for (unsigned i = 0; i < lines; ++i) {
      const std::string line(1, static_cast<char>('a' + random() % 4));
      if (random() % 4 != 0) before += line + "\n";
      if (random() % 4 != 0) after += line + "\n";
    }
    EXPECT_EQ(Patched(before, PatchText("f", before, after)), after) << round;
  }
  std::string ones, twos;
  for (int i = 0; i < 300; ++i) {
    ones += "one " + std::to_string(i) + "\n";
    twos += "two " + std::to_string(i) + "\n";
  }
  EXPECT_EQ(Patched(ones, PatchText("f", ones, twos)), twos);
}

// Where both agree again within 399 lines that one of them has more, the rest is no difference.
TEST(PatchText, LooksForWhereBothAgreeAgain) {
  const auto differs = [](int lines) {
    std::string more;
    for (int i = 0; i < lines; ++i) more += "x\n";
    const std::string patch = Hunks("a\nb\n", more + "a\nb\n");
    return patch.substr(0, patch.find('\n'));
  };
  EXPECT_EQ(differs(399), "@@ -0,0 +1,399 @@");
  EXPECT_EQ(differs(400), "@@ -1,2 +1,402 @@");
}

// OPT-2.35, OPT-7.91: errors that stay in one file keep nobody from repairing the next one.
TEST_F(FixFileTest, TheNextFileIsRepairedAllTheSame) {
  CheckOptions options;
  options.files = {folder.Put("bad.S", "SPEED 101\n"), folder.Put("good.S", "SPEDE 20\n")};
  options.fix = true;
  const Told told = Hear([&] { return cli::Check(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(folder.Read("bad.S"), "SPEED 101\n");
  EXPECT_EQ(folder.Read("good.S"), "SPEED 20\n");
  EXPECT_THAT(told.output, HasSubstr("good.S: 1 fixed, GOOD\n"));
}

}  // namespace
}  // namespace rmlcell::cli
