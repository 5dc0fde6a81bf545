#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/optimo/language/words.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

std::vector<std::string> Offered(std::string_view marked, Editor& editor) {
  const Json answer = editor.At("textDocument/completion", marked);
  std::vector<std::string> labels;
  for (const Json& item : answer["result"]["items"]) labels.push_back(item["label"]);
  return labels;
}
std::vector<std::string> Offered(std::string_view marked) {
  Editor editor;
  return Offered(marked, editor);
}

TEST(Completion, AStatementBeginsWithAnInstructionANameOrAVariable) {
  constexpr const char* kText = "DECLARE XHOME = VR[0]\n|";
  const auto offered = Offered(kText);
  for (const optimo::WordInfo& row : optimo::ReservedWords()) {
    if (row.group == optimo::WordGroup::kInstruction) {
      EXPECT_THAT(offered, Contains(std::string(row.text)));
    }
    if (row.group == optimo::WordGroup::kUnavailable || row.group == optimo::WordGroup::kFunction) {
      EXPECT_THAT(offered, Not(Contains(std::string(row.text))));
    }
  }
  EXPECT_THAT(offered, AllOf(Contains("XHOME"), Contains("VR")));
  EXPECT_THAT(Offered("10 |\n"), Contains("MOVE"));
  EXPECT_THAT(Offered("SPEED 5 \n  |\nSPEED 6\n"), Contains("MOVE"));
}

TEST(Completion, BehindTheEndMarkNothingIsOffered) {
  EXPECT_THAT(Offered("MOVE P1\x1Awo|\n"), IsEmpty());
  EXPECT_THAT(Offered("MO|\x1A\n"), Contains("MOVE"));
}

TEST(Completion, WhatIsTypedNarrowsTheListAndIsReplaced) {
  EXPECT_THAT(Offered("wo|\n"), ElementsAre("WORK", "WORKDEF"));
  Editor editor;
  const Json items = editor.At("textDocument/completion", "10 mo|\n")["result"]["items"];
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(items[0]["textEdit"], TextEdit({{0, 3}, {0, 5}}, "MOVE"));
  EXPECT_NE(items[0]["documentation"]["value"].get<std::string>().find("mm"), std::string::npos);
}

// OPT-2.43, OPT-3.13, OPT-B.59: those of the instruction, each once, none that does nothing.
TEST(Completion, BehindASlashStandTheAttributesOfTheInstruction) {
  EXPECT_THAT(Offered("MOVE (1,2,3,0,0)/|"),
              UnorderedElementsAre("VIA", "FLY", "START", "END", "TIME", "NEXT"));
  EXPECT_THAT(Offered("MOVE (1,2,3,0,0) /FLY /|"),
              UnorderedElementsAre("VIA", "START", "END", "TIME", "NEXT"));
  EXPECT_THAT(Offered("MOVE (1,2,3,0,0) /FLY\n /|"), Contains("VIA"));
  EXPECT_THAT(Offered("WORK 1,0 /o|"), UnorderedElementsAre("ON", "OFF"));
  EXPECT_THAT(Offered("GO 46/|"), UnorderedElementsAre("C", "R", "S"));
  EXPECT_THAT(Offered("TIMER /|"), UnorderedElementsAre("AUTO", "DIS"));
}

// OPT-7.72: in an expression a slash divides.
TEST(Completion, BehindADivisionStandsAValue) {
  EXPECT_THAT(Offered("VR[0] = 5 / |"), AllOf(Contains("VR"), Not(Contains("FLY"))));
  EXPECT_THAT(Offered("SPEED 5 /|"), AllOf(Contains("VR"), Not(Contains("FLY"))));
  EXPECT_THAT(Offered("MOVE (VR[0]/|"), AllOf(Contains("SIN"), Not(Contains("FLY"))));
}

// OPT-7.15, OPT-7.17, OPT-7.23, OPT-2.54
TEST(Completion, BehindAJumpStandTheSequenceNumbers) {
  constexpr const char* kRest = "\n10 SPEED 5\n20\n";
  for (const char* line :
       {"GOTO |", "gosub |", "IF VL[0] THEN |", "IF VL[0] THEN 10 ELSE |", "GOTO VI[2] (|",
        "GOTO VI[2] (10, |", "ERR |", "MOVE (1,2,3,0,0)/TIME (2., |", "TIMER (2., |"})
    EXPECT_THAT(Offered(line + std::string(kRest)), ElementsAre("10", "20")) << line;
  EXPECT_THAT(Offered("GOTO 1|\n10 SPEED 5\n20\n"), ElementsAre("10"));
}

// OPT-7.07
TEST(Completion, BehindACallStandTheProgramsOfTheFolder) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "";
  editor.folder.files["file:///work/7.S"] = "";
  EXPECT_THAT(Offered("FUNCTION |", editor), ElementsAre("7", "44"));
  EXPECT_THAT(Offered("CALL |", editor), AllOf(Contains("44"), Contains("VI")));
}

TEST(Completion, WordsThatTakeAFewOthersOfferThose) {
  EXPECT_THAT(Offered("COORD |"), UnorderedElementsAre("ABSOL", "ROBOT"));
  EXPECT_THAT(Offered("path |"), UnorderedElementsAre("PTP", "LIN", "CIR", "HOLE"));
  EXPECT_THAT(Offered("DEFINE PAR[0] = |"), UnorderedElementsAre("FLOAT", "INT", "LOGIC"));
  EXPECT_THAT(Offered("UPDATE IL, |"), UnorderedElementsAre("IL", "OL", "IA", "OA"));
  EXPECT_THAT(Offered("IF VR[0] > 5 |"),
              AllOf(Contains("THEN"), Contains("AND"), Not(Contains("SIN"))));
  EXPECT_THAT(Offered("DECLARE X = |"),
              AllOf(Contains("VR"), Contains("PI"), Not(Contains("SIN"))));
}

// OPT-7.104
TEST(Completion, AnIndexIsOfferedWithItsUse) {
  Editor editor;
  const Json items = editor.At("textDocument/completion", "VR[8|")["result"]["items"];
  ASSERT_EQ(items.size(), 11U);  // 8, 80 to 89
  EXPECT_EQ(items[0]["label"], "8");
  EXPECT_EQ(items[7]["label"], "86");
  EXPECT_NE(items[7]["detail"].get<std::string>().find("SYSDEF"), std::string::npos);
  EXPECT_EQ(Offered("PAR[|").size(), 8U);
}

// OPT-8.03, OPT-8.04
TEST(Completion, CommentsHaveDirectivesAndNothingElse) {
  EXPECT_THAT(Offered("SPEED 5 ; s|"), IsEmpty());
  EXPECT_THAT(Offered(";$|"), UnorderedElementsAre("dia", "rad", "left", "right", "none"));
  EXPECT_THAT(Offered("SPEED 90 ; rmlcell: |"), ElementsAre("allow"));
  // What stands before and behind does not count.
  EXPECT_THAT(Offered("SPEED 5\n;$|\nSPEED 6\n"),
              UnorderedElementsAre("dia", "rad", "left", "right", "none"));
  EXPECT_THAT(Offered("SPEED 90 ; rmlcell: |\nSPEED 80 ; slow\n"), ElementsAre("allow"));
  EXPECT_THAT(Offered("SPEED 5\n; $|\n"), IsEmpty());
  EXPECT_THAT(Offered("SPEED 5 ; rmlcell: allow |\n"), IsEmpty());
}

// What a number or a name stands for is said beside it, with the kind that LSP has for it.
TEST(Completion, WhatIsOfferedSaysWhatItIs) {
  Editor editor;
  for (const char* name : {"44.S", "44.SI", "7.SI"})
    editor.folder.files[std::string("file:///work/") + name] = "";
  const auto details = [&](std::string_view marked, int kind) {
    std::vector<std::string> told;
    const Json items = editor.At("textDocument/completion", marked)["result"]["items"];
    for (const Json& item : items) {
      if (item["kind"] == kind)
        told.push_back(item["label"].get<std::string>() + ": " + item.value("detail", ""));
    }
    return told;
  };
  EXPECT_THAT(details("FUNCTION |", 9), ElementsAre("7: 7.SI", "44: 44.S"));  // module
  EXPECT_THAT(details("GOTO |\n10 SPEED 5\n20\n", 18),
              ElementsAre("10: SPEED 5", "20: "));  // reference
  constexpr const char* kNames = "DECLARE EDGE = 1.5\nDECLARE HOME = VR[3]\nVR[0] = |\n";
  EXPECT_THAT(details(kNames, 21), Contains("EDGE: = 1.5"));   // constant
  EXPECT_THAT(details(kNames, 6), Contains("HOME: = VR[3]"));  // variable
}

// The kinds that LSP has: 3 function, 6 variable, 14 keyword, 21 constant.
TEST(Completion, EachHasTheKindOfItsWord) {
  Editor editor;
  const auto kind = [&](std::string_view marked, const std::string& label) {
    const Json items = editor.At("textDocument/completion", marked)["result"]["items"];
    for (const Json& item : items) {
      if (item["label"] == label) return item["kind"].get<int>();
    }
    return 0;
  };
  EXPECT_EQ(kind("VR[0] = SI|\n", "SIN"), 3);
  EXPECT_EQ(kind("VR[0] = V|\n", "VR"), 6);
  EXPECT_EQ(kind("MO|\n", "MOVE"), 14);
  EXPECT_EQ(kind("VR[0] = 1 M|\n", "MOD"), 14);
  EXPECT_EQ(kind("VR[0] = P|\n", "PI"), 21);
}

}  // namespace
}  // namespace rmlcell::lsp
