// What a hover says at its bounds: how much of a text is quoted, how many uses are counted, which
// definition is meant.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "clients/lsp/answers.h"
#include "engine/core/diagnostic.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

std::string HoverIn(Editor& editor, std::string_view marked) {
  const Json answer = editor.At("textDocument/hover", marked);
  if (!answer.contains("result") || answer["result"].is_null()) return {};
  return answer["result"]["contents"]["value"];
}
std::string HoverIn(std::string_view marked) {
  Editor editor;
  return HoverIn(editor, marked);
}

// 120 bytes of a value are quoted, and what is cut is marked as cut.
TEST(HoverDetails, AQuoteIsCutBehind120Bytes) {
  const auto quoted = [](std::size_t bytes) {
    const std::string value(bytes, '1');
    return HoverIn("DECLARE X = " + value + "\nVR[0] = X|\n");
  };
  EXPECT_THAT(quoted(120), HasSubstr("= `" + std::string(120, '1') + "`\n"));
  EXPECT_THAT(quoted(121), HasSubstr("= `" + std::string(120, '1') + " ...`\n"));
}

// As code in one line: each run of blanks and line ends is one blank, none at an end; no backtick.
TEST(HoverDetails, AQuoteIsOneLine) {
  EXPECT_THAT(HoverIn("WORKDEF 1,0 (8.0,\r\n\t 75.0, 1.0, 50.0, 12)\nWO|RK 1,0/ON\n"),
              AllOf(HasSubstr("Defined on line 1: `WORKDEF 1,0 (8.0, 75.0, 1.0, 50.0, 12)`\n"),
                    HasSubstr("\n- power at that speed, percent: `75.0`\n")));
  Editor editor;
  editor.folder.files["file:///work/44.S"] = ";\t`twice`  \nSPEED 5\n";
  EXPECT_THAT(HoverIn(editor, "CALL 4|4\n"), EndsWith("\n\n`; 'twice'`"));
}

// OPT-7.20
TEST(HoverDetails, JumpsAndGosubsAreCountedOfThatNumberAlone) {
  EXPECT_THAT(HoverIn("1|0 SPEED 5\nGOTO 20\n20 STOP\n"),
              HasSubstr("\n\n0 jumps, 0 GOSUBs to it."));
  EXPECT_THAT(HoverIn("1|0 SPEED 5\nGOTO 10\nGOSUB 10\nGOSUB 10\nIF VL[0] THEN 10\n"),
              HasSubstr("\n\n2 jumps, 2 GOSUBs to it."));
  EXPECT_THAT(HoverIn("1|0 SPEED 5\nGOTO 10\n"), HasSubstr("\n\n1 jump, 0 GOSUBs to it."));
}

// OPT-1.27: what a jump leads to is the first statement at or behind its number; of the number
// itself it stands there to be read.
TEST(HoverDetails, AJumpShowsWhereItLeads) {
  EXPECT_THAT(HoverIn("GOTO 1|0\n10\n20\n; note\nSPEED 5\nSPEED 6\n"),
              AllOf(HasSubstr("on line 2, step 2\n"), EndsWith("\n\n`SPEED 5`")));
  EXPECT_THAT(HoverIn("GOTO 10\nGOTO 20\n1|0 SPEED 5\n20\n"),
              AllOf(HasSubstr("on line 3, step 3\n"), Not(HasSubstr("`"))));
  EXPECT_THAT(HoverIn("GOTO 10\nGOTO 2|0\n10 SPEED 5\n20\n"),
              AllOf(HasSubstr("on line 4, the end of the program\n"), Not(HasSubstr("`"))));
}

// OPT-3.11: the nearest WORKDEF of that process before a WORK, else the first behind it.
TEST(HoverDetails, AWorkHasTheWorkdefThatItFollows) {
  EXPECT_THAT(HoverIn("WORKDEF 1,0 (1,2,3,4)\nWORKDEF 1,0 (2,2,3,4)\nWORKDEF 1,1 (5,2,3,4)\n"
                      "WORKDEF 2,0 (6)\nWO|RK 1,0/ON\nWORKDEF 1,0 (3,2,3,4)\n"),
              HasSubstr("Defined on line 2: "));
  EXPECT_THAT(HoverIn("WORKDEF 2,0 (6)\nWO|RK 1,0/ON\nWORKDEF 1,0 (3,2,3,4)\nWORKDEF 1,0 "
                      "(4,2,3,4)\n"),
              HasSubstr("Defined on line 3: "));
  EXPECT_THAT(HoverIn("WORKDEF 1,1 (1,2,3,4)\nWORKDEF 2,0 (6)\nWO|RK 1,0/ON\n"),
              HasSubstr("This program has no WORKDEF 1,0. Rule OPT-3.09"));
}

TEST(HoverDetails, AWorkdefCountsWhereItIsTurnedOn) {
  EXPECT_THAT(HoverIn("WO|RKDEF 1,0 (1,2,3,4)\nWORK 1,0/OFF\nWORK 1,1/ON\nWORK 2,0/ON\n"),
              HasSubstr("Process 1,0, turned ON 0 times."));
  EXPECT_THAT(HoverIn("WO|RKDEF 1,0 (1,2,3,4)\nWORK 1,0/ON\nWORK 1,0/OFF\nWORK 1,0/ON\n"),
              HasSubstr("Process 1,0, turned ON 2 times."));
}

// OPT-3.05, OPT-3.06: a value may be an expression with commas of its own.
TEST(HoverDetails, TheValuesOfAWorkdefHaveTheirNames) {
  EXPECT_THAT(HoverIn("WO|RKDEF 1,0 (8.0, (1+2)*3, 0.5, SIN (PI), 11)\n"),
              EndsWith("turned ON 0 times.\n\n- speed, percent of the largest: `8.0`"
                       "\n- power at that speed, percent: `(1+2)*3`\n- dwell at peak, s: `0.5`"
                       "\n- piercing power, percent: `SIN (PI)`\n- laser schedule: `11`"));
  // One of kind 2 has a schedule and no more.
  EXPECT_THAT(HoverIn("WO|RKDEF 2,0 (11, 5)\n"),
              EndsWith("turned ON 0 times.\n\n- laser schedule: `11`"));
  EXPECT_THAT(HoverIn("WO|RKDEF 1,0 (1,2,3,4,5,6)\n"), EndsWith("- laser schedule: `5`"));
  for (const char* open : {"WO|RKDEF 1,0\n", "WO|RKDEF 1,0 (8.0\n", "WO|RKDEF 1,0 8.0)\n"})
    EXPECT_THAT(HoverIn(open), EndsWith("turned ON 0 times.")) << open;
}

// Schedules have the numbers 1 to 63 (OPT-3.26).
TEST(HoverDetails, OnlyNumbersOfSchedulesAreLookedUp) {
  Editor editor;
  editor.folder.files["file:///work/project.json"] =
      R"({"laserSchedules": [{"number": 0, "mode": "A"}, {"number": 1, "mode": "B"},
          {"number": 63, "mode": "C"}, {"number": 64, "mode": "D"}]})";
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,0 (0)\n"), EndsWith("`0`"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,0 ( 1\t)\n"), EndsWith("`1` (B)"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,0 (63)\n"), EndsWith("`63` (C)"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,0 (64)\n"), EndsWith("`64`"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,0 (XP)\n"), EndsWith("`XP`"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,0 ( )\n"), EndsWith("``"));
  // Of a process with a laser only the last value is a schedule.
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 1,0 (1,1,1,1,1)\n"),
              EndsWith("- piercing power, percent: `1`\n- laser schedule: `1` (B)"));
}

// OPT-7.44, OPT-7.46: uses are those that read or write, not the DECLARE.
TEST(HoverDetails, ANameCountsItsUses) {
  EXPECT_THAT(HoverIn("DECLARE XHO|ME = 5\nDECLARE OTHER = 6\nVR[0] = OTHER\n"),
              HasSubstr("Declared on line 1, used 0 times."));
  EXPECT_THAT(HoverIn("\nDECLARE XHO|ME = 5\nVR[0] = XHOME\n"),
              HasSubstr("Declared on line 2, used 1 time."));
  EXPECT_THAT(HoverIn("DECLARE POSITION = 5\nVR[0] = POSIT|ION\n"), Not(HasSubstr("OPT-7.46")));
  EXPECT_THAT(HoverIn("DECLARE POSITIONS = 5\nVR[0] = POSIT|IONS\n"), HasSubstr("OPT-7.46"));
}

// OPT-7.07: a name behind CALL is a program, too, and what is passed is none.
TEST(HoverDetails, ACalledNameIsToldWithItsProgram) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "VR[0] = PAR[2]\nVR[1] = PAR[0]\n";
  EXPECT_THAT(HoverIn(editor, "DECLARE RECT = 44\nCALL RE|CT\n"),
              EndsWith("\n\n**Program 44** in `44.S`, 2 steps\n\nReads PAR[0] to PAR[2]."));
  editor.folder.files["file:///work/45.S"] = "VR[0] = PAR[0]\n";
  EXPECT_THAT(HoverIn(editor, "CALL 4|5\n"), EndsWith("1 step\n\nReads PAR[0]."));
  editor.folder.files["file:///work/46.S"] = "VR[0] = PAR[1]\n";
  EXPECT_THAT(HoverIn(editor, "CALL 4|6\n"), EndsWith("1 step\n\nReads PAR[0] to PAR[1]."));
  EXPECT_THAT(HoverIn(editor, "DECLARE RECT = 44\nCALL 4 (RE|CT)\n"), Not(HasSubstr("Program")));
  EXPECT_THAT(HoverIn(editor, "DECLARE RECT = 44\n10 GO RE|CT\n"), HasSubstr("**Program 44**"));
  EXPECT_THAT(HoverIn(editor, "DECLARE RECT = 44.5\nCALL RE|CT\n"), Not(HasSubstr("Program")));
  EXPECT_THAT(HoverIn(editor, "DECLARE RECT = 100\nCALL RE|CT\n"), Not(HasSubstr("Program")));
  EXPECT_THAT(HoverIn(editor, "DECLARE RECT = 99\nCALL RE|CT\n"), HasSubstr("**Program 99**"));
}

// OPT-B.83, OPT-B.84: programs 2, 4 and 90 stand on the control from the beginning.
TEST(HoverDetails, AProgramThatIsNotInTheFolder) {
  EXPECT_THAT(HoverIn("CALL 4|5\n"),
              EndsWith("**Program 45**\n\nThere is no file 45.S in this folder."));
  EXPECT_THAT(HoverIn("CALL |4\n"), EndsWith("in this folder. On the control it is HOME RETURN."));
}

TEST(HoverDetails, TheHeadOfAProgramIsTheCommentBeforeItsFirstStatement) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "; cuts a hole\n; second line\nSPEED 5\n";
  editor.folder.files["file:///work/45.S"] = "SPEED 5 ; slow\n";
  editor.folder.files["file:///work/46.S"] = "; nothing yet\n";
  EXPECT_THAT(HoverIn(editor, "CALL 4|4\n"),
              EndsWith("**Program 44** in `44.S`, 1 step\n\n`; cuts a hole`"));
  EXPECT_THAT(HoverIn(editor, "CALL 4|5\n"), EndsWith("**Program 45** in `45.S`, 1 step"));
  EXPECT_THAT(HoverIn(editor, "CALL 4|6\n"), EndsWith("0 steps\n\n`; nothing yet`"));
}

// OPT-7.44: a variable may have several names.
TEST(HoverDetails, AVariableHasItsNames) {
  EXPECT_THAT(HoverIn("DECLARE A1 = VR[30]\nDECLARE B1 = VR[31]\nDECLARE C1 = VR[30]\n"
                      "DECLARE D1 = VI[30]\nVR[3|0] = 1.\n"),
              EndsWith("\n\nDeclared here as A1, C1."));
  EXPECT_THAT(HoverIn("DECLARE B1 = VR[31]\nVR[3|0] = 1.\n"), Not(HasSubstr("Declared")));
}

// A finding of a place stands below what is there; three at most of one place.
TEST(HoverDetails, FindingsOfAPlaceStandBelow) {
  Editor editor;
  editor.Open("SPEED 101\nSPEED 5\n");
  editor.Diagnostics();
  const auto at = [&](std::uint32_t line, std::uint32_t character) {
    const Json result = editor.Result(
        "textDocument/hover",
        {{"textDocument", {{"uri", kUri}}}, {"position", ToJson(Position{line, character})}});
    return result.is_null() ? std::string() : result["contents"]["value"].get<std::string>();
  };
  EXPECT_THAT(at(0, 6), HasSubstr("OPT-E7004"));  // its first byte
  EXPECT_THAT(at(0, 9), HasSubstr("OPT-E7004"));  // behind its last
  EXPECT_THAT(at(0, 5), Not(HasSubstr("OPT-E7004")));
  EXPECT_THAT(at(1, 6), Not(HasSubstr("OPT-E7004")));
}

// Three findings of a place are told; one of no place is of none of them.
TEST(HoverDetails, ThreeFindingsOfOnePlace) {
  const Document document(kUri, "optimo-rml", 1, "SPEED 5\n", Encoding::kUtf16);
  const auto told = [&](std::size_t offset, std::int64_t at, std::size_t count) {
    Diagnostic finding{.code = ErrorCode::kNameUndeclared, .severity = Severity::kCompile};
    finding.where.byte_offset = at;
    finding.where.length = 2;
    const std::vector<Diagnostic> findings(count, finding);
    const Json answer = HoverAnswer(document, offset, std::nullopt, findings, nullptr);
    if (answer.is_null()) return std::size_t{0};
    const std::string text = answer["contents"]["value"];
    std::size_t found = 0;
    for (std::size_t from = text.find("**OPT-E7011**"); from != std::string::npos;
         from = text.find("**OPT-E7011**", from + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(told(0, -1, 1), 0U);
  EXPECT_EQ(told(0, 0, 1), 1U);
  EXPECT_EQ(told(3, 4, 1), 0U);
  EXPECT_EQ(told(4, 4, 1), 1U);
  EXPECT_EQ(told(6, 4, 1), 1U);
  EXPECT_EQ(told(7, 4, 1), 0U);
  EXPECT_EQ(told(4, 4, 3), 3U);
  EXPECT_EQ(told(4, 4, 4), 3U);
}

// OPT-6.01: DECLARE is no step, whatever stands before it.
TEST(HoverDetails, WhatIsNoStepHasNoNumber) {
  EXPECT_THAT(HoverIn("SPEED 5\nDECL|ARE X = 1\n"),
              AllOf(HasSubstr("**DECLARE**"), Not(HasSubstr("\n\nStep "))));
  EXPECT_THAT(HoverIn("DECLARE X = 1\nSP|EED 5\n"), EndsWith("\n\nStep 1"));
}

// OPT-3.05, OPT-3.26: JSON names a mode with its prefix and leaves out what is 0 or empty; a
// schedule without a mode is CW.
TEST(HoverDetails, WhatAProjectLeavesOutIsItsDefault) {
  Editor editor;
  editor.folder.files["file:///work/project.json"] =
      R"({"laserSchedules": [{"number": 11, "mode": "LASER_MODE_PULSE", "powerPercent": 50},
                             {"number": 12, "title": "fine"},
                             {"number": 13, "mode": "LASER_MODE_CW", "title": ""}],
          "processes": [{"values": [5], "note": ""}, {"kind": 1, "note": "steel"}]})";
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,1 (11)\n"), EndsWith("`11` (PULSE, 50 %)"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,1 (12)\n"), EndsWith("`12` (CW, fine)"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 2,1 (13)\n"), EndsWith("`13` (CW)"));
  EXPECT_THAT(HoverIn(editor, "WO|RK 0,0/ON\n"), EndsWith("\n\nIn project.json: 5"));
  EXPECT_THAT(HoverIn(editor, "WO|RKDEF 1,0 (1,2,3,4)\n"),
              EndsWith("\n\nIn project.json: (steel)"));
}

// OPT-9.21: what a program reads of its caller is PAR alone, whatever other variables it has.
TEST(HoverDetails, AProgramReadsItsParAlone) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "VR[50] = PAR[1]\n";
  editor.folder.files["file:///work/45.S"] = "VR[50] = VI[7]\n";
  EXPECT_THAT(HoverIn(editor, "CALL 4|4\n"), EndsWith("Reads PAR[0] to PAR[1]."));
  EXPECT_THAT(HoverIn(editor, "CALL 4|5\n"),
              AllOf(HasSubstr("in `45.S`"), Not(HasSubstr("Reads"))));
}

// OPT-3.03: a WORKDEF of kind 0 has no values that mean anything.
TEST(HoverDetails, KindZeroHasNoParameters) {
  EXPECT_THAT(HoverIn("WO|RKDEF 0,0 (5)\n"), AllOf(HasSubstr("Process 0,0, turned ON 0 times."),
                                                   Not(HasSubstr("\n- laser schedule"))));
}

// OPT-W.05: a word without effect is told by its own rule; it is no instruction with a step.
TEST(HoverDetails, AWordWithoutEffectHasItsRule) {
  EXPECT_THAT(HoverIn("CO|NT 3\n"),
              AllOf(HasSubstr("\n\nRule OPT-W.05"), Not(HasSubstr("\n\nStep "))));
}

}  // namespace
}  // namespace rmlcell::lsp
