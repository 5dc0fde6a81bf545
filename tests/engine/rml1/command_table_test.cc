#include "engine/rml1/command_table.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace rmlcell::rml1 {
namespace {

std::set<std::string> NamesOf(Family family) {
  std::set<std::string> names;
  for (const CommandRow& row : CommandTable()) {
    if (row.family == family && row.skip_set == kSkipNothing) names.insert(std::string(row.name));
  }
  return names;
}

// RML1-1.01, RML1-1.02, RML1-1.03, RML1-8.02: the three families, whole.
TEST(CommandTable, HasTheThreeFamilies) {
  EXPECT_EQ(NamesOf(Family::kMode1),
            (std::set<std::string>{"D", "F", "H", "I", "M", "R", "V", "W", "Z", "@", "^"}));
  EXPECT_EQ(NamesOf(Family::kMode2),
            (std::set<std::string>{"DF", "IN", "PA", "PD", "PR", "PU", "VS"}));
  EXPECT_EQ(NamesOf(Family::kCommon), (std::set<std::string>{"!DW", "!MC", "!NR", "!PZ", "!RC",
                                                             "!VZ", "!ZM", "!ZO", "!ZZ", "!ZE"}));
}

// RML1-1.15: of all pairs of letters only the seven are mode-2 commands; the lookup agrees with the
// rows for every name.
TEST(CommandTable, FindsEveryNameAndNoOther) {
  std::set<std::string> pairs;
  std::set<std::string> commons;
  std::set<std::string> letters;
  for (char first = 'A'; first <= 'Z'; ++first) {
    const CommandRow* one = FindMode1(first, kSkipNothing);
    if (one != nullptr) letters.insert(std::string(one->name));
    for (char second = 'A'; second <= 'Z'; ++second) {
      const CommandRow* pair = FindMode2(first, second);
      if (pair != nullptr) pairs.insert(std::string(pair->name));
      const CommandRow* common = FindCommon(first, second, kSkipNothing);
      if (common != nullptr) commons.insert(std::string(common->name));
    }
  }
  EXPECT_EQ(pairs, NamesOf(Family::kMode2));
  EXPECT_EQ(commons, NamesOf(Family::kCommon));
  letters.insert({"@", "^"});  // no letters
  EXPECT_EQ(letters, NamesOf(Family::kMode1));
}

// RML1-2.12: exactly the first letters of mode-2 names need a look at the next letter.
TEST(CommandTable, KnowsTheFirstLettersOfPairs) {
  std::set<char> firsts;
  for (const std::string& name : NamesOf(Family::kMode2)) firsts.insert(name[0]);
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    EXPECT_EQ(BeginsMode2(letter), firsts.contains(letter)) << letter;
  }
}

// RML1-5C.01, RML1-5C.02, RML1-5C.05: mode and tool state as guideline 5-3 lists them.
TEST(CommandTable, ListsEffectsOnModeAndTool) {
  std::set<std::string> absolute;
  std::set<std::string> relative;
  std::set<std::string> up;
  std::set<std::string> down;
  for (const CommandRow& row : CommandTable()) {
    const std::string name(row.name);
    if (row.mode == ModeChange::kAbsolute) absolute.insert(name);
    if (row.mode == ModeChange::kRelative) relative.insert(name);
    if (row.tool == ToolChange::kUp) up.insert(name);
    if (row.tool == ToolChange::kDown) down.insert(name);
  }
  EXPECT_EQ(absolute, (std::set<std::string>{"M", "D", "H", "PA", "DF", "IN"}));
  EXPECT_EQ(relative, (std::set<std::string>{"I", "R", "PR"}));
  EXPECT_EQ(up, (std::set<std::string>{"H", "M", "R", "IN", "PU"}));
  EXPECT_EQ(down, (std::set<std::string>{"D", "I", "PD"}));
}

// RML1-9.48: vendor names are commands only where the profile skips them.
TEST(CommandTable, HidesVendorNames) {
  EXPECT_EQ(FindMode1('J', kSkipNothing), nullptr);
  EXPECT_EQ(FindCommon('C', 'O', kSkipToolChange), nullptr);
  EXPECT_EQ(FindCommonDigit('1', kSkipVPanel), nullptr);
  ASSERT_NE(FindMode1('J', kSkipToolChange), nullptr);
  ASSERT_NE(FindCommon('C', 'O', kSkipVPanel), nullptr);
  ASSERT_NE(FindCommonDigit('0', kSkipPnc3000), nullptr);
  EXPECT_EQ(FindCommonDigit('2', kSkipPnc3000), nullptr);
}

}  // namespace
}  // namespace rmlcell::rml1
