// What is offered at the bounds: how much of it, where a statement goes on, and what stands inside
// parentheses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

Json ListAt(const std::string& marked) {
  Editor editor;
  return editor.At("textDocument/completion", marked)["result"];
}
std::vector<std::string> OfferedAt(const std::string& marked) {
  const Json list = ListAt(marked);
  std::vector<std::string> labels;
  for (const Json& item : list["items"]) labels.push_back(item["label"]);
  return labels;
}

// A thousand sequence numbers are offered; of more, a thousand, and the editor asks again.
TEST(CompletionBounds, AThousandSequenceNumbers) {
  const auto list = [](int numbers) {
    std::string text = "GOTO |\n";
    for (int number = 1; number <= numbers; ++number)
      text += std::to_string(number) + " SPEED 5\n1 SPEED 5\n";
    return ListAt(text);
  };
  const Json all = list(1000);
  EXPECT_EQ(all["items"].size(), 1000U);  // each once
  EXPECT_EQ(all["isIncomplete"], false);
  const Json some = list(1001);
  EXPECT_EQ(some["items"].size(), 1000U);
  EXPECT_EQ(some["isIncomplete"], true);
}

TEST(CompletionBounds, AThousandNames) {
  const auto list = [](int names) {
    std::string text;
    for (int name = 0; name < names; ++name) text += "DECLARE Q" + std::to_string(name) + " = 5\n";
    return ListAt(text + "VR[0] = Q|\n");
  };
  EXPECT_EQ(list(1000)["items"].size(), 1000U);
  EXPECT_EQ(list(1000)["isIncomplete"], false);
  EXPECT_EQ(list(1001)["items"].size(), 1000U);
  EXPECT_EQ(list(1001)["isIncomplete"], true);
}

// 60 bytes of what a name or a number stands for.
TEST(CompletionBounds, ADetailIsCutBehind60Bytes) {
  const auto detail = [](const std::string& marked, const std::string& label) {
    const Json list = ListAt(marked);
    for (const Json& item : list["items"])
      if (item["label"] == label) return item.value("detail", "");
    return std::string("not offered");
  };
  const std::string nines(60, '9');
  EXPECT_EQ(detail("DECLARE EDGE = " + nines + "\nVR[0] = ED|\n", "EDGE"), "= " + nines);
  EXPECT_EQ(detail("DECLARE EDGE = 9" + nines + "\nVR[0] = ED|\n", "EDGE"), "= " + nines);
  EXPECT_EQ(detail("GOTO |\n10 VR[0] = " + std::string(60, '9') + "\n", "10"),
            "VR[0] = " + std::string(52, '9'));
}

// OPT-1.30: a statement goes on where its last character asks for more, or a parenthesis is open.
TEST(CompletionBounds, AStatementGoesOnOverTheEndOfALine) {
  for (const char* end : {"/", ",", "(", "=", "+", "-", "*", "^", "<", ">"})
    EXPECT_THAT(OfferedAt("VR[0] = 1 " + std::string(end) + "\n|\n"), Not(Contains("MOVE"))) << end;
  EXPECT_THAT(OfferedAt("MOVE (1,2,3,0,0)/\n|\n"), AllOf(Contains("FLY"), Not(Contains("MOVE"))));
  EXPECT_THAT(OfferedAt("MOVE (1,2,(3\n|\n"), Not(Contains("SPEED")));
  EXPECT_THAT(OfferedAt("MOVE (1,2,(3),0,0)\n|\n"), Contains("SPEED"));
  EXPECT_THAT(OfferedAt("VR[0] = 1\n|\n"), Contains("MOVE"));
  EXPECT_THAT(OfferedAt("VR[0] = 1 |\n"), Not(Contains("MOVE")));  // on the same line
}

// OPT-2.43, OPT-7.72: behind a closed parenthesis a slash begins an attribute, inside one it
// divides.
TEST(CompletionBounds, ParenthesesDecideWhatASlashIs) {
  EXPECT_THAT(OfferedAt("MOVE (1,(2+3),4,0,0)/|"), Contains("FLY"));
  EXPECT_THAT(OfferedAt("MOVE (1,(2+3)/|"), AllOf(Not(Contains("FLY")), Contains("VR")));
  EXPECT_THAT(OfferedAt("XPOS = 4/|"), AllOf(Not(Contains("FLY")), Contains("VR")));
}

// OPT-7.17, OPT-2.54: the list of a GOTO, and the second value of a time.
TEST(CompletionBounds, NumbersStandInTheListsThatJump) {
  const std::string rest = "\n10 SPEED 5\n20\n";
  EXPECT_THAT(OfferedAt("GOTO VI[2] (10|" + rest), ElementsAre("10"));
  EXPECT_THAT(OfferedAt("GOTO VI[2] (10 |" + rest), Not(Contains("20")));
  EXPECT_THAT(OfferedAt("TIMER ((1+2), |" + rest), ElementsAre("10", "20"));
  EXPECT_THAT(OfferedAt("TIMER (|" + rest), Not(Contains("20")));
  EXPECT_THAT(OfferedAt("TIMER (5, 10 + |" + rest), Not(Contains("20")));
  EXPECT_THAT(OfferedAt("MOVE (1, |" + rest), Not(Contains("20")));
  EXPECT_THAT(OfferedAt("MOVE (1,2,3,0,0)/TIME ((1+2), |" + rest), ElementsAre("10", "20"));
  EXPECT_THAT(OfferedAt("SPEED GOTO |" + rest), Not(Contains("20")));
}

// Slots begin with 1; each program is offered once.
TEST(CompletionBounds, ProgramsBeginWithTheFirstSlot) {
  Editor editor;
  for (const char* name : {"1.S", "1.SI", "2.S"})
    editor.folder.files[std::string("file:///work/") + name] = "";
  const Json answer = editor.At("textDocument/completion", "FUNCTION |");
  std::vector<std::string> labels;
  for (const Json& item : answer["result"]["items"]) labels.push_back(item["label"]);
  EXPECT_THAT(labels, ElementsAre("1", "2"));
}

TEST(CompletionBounds, BehindAValueStandOperators) {
  for (const char* value : {"VR[0] = 5 |", "VR[0] = (5) |", "VR[0] = VR[1] |", "VR[0] = XPOS |"})
    EXPECT_THAT(OfferedAt(value),
                AllOf(Contains("MOD"), Not(Contains("SIN")), Not(Contains("THEN"))))
        << value;
  EXPECT_THAT(OfferedAt("VR[0] = 5 + |"), AllOf(Contains("SIN"), Contains("NOT"), Contains("PI")));
  EXPECT_THAT(OfferedAt("XPOS |"), IsEmpty());  // then =
}

TEST(CompletionBounds, WordsThatNameAThingOfTheirOwnOfferNothing) {
  for (const char* word : {"SYSDEF |", "TASK |", "BREAK |", "SIMUL |", "WORK |", "DECLARE |",
                           "DECLARE XPOS |", "DEFINE PAR[0] |", "UPDATE IL |"})
    EXPECT_THAT(OfferedAt(word), IsEmpty()) << word;
  EXPECT_THAT(OfferedAt("DEFINE |"), ElementsAre("PAR"));
  for (const char* word : {"UPDATE |", "IMAGE |", "REAL |", "UPDATE IL, |"})
    EXPECT_THAT(OfferedAt(word), ElementsAre("IL", "OL", "IA", "OA")) << word;
}

// OPT-7.60: VR to OA have 100 each, PAR eight.
TEST(CompletionBounds, IndexesAreThoseOfTheGroup) {
  for (const char* group : {"VR", "VI", "VL", "IL", "OL", "IA", "OA"}) {
    const auto offered = OfferedAt(std::string(group) + "[|");
    ASSERT_EQ(offered.size(), 100U) << group;
    EXPECT_EQ(offered.front(), "0");
    EXPECT_EQ(offered.back(), "99");
  }
  EXPECT_EQ(OfferedAt("PAR[|").back(), "7");
  EXPECT_THAT(OfferedAt("SPEED [|"), IsEmpty());
  EXPECT_THAT(OfferedAt("[|"), IsEmpty());
  EXPECT_THAT(OfferedAt("DECLARE NEXT9 = 5\nVR[NE|"), ElementsAre("NEXT9"));
}

// What is being typed is letters and digits of ASCII.
TEST(CompletionBounds, AWordIsLettersAndDigits) {
  const auto typed_from = [](const std::string& marked) {
    return ListAt(marked)["items"][0]["textEdit"]["range"]["start"]["character"].get<int>();
  };
  EXPECT_EQ(typed_from("DECLARE AZaz09 = 1\nVR[0] = AZaz0|\n"), 8);
  EXPECT_EQ(typed_from("DECLARE AZaz09 = 1\nVR[0] =AZaz0|\n"), 7);
  EXPECT_EQ(typed_from("DECLARE AZaz09 = 1\nVR[0] =(AZ|\n"), 8);
  EXPECT_THAT(OfferedAt("DECLARE AZaz09 = 1\nVR[0] = azAZ|\n"), ElementsAre("AZaz09"));
}

// Of a statement that is being typed 2000 tokens are looked at: "VR[0] = 1" has six, each "+1" two.
TEST(CompletionBounds, TwoThousandTokensOfAStatement) {
  const auto offered = [](int sums) {
    std::string text = "VR[0] = 1";
    for (int sum = 0; sum < sums; ++sum) text += "+1";
    return OfferedAt(text + "+|\n");
  };
  EXPECT_THAT(offered(996), AllOf(Contains("SIN"), Not(Contains("MOD"))));
  EXPECT_THAT(offered(997), AllOf(Contains("MOD"), Not(Contains("SIN"))));
}

// OPT-7.07, OPT-9.01: a declared number may say which program is meant.
TEST(CompletionBounds, ANameMayStandForAProgram) {
  const std::string named = "DECLARE RECT = 44\n";
  EXPECT_THAT(OfferedAt(named + "FUNCTION |\n"), ElementsAre("RECT"));
  for (const char* word : {"CALL |\n", "GO |\n"})
    EXPECT_THAT(OfferedAt(named + word), AllOf(Contains("RECT"), Contains("VI"))) << word;
}

// Behind a word that is no name of the program stands a value, not "=".
TEST(CompletionBounds, BehindAWordStandsAValue) {
  for (const char* word : {"SPEED |\n", "IF |\n", "VL[0] = VL[1] AND |\n", "VL[0] = NOT |\n"})
    EXPECT_THAT(OfferedAt(word), AllOf(Contains("VR"), Contains("SIN"))) << word;
}

}  // namespace
}  // namespace rmlcell::lsp
