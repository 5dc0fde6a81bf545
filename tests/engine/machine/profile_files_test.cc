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
    return none ? std::string() : none.error().detail;
  };
  EXPECT_EQ(said("mdx40"), "no profile 'mdx40'; did you mean mdx-40a or mdx-40a-rotary?");
  EXPECT_EQ(said("mdx-540s"), "no profile 'mdx-540s'; did you mean mdx-540?");
  EXPECT_EQ(said("Roland SRM-20"), "no profile 'Roland SRM-20'; did you mean srm-20?");
  EXPECT_EQ(said("my.toml"), "no profile 'my.toml': a file of one's own goes to --machine");
  EXPECT_TRUE(said("lathe").starts_with("no profile 'lathe'; there are ")) << said("lathe");
  // Nobody named one: it is a machine that there is, and is not said to be named.
  EXPECT_EQ(MakeParameters(mill, "", {})->profile(), "");
  EXPECT_EQ(MakeParameters(mill, "", {})->Number("X_MAX"), 203.2);
}

}  // namespace
}  // namespace rmlcell::machine
