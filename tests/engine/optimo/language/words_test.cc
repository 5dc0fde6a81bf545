#include "engine/optimo/language/words.h"

#include <gtest/gtest.h>

#include <array>
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
  EXPECT_EQ(FindWord(PackName("task")), Word::kTask);
  EXPECT_EQ(FindWord(PackName("zero")), Word::kZero);
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

using Words = std::vector<std::string>;

// OPT-7.91, OPT-E.7011
TEST(NearestWords, ProposesWhatIsNear) {
  const std::vector<std::string_view> words = {"SPEED", "MOVE", "GOSUB", "GO", "GOTO"};
  EXPECT_EQ(NearestWords("SPEDE", words).words, (Words{"SPEED"}));
  EXPECT_EQ(NearestWords("MVOE", words).words, (Words{"MOVE"}));
  EXPECT_EQ(NearestWords("gosup", words).words, (Words{"GOSUB"}));
  EXPECT_EQ(NearestWords("GOT", words).words, (Words{"GO", "GOTO"}));
  EXPECT_EQ(NearestWords("ZZZZZ", words).words, Words{});
  EXPECT_EQ(NearestWords("X", words).words, Words{});
  EXPECT_EQ(NearestWords(std::string(1000, 'M'), words).words, Words{});
}

// OPT-7.91: of several nothing is sure, nor where a digit differs or more than one letter.
TEST(NearestWords, TellsASlipFromAnotherWord) {
  const std::vector<std::string_view> words = {"SPEED", "ZONE1", "GO", "GOTO"};
  EXPECT_TRUE(NearestWords("SPEDE", words).IsSingle(Slip::kSwap));
  EXPECT_TRUE(NearestWords("SPED", words).IsSingle(Slip::kOneLetter));
  EXPECT_TRUE(NearestWords("SPEEED", words).IsSingle(Slip::kOneLetter));
  EXPECT_TRUE(NearestWords("ZONE3", words).IsSingle(Slip::kOther));
  for (const char digit : std::string("0123456789")) {
    const std::string zone = std::string("ZONE") + digit;
    EXPECT_TRUE(NearestWords(zone, std::array<std::string_view, 1>{"ZONEX"}).IsSingle(Slip::kOther))
        << zone;
    EXPECT_TRUE(NearestWords("ZONEX", std::array<std::string_view, 1>{zone}).IsSingle(Slip::kOther))
        << zone;
  }
  EXPECT_TRUE(NearestWords("SPEED20", words).IsSingle(Slip::kOther));
  EXPECT_TRUE(
      NearestWords("ABCDEF", std::array<std::string_view, 1>{"ABXYEF"}).IsSingle(Slip::kOther));
  EXPECT_TRUE(NearestWords("SPPE", words).words.empty() ||
              NearestWords("SPPE", words).IsSingle(Slip::kOther));
  EXPECT_FALSE(NearestWords("GOT", words).IsSingle(Slip::kOneLetter));
  EXPECT_EQ(QuestionFor(NearestWords("GOT", words)), "; did you mean GO or GOTO?");
  EXPECT_EQ(QuestionFor(NearestWords("QQ", words)), "");
}

// OPT-7.50: names that differ in a letter may both be meant; XPOS and YPOS always are.
TEST(NearestWords, NamesAreSureOnlyWhenLettersAreSwapped) {
  const auto sure = [](std::string_view word, std::string_view meant) {
    return IsSurelyName(word, NearestWords(word, std::array{meant}));
  };
  EXPECT_TRUE(sure("XHOEM", "XHOME"));
  EXPECT_FALSE(sure("XHOM", "XHOME"));
  EXPECT_FALSE(sure("YPOS", "XPOS"));
  EXPECT_FALSE(sure("POSYX", "POSXY"));
  EXPECT_FALSE(sure("ZONE12", "ZONE21"));
}

// OPT-7.91: one mistyped letter in three is near: put in, left out, another one, or two exchanged;
// upper and lower case are the same. The nearest are proposed, each once.
TEST(NearestWords, OneLetterInThreeMayDiffer) {
  const auto near = [](std::string_view word, std::vector<std::string_view> words) {
    return NearestWords(word, words).words;
  };
  EXPECT_EQ(near("AB", {"AC"}), Words{});
  EXPECT_EQ(near("AB", {"ABC"}), Words{});
  EXPECT_EQ(near("ABC", {"ABD"}), (Words{"ABD"}));
  EXPECT_EQ(near("ABC", {"ABCD"}), (Words{"ABCD"}));
  EXPECT_EQ(near("ABC", {"AC"}), (Words{"AC"}));
  EXPECT_EQ(near("ABC", {"BAC"}), (Words{"BAC"}));
  EXPECT_EQ(near("abc", {"ACB"}), (Words{"ACB"}));
  EXPECT_EQ(near("ABC", {"BCA"}), Words{});
  EXPECT_EQ(near("ABCDE", {"ABXYE"}), Words{});
  EXPECT_EQ(near("ABCDEF", {"ABXYEF"}), (Words{"ABXYEF"}));
  EXPECT_EQ(near("ABCDEF", {"BADCEF"}), (Words{"BADCEF"}));
  EXPECT_EQ(near("ABCDEF", {"ABXYZF"}), Words{});
  EXPECT_EQ(near("ABCDEF", {"ABXYEF", "ABCDEX", "XBCDEF"}), (Words{"ABCDEX", "XBCDEF"}));
  EXPECT_EQ(near("ABCDEF", {"ABCDEX", "ABXYEF", "ABCDEX"}), (Words{"ABCDEX"}));
  EXPECT_EQ(near("ABC", {"", "ABC"}), (Words{"ABC"}));
  const std::string sixteen(16, 'A'), seventeen(17, 'A');
  EXPECT_EQ(near(sixteen, {sixteen}).size(), 1U);
  EXPECT_EQ(near(seventeen, {sixteen}), Words{});
  EXPECT_EQ(near(sixteen, {seventeen}), Words{seventeen});
  const std::vector<std::string_view> many = {"ABD", "ABE", "ABF", "ABG", "ABH"};
  EXPECT_EQ(near("ABC", many), Words(many.begin(), many.begin() + kNearWordsMax));
  EXPECT_EQ(QuestionFor(NearestWords("ABC", std::array<std::string_view, 3>{"ABD", "ABE", "ABF"})),
            "; did you mean ABD, ABE or ABF?");
  EXPECT_EQ(QuestionFor(NearestWords("ABC", std::array<std::string_view, 1>{"ABD"})),
            "; did you mean ABD?");
}

}  // namespace
}  // namespace rmlcell::optimo
