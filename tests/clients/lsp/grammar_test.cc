// The TextMate grammar of clients/vscode against the table of the language.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "engine/optimo/language/words.h"

namespace rmlcell::lsp {
namespace {

using optimo::WordGroup;

nlohmann::json Grammar() {
  std::ifstream file(std::string(RMLCELL_SOURCE_DIR) +
                     "/clients/vscode/syntaxes/optimo-rml.tmLanguage.json");
  EXPECT_TRUE(file);
  return nlohmann::json::parse(file);
}

const std::map<std::string, WordGroup>& Rules() {
  static const std::map<std::string, WordGroup> rules = {
      {"instructions", WordGroup::kInstruction}, {"ignored", WordGroup::kIgnored},
      {"unavailable", WordGroup::kUnavailable},  {"attributes", WordGroup::kAttribute},
      {"choices", WordGroup::kChoice},           {"flow", WordGroup::kFlow},
      {"constants", WordGroup::kConstant},       {"variables", WordGroup::kVariable},
      {"functions", WordGroup::kFunction},       {"operators", WordGroup::kOperator}};
  return rules;
}

// The words between "(?:" and ")".
std::set<std::string> WordsOf(const std::string& match) {
  std::set<std::string> words;
  const std::size_t begin = match.find("(?:") + 3;
  const std::string list = match.substr(begin, match.find(')', begin) - begin);
  const std::regex word("[^|]+");
  for (std::sregex_iterator at(list.begin(), list.end(), word), end; at != end; ++at)
    words.insert(at->str());
  return words;
}

TEST(Grammar, EveryGroupHasTheWordsOfTheLanguageAndNoOthers) {
  const nlohmann::json grammar = Grammar();
  std::size_t total = 0;
  for (const auto& [rule, group] : Rules()) {
    std::set<std::string> wanted;
    for (const optimo::WordInfo& row : optimo::ReservedWords()) {
      if (row.group == group) wanted.insert(std::string(row.text));
    }
    EXPECT_EQ(WordsOf(grammar["repository"][rule]["match"]), wanted) << rule;
    total += wanted.size();
  }
  EXPECT_EQ(total, optimo::ReservedWords().size());
}

TEST(Grammar, WordsAreFoundWithoutCaseAndAsWholeWords) {
  const nlohmann::json grammar = Grammar();
  for (const auto& [rule, group] : Rules()) {
    const std::string match = grammar["repository"][rule]["match"];
    EXPECT_EQ(match.rfind("(?i)", 0), 0U) << rule;
    EXPECT_NE(match.find("\\b(?:"), std::string::npos) << rule;
    EXPECT_EQ(match.substr(match.size() - 2), "\\b") << rule;
  }
}

TEST(Grammar, EveryPatternThatIsIncludedIsThereAndTheOtherWayRound) {
  const nlohmann::json grammar = Grammar();
  std::set<std::string> included;
  for (const auto& pattern : grammar["patterns"])
    included.insert(pattern["include"].get<std::string>().substr(1));
  std::set<std::string> there;
  for (const auto& [name, rule] : grammar["repository"].items()) there.insert(name);
  EXPECT_EQ(included, there);
}

// OPT-1.23, OPT-7.15: what ECMAScript can say of the two patterns with numbers.
TEST(Grammar, SequenceNumbersAndJumpsAreCaptured) {
  const nlohmann::json grammar = Grammar();
  const auto expression = [&](const char* rule) {
    std::string match = grammar["repository"][rule]["match"];
    if (match.rfind("(?i)", 0) == 0) match.erase(0, 4);
    return std::regex(match, std::regex::icase);
  };
  std::smatch found;
  const std::string label = "  10 MOVE";
  ASSERT_TRUE(std::regex_search(label, found, expression("label")));
  EXPECT_EQ(found[1], "10");
  const std::string jump = "if VL[0] then 50 else 60";
  ASSERT_TRUE(std::regex_search(jump, found, expression("jumps")));
  EXPECT_EQ(found[2], "50");
}

}  // namespace
}  // namespace rmlcell::lsp
