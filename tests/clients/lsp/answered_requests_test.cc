// Requests that are answered already, addresses that are no files, and findings that stand
// together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "clients/lsp/answers.h"
#include "clients/lsp/program_folder.h"
#include "engine/core/catalogue.h"
#include "engine/core/diagnostic.h"
#include "engine/optimo/language/words.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// Whatever has the place of an answered one by now is asked by nobody to stop.
TEST(AnsweredRequests, CancellingThemCancelsNoOther) {
  Editor editor;
  editor.Open("SPEED 5\n");
  const auto hover = [&](int id) {
    editor.Send(
        {{"jsonrpc", "2.0"},
         {"id", id},
         {"method", "textDocument/hover"},
         {"params",
          {{"textDocument", {{"uri", kUri}}}, {"position", {{"line", 0}, {"character", 1}}}}}});
  };
  for (int id = 500; id < 510; ++id) {
    hover(id);
    const std::vector<Json> answers = editor.Handle();
    ASSERT_EQ(answers.size(), 1U);
    ASSERT_TRUE(answers[0].contains("result")) << answers[0];
    hover(id + 100);
    for (int old = 500; old <= id; ++old)
      editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", old}}}});
    const std::vector<Json> later = editor.Handle();
    ASSERT_EQ(later.size(), 1U);
    EXPECT_EQ(later[0]["id"], id + 100);
    EXPECT_TRUE(later[0].contains("result")) << later[0];
  }
  hover(700);
  editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", 700}}}});
  EXPECT_EQ(editor.Handle().at(0)["error"]["message"], "cancelled");
}

TEST(AnsweredRequests, AnAddressOfAnotherKindIsNoPath) {
  for (const char* uri : {"https://host/12.S", "untitled:/12.S", "file:/12.S", "file://",
                          "file://host", "vscode-remote://wsl/work/12.S", "/work/12.S", ""})
    EXPECT_EQ(PathOfUri(uri), std::nullopt) << uri;
  EXPECT_EQ(PathOfUri("file:///12.S"), "/12.S");
}

// A blank line between two, and none before the first.
TEST(AnsweredRequests, FindingsOfOnePlaceStandApart) {
  const Document document(kUri, "optimo-rml", 1, "SPEED 5\n", Encoding::kUtf16);
  std::vector<Diagnostic> findings;
  for (const ErrorCode code : {ErrorCode::kNameUndeclared, ErrorCode::kPracticeAdvice}) {
    Diagnostic finding{.code = code, .severity = Severity::kWarning};
    finding.where.byte_offset = 0;
    finding.where.length = 5;
    findings.push_back(finding);
  }
  const std::string text =
      HoverAnswer(document, 0, std::nullopt, findings, nullptr)["contents"]["value"];
  EXPECT_THAT(text, StartsWith("**OPT-E7011** ("));
  const std::string advice(Lookup(ErrorCode::kNameUndeclared).advice);
  EXPECT_THAT(text, HasSubstr("\n\nWhat to do: " + advice + "\n\n**OPT-E7033** ("));
  const machine::HoverNote note{.text = "NOTE", .of = {0, 5}};
  const std::string both = HoverAnswer(document, 0, note, findings, nullptr)["contents"]["value"];
  EXPECT_EQ(both, "NOTE\n\n---\n\n" + text);
}

// OPT-W.60: a word that is not what its statement begins with.
TEST(AnsweredRequests, AWordInsideAStatementHasItsRule) {
  Editor editor;
  const auto hover = [&](std::string_view marked) -> std::string {
    return editor.At("textDocument/hover", marked)["result"]["contents"]["value"];
  };
  EXPECT_THAT(hover("MOVE (1.,2.,3.,0.,0.) /F|LY\n"), EndsWith("\n\nRule OPT-W.60"));
  const std::string sine(optimo::Describe(optimo::Word::kSin).rule);
  EXPECT_THAT(hover("VR[1] = SI|N (2.)\n"), EndsWith("\n\nRule " + sine));
}

std::vector<std::string> ChoicesAt(std::string_view marked) {
  Editor editor;
  const Json answer = editor.At("textDocument/completion", marked);
  std::vector<std::string> labels;
  for (const Json& item : answer["result"]["items"]) labels.push_back(item["label"]);
  return labels;
}

// OPT-2.12: the radius may be computed, and so may what a program is called with.
TEST(AnsweredRequests, BehindAParenthesisStandsAValue) {
  for (const char* text : {"PATH HOLE (|", "CALL 44 (|", "FUNCTION 44 (1, |", "GO 44 (|"})
    EXPECT_THAT(ChoicesAt(text), AllOf(Contains("VR"), Contains("SIN"))) << text;
}

// OPT-7.17: the numbers of a table stand in parentheses.
TEST(AnsweredRequests, JumpsOfATableStandInItsParentheses) {
  EXPECT_THAT(ChoicesAt("10 STOP\nGOTO VI[2] (10, |"), ElementsAre("10"));
  EXPECT_THAT(ChoicesAt("10 STOP\nGOTO VI[2], |"), Not(Contains("10")));
  EXPECT_THAT(ChoicesAt("10 STOP\n(1, |"), Not(Contains("10")));
  EXPECT_THAT(ChoicesAt("10 STOP\nGOTO (1, |)"), Contains("10"));
  EXPECT_THAT(ChoicesAt("[|"), IsEmpty());
}

// A word of the language has the name that it has, and the answer says that it was refused for
// that.
TEST(AnsweredRequests, WhatCannotBeRenamedIsToldSo) {
  constexpr int kRequestFailed = -32803;  // of LSP
  Editor editor;
  for (const char* method : {"textDocument/prepareRename", "textDocument/rename"}) {
    const Json answer = editor.At(method, "STO|P\n", {{"newName", "OTHER"}});
    ASSERT_TRUE(answer.contains("error")) << method;
    EXPECT_EQ(answer["error"]["code"], kRequestFailed) << method;
  }
}

}  // namespace
}  // namespace rmlcell::lsp
