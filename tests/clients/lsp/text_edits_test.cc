#include "clients/lsp/text_edits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/text_fixes.h"
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

// clients/lsp/text_edits.h: none for streams.
TEST(Formatting, AStreamHasNoLayout) {
  const Document stream("file:///work/a.rml", "rml1", 1, "PU0,0;PD9,9;", Encoding::kUtf16);
  EXPECT_EQ(FormattingEdits(stream), Json::array());
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
  EXPECT_EQ(Applied(text, actions[0]["edit"]["changes"][kUri]), ApplyFixes(text, findings.list));
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

std::vector<std::string> TitlesOf(const Json& actions) {
  std::vector<std::string> titles;
  for (const Json& action : actions) titles.push_back(action["title"]);
  return titles;
}
using Titles = std::vector<std::string>;

// A finding is there at both of its ends and in between; a range that ends before it begins is a
// place.
TEST(CodeActions, AFindingReachesFromItsFirstCharacterBehindItsLast) {
  Editor editor;
  editor.Open("STOP\n SPED 5\n");
  const Titles fix = {"Replace 'SPED' by 'SPEED'"};
  const auto titles = [&](const Range& range) {
    return TitlesOf(ActionsOf(editor, range, {{"only", {"quickfix"}}}));
  };
  EXPECT_EQ(titles({{1, 0}, {1, 0}}), Titles{});
  EXPECT_EQ(titles({{1, 1}, {1, 1}}), fix);
  EXPECT_EQ(titles({{1, 5}, {1, 5}}), fix);
  EXPECT_EQ(titles({{1, 6}, {1, 6}}), Titles{});
  EXPECT_EQ(titles({{0, 0}, {1, 1}}), fix);
  EXPECT_EQ(titles({{1, 5}, {1, 7}}), fix);
  EXPECT_EQ(titles({{1, 5}, {0, 0}}), fix);
  EXPECT_EQ(titles({{1, 6}, {0, 0}}), Titles{});
}

// A kind that is asked for stands for all below it; a part of a word stands for nothing.
TEST(CodeActions, OnlyKindsThatAreAskedFor) {
  Editor editor;
  editor.Open("MOVE (1,2,3,0,0) /INF\n");
  const auto kinds = [&](const Json& only) {
    std::vector<std::string> found;
    for (const Json& action : ActionsOf(editor, {{0, 0}, {0, 0}}, {{"only", only}})) {
      if (found.empty() || found.back() != action["kind"]) found.push_back(action["kind"]);
    }
    return found;
  };
  const Titles quick = {"quickfix"}, all = {"source.fixAll.rmlcell"},
               both = {"quickfix", "source.fixAll.rmlcell"};
  EXPECT_EQ(kinds(Json::array()), both);
  EXPECT_EQ(kinds(nullptr), both);
  EXPECT_EQ(kinds({""}), both);
  EXPECT_EQ(kinds({"quickfix"}), quick);
  EXPECT_EQ(kinds({"source"}), all);
  EXPECT_EQ(kinds({"source.fixAll"}), all);
  EXPECT_EQ(kinds({"source.fixAll.rmlcell"}), all);
  EXPECT_EQ(kinds({"refactor", "quickfix"}), quick);
  for (const Json& none : {Json{"sourc"}, Json{"source.fix"}, Json{"quickfix.more"},
                           Json{"source.fixAll.rmlcell.x"}, Json::array({5})}) {
    EXPECT_EQ(kinds(none), Titles{}) << none.dump();
  }
}

// A hundred for one request, and the one that stands for all.
TEST(CodeActions, AHundredAtMost) {
  for (const std::size_t lines : {99U, 100U, 101U}) {
    Editor editor;
    std::string text;
    for (std::size_t k = 0; k < lines; ++k) text += "SPED 5\n";
    editor.Open(text);
    const Json actions = ActionsOf(editor, {{0, 0}, {200, 0}});
    EXPECT_EQ(actions.size(), std::min<std::size_t>(lines, 100) + 1U);
    EXPECT_EQ(actions.back()["title"], "Apply all fixes of rmlcell");
    EXPECT_FALSE(actions.back().contains("diagnostics"));
    EXPECT_FALSE(actions.back().contains("isPreferred"));
  }
}

// The whole action that allows a warning, at the end of what stands on the line, wherever that
// ends.
TEST(CodeActions, AllowingStandsAtTheEndOfTheLine) {
  const auto allowed = [](const std::string& text, std::uint32_t line, std::uint32_t end) {
    Editor editor;
    editor.Open(text);
    const Json actions = ActionsOf(editor, {{line, 0}, {line, 0}});
    const Json* allow = Titled(actions, "Allow 7413 on this line");
    if (allow == nullptr) return std::string("nothing");
    EXPECT_EQ((*allow)["kind"], "quickfix");
    EXPECT_EQ((*allow)["isPreferred"], false);
    EXPECT_EQ((*allow)["diagnostics"][0]["code"], "OPT-E7413");
    const Json edits = (*allow)["edit"]["changes"][kUri];
    EXPECT_EQ(edits.size(), 1U);
    EXPECT_EQ(edits[0]["range"], ToJson(Range{{line, end}, {line, end}}));
    return edits[0]["newText"].get<std::string>();
  };
  const std::string comment = "  ; rmlcell: allow 7413";
  EXPECT_EQ(allowed("VR[98] = 1.", 0, 11), comment);
  EXPECT_EQ(allowed("VR[98] = 1. \t\r\nSTOP\n", 0, 11), comment);
  EXPECT_EQ(allowed("STOP\nVR[98] = 1.\nSTOP\n", 1, 11), comment);
  EXPECT_EQ(allowed("STOP\nVR[98] = 1.", 1, 11), comment);
  EXPECT_EQ(allowed("STOP ; x\n\nVR[98] = 1.\n", 2, 11), comment);
  EXPECT_EQ(allowed("VR[98] = 1.; rmlcell: allow 7033 \n", 0, 32), " 7413");
  EXPECT_EQ(allowed("VR[98] = 1.; rmlcell: allow 7033 in file\n", 0, 0), "nothing");
  EXPECT_EQ(allowed("VR[98] = 1.; mine 7033\n", 0, 0), "nothing");
}

// What a finding with these fixes, at the end of "STOP\nabc", is repaired by; nothing: by none.
Json FixedBy(const std::vector<Fix>& fixes) {
  const Document document(std::string(kUri), "optimo-rml", 1, "STOP\nabc", Encoding::kUtf16);
  const Diagnostic finding{.code = ErrorCode::kNameUndeclared,
                           .severity = Severity::kCompile,
                           .where = {.line = 2, .column = 1, .length = 3, .byte_offset = 5},
                           .fixes = fixes};
  const Json only = Json::array({"quickfix"});
  const Json actions = CodeActions(document, {{finding}, {}}, {{1, 0}, {1, 0}}, &only);
  return actions.empty() ? Json() : actions[0];
}

// Within the text, and each behind the one before it.
TEST(CodeActions, FixesThatFitAreMade) {
  const auto edits = [](const std::vector<Fix>& fixes) {
    const Json action = FixedBy(fixes);
    return action.is_null() ? Json::array() : action["edit"]["changes"][kUri];
  };
  const Json first = TextEdit({{1, 0}, {1, 1}}, "x");
  EXPECT_EQ(edits({{5, 3, "x"}}), Json::array({TextEdit({{1, 0}, {1, 3}}, "x")}));
  EXPECT_EQ(edits({{5, 4, "x"}}), Json::array());
  EXPECT_EQ(edits({{8, 0, "x"}}), Json::array({TextEdit({{1, 3}, {1, 3}}, "x")}));
  EXPECT_EQ(edits({{9, 0, "x"}}), Json::array());
  EXPECT_EQ(edits({{0, 0, "x"}}), Json::array({TextEdit({{0, 0}, {0, 0}}, "x")}));
  EXPECT_EQ(edits({{-1, 0, "x"}}), Json::array());
  EXPECT_EQ(edits({{5, -1, "x"}}), Json::array());
  EXPECT_EQ(edits({{6, 1, "y"}, {5, 1, "x"}}),
            Json::array({first, TextEdit({{1, 1}, {1, 2}}, "y")}));
  EXPECT_EQ(edits({{5, 1, "x"}, {5, 2, "y"}}), Json::array({first}));
}

// Of a long one the first 30 characters are shown.
TEST(CodeActions, TheTitleSaysWhatIsDone) {
  const auto title = [](const Fix& fix) { return FixedBy({fix})["title"].get<std::string>(); };
  EXPECT_EQ(title({5, 3, "x"}), "Replace 'abc' by 'x'");
  EXPECT_EQ(title({4, 4, ""}), "Remove ' abc'");
  EXPECT_EQ(title({5, 0, "x"}), "Insert 'x'");
  EXPECT_EQ(title({5, 0, std::string(30, 'x')}), "Insert '" + std::string(30, 'x') + "'");
  EXPECT_EQ(title({5, 0, std::string(31, 'x')}), "Insert '" + std::string(30, 'x') + "...'");
}

// Each stretch of lines that change is an edit of its own; the last line may have no end.
TEST(Formatting, StretchesOfLines) {
  EXPECT_EQ(FormatOf("speed 5\n     SPEED 6\nspeed 7\nspeed 8"),
            (Json{TextEdit({{0, 0}, {1, 0}}, "     SPEED 5\n"),
                  TextEdit({{2, 0}, {3, 7}}, "     SPEED 7\n     SPEED 8\n")}));
}

// What takes something away is never what an editor does without being asked; a title is one line.
TEST(CodeActions, ARemovalIsNotPreferred) {
  EXPECT_EQ(FixedBy({{5, 3, "x"}})["isPreferred"], true);
  EXPECT_EQ(FixedBy({{5, 3, ""}})["isPreferred"], false);
  EXPECT_EQ(FixedBy({{5, 0, "a\nb\rc"}})["title"], "Insert 'a b c'");
}

// Silencing advice is never what an editor does without being asked, while its repair is.
TEST(CodeActions, AnAllowanceIsNotPreferred) {
  Editor editor;
  editor.Open("SYSDEF (0.,0.,0.,0.,0.,0.)\nMOVE (1,2,3,0,0) /INF\nSPED 5\n");
  const Json actions = ActionsOf(editor, {{0, 3}, {0, 3}});
  const Json* fix = Titled(actions, "by 'SYSDEF'");
  ASSERT_NE(fix, nullptr) << actions.dump();
  EXPECT_EQ((*fix)["isPreferred"], true);
  const Json* allow = Titled(actions, "Allow 7311 on this line");
  ASSERT_NE(allow, nullptr) << actions.dump();
  EXPECT_EQ((*allow)["isPreferred"], false);
}

}  // namespace
}  // namespace rmlcell::lsp
