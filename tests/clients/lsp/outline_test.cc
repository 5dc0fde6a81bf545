#include "engine/optimo/editing/outline.h"

#include <gtest/gtest.h>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

// "10 step 2 [1-3]" and, indented, its children.
std::string Dump(const Json& symbols, const std::string& indent = "") {
  std::string out;
  for (const Json& symbol : symbols) {
    out += indent + symbol["name"].get<std::string>();
    if (symbol.contains("detail")) out += " = " + symbol["detail"].get<std::string>();
    out += " [" + std::to_string(symbol["range"]["start"]["line"].get<int>()) + "-" +
           std::to_string(symbol["range"]["end"]["line"].get<int>()) + "]\n";
    if (symbol.contains("children")) out += Dump(symbol["children"], indent + "  ");
  }
  return out;
}

std::string OutlineOf(std::string_view text) {
  Editor editor;
  editor.Open(text);
  return Dump(editor.Result("textDocument/documentSymbol", {{"textDocument", {{"uri", kUri}}}}));
}

// OPT-1.27, OPT-6.01
TEST(Outline, SequenceNumbersHoldTheirSteps) {
  EXPECT_EQ(
      OutlineOf("DECLARE X = VR[0]\nSPEED 5\n10 PATH LIN\nMOVE (1,2,\n3,0,0)\n20\nSTOP\n30\n"),
      "X = VR[0] [0-0]\n"
      "1 SPEED 5 [1-1]\n"
      "10 = step 2 [2-4]\n"
      "  2 PATH LIN [2-2]\n"
      "  3 MOVE (1,2, 3,0,0) [3-4]\n"
      "20 = step 4 [5-6]\n"
      "  4 STOP [6-6]\n"
      "30 = end [7-7]\n");
}

TEST(Outline, ASubroutineIsAFunction) {
  Editor editor;
  editor.Open("GOSUB 20\nGOTO 10\n10 STOP\n20 RETURN\n");
  const Json symbols =
      editor.Result("textDocument/documentSymbol", {{"textDocument", {{"uri", kUri}}}});
  EXPECT_EQ(symbols[2]["name"], "10");
  EXPECT_EQ(symbols[2]["kind"], 20);
  EXPECT_EQ(symbols[3]["name"], "20");
  EXPECT_EQ(symbols[3]["kind"], 12);
}

TEST(Outline, ALongProgramHasItsNumbersAndNamesAlone) {
  const auto count = [](std::uint32_t steps) {
    std::string text = "10 STOP\n";
    for (std::uint32_t i = 1; i < steps; ++i) text += "SPEED 5\n";
    Editor editor;
    editor.Open(text);
    const Json symbols =
        editor.Result("textDocument/documentSymbol", {{"textDocument", {{"uri", kUri}}}});
    return symbols[0].contains("children") ? symbols[0]["children"].size() : 0U;
  };
  EXPECT_EQ(count(optimo::editing::kOutlineStepsMax), optimo::editing::kOutlineStepsMax);
  EXPECT_EQ(count(optimo::editing::kOutlineStepsMax + 1), 0U);
}

TEST(Outline, AnEditorWithoutTreesGetsAList) {
  Editor editor(Json::object());
  editor.Open("10 SPEED 5\n");
  const Json symbols =
      editor.Result("textDocument/documentSymbol", {{"textDocument", {{"uri", kUri}}}});
  ASSERT_EQ(symbols.size(), 2U);
  EXPECT_EQ(symbols[0]["location"]["uri"], kUri);
  EXPECT_EQ(symbols[1]["containerName"], "10");
}

// "comment 0-2" for each range.
std::vector<std::string> FoldsOf(std::string_view text) {
  Editor editor;
  editor.Open(text);
  std::vector<std::string> folds;
  for (const Json& range :
       editor.Result("textDocument/foldingRange", {{"textDocument", {{"uri", kUri}}}})) {
    folds.push_back(range.value("kind", "") + " " + std::to_string(range["startLine"].get<int>()) +
                    "-" + std::to_string(range["endLine"].get<int>()));
  }
  return folds;
}
using Strings = std::vector<std::string>;

TEST(Folding, CommentsInARowStatementsOverLinesAndDeclarations) {
  EXPECT_EQ(FoldsOf("; a\n; b\nSPEED 5 ; c\n; d\n\n; e\n"), Strings{"comment 0-1"});
  EXPECT_EQ(FoldsOf("MOVE (1,2,3,0,0)/\n  VIA (1,2,3,\n0,0)\nSPEED 5\n"), Strings{" 0-2"});
  EXPECT_EQ(FoldsOf("DECLARE X = 1\nDECLARE Y = 2\nSPEED 5\nDECLARE Z = 3\n"), Strings{" 0-1"});
}

// OPT-3.13, OPT-7.20
TEST(Folding, ContoursAndSubroutines) {
  EXPECT_EQ(FoldsOf("WORK 2,0/ON\nWORK 0,0/ON\nMOVE (1,2,3,0,0)\nWORK 0,00 /OFF\nWORK 2,0/OFF\n"),
            (Strings{"region 1-3", "region 0-4"}));
  EXPECT_EQ(FoldsOf("GOSUB 100\nENDTASK\n90 STOP\n100\nSPEED 5\nRETURN\n"), Strings{"region 3-5"});
  EXPECT_EQ(FoldsOf("WORK 0,0/ON\nSPEED 5\n"), Strings{});
}

// OPT-3.13, OPT-7.20: one fold for each: a second RETURN, or a second OFF, ends nothing.
TEST(Folding, ContoursAndSubroutinesEndOnce) {
  EXPECT_EQ(FoldsOf("GOSUB 100\nENDTASK\n100\nSPEED 5\nRETURN\nSPEED 6\nRETURN\n"),
            Strings{"region 2-4"});
  EXPECT_EQ(FoldsOf("WORK 0,0/ON\nSPEED 5\nWORK 0,0/OFF\nSPEED 6\nWORK 0,0/OFF\n"),
            Strings{"region 0-2"});
}

// What the text ends with folds as what something else follows.
TEST(Folding, TheLastLinesFold) {
  EXPECT_EQ(FoldsOf("SPEED 5\nDECLARE X = 1\nDECLARE Y = 2\n"), Strings{" 1-2"});
  EXPECT_EQ(FoldsOf("SPEED 5\n; a\n; b\n"), Strings{"comment 1-2"});
}

// OPT-7.20: only a number that a GOSUB has begins a subroutine.
TEST(Folding, ASubroutineBeginsWithANumberOfAGosub) {
  EXPECT_EQ(FoldsOf("GOSUB 100\nENDTASK\n100 SPEED 5\n110 SPEED 6\nRETURN\n"),
            Strings{"region 2-4"});
  EXPECT_EQ(FoldsOf("GOTO 90\n90 SPEED 5\nRETURN\n"), Strings{});
  // 0 is a number as others are, and statements without one do not have it.
  EXPECT_EQ(FoldsOf("GOSUB 0\nENDTASK\n0 SPEED 5\nSPEED 6\nRETURN\n"), Strings{"region 2-4"});
}

}  // namespace
}  // namespace rmlcell::lsp
