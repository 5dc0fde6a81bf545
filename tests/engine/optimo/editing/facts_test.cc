#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "engine/core/catalogue.h"
#include "engine/optimo/editing/allowance.h"
#include "engine/optimo/editing/optimo_editing.h"
#include "engine/optimo/editing/rule_facts.h"
#include "engine/optimo/editing/variable_facts.h"
#include "engine/optimo/editing/word_facts.h"
#include "engine/optimo/language/instruction_set.h"

namespace rmlcell::optimo::editing {
namespace {

namespace fs = std::filesystem;

std::string ReadText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

// What a finding or an instruction names, a programmer can look up where he stands.
TEST(Facts, EveryRuleThatTheCheckerNamesIsExplained) {
  const fs::path root = RMLCELL_SOURCE_DIR;
  std::set<std::string> named;
  const std::regex rule("\"(OPT-[0-9BE]+\\.[0-9]+)\"");
  std::vector<fs::path> sources = {root / "engine/optimo/offline/contour_advice.cc",
                                   root / "engine/optimo/editing/variable_facts.cc"};
  for (const auto& entry : fs::directory_iterator(root / "engine/optimo/language"))
    sources.push_back(entry.path());
  for (const fs::path& path : sources) {
    const std::string text = ReadText(path);
    for (std::sregex_iterator at(text.begin(), text.end(), rule), end; at != end; ++at)
      named.insert((*at)[1]);
  }
  EXPECT_GT(named.size(), 80U);
  for (const std::string& id : named) EXPECT_NE(TextOfRule(id), "") << id;
}

TEST(Facts, RulesOfInstructionsAreExplained) {
  for (const InstructionInfo& row : kInstructionSet) {
    if (row.rule.empty()) continue;
    EXPECT_NE(TextOfRule(row.rule), "") << row.rule;
  }
}

// OPT-7.64, OPT-7.69, OPT-7.104, OPT-7.105, OPT-7.106: every variable by what is kept in it, place
// for place.
TEST(Facts, EachVariableSaysWhatIsKeptInIt) {
  struct Row {
    VariableGroup group;
    int first, last;
    std::string word;  // of what is told; empty: nothing
  };
  const Row rows[] = {
      {VariableGroup::kVr, 0, 25, "customers"},
      {VariableGroup::kVr, 26, 42, "without unit"},
      {VariableGroup::kVr, 43, 59, "Amada"},
      {VariableGroup::kVr, 60, 63, "WORKDEF 1,00"},
      {VariableGroup::kVr, 64, 64, "speed 1"},
      {VariableGroup::kVr, 65, 68, "WORKDEF 1,01"},
      {VariableGroup::kVr, 69, 69, "speed 2"},
      {VariableGroup::kVr, 70, 73, "WORKDEF 1,02"},
      {VariableGroup::kVr, 74, 74, "speed 3"},
      {VariableGroup::kVr, 75, 78, "WORKDEF 1,03"},
      {VariableGroup::kVr, 79, 79, "speed 4"},
      {VariableGroup::kVr, 80, 85, "TCP"},
      {VariableGroup::kVr, 86, 91, "SYSDEF 1"},
      {VariableGroup::kVr, 92, 97, "SYSDEF 2"},
      {VariableGroup::kVr, 98, 99, "system"},
      {VariableGroup::kVi, 0, 0, ""},
      {VariableGroup::kVi, 1, 1, "chaining"},
      {VariableGroup::kVi, 2, 69, "customers"},
      {VariableGroup::kVi, 70, 97, "Amada"},
      {VariableGroup::kVi, 98, 98, "runs"},
      {VariableGroup::kVi, 99, 99, "error"},
      {VariableGroup::kVl, 0, 79, "customers"},
      {VariableGroup::kVl, 80, 99, "Amada"},
      {VariableGroup::kOl, 0, 1, "system"},
      {VariableGroup::kOl, 2, 2, "EFA-51"},
      {VariableGroup::kOl, 3, 7, "system"},
      {VariableGroup::kOl, 8, 9, "gas"},
      {VariableGroup::kOl, 10, 10, "system"},
      {VariableGroup::kOl, 11, 11, "sensor"},
      {VariableGroup::kOl, 12, 15, "system"},
      {VariableGroup::kOl, 16, 16, "customers"},
      {VariableGroup::kOl, 17, 31, "system"},
      {VariableGroup::kOl, 32, 99, ""},
      {VariableGroup::kIl, 0, 15, "system"},
      {VariableGroup::kIl, 16, 16, "START"},
      {VariableGroup::kIl, 17, 31, "system"},
      {VariableGroup::kIl, 32, 86, ""},
      {VariableGroup::kIl, 87, 94, "process with number"},
      {VariableGroup::kIl, 95, 95, "motion"},
      {VariableGroup::kIl, 96, 99, "reserved"},
      {VariableGroup::kIa, 0, 0, "coordinate X"},
      {VariableGroup::kIa, 1, 1, "coordinate Y"},
      {VariableGroup::kIa, 2, 2, "coordinate Z"},
      {VariableGroup::kIa, 3, 3, "angle A"},
      {VariableGroup::kIa, 4, 4, "angle B"},
      {VariableGroup::kIa, 5, 39, "reserved"},
      {VariableGroup::kIa, 40, 99, ""},
      {VariableGroup::kOa, 0, 0, "speed"},
      {VariableGroup::kOa, 1, 99, ""},
      {VariableGroup::kPar, 0, 7, ""},
  };
  for (const Row& row : rows) {
    for (int index = row.first; index <= row.last; ++index) {
      const std::string note = VariableNote({row.group, static_cast<std::uint8_t>(index)});
      if (row.word.empty()) {
        EXPECT_EQ(note, "") << index;
      } else {
        EXPECT_NE(note.find(row.word), std::string::npos) << index << ": " << note;
      }
    }
  }
}

TEST(Facts, AnUnknownRuleHasNoText) {
  EXPECT_EQ(TextOfRule("OPT-nonsense"), "");
  EXPECT_EQ(TextOfRule(""), "");
}

TEST(Facts, TextsAreSentencesInOneLine) {
  for (const RuleFact& row : RuleFacts()) {
    EXPECT_EQ(row.text.back(), '.') << row.id;
    EXPECT_EQ(row.text.find('\n'), std::string_view::npos) << row.id;
  }
  for (const WordFact& row : WordFacts()) {
    EXPECT_EQ(row.text.find('\n'), std::string_view::npos);
    EXPECT_GT(row.text.size(), 3U);
  }
}

// The form of a word has that word in it.
TEST(Facts, FormsNameTheirWord) {
  for (const WordFact& row : WordFacts()) {
    if (row.form.empty()) continue;
    EXPECT_NE(row.form.find(Describe(row.word).text), std::string_view::npos) << row.form;
  }
}

// Whoever asks for the words gets all of them, in the order of their names.
TEST(Facts, WordsStandInTheOrderOfTheirNames) {
  const std::vector<machine::LanguageWord> words = OptimoWords();
  EXPECT_EQ(words.size(), WordFacts().size());
  EXPECT_TRUE(std::ranges::is_sorted(words, {}, &machine::LanguageWord::name));
  const auto found = std::ranges::find(words, "MOVE", &machine::LanguageWord::name);
  ASSERT_NE(found, words.end());
  EXPECT_EQ(found->form, FactOf(Word::kMove).form);
  EXPECT_EQ(found->text, FactOf(Word::kMove).text);
  EXPECT_EQ(found->rule, Describe(Word::kMove).rule);
}

// OPT-7.60: what each group holds, and which process a flag of IL is of (OPT-3.37).
TEST(Facts, VariablesAreToldWithTheirGroupAndTheirRule) {
  using enum VariableGroup;
  const auto head = [](VariableGroup group, std::uint8_t index) {
    const std::string facts = VariableFacts({group, index});
    return facts.substr(0, facts.find('\n'));
  };
  EXPECT_EQ(head(kVr, 26), "**VR[26]** real variable");
  EXPECT_EQ(head(kVi, 26), "**VI[26]** whole-number variable, -32768 to 32767");
  EXPECT_EQ(head(kVl, 26), "**VL[26]** logical variable");
  EXPECT_EQ(head(kIl, 26), "**IL[26]** logical input");
  EXPECT_EQ(head(kOl, 26), "**OL[26]** logical output");
  EXPECT_EQ(head(kIa, 26), "**IA[26]** analogue input");
  EXPECT_EQ(head(kOa, 26), "**OA[26]** analogue output");
  EXPECT_EQ(head(kPar, 6), "**PAR[6]** parameter of CALL or FUNCTION");
  EXPECT_EQ(VariableFacts({kOl, 16}),
            "**OL[16]** logical output\n\nfree for customers (OPT-7.106)");
  for (std::uint8_t flag = 87; flag <= 94; ++flag) {
    const std::string said =
        "1 while a process with number " + std::to_string(flag - 87) + " is ON";
    EXPECT_EQ(VariableNote({kIl, flag}), said);
    EXPECT_NE(VariableFacts({kIl, flag}).find("\n\n" + said + " (OPT-3.37)"), std::string::npos);
  }
  // OPT-7.66
  EXPECT_NE(VariableFacts({kIa, 50}).find("cannot write"), std::string::npos);
  EXPECT_NE(VariableFacts({kOa, 0}).find("cannot write"), std::string::npos);
  EXPECT_EQ(VariableFacts({kOa, 1}).find("cannot write"), std::string::npos);
}

std::string Note(VariableGroup group, int index) {
  return VariableNote({group, static_cast<std::uint8_t>(index)});
}

// OPT-7.66, OPT-7.104, OPT-7.105, OPT-3.37, OPT-8.30
TEST(Facts, VariablesSayWhatTheyAreKeptFor) {
  using enum VariableGroup;
  EXPECT_NE(Note(kVr, 50).find("Amada"), std::string::npos);
  EXPECT_EQ(Note(kVr, 42).find("Amada"), std::string::npos);
  EXPECT_NE(Note(kVr, 86).find("SYSDEF 1"), std::string::npos);
  EXPECT_NE(Note(kIl, 89).find("number 2 is ON"), std::string::npos);
  EXPECT_NE(Note(kIl, 95).find("motion"), std::string::npos);
  EXPECT_EQ(Note(kIl, 50), "");
  EXPECT_NE(VariableFacts({kVi, 99}).find("OPT-7.66"), std::string::npos);
  EXPECT_EQ(VariableFacts({kVi, 97}).find("OPT-7.66"), std::string::npos);
  EXPECT_NE(VariableFacts({kVr, 5}).find("lengths"), std::string::npos);
  EXPECT_NE(VariableFacts({kVr, 3}).find("angles"), std::string::npos);
  EXPECT_EQ(VariableFacts({kVr, 26}).find("CONVERT"), std::string::npos);
}

// OPT-7.60: the last of a group is 99; nothing is kept in what is beyond.
TEST(Facts, NothingIsKeptBeyondTheLastVariable) {
  using enum VariableGroup;
  for (const VariableGroup group : {kVr, kVi, kVl, kIl, kOl, kIa, kOa})
    EXPECT_EQ(VariableNote({group, 100}), "") << static_cast<int>(group);
}

// A directive silences warnings and advice of the Optimo, of a place in the text, and no directive.
TEST(Allowance, IsForWarningsOfAPlace) {
  constexpr std::string_view kText = "VR[98] = 1. \n; x\n";
  const auto allowed = [&](ErrorCode code, Severity severity, std::int64_t at) {
    Diagnostic finding{.code = code, .severity = severity};
    finding.where.byte_offset = at;
    return Allowance(kText, finding);
  };
  const Fix directive{11, 0, "  ; rmlcell: allow 7413"};
  EXPECT_EQ(allowed(ErrorCode::kReservedVariable, Severity::kWarning, 0), directive);
  EXPECT_EQ(allowed(ErrorCode::kReservedVariable, Severity::kAdvice, 5), directive);
  EXPECT_EQ(allowed(ErrorCode::kReservedVariable, Severity::kCompile, 0), std::nullopt);
  EXPECT_EQ(allowed(ErrorCode::kCellTooLarge, Severity::kWarning, 0), std::nullopt);
  EXPECT_EQ(allowed(ErrorCode::kReservedVariable, Severity::kWarning, -1), std::nullopt);
  EXPECT_EQ(allowed(ErrorCode::kReservedVariable, Severity::kWarning, 13), std::nullopt);
}

}  // namespace
}  // namespace rmlcell::optimo::editing
