// Requests that share an id, documents and programs without a folder, and bytes that belong to no
// message.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/lsp/framing.h"
#include "clients/lsp/project_facts.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

Json HoverRequest(int id) {
  return {{"jsonrpc", "2.0"},
          {"id", id},
          {"method", "textDocument/hover"},
          {"params",
           {{"textDocument", {{"uri", kUri}}}, {"position", {{"line", 0}, {"character", 1}}}}}};
}

// The one that waits is cancelled, though another one of that id is answered.
TEST(SessionEdges, AnIdThatIsUsedTwiceIsCancelledWhereItWaits) {
  Editor editor;
  editor.Open("SPEED 5\n");
  editor.Send(HoverRequest(7));
  editor.Send(HoverRequest(7));
  editor.server.HandleNext();
  editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", 7}}}});
  const std::vector<Json> answers = editor.Handle();
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_TRUE(answers[0].contains("result")) << answers[0];
  ASSERT_TRUE(answers[1].contains("error")) << answers[1];
  EXPECT_EQ(answers[1]["error"]["message"], "cancelled");
}

// Documents that are no files have no path to be compared by.
TEST(SessionEdges, UntitledDocumentsAreDifferentOnes) {
  Editor editor;
  editor.Open("SPEED 5\n", "untitled:Untitled-1");
  const auto hover = [&](const char* uri) {
    return editor.Ask("textDocument/hover", {{"textDocument", {{"uri", uri}}},
                                             {"position", {{"line", 0}, {"character", 1}}}});
  };
  EXPECT_TRUE(hover("untitled:Untitled-1").contains("result"));
  const Json other = hover("untitled:Untitled-2");
  ASSERT_TRUE(other.contains("error")) << other;
  EXPECT_EQ(other["error"]["message"], "the document is not open");
}

// What was seen of a mark before a loss is no part of the next one.
TEST(SessionEdges, AByteOfNothingBehindASecondLossBeginsNoMark) {
  const std::string stream = "x\n\n" + Framed("a") + "y\n\n" + std::string(1, '\0') + Framed("b");
  std::vector<Frame> frames;
  MessageReader().Feed(stream, frames);
  std::vector<std::string> read;
  for (const Frame& frame : frames) read.push_back(frame.problem.empty() ? frame.body : "?");
  EXPECT_EQ(read, (std::vector<std::string>{"?", "a", "?", "b"}));
}

// Not even that of the folder where the server runs.
TEST(SessionEdges, AProgramWithoutAFolderHasNoProject) {
  const std::string project = R"({"laserSchedules": [{"number": 11, "title": "fine"}],
                                  "processes": [{"kind": 1, "note": "steel"}]})";
  FakeFolder folder;
  folder.files["project.json"] = project;
  folder.files["file:///work/project.json"] = project;
  EXPECT_EQ(ScheduleNote(folder, "file:///work/12.S", 11), "CW, fine");
  EXPECT_EQ(ProcessNote(folder, "file:///work/12.S", 1, 0), "(steel)");
  EXPECT_EQ(ScheduleNote(folder, "untitled:Untitled-1", 11), "");
  EXPECT_EQ(ProcessNote(folder, "untitled:Untitled-1", 1, 0), "");
}

}  // namespace
}  // namespace rmlcell::lsp
