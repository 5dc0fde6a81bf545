#include "clients/cli/usage_error.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <vector>

namespace rmlcell::cli {
namespace {

// What a small command says to a line that it cannot read; empty when it can.
std::string SaidTo(const std::vector<std::string>& line) {
  CLI::App app("", "rmlcell");
  app.require_subcommand(1);
  std::string stock;
  std::vector<std::string> files;
  CLI::App* simulate = app.add_subcommand("simulate");
  simulate->add_option("FILES", files)->required();
  simulate->add_option("--stock", stock);
  simulate->add_flag("--json");
  int slot = 0;
  simulate->add_option("--slot", slot);
  std::string kind;
  simulate->add_option("--kind", kind)->check(CLI::IsMember({"check", "run"}));
  std::vector<std::string> samples;
  simulate->add_option("--samples", samples, "RATE FILE: write samples")
      ->type_size(2)
      ->expected(1)
      ->allow_extra_args(false);
  CLI::App* projects = app.add_subcommand("projects");
  projects->require_subcommand(0, 1);
  projects->fallthrough();
  projects->add_option("--server", stock);
  projects->add_subcommand("list")->add_flag("--all");
  app.add_subcommand("rml1")->require_subcommand(1)->add_subcommand("explain");
  std::vector<std::string> reversed(line.rbegin(), line.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    return UsageText(app, error);
  }
  return {};
}

TEST(UsageText, AnOptionThatIsNoneIsNamedWithTheOneThatWasMeant) {
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--stok", "100x80x10"}),
            "simulate has no option --stok; did you mean --stock? (rmlcell simulate --help)");
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--stok=100x80x10"}),
            "simulate has no option --stok; did you mean --stock? (rmlcell simulate --help)");
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--colour"}),
            "simulate has no option --colour (rmlcell simulate --help)");
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--stock", "1x1x1", "--json"}), "");
}

// Those of the verb that it stands in are options of an inner verb, too, where they fall through.
TEST(UsageText, InnerVerbsKnowTheOptionsOfTheirVerb) {
  EXPECT_EQ(SaidTo({"projects", "list", "--al"}),
            "projects list has no option --al; did you mean --all? (rmlcell projects list --help)");
  EXPECT_EQ(
      SaidTo({"projects", "list", "--sever", "x:1"}),
      "projects list has no option --sever; did you mean --server? (rmlcell projects list --help)");
}

TEST(UsageText, AnOptionInFrontOfItsVerbIsSentBehindIt) {
  EXPECT_EQ(SaidTo({"--stock", "1x1x1", "simulate", "a.rml"}),
            "--stock stands behind the verb: rmlcell simulate --stock (rmlcell simulate --help)");
}

TEST(UsageText, AVerbThatIsNoneIsNamedWithTheOneThatWasMeant) {
  EXPECT_EQ(SaidTo({"rml1", "explian", "a.rml"}),
            "rml1 has no verb 'explian'; did you mean explain? (rmlcell rml1 --help)");
  EXPECT_EQ(SaidTo({"projects", "lsit"}),
            "projects has no verb 'lsit'; did you mean list? (rmlcell projects --help)");
  CLI::App app("", "rmlcell");
  app.add_subcommand("simulate");
  EXPECT_EQ(NoSuchVerb(app, "simulat"),
            "there is no verb 'simulat'; did you mean simulate? (rmlcell --help)");
  EXPECT_EQ(NoSuchVerb(app, "a\tb"), "there is no verb 'a\\x09b' (rmlcell --help)");
}

TEST(UsageText, WhatIsMissingIsSaidWithWhereToRead) {
  EXPECT_EQ(SaidTo({"simulate"}), "FILES is required (rmlcell simulate --help)");
  EXPECT_EQ(SaidTo({"rml1"}), "rml1 needs a verb: explain (rmlcell rml1 --help)");
  EXPECT_EQ(SaidTo({}), "rmlcell needs a verb: simulate, projects, rml1 (rmlcell --help)");
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--samples", "10"}),
            "--samples wants more: RATE FILE: write samples (rmlcell simulate --help)");
}

// More of them than 12 are read in the help.
TEST(UsageText, FewVerbsAreListed) {
  const auto said = [](int verbs) {
    CLI::App app("", "rmlcell");
    app.require_subcommand(1);
    for (int verb = 0; verb < verbs; ++verb) app.add_subcommand("v" + std::to_string(verb));
    try {
      app.parse(std::vector<std::string>{});
    } catch (const CLI::ParseError& error) {
      return UsageText(app, error);
    }
    return std::string();
  };
  EXPECT_EQ(said(12),
            "rmlcell needs a verb: v0, v1, v2, v3, v4, v5, v6, v7, v8, v9, v10, v11 "
            "(rmlcell --help)");
  EXPECT_EQ(said(13), "rmlcell needs a verb (rmlcell --help)");
}

TEST(UsageText, AValueThatIsNoneIsShown) {
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--slot", "x"}),
            "--slot: 'x' is no number (rmlcell simulate --help)");
  EXPECT_EQ(SaidTo({"simulate", "a.rml", "--kind", "chek"}),
            "--kind: 'chek' is none of check, run; did you mean check? (rmlcell simulate --help)");
}

// What the library says in other words than those is passed on as it is.
TEST(UsageText, OtherWordsOfTheLibraryStay) {
  const CLI::App app("", "rmlcell");
  const auto said = [&app](const CLI::Error& error) { return UsageText(app, error); };
  EXPECT_EQ(said(CLI::ConversionError("--json: too many inputs for a flag")),
            "--json: too many inputs for a flag (rmlcell --help)");
  EXPECT_EQ(said(CLI::ValidationError("--kind", "odd}")), "--kind: odd} (rmlcell --help)");
  EXPECT_EQ(said(CLI::ValidationError("--kind", "odd not in {check} here")),
            "--kind: odd not in {check} here (rmlcell --help)");
  EXPECT_EQ(said(CLI::ValidationError("odd not in {check}")),
            "odd not in {check} (rmlcell --help)");
}

}  // namespace
}  // namespace rmlcell::cli
