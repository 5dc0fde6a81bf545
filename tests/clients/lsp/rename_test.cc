#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::HasSubstr;

std::string Renamed(std::string_view marked, const std::string& name) {
  Editor editor;
  const Json answer = editor.At("textDocument/rename", marked, {{"newName", name}});
  if (answer.contains("error")) return "refused: " + answer["error"]["message"].get<std::string>();
  EXPECT_EQ(answer["result"]["changes"].size(), 1U);
  return Applied(Cursor(marked).text, answer["result"]["changes"][kUri]);
}

// OPT-7.15, OPT-7.17, OPT-2.54
TEST(Rename, ASequenceNumberChangesWithEveryJumpToIt) {
  EXPECT_EQ(Renamed("1|0 SPEED 10\nGOTO 10\nGOTO VI[2] (20, 010)\n"
                    "MOVE (10,0,0,0,0)/TIME (10, 10)\n20 GOSUB 10 ; GOTO 10\n",
                    "900"),
            "900 SPEED 10\nGOTO 900\nGOTO VI[2] (20, 900)\n"
            "MOVE (10,0,0,0,0)/TIME (10, 900)\n20 GOSUB 900 ; GOTO 10\n");
}

// OPT-1.23, OPT-1.25, OPT-7.16
TEST(Rename, ASequenceNumberThatIsTakenOrNoneIsRefused) {
  EXPECT_THAT(Renamed("1|0 SPEED 5\n20 SPEED 6\n", "20"), HasSubstr("taken"));
  EXPECT_THAT(Renamed("1|0 SPEED 5\n20 SPEED 6\n", "020"), HasSubstr("taken"));
  EXPECT_THAT(Renamed("1|0 SPEED 5\nGOTO 30\n", "30"), HasSubstr("lead nowhere"));
  for (const char* name : {"10000", "-1", "1.5", "", "X", "00010", " 5"})
    EXPECT_THAT(Renamed("1|0 SPEED 5\n", name), HasSubstr("OPT-1.23")) << name;
  EXPECT_EQ(Renamed("1|0 SPEED 5\n", "9999"), "9999 SPEED 5\n");
  EXPECT_EQ(Renamed("1|0 SPEED 5\n", "0"), "0 SPEED 5\n");
  EXPECT_EQ(Renamed("1|0 SPEED 5\n", "0010"), "0010 SPEED 5\n");
  EXPECT_THAT(Renamed("GOTO 1|0\n", "20"), HasSubstr("no sequence number 10"));
}

// OPT-7.41, OPT-7.46
TEST(Rename, ANameChangesInEverySpelling) {
  EXPECT_EQ(Renamed("DECLARE XHOME = 10.5\nDECLARE I = 5\nVR[I] = xhome + XHO|ME ; XHOME\n"
                    "IF XHome > 1 THEN 5\n",
                    "XNEAR"),
            "DECLARE XNEAR = 10.5\nDECLARE I = 5\nVR[I] = XNEAR + XNEAR ; XHOME\n"
            "IF XNEAR > 1 THEN 5\n");
  EXPECT_EQ(Renamed("DECLARE I = 5\nVR[|I] = VR[ I ]\n", "K"), "DECLARE K = 5\nVR[K] = VR[ K ]\n");
}

// OPT-7.45, OPT-7.46, OPT-7.48
TEST(Rename, ANameThatIsReservedTakenOrNoneIsRefused) {
  constexpr const char* kText = "DECLARE |X = 1\nDECLARE POSITION1 = 2\n";
  EXPECT_THAT(Renamed(kText, "C"), HasSubstr("reserved"));
  EXPECT_THAT(Renamed(kText, "Function2"), HasSubstr("reserved: FUNCTION"));
  EXPECT_THAT(Renamed(kText, "POSITION2"), HasSubstr("same name as 'POSITION1'"));
  EXPECT_THAT(Renamed(kText, "position"), HasSubstr("same name"));
  for (const char* name : {"2X", "X_1", "", "X Y", "\xC3\xA4"})
    EXPECT_THAT(Renamed(kText, name), HasSubstr("OPT-7.45")) << name;
  EXPECT_EQ(Renamed(kText, "x"), "DECLARE x = 1\nDECLARE POSITION1 = 2\n");  // its own spelling
}

TEST(Rename, WhatHasNoOtherNameIsRefused) {
  EXPECT_THAT(Renamed("SPE|ED 5\n", "X"), HasSubstr("reserved word"));
  EXPECT_THAT(Renamed("SPEED VR[|5]\n", "X"), HasSubstr("DECLARE"));
  EXPECT_THAT(Renamed("CALL 4|4\n", "45"), HasSubstr("renaming its file"));
  EXPECT_THAT(Renamed("SPEED UNK|NOWN\n", "X"), HasSubstr("not declared"));
  EXPECT_THAT(Renamed("SPEED 5 ; SPE|ED\n", "X"), HasSubstr("no name"));
  EXPECT_THAT(Renamed("|", "X"), HasSubstr("no name"));
}

TEST(Rename, ItIsPreparedWithTheRangeAndThePresentName) {
  Editor editor;
  const Json result = editor.At("textDocument/prepareRename", "GOTO 01|0\n10 STOP\n")["result"];
  EXPECT_EQ(result["range"], ToJson(Range{{0, 5}, {0, 8}}));
  EXPECT_EQ(result["placeholder"], "010");
  EXPECT_TRUE(editor.At("textDocument/prepareRename", "STO|P\n").contains("error"));
}

}  // namespace
}  // namespace rmlcell::lsp
