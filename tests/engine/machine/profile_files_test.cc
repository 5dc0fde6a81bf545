#include "engine/machine/profile_files.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "engine/families/families.h"

namespace rmlcell::machine {
namespace {

std::string Fault(std::string_view text) {
  const ProfileText files[] = {{"mine", text}};
  const Result<ProfileFiles> read = ProfileFiles::Read(files);
  if (read) return {};
  EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
  return read.error().detail;
}

TEST(ProfileFiles, HaveNumbersAndWordsWithTheirSources) {
  const ProfileText files[] = {
      {"mine",
       "title = 'My mill'\n[parameters]\nX_MAX = 12.5\nAXES = 'XZA'\nZ2 = 3\n"
       "[sources]\nX_MAX = 'measured'\nAXES = 'seen'\nZ2 = 'estimate'\n"},
      {"bare", "title = 'Nothing of its own'\n"}};
  const Result<ProfileFiles> read = ProfileFiles::Read(files);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->all().size(), 2U);
  const MachineProfile& mine = read->all()[0];
  EXPECT_EQ(mine.id, "mine");
  EXPECT_EQ(mine.title, "My mill");
  std::map<std::string, std::string> values, sources;
  for (const ParameterValue& value : mine.values) {
    values.emplace(value.name, value.Text());
    sources.emplace(value.name, value.source);
  }
  EXPECT_EQ(values,
            (std::map<std::string, std::string>{{"X_MAX", "12.5"}, {"AXES", "XZA"}, {"Z2", "3"}}));
  EXPECT_EQ(sources.at("Z2"), "estimate");
  EXPECT_TRUE(read->all()[1].values.empty());
}

TEST(ProfileFiles, TellWhatIsWrongAndWhere) {
  EXPECT_EQ(Fault("title = 'A'\n[parameters]\nX_MAX = 1\n"), "mine.toml:3: X_MAX has no source");
  EXPECT_EQ(Fault("title = 'A'\n[parameters]\nX = [1]\n"),
            "mine.toml:3: X is no number and no word");
  EXPECT_EQ(Fault("title = 'A'\nspeed = 1\n"), "mine.toml:2: no key speed");
  EXPECT_EQ(Fault("[parameters]\n"), "mine.toml:1: no title");
  EXPECT_EQ(Fault("title = \n").substr(0, 12), "mine.toml:1:");
}

// Each figure of a profile is one that its family has, within its range, and says where it is from.
TEST(ProfileFiles, OfTheMillsAreWhole) {
  const MachineFamily& mill = *families::FindFamily("rml1");
  EXPECT_EQ(mill.profiles().size(), 13U);
  for (const MachineProfile& profile : mill.profiles()) {
    EXPECT_TRUE(MakeParameters(mill, std::string(profile.id), {})) << profile.id;
    for (const ParameterValue& value : profile.values)
      EXPECT_FALSE(value.source.empty()) << profile.id << ' ' << value.name;
  }
}

// "SRM-20" as people write it.
TEST(Profiles, AreFoundByForgivingNames) {
  const MachineFamily& mill = *families::FindFamily("rml1");
  for (const char* name :
       {"srm-20", "SRM-20", "srm20", "Srm_20", "SRM 20", "Roland monoFab SRM-20"}) {
    const Result<Parameters> parameters = MakeParameters(mill, name, {});
    ASSERT_TRUE(parameters) << name;
    EXPECT_EQ(parameters->profile(), "srm-20");
    EXPECT_EQ(parameters->Number("X_MAX"), 203.2);
  }
  EXPECT_FALSE(MakeParameters(mill, "srm-2", {}));
  EXPECT_FALSE(MakeParameters(mill, "srm-200", {}));
  const auto said = [&](const std::string& name) {
    const Result<Parameters> none = MakeParameters(mill, name, {});
    return none ? Detail() : none.error().detail;
  };
  EXPECT_EQ(said("mdx40"), "no profile 'mdx40'; did you mean mdx-40a or mdx-40a-rotary?");
  EXPECT_EQ(said("mdx"),
            "no profile 'mdx'; did you mean mdx-15, mdx-20, mdx-40a, mdx-40a-rotary, mdx-50 or "
            "mdx-540?");
  EXPECT_EQ(said("mdx-540s"), "no profile 'mdx-540s'; did you mean mdx-540?");
  EXPECT_EQ(said("Roland SRM-20"), "no profile 'Roland SRM-20'; did you mean srm-20?");
  EXPECT_EQ(said("my.toml"), "no profile 'my.toml': a file of one's own goes to --machine");
  EXPECT_EQ(said("smr-20"), "no profile 'smr-20'; did you mean srm-20?");
  EXPECT_EQ(said("50"), "no profile '50'; did you mean mdx-50?");
  for (const std::string name : {"lathe", "m"}) {  // one letter is in many names
    EXPECT_TRUE(said(name).starts_with("no profile '" + name + "'; there are ")) << said(name);
  }
  // Nobody named one: it is a machine that there is, and is not said to be named.
  EXPECT_EQ(MakeParameters(mill, "", {})->profile(), "srm-20");
  EXPECT_FALSE(MakeParameters(mill, "", {})->profile_named());
  EXPECT_TRUE(MakeParameters(mill, "srm20", {})->profile_named());
  EXPECT_EQ(MakeParameters(mill, "", {})->Number("X_MAX"), 203.2);
}

// The SRM-20 has 203.2 mm in X and 100 units in a mm; a file that says the same changes nothing.
TEST(Profiles, WhatIsChangedOfThemIsTold) {
  const MachineFamily& mill = *families::FindFamily("rml1");
  const auto used = [&](const std::map<std::string, std::string>& values) {
    auto parameters = MakeParameters(mill, "srm-20", values);
    EXPECT_TRUE(parameters);
    parameters->SetChangedBy("mine.toml");
    return parameters->Used();
  };
  EXPECT_EQ(used({{"X_MAX", "203.2"}}).changes, std::vector<ChangedParameter>{});
  EXPECT_EQ(used({{"X_MAX", "203.2"}}).ChangesText(), "nothing, by mine.toml");
  const MachineUsed two = used({{"X_MAX", "100"}, {"CLAMP_HEIGHT", "5"}});
  ASSERT_EQ(two.changes.size(), 2U);
  EXPECT_EQ(two.changes[1], (ChangedParameter{"X_MAX", "100", "203.2"}));
  EXPECT_EQ(two.changes[0].name, "CLAMP_HEIGHT");
  EXPECT_EQ(two.ChangesText(), "CLAMP_HEIGHT 5 (profile: " + two.changes[0].of_profile +
                                   "), X_MAX 100 (profile: 203.2); by mine.toml");
  EXPECT_EQ(two.profile, "srm-20");
  EXPECT_EQ(MakeParameters(mill, "srm-20", {})->Used().ChangesText(), "");
  // Of a profile that nobody named, and words as well as numbers.
  const MachineFamily& laser = *families::FindFamily("optimo");
  const MachineUsed standard = MakeParameters(laser, "", {{"LASER", "EFA51"}})->Used();
  EXPECT_EQ(standard.profile, "standard");
  EXPECT_FALSE(standard.named);
  EXPECT_EQ(standard.changes, (std::vector<ChangedParameter>{{"LASER", "EFA51", "ARROW"}}));
  EXPECT_EQ(MakeParameters(laser, "efa-51", {})->Used().changes, std::vector<ChangedParameter>{});
}

TEST(Profiles, AMachineOfOnesOwnHasItsNameAndSources) {
  const MachineFamily& mill = *families::FindFamily("rml1");
  auto parameters = MakeParameters(mill, "srm-20", {{"X_MAX", "100"}, {"CLAMP_HEIGHT", "5"}});
  ASSERT_TRUE(parameters);
  parameters->SetChangedBy("mine.toml");
  parameters->SetOwn(
      {.name = "My mill", .sources = {{"x_max", "measured"}, {"Y_MAX", "estimate"}}});
  const MachineUsed used = parameters->Used();
  EXPECT_EQ(used.own_name, "My mill");
  ASSERT_EQ(used.changes.size(), 2U);
  EXPECT_EQ(used.changes[0].source, "");
  EXPECT_EQ(used.changes[1], (ChangedParameter{"X_MAX", "100", "203.2", "measured"}));
  EXPECT_NE(used.ChangesText().find("X_MAX 100 (profile: 203.2; source: measured); by mine.toml"),
            std::string::npos);
  EXPECT_EQ(MachineTitle(mill, "srm-20", true, "My mill"),
            "My mill, based on Roland monoFab SRM-20 (srm-20)");
  EXPECT_EQ(
      MachineTitle(mill, "srm-20", false, "mine.toml"),
      "mine.toml, based on Roland monoFab SRM-20 (srm-20): the default, as it names no profile");
}

TEST(Profiles, ATitleSaysWhenNobodyNamedOne) {
  const MachineFamily& mill = *families::FindFamily("rml1");
  EXPECT_EQ(MachineTitle(mill, "srm-20", true), "Roland monoFab SRM-20 (srm-20)");
  EXPECT_EQ(MachineTitle(mill, "srm-20", false),
            "Roland monoFab SRM-20 (srm-20): no profile was named");
  EXPECT_EQ(MachineTitle(mill, "", false), mill.info().title);
}

// Of a code the most serious of its reasons counts.
TEST(Verdicts, FindingsAreMarked) {
  Judgement judgement;
  judgement.Add({.code = ErrorCode::kRml1Clipped, .verdict = Verdict::kDoubtful});
  judgement.Add({.code = ErrorCode::kRml1Clipped, .verdict = Verdict::kBad});
  judgement.Add({.code = ErrorCode::kRml1NotUnderstood, .verdict = Verdict::kDoubtful});
  std::vector<Diagnostic> findings = {
      {.code = ErrorCode::kRml1Clipped, .severity = Severity::kAdvice},
      {.code = ErrorCode::kRml1NotUnderstood, .severity = Severity::kAdvice},
      {.code = ErrorCode::kHoleRadiusZero, .severity = Severity::kProgram},
      {.code = ErrorCode::kRml1LogCut, .severity = Severity::kAdvice}};
  MarkJudged(judgement, findings);
  EXPECT_EQ(FindingWord(findings[0]), "BAD");
  EXPECT_EQ(FindingWord(findings[1]), "DOUBTFUL");
  EXPECT_EQ(FindingWord(findings[2]), "error");
  EXPECT_EQ(FindingWord(findings[3]), "advice");
  EXPECT_EQ(FormatDiagnostic(findings[0], {}).substr(0, 14), "BAD RML1-E8002");
}

}  // namespace
}  // namespace rmlcell::machine
