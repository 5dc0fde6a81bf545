#include "clients/lsp/text_edits.h"

#include <gtest/gtest.h>

#include "engine/optimo/language/fixes.h"
#include "engine/optimo/language/formatter.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

Json FormatOf(std::string_view text) {
  Editor editor;
  editor.Open(text);
  return editor.Result(
      "textDocument/formatting",
      {{"textDocument", {{"uri", kUri}}}, {"options", {{"tabSize", 2}, {"insertSpaces", true}}}});
}

// OPT-B.40: what comes out is what `rmlcell format` writes.
TEST(Formatting, TheEditsGiveTheCanonicalText) {
  for (const std::string text :
       {"speed   20   ; slow\n\n; alone\nMOVE(1.,2.,3.,0.,0.)\n", "speed 20",
        "10 goto 10\r\nstop\r\n", "move (1,2,\n3,0,0)/fly\nSPEED 5\n     SPEED 6\nspeed 7\n",
        "; \xF0\x9D\x84\x9E\nspeed 5 ; \xC3\xA4\nstop\n", "speed 5\n\x1A junk\n"}) {
    EXPECT_EQ(Applied(text, FormatOf(text)), optimo::Format(text).text) << text;
  }
}

TEST(Formatting, OnlyLinesThatChangeAreTouched) {
  const Json edits = FormatOf("     SPEED 5\nspeed 6\nspeed 7\n     SPEED 8\nstop\n");
  ASSERT_EQ(edits.size(), 2U);
  EXPECT_EQ(edits[0]["range"], ToJson(Range{{1, 0}, {3, 0}}));
  EXPECT_EQ(edits[0]["newText"], "     SPEED 6\n     SPEED 7\n");
  EXPECT_EQ(edits[1]["range"], ToJson(Range{{4, 0}, {5, 0}}));
}

TEST(Formatting, CanonicalAndBrokenProgramsAndStreamsStayAsTheyAre) {
  EXPECT_EQ(FormatOf("     SPEED 5\n"), Json::array());
  EXPECT_EQ(FormatOf("speed 5\nMOVE (\n"), Json::array());
  EXPECT_EQ(FormatOf(""), Json::array());
  Editor editor;
  editor.Open("PU0,0;", "file:///a.rml", "rml1");
  EXPECT_TRUE(
      editor.Result("textDocument/formatting", {{"textDocument", {{"uri", "file:///a.rml"}}}})
          .is_null());
}

Json ActionsOf(Editor& editor, Range range, Json context = Json::object()) {
  return editor.Result("textDocument/codeAction", {{"textDocument", {{"uri", kUri}}},
                                                   {"range", ToJson(range)},
                                                   {"context", std::move(context)}});
}
const Json* Titled(const Json& actions, std::string_view part) {
  for (const Json& action : actions) {
    if (action["title"].get<std::string>().find(part) != std::string::npos) return &action;
  }
  return nullptr;
}

// OPT-7.37, OPT-2.61, OPT-7.91
TEST(CodeActions, AFixIsAnEditOfItsFinding) {
  Editor editor;
  const std::string text = "SYSDEF (0.,0.,0.,0.,0.,0.)\nMOVE (1,2,3,0,0) /INF\nSPED 5\n";
  editor.Open(text);
  const Json sysdef = ActionsOf(editor, {{0, 3}, {0, 3}});
  const Json* fix = Titled(sysdef, "by 'SYSDEF'");
  // The last line is an error, so advice on SYSDEF comes with it all the same.
  ASSERT_NE(fix, nullptr) << sysdef.dump();
  EXPECT_EQ((*fix)["kind"], "quickfix");
  EXPECT_EQ((*fix)["diagnostics"][0]["code"], "OPT-E7311");
  EXPECT_EQ(Applied(text, (*fix)["edit"]["changes"][kUri]),
            "SYSDEF\nMOVE (1,2,3,0,0) /INF\nSPED 5\n");
  const Json inf = ActionsOf(editor, {{1, 0}, {1, 5}});
  fix = Titled(inf, "Remove '/INF'");
  ASSERT_NE(fix, nullptr) << inf.dump();
  EXPECT_EQ(Applied(text, (*fix)["edit"]["changes"][kUri]),
            "SYSDEF (0.,0.,0.,0.,0.,0.)\nMOVE (1,2,3,0,0)\nSPED 5\n");
  const Json speed = ActionsOf(editor, {{2, 0}, {2, 1}});
  fix = Titled(speed, "Replace 'SPED' by 'SPEED'");
  ASSERT_NE(fix, nullptr) << speed.dump();
  EXPECT_EQ((*fix)["isPreferred"], true);
}

TEST(CodeActions, AllFixesAtOnceAreThoseOfTheEngine) {
  Editor editor;
  const std::string text =
      "SYSDEF (0.,0.,0.,0.,0.,0.)\nMOVE (1,2,3,0,0) /INF\nMOVE (1,2,3,0,0)/INF /FLY\n";
  editor.Open(text);
  const Json actions = ActionsOf(editor, {{0, 0}, {0, 0}}, {{"only", {"source.fixAll"}}});
  ASSERT_EQ(actions.size(), 1U);
  EXPECT_EQ(actions[0]["kind"], "source.fixAll.rmlcell");
  const Findings findings = CheckDocument({kUri, {}, 0, text, Encoding::kUtf16});
  EXPECT_EQ(Applied(text, actions[0]["edit"]["changes"][kUri]),
            optimo::ApplyFixes(text, findings.list));
  EXPECT_EQ(ActionsOf(editor, {{0, 0}, {0, 0}}, {{"only", {"refactor"}}}), Json::array());
}

// A directive silences its finding, and only warnings and advice.
TEST(CodeActions, AWarningCanBeAllowedOnItsLine) {
  Editor editor;
  std::string text = "SPEED 5 \nVR[98] = 1.\r\nSPEED 101\n";
  editor.Open(text);
  const Json actions = ActionsOf(editor, {{1, 0}, {1, 0}});
  const Json* allow = Titled(actions, "Allow 7413");
  ASSERT_NE(allow, nullptr) << actions.dump();
  text = Applied(text, (*allow)["edit"]["changes"][kUri]);
  EXPECT_EQ(text, "SPEED 5 \nVR[98] = 1.  ; rmlcell: allow 7413\r\nSPEED 101\n");
  for (const Diagnostic& finding : CheckDocument({kUri, {}, 0, text, Encoding::kUtf16}).list)
    EXPECT_NE(finding.code, ErrorCode::kReservedVariable);
  EXPECT_EQ(Titled(ActionsOf(editor, {{2, 7}, {2, 7}}), "Allow"), nullptr);
}

TEST(CodeActions, ADirectiveThatIsThereGetsAnotherNumberAndAnotherCommentStays) {
  Editor editor;
  std::string text = "VR[98] = 1. ; rmlcell: allow 7033\nVR[99] = 1. ; mine\n";
  editor.Open(text);
  const Json actions = ActionsOf(editor, {{0, 0}, {0, 0}});
  ASSERT_NE(Titled(actions, "Allow 7413"), nullptr);
  EXPECT_EQ(Applied(text, (*Titled(actions, "Allow 7413"))["edit"]["changes"][kUri]),
            "VR[98] = 1. ; rmlcell: allow 7033 7413\nVR[99] = 1. ; mine\n");
  EXPECT_EQ(Titled(ActionsOf(editor, {{1, 0}, {1, 0}}), "Allow"), nullptr);
}

// What is said about a directive is repaired, and nothing silences it.
TEST(CodeActions, AMistypedDirectiveIsRepaired) {
  Editor editor;
  const std::string text = "SPEED 5 ; rmlcell: alow 7033\n";
  editor.Open(text);
  const Json actions = ActionsOf(editor, {{0, 10}, {0, 10}});
  const Json* fix = Titled(actions, "Replace 'alow' by 'allow'");
  ASSERT_NE(fix, nullptr) << actions.dump();
  EXPECT_EQ(Applied(text, (*fix)["edit"]["changes"][kUri]), "SPEED 5 ; rmlcell: allow 7033\n");
  EXPECT_EQ(Titled(actions, "Allow"), nullptr);
}

TEST(CodeActions, AnEditorThatKnowsCommandsOnlyGetsNone) {
  Editor editor(Json::object());
  editor.Open("SPED 5\n");
  EXPECT_EQ(ActionsOf(editor, {{0, 0}, {0, 1}}), Json::array());
}

}  // namespace
}  // namespace rmlcell::lsp
