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
