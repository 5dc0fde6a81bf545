#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string HoverAt(std::string_view marked, Editor& editor) {
  const Json answer = editor.At("textDocument/hover", marked);
  if (!answer.contains("result") || answer["result"].is_null()) return {};
  EXPECT_EQ(answer["result"]["contents"]["kind"], "markdown");
  return answer["result"]["contents"]["value"];
}
std::string HoverAt(std::string_view marked) {
  Editor editor;
  return HoverAt(marked, editor);
}

// OPT-2.34, OPT-2.44
TEST(Hover, AnInstructionHasItsFormItsRuleAndItsStep) {
  EXPECT_THAT(HoverAt("DECLARE X = VR[0]\nPATH LIN\nspe|ed 20\n"),
              AllOf(HasSubstr("**SPEED** `SPEED percent`"), HasSubstr("OPT-2.34"),
                    HasSubstr("OPT-W.41"), HasSubstr("Step 2")));
  EXPECT_THAT(HoverAt("MOVE (1,2,3,0,0)/F|LY\n"),
              AllOf(HasSubstr("**FLY**"), HasSubstr("without a stop"), Not(HasSubstr("Step"))));
}

TEST(Hover, TheRangeIsTheWord) {
  Editor editor;
  const Json result = editor.At("textDocument/hover", "10 SPE|ED 20\n")["result"];
  EXPECT_EQ(result["range"], ToJson(Range{{0, 3}, {0, 8}}));
}

TEST(Hover, CommentsAndEmptyPlacesSayNothing) {
  EXPECT_EQ(HoverAt("SPEED 20 ; SPE|ED 30\n"), "");
  EXPECT_EQ(HoverAt("SPEED 20\n|\n"), "");
  EXPECT_EQ(HoverAt("|"), "");
}

// OPT-7.20, OPT-1.27
TEST(Hover, ASequenceNumberSaysWhereItIsAndWhoJumps) {
  constexpr const char* kText = "GOSUB 1|00\nGOTO 100\nENDTASK\n100\n; here\nSPEED 5\nRETURN\n";
  EXPECT_THAT(HoverAt(kText), AllOf(HasSubstr("**Sequence number 100** on line 4, step 4"),
                                    HasSubstr("1 jump, 1 GOSUB"), HasSubstr("`SPEED 5`")));
  EXPECT_THAT(HoverAt("GOTO 1|0\n"),
              AllOf(HasSubstr("no sequence number 10"), HasSubstr("OPT-7.16")));
  EXPECT_THAT(HoverAt("GOTO 1|0\n10\n"), HasSubstr("the end of the program"));
}

// OPT-7.44, OPT-7.46, OPT-7.50
TEST(Hover, ANameSaysWhatItStandsFor) {
  EXPECT_THAT(HoverAt("DECLARE SPEED1 = VR[64]\nSPEED SPE|ED1\nSPEED SPEED1\n"),
              AllOf(HasSubstr("**SPEED1** = `VR[64]`"), HasSubstr("line 1, used 2 times"),
                    HasSubstr("speed 1")));
  EXPECT_THAT(HoverAt("SPEED NO|NE\n"), HasSubstr("not declared"));
  EXPECT_THAT(HoverAt("DECLARE POSITION1 = 5.\nVR[0] = POSITION|2\n"),
              AllOf(HasSubstr("**POSITION1** = `5.`"), HasSubstr("Eight characters")));
}

// OPT-7.104, OPT-7.71
TEST(Hover, AVariableSaysWhatItIsKeptForAndItsNames) {
  EXPECT_THAT(HoverAt("DECLARE E = VI[99]\nIF VI [9|9] = 60 THEN 5\n"),
              AllOf(HasSubstr("**VI[99]**"), HasSubstr("latest error"), HasSubstr("OPT-7.71"),
                    HasSubstr("Declared here as E")));
}

// OPT-3.05, OPT-3.09
TEST(Hover, AWorkShowsTheWorkdefBeforeIt) {
  constexpr const char* kText =
      "WORKDEF 1,00 (8.0, 75.0, 1.0, 50.0, 12)\nWORK 1,0/OFF\nWO|RK 1,0 /ON\nWORKDEF 1,0 "
      "(1,2,3,4)\n";
  EXPECT_THAT(HoverAt(kText), AllOf(HasSubstr("Defined on line 1"),
                                    HasSubstr("speed, percent of the largest: `8.0`"),
                                    HasSubstr("dwell at peak, s: `1.0`"),
                                    HasSubstr("laser schedule: `12`"), Not(HasSubstr("`4`"))));
  EXPECT_THAT(HoverAt("WORKD|EF 2,5 (15)\nWORK 2,5/ON\n"),
              AllOf(HasSubstr("turned ON 1 time."), HasSubstr("laser schedule: `15`")));
  EXPECT_THAT(HoverAt("WO|RK 1,3/ON\n"), AllOf(HasSubstr("no WORKDEF 1,3"), HasSubstr("OPT-3.09")));
  EXPECT_THAT(HoverAt("WO|RK 0,3/ON\n"), HasSubstr("needs no WORKDEF"));
}

// OPT-3.05, OPT-3.06
TEST(Hover, SchedulesAndProcessesOfTheProjectAreShown) {
  Editor editor;
  editor.folder.files["file:///work/project.json"] =
      R"({"laserSchedules": [{"number": 11, "mode": "PULSE", "powerPercent": 50, "title": "fine"}],
          "processes": [{"kind": 1, "process": 0, "values": [8, 75, 0.5, 60], "note": "steel"}]})";
  EXPECT_THAT(HoverAt("WORKDEF 2,0 (11)\nWO|RK 2,0/ON\n", editor),
              AllOf(HasSubstr("laser schedule: `11` (PULSE, 50 %, fine)"),
                    Not(HasSubstr("In project.json"))));
  EXPECT_THAT(HoverAt("WORKD|EF 1,0 (8.,75.,.5,60.,12)\n", editor),
              AllOf(HasSubstr("laser schedule: `12`\n\nIn project.json: 8, 75, 0.5, 60 (steel)")));
  for (const char* broken :
       {"", "[]", "{\"laserSchedules\": 5}", "{\"laserSchedules\": [5, {}]}"}) {
    editor.folder.files["file:///work/project.json"] = broken;
    EXPECT_THAT(HoverAt("WORKDEF 2,0 (11)\nWO|RK 2,0/ON\n", editor), HasSubstr("`11`"));
  }
}

// OPT-9.01, OPT-9.21
TEST(Hover, ACalledProgramIsTheFileBesideOrTheTextThatIsOpen) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "; a rectangle\nVR[0] = PAR[1]\nSPEED 5\n";
  EXPECT_THAT(HoverAt("FUNCTION 4|4 (1,2)\n", editor),
              AllOf(HasSubstr("**Program 44** in `44.S`, 2 steps"), HasSubstr("`; a rectangle`"),
                    HasSubstr("PAR[0] to PAR[1]")));
  editor.Open("SPEED 5\n", "file:///work/44.S");
  EXPECT_THAT(HoverAt("FUNCTION 4|4\n", editor), HasSubstr("1 step"));
  EXPECT_THAT(HoverAt("CALL 4|5\n", editor), HasSubstr("no file 45.S"));
  EXPECT_THAT(HoverAt("CALL |2\n", editor), HasSubstr("Z-UP"));
  EXPECT_THAT(HoverAt("DECLARE DATO = 44\nFUNCTION DA|TO\n", editor), HasSubstr("in `44.S`"));
}

// OPT-2.35: what is wrong is told with its rule in words, once the text was checked.
TEST(Hover, AFindingIsToldWithItsRule) {
  Editor editor;
  const WithCursor place = Cursor("SPEED 10|1\n");
  editor.Open(place.text);
  const Json asked = {{"textDocument", {{"uri", kUri}}}, {"position", ToJson(Position{0, 8})}};
  EXPECT_TRUE(editor.Result("textDocument/hover", asked).is_null());
  editor.Diagnostics();
  EXPECT_THAT(
      editor.Result("textDocument/hover", asked)["contents"]["value"],
      AllOf(HasSubstr("**OPT-E7004**"), HasSubstr("Rule OPT-2.35: SPEED, ACCEL and OVERSH")));
}

// OPT-7.20, OPT-7.44, OPT-1.27: the whole of what is said, with its counts.
TEST(Hover, CountsJumpsAndUses) {
  EXPECT_EQ(HoverAt("GOSUB 1|00\nGOTO 100\nENDTASK\n100\n; here\nSPEED 5\nRETURN\n"),
            "**Sequence number 100** on line 4, step 4\n\n1 jump, 1 GOSUB to it.\n\n`SPEED 5`");
  EXPECT_EQ(HoverAt("GOSUB 100\nGOSUB 100\nENDTASK\n1|00 SPEED 5\nRETURN\n"),
            "**Sequence number 100** on line 4, step 4\n\n0 jumps, 2 GOSUBs to it.");
  EXPECT_EQ(HoverAt("IF VL[1] THEN 1|0 ELSE 20\nGOTO VI[2] (10,20)\n20\n10 STOP\n"),
            "**Sequence number 10** on line 4, step 3\n\n2 jumps, 0 GOSUBs to it.\n\n`STOP`");
  EXPECT_EQ(HoverAt("DECLARE K = 5.\nVR[0] = K|\n"),
            "**K** = `5.`\n\nDeclared on line 1, used 1 time.");
  EXPECT_EQ(HoverAt("; one\nDECLARE K| = 5.\nDECLARE L = 6.\nVR[0] = L\n"),
            "**K** = `5.`\n\nDeclared on line 2, used 0 times.");
}

// OPT-3.05, OPT-3.06, OPT-3.07: values that are expressions stay whole.
TEST(Hover, TheValuesOfAWorkdefAreNamedInTheirOrder) {
  EXPECT_THAT(
      HoverAt("WORKD|EF 1,0 ((1+2)*3, SIN(1.),\n  1., 50.)\nWORK 1,0/ON\nWORK 1,0/ON\nWORK "
              "1,1/ON\nWORK 1,0/OFF\nWORK 2,0/ON\n"),
      testing::EndsWith("\n\nProcess 1,0, turned ON 2 times.\n\n- speed, percent of the largest: "
                        "`(1+2)*3`\n- power at that speed, percent: `SIN(1.)`\n- dwell at peak, s: "
                        "`1.`\n- piercing power, percent: `50.`"));
  EXPECT_THAT(HoverAt("WORKD|EF 0,3\nWORK 0,3/ON\n"),
              testing::EndsWith("\n\nProcess 0,3, turned ON 1 time."));
  EXPECT_THAT(HoverAt("WORKDEF 2,0 (11)\nWORKDEF 2,0 (12)\nWORKDEF 2,1 (13)\nWO|RK 2,0 "
                      "/ON\nWORKDEF 2,0 (14)\n"),
              testing::EndsWith("\n\nDefined on line 2: `WORKDEF 2,0 (12)`\n\n- laser schedule: "
                                "`12`"));
  EXPECT_THAT(HoverAt("WO|RK 2,0 /ON\nWORKDEF 2,0 (14)\nWORKDEF 2,0 (15)\n"),
              HasSubstr("Defined on line 2: `WORKDEF 2,0 (14)`"));
}

// OPT-3.06, OPT-3.07: schedules are those from 1 to 63, and a REAL one is truncated.
TEST(Hover, SchedulesOfTheProjectAreFoundByTheirNumber) {
  Editor editor;
  editor.folder.files["file:///work/project.json"] =
      R"({"laserSchedules": [{"number": 1, "mode": "CW", "powerPercent": 50},
                             {"number": 63, "mode": "PULSE", "powerPercent": 60}]})";
  const auto schedule = [&](const std::string& written) {
    return HoverAt("WORKD|EF 2,0 (" + written + ")\n", editor);
  };
  EXPECT_THAT(schedule("1"), HasSubstr("`1` (CW, 50 %)"));
  EXPECT_THAT(schedule(" 1.9 "), HasSubstr("`1.9` (CW, 50 %)"));
  EXPECT_THAT(schedule("63"), HasSubstr("`63` (PULSE, 60 %)"));
  EXPECT_THAT(schedule("63.9"), HasSubstr("`63.9` (PULSE, 60 %)"));
  for (const char* other : {"0", ".9", "2", "64", "VR[30]"})
    EXPECT_THAT(schedule(other), Not(HasSubstr("%)"))) << other;
}

// OPT-9.01, OPT-9.21: the whole of what is said of another program; what heads it is a comment
// before its first statement.
TEST(Hover, AProgramOfTheFolderIsTold) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "; a `long`\t rectangle\nVR[0] = PAR[1]\nSPEED 5\n";
  editor.folder.files["file:///work/46.S"] = "SPEED 5 ; slow\n; more\n";
  editor.folder.files["file:///work/47.S"] = ";" + std::string(130, 'x') + "\nVR[1] = PAR[0]\n";
  editor.folder.files["file:///work/48.S"] = ";" + std::string(119, 'x') + "\n";
  EXPECT_EQ(HoverAt("FUNCTION 4|4 (1,2)\n", editor),
            "**Program 44** in `44.S`, 2 steps\n\n`; a 'long' rectangle`\n\nReads PAR[0] to "
            "PAR[1].");
  EXPECT_EQ(HoverAt("CALL 4|6\n", editor), "**Program 46** in `46.S`, 1 step");
  EXPECT_EQ(HoverAt("CALL 4|7\n", editor), "**Program 47** in `47.S`, 1 step\n\n`;" +
                                               std::string(119, 'x') +
                                               " ...`\n\nReads PAR[0] to PAR[0].");
  EXPECT_EQ(HoverAt("CALL 4|8\n", editor),
            "**Program 48** in `48.S`, 0 steps\n\n`;" + std::string(119, 'x') + "`");
  EXPECT_EQ(HoverAt("CALL 4|5\n", editor),
            "**Program 45**\n\nThere is no file 45.S in this folder.");
}

TEST(Hover, AStreamOfAMillHasItsFindings) {
  Editor editor;
  editor.Open("PU0,0;QQ;", "file:///work/a.rml", "rml1");
  editor.Diagnostics();
  const Json result = editor.Result(
      "textDocument/hover",
      {{"textDocument", {{"uri", "file:///work/a.rml"}}}, {"position", ToJson(Position{0, 6})}});
  EXPECT_THAT(result.dump(), HasSubstr("RML1-E"));
}

}  // namespace
}  // namespace rmlcell::lsp
