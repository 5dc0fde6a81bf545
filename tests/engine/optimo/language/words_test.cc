#include "engine/optimo/language/words.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/optimo/language/instruction_set.h"
#include "engine/optimo/language/nearest_word.h"

namespace rmlcell::optimo {
namespace {

// OPT-1.02, OPT-7.48
TEST(Words, AreFoundWithoutCaseByEightCharacters) {
  EXPECT_EQ(FindWord(PackName("function")), Word::kFunction);
  EXPECT_EQ(FindWord(PackName("FUNCTION1")), Word::kFunction);
  EXPECT_EQ(FindWord(PackName("SPEEDY")), Word::kNone);
  EXPECT_EQ(FindWord(PackName("")), Word::kNone);
}

TEST(Words, EachIsFoundAndUnique) {
  std::set<std::string_view> texts;
  for (const WordInfo& row : ReservedWords()) {
    EXPECT_EQ(FindWord(PackName(row.text)), row.word) << row.text;
    EXPECT_EQ(Describe(row.word).text, row.text);
    EXPECT_TRUE(texts.insert(row.text).second) << row.text;
    char room[kNameLength];
    EXPECT_EQ(UnpackName(PackName(row.text), room), row.text);
  }
}

// Every instruction word has a row of the instruction set, and the other way round.
TEST(Words, InstructionsAreInTheInstructionSet) {
  for (const WordInfo& row : ReservedWords()) {
    EXPECT_EQ(OpOf(row.word) != Op::kInvalid, row.group == WordGroup::kInstruction) << row.text;
  }
  EXPECT_EQ(OpOf(Word::kGoto), Op::kGoto);
}

TEST(NearestWord, ProposesWhatIsNear) {
  const std::vector<std::string_view> words = {"SPEED", "MOVE", "GOSUB", "GOTO"};
  EXPECT_EQ(NearestWord("SPEDE", words), "SPEED");
  EXPECT_EQ(NearestWord("MVOE", words), "MOVE");
  EXPECT_EQ(NearestWord("gosup", words), "GOSUB");
  EXPECT_EQ(NearestWord("ZZZZZ", words), "");
  EXPECT_EQ(NearestWord("X", words), "");
  EXPECT_EQ(NearestWord(std::string(1000, 'M'), words), "");
}

}  // namespace
}  // namespace rmlcell::optimo
