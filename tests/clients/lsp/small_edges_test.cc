// Small things at the edges of what an editor asks: halves of characters, lines at the end, what is
// left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "clients/lsp/framing.h"
#include "clients/lsp/program_folder.h"
#include "engine/optimo/language/formatter.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Json LayoutOf(std::string_view text) {
  Editor editor;
  editor.Open(text);
  return editor.Result("textDocument/formatting",
                       {{"textDocument", {{"uri", kUri}}}, {"options", Json::object()}});
}

Json ItemsAt(const std::string& marked) {
  Editor editor;
  return editor.At("textDocument/completion", marked)["result"]["items"];
}
std::vector<std::string> LabelsAt(const std::string& marked) {
  const Json items = ItemsAt(marked);
  std::vector<std::string> labels;
  for (const Json& item : items) labels.push_back(item["label"]);
  return labels;
}

// The ends of both ranges; each time beside a half that makes the text be looked through.
TEST(SmallEdges, HalvesOfAPairFromTheirFirstToTheirLast) {
  const std::string replaced = "\xEF\xBF\xBD";
  const auto text = [](std::string_view json) {
    const auto read = ReadJson(json);
    return read && read->is_string() ? read->get<std::string>() : std::string("nothing");
  };
  EXPECT_EQ(text(R"("\uDC00\uDC00")"), replaced + replaced);
  EXPECT_EQ(text(R"("\uDFFF\uD800\uDC00")"), replaced + "\xF0\x90\x80\x80");
  EXPECT_EQ(text(R"("\uD800\uDBFF\uDFFF")"), replaced + "\xF4\x8F\xBF\xBF");
  EXPECT_EQ(text(R"("\uD800\uD7FF")"), replaced + "\xED\x9F\xBF");
  EXPECT_EQ(text(R"("\uD800\uE000")"), replaced + "\xEE\x80\x80");
  EXPECT_EQ(text(R"("\uD800\uDBFF")"), replaced + replaced);
  EXPECT_EQ(text(R"("\uD834a")"), replaced + "a");  // four digits, whatever follows
}

// What stands behind a text in quotes counts again.
TEST(SmallEdges, DepthBehindAText) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + "1" + std::string(depth, ']');
  };
  EXPECT_TRUE(ReadJson("[\"a\"," + nested(kJsonDepthMax - 1) + "]"));
  EXPECT_FALSE(ReadJson("[\"a\"," + nested(kJsonDepthMax) + "]"));
}

// A message has no line of its own for each member.
TEST(SmallEdges, JsonIsWrittenOnOneLine) {
  EXPECT_EQ(WriteJson({{"a", {1, 2}}, {"b", nullptr}}), R"({"a":[1,2],"b":null})");
}

// What stands behind the name in memory is no part of it.
TEST(SmallEdges, ANameEndsWhereItEnds) {
  EXPECT_EQ(PathOfUri(std::string_view("file:///a%41").substr(0, 11)), std::nullopt);
  EXPECT_EQ(PathOfUri(std::string_view("file:///a%41").substr(0, 10)), std::nullopt);
  EXPECT_EQ(PathOfUri("file:///a%41"), "/aA");
}

// Blank lines at the end are taken away, and nothing else is touched.
TEST(SmallEdges, LinesAtTheEndAreTakenAway) {
  for (const std::string text :
       {"\n\n", "     SPEED 5\n\n\n", " \n", "     SPEED 5\n     SPEED 5\n\n"})
    EXPECT_EQ(Applied(text, LayoutOf(text)), optimo::Format(text).text) << text;
  const Json edits = LayoutOf("     SPEED 5\n\n\n");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0]["range"], ToJson(Range{{1, 0}, {3, 0}}));
  EXPECT_EQ(edits[0]["newText"], "");
}

// Two lines become one: those around them stay.
TEST(SmallEdges, LinesAroundOnesThatAreJoinedStay) {
  const Json edits = LayoutOf("     STOP\nmove (1,2,\n3,0,0)/fly\n     SPEED 5\n     SPEED 6\n");
  ASSERT_EQ(edits.size(), 1U);
  EXPECT_EQ(edits[0]["range"], ToJson(Range{{1, 0}, {3, 0}}));
}

// A client that tells no version hears of version 0.
TEST(SmallEdges, ADocumentWithoutAVersionHasTheFirst) {
  Editor editor;
  editor.Notify(
      "textDocument/didOpen",
      {{"textDocument", {{"uri", kUri}, {"languageId", "optimo-rml"}, {"text", "SPEED 101\n"}}}});
  EXPECT_EQ(editor.Diagnostics()["version"], 0);
  editor.Open("SPEED 101\n");
  EXPECT_EQ(editor.Diagnostics()["version"], 1);
}

// OPT-8.03, OPT-8.04: what is written, and what it means.
TEST(SmallEdges, DirectivesSayWhatTheyMean) {
  const Json items = ItemsAt(";$|\n");
  std::vector<std::pair<std::string, std::string>> told;
  for (const Json& item : items) told.emplace_back(item["detail"], item["documentation"]["value"]);
  EXPECT_THAT(told, testing::ElementsAre(
                        std::pair(";$dia=0.4", "Diameter of the beam for cutter compensation."),
                        std::pair(";$rad=0.2", "Radius of the beam for cutter compensation."),
                        std::pair(";$left", "The cut lies left of the programmed path."),
                        std::pair(";$right", "The cut lies right of the programmed path."),
                        std::pair(";$none", "No compensation from here on.")));
}

TEST(SmallEdges, AnAllowanceIsOfferedBehindItsMark) {
  EXPECT_THAT(LabelsAt("; rmlcell:|\n"), testing::ElementsAre("allow"));
  EXPECT_THAT(LabelsAt("; rmlcell: \t|\n"), testing::ElementsAre("allow"));
  EXPECT_THAT(LabelsAt("; rmlcell:/|\n"), IsEmpty());
  EXPECT_THAT(LabelsAt("; rmlcell: x |\n"), IsEmpty());
}

// OPT-1.30
TEST(SmallEdges, AStatementGoesOnBehindOneOpenParenthesis) {
  EXPECT_THAT(LabelsAt("MOVE (1,2,3\n|\n"), Not(Contains("SPEED")));
  EXPECT_THAT(LabelsAt("STOP\nMOVE (1,2,3\n|\n"), Not(Contains("SPEED")));
  EXPECT_THAT(LabelsAt("=\n|\n"), Not(Contains("MOVE")));
  // Behind a blank on a later line as well.
  EXPECT_THAT(LabelsAt("VR[0] = 1\n\n   |\n"), Contains("MOVE"));
  EXPECT_THAT(LabelsAt("SPEED 5\nVR[0] = 1   \n|\n"), Contains("MOVE"));
  EXPECT_THAT(LabelsAt("\n\n\n\nSPEED 5   |\n"), Not(Contains("MOVE")));
}

// The tokens are those of the whole statement, on however many lines, and of no other one.
TEST(SmallEdges, AStatementOfTwoLinesIsOneStatement) {
  EXPECT_THAT(LabelsAt("IF VR[0] =\n1 |\n"), AllOf(Contains("THEN"), Not(Contains("MOVE"))));
  EXPECT_THAT(LabelsAt("IF VR[0] =\n1 |\nSPEED 5\n"), Contains("THEN"));
  EXPECT_THAT(LabelsAt("(|\nGOTO 10\n"), AllOf(Contains("SIN"), Not(Contains("MOD"))));
}

// A name is a value, behind any word.
TEST(SmallEdges, BehindANameStandOperators) {
  EXPECT_THAT(LabelsAt("SPEED XPOS |"), AllOf(Contains("MOD"), Not(Contains("SIN"))));
}

// A comma inside a value is none between two.
TEST(SmallEdges, ValuesOfAWorkdefMayHaveParentheses) {
  Editor editor;
  const Json hover =
      editor.At("textDocument/hover", "WORK|DEF 1,0 (8.,(75.,1),1.,50.)\n")["result"];
  const std::string text = hover["contents"]["value"];
  EXPECT_THAT(text, AllOf(HasSubstr("\n- power at that speed, percent: `(75.,1)`"),
                          HasSubstr("\n- dwell at peak, s: `1.`")));
}

// The comment at the head of a program that is called, wherever it begins.
TEST(SmallEdges, AProgramIsToldByItsHead) {
  Editor editor;
  editor.folder.files["file:///work/44.S"] = "\n\n; cuts a door\nSPEED 5\n";
  const std::string text =
      editor.At("textDocument/hover", "CALL 4|4\n")["result"]["contents"]["value"];
  EXPECT_THAT(text, AllOf(HasSubstr("`44.S`, 1 step"), testing::EndsWith("\n\n`; cuts a door`")));
}

}  // namespace
}  // namespace rmlcell::lsp
