#include "clients/lsp/server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

using testing::HasSubstr;

int ErrorOf(const Json& answer) {
  return answer.contains("error") ? answer["error"]["code"].get<int>() : 0;
}
Json Request(int id, std::string_view method, Json parameters = Json::object()) {
  return {{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(parameters)}};
}
Json Here(int line, int character) {
  return {{"textDocument", {{"uri", kUri}}},
          {"position", {{"line", line}, {"character", character}}}};
}

TEST(Server, InitializeComesFirstAndOnce) {
  const FakeFolder folder;
  Server server(folder);
  server.Receive(Framed(Request(1, "textDocument/hover").dump()));
  server.Receive(Framed(Request(2, "initialize").dump()));
  server.Receive(Framed(Request(3, "initialize").dump()));
  while (server.waiting()) server.HandleNext();
  MessageReader reader;
  std::vector<Frame> frames;
  reader.Feed(server.TakeOutput(), frames);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(ErrorOf(Json::parse(frames[0].body)), -32002);
  EXPECT_TRUE(Json::parse(frames[1].body)["result"].contains("capabilities"));
  EXPECT_EQ(ErrorOf(Json::parse(frames[2].body)), -32600);
}

TEST(Server, ExitIsGoodAfterShutdownOnly) {
  {
    Editor editor;
    editor.Notify("exit", Json::object());
    EXPECT_EQ(editor.server.exit_code(), 1);
  }
  Editor editor;
  EXPECT_TRUE(editor.Result("shutdown", nullptr).is_null());
  EXPECT_EQ(editor.server.exit_code(), std::nullopt);
  EXPECT_EQ(ErrorOf(editor.Ask("textDocument/hover", Here(0, 0))), -32600);
  editor.Notify("exit", nullptr);
  EXPECT_EQ(editor.server.exit_code(), 0);
}

TEST(Server, EncodingsAreChosenFromWhatTheEditorOffers) {
  const auto chosen = [](const Json& offered) {
    return Editor(Json{{"general", {{"positionEncodings", offered}}}})
        .capabilities["positionEncoding"];
  };
  EXPECT_EQ(Editor().capabilities["positionEncoding"], "utf-16");
  EXPECT_EQ(chosen(Json::array({"utf-8", "utf-16"})), "utf-8");
  EXPECT_EQ(chosen(Json::array({"utf-16", "utf-8"})), "utf-16");
  EXPECT_EQ(chosen(Json::array({"utf-7", "utf-32"})), "utf-32");
  EXPECT_EQ(chosen(Json::array({5})), "utf-16");
}

TEST(Server, AnEditorThatCountsBytesGetsBytes) {
  Editor editor(Json{{"general", {{"positionEncodings", Json::array({"utf-8"})}}}});
  editor.Open("SPEED 5 ; \xC3\xA4\xC3\xA4xSPEED 101\n");
  EXPECT_EQ(editor.Diagnostics()["diagnostics"], Json::array());
  editor.Notify(
      "textDocument/didChange",
      {{"textDocument", {{"uri", kUri}, {"version", 2}}},
       {"contentChanges", {{{"range", ToJson(Range{{0, 10}, {0, 15}})}, {"text", "\n"}}}}});
  EXPECT_EQ(editor.Diagnostics()["diagnostics"][0]["range"], ToJson(Range{{1, 6}, {1, 9}}));
}

TEST(Server, ChangesAreAppliedInTheirOrder) {
  Editor editor;
  editor.Open("SPEED 5\nSPEED 6\n");
  editor.Notify("textDocument/didChange",
                {{"textDocument", {{"uri", kUri}, {"version", 7}}},
                 {"contentChanges",
                  {{{"range", ToJson(Range{{0, 0}, {0, 0}})}, {"text", "STOP\n"}},
                   {{"range", ToJson(Range{{2, 6}, {2, 7}})}, {"text", "600"}}}}});
  const Json told = editor.Diagnostics();
  EXPECT_EQ(told["version"], 7);
  ASSERT_EQ(told["diagnostics"].size(), 1U);
  EXPECT_EQ(told["diagnostics"][0]["range"], ToJson(Range{{2, 6}, {2, 9}}));
  editor.Notify("textDocument/didChange", {{"textDocument", {{"uri", kUri}, {"version", 8}}},
                                           {"contentChanges", {{{"text", "SPEED 5\n"}}}}});
  EXPECT_EQ(editor.Diagnostics()["diagnostics"], Json::array());
}

// Half of a change would leave editor and server with different texts.
TEST(Server, AChangeThatCannotBeReadChangesNothing) {
  Editor editor;
  editor.Open("SPEED 5\n");
  for (const Json& broken : {Json{{"range", {{"start", 5}}}, {"text", "x"}},
                             Json{{"range", 5}, {"text", "x"}}, Json{{"text", 5}}, Json::array()}) {
    const std::size_t before = editor.notices.size();
    editor.Notify("textDocument/didChange",
                  {{"textDocument", {{"uri", kUri}, {"version", 2}}},
                   {"contentChanges", {{{"text", "SPEED 101\n"}}, broken}}});
    ASSERT_EQ(editor.notices.size(), before + 1) << broken.dump();
    EXPECT_EQ(editor.notices.back()["method"], "window/logMessage");
  }
  EXPECT_EQ(editor.Diagnostics()["diagnostics"], Json::array());
}

TEST(Server, ClosingADocumentTakesItsFindingsAway) {
  Editor editor;
  editor.Open("SPEED 101\n");
  EXPECT_EQ(editor.Diagnostics()["diagnostics"].size(), 1U);
  editor.Notify("textDocument/didClose", {{"textDocument", {{"uri", kUri}}}});
  EXPECT_EQ(editor.Diagnostics()["diagnostics"].size(), 0U);
  EXPECT_EQ(ErrorOf(editor.Ask("textDocument/hover", Here(0, 0))), -32602);
}

TEST(Server, ChangesBetweenChecksAreCheckedOnce) {
  Editor editor;
  editor.Open("SPEED 101\n");
  for (int version = 2; version < 10; ++version) {
    editor.Notify("textDocument/didChange",
                  {{"textDocument", {{"uri", kUri}, {"version", version}}},
                   {"contentChanges", {{{"text", "SPEED 5\n"}}}}});
  }
  EXPECT_TRUE(editor.server.unchecked());
  editor.server.CheckNext();
  EXPECT_FALSE(editor.server.unchecked());
  editor.Handle();
  EXPECT_EQ(editor.notices.size(), 1U);
}

TEST(Server, ACancelledRequestIsAnsweredWithThat) {
  Editor editor;
  editor.Open("SPEED 5\n");
  editor.Send(Request(101, "textDocument/hover", Here(0, 1)));
  editor.Send(Request(102, "textDocument/hover", Here(0, 1)));
  editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", 101}}}});
  editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", 999}}}});
  const auto answers = editor.Handle();
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[0]["id"], 101);
  EXPECT_EQ(ErrorOf(answers[0]), -32800);
  EXPECT_EQ(answers[1]["id"], 102);
  EXPECT_FALSE(answers[1]["result"].is_null());
  // Too late: nothing comes of it.
  editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", 102}}}});
  EXPECT_TRUE(editor.Handle().empty());
}

TEST(Server, TextAndNumberAreDifferentIds) {
  Editor editor;
  editor.Open("SPEED 5\n");
  Json request = Request(7, "textDocument/hover", Here(0, 1));
  request["id"] = "7";
  editor.Send(request);
  editor.Send({{"jsonrpc", "2.0"}, {"method", "$/cancelRequest"}, {"params", {{"id", 7}}}});
  const auto answers = editor.Handle();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0]["id"], "7");
  EXPECT_TRUE(answers[0].contains("result"));
}

TEST(Server, UnknownMethodsAreAnsweredAndUnknownNoticesPassedOver) {
  Editor editor;
  EXPECT_EQ(ErrorOf(editor.Ask("textDocument/somethingNew", Json::object())), -32601);
  EXPECT_EQ(ErrorOf(editor.Ask("$/private", Json::object())), -32601);
  editor.Notify("$/setTrace", {{"value", "off"}});
  editor.Notify("workspace/didChangeConfiguration", Json::object());
  EXPECT_TRUE(editor.notices.empty());
}

TEST(Server, WhatIsNoRequestIsAnsweredWithItsError) {
  struct Row {
    const char* body;
    int code;
  };
  for (const Row& row : {Row{"{", -32700}, Row{"[]", -32600}, Row{"5", -32600}, Row{"null", -32600},
                         Row{"{\"id\":1}", -32600}, Row{"{\"id\":1,\"method\":5}", -32600},
                         Row{"{\"id\":{},\"method\":\"shutdown\"}", -32600},
                         Row{"{\"id\":1.5,\"method\":\"shutdown\"}", -32600},
                         Row{"[{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"shutdown\"}]", -32600}}) {
    Editor editor;
    editor.SendBytes(Framed(row.body));
    const auto answers = editor.Handle();
    ASSERT_EQ(answers.size(), 1U) << row.body;
    EXPECT_EQ(ErrorOf(answers[0]), row.code) << row.body;
    EXPECT_FALSE(editor.Result("shutdown", nullptr).is_object());  // and it goes on
  }
}

TEST(Server, WrongParametersAreAnsweredForEveryMethod) {
  Editor editor;
  editor.Open("10 SPEED 5\n");
  const Json wrong[] = {nullptr,
                        5,
                        Json::array({1}),
                        Json::object(),
                        {{"textDocument", 5}},
                        {{"textDocument", {{"uri", "file:///other.S"}}}},
                        {{"textDocument", {{"uri", kUri}}}, {"position", {{"line", -5}}}},
                        {{"textDocument", {{"uri", kUri}}}, {"position", "x"}, {"range", 7}}};
  for (const char* method :
       {"hover", "definition", "references", "documentHighlight", "completion", "prepareRename",
        "rename", "formatting", "foldingRange", "documentSymbol", "codeAction"}) {
    for (const Json& parameters : wrong) {
      const Json answer = editor.Ask("textDocument/" + std::string(method), parameters);
      const bool whole = std::string_view("formatting foldingRange documentSymbol").find(method) !=
                             std::string_view::npos &&
                         parameters.is_object() && parameters.contains("position");
      EXPECT_EQ(ErrorOf(answer), whole ? 0 : -32602) << method << " " << parameters.dump();
    }
  }
  EXPECT_EQ(ErrorOf(editor.Ask("textDocument/rename", Here(0, 1))), -32602);  // no new name
}

TEST(Server, PlacesOutsideTheTextAreItsEnds) {
  Editor editor;
  editor.Open("10 SPEED 5\n");
  for (const char* method :
       {"hover", "definition", "references", "documentHighlight", "completion"})
    EXPECT_EQ(ErrorOf(editor.Ask("textDocument/" + std::string(method), Here(4000000, 4000000))),
              0);
}

TEST(Server, AnAnswerOfTheEditorIsPassedOver) {
  Editor editor;
  editor.SendBytes(Framed("{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":null}"));
  EXPECT_TRUE(editor.Handle().empty());
}

TEST(Server, BrokenFramesAreToldAndTheSessionGoesOn) {
  Editor editor;
  editor.SendBytes("GET / HTTP/1.1\r\n\r\n");
  const auto answers = editor.Handle();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_TRUE(answers[0]["id"].is_null());
  EXPECT_EQ(ErrorOf(answers[0]), -32700);
  EXPECT_TRUE(editor.Result("shutdown", nullptr).is_null());
}

TEST(Server, TheSamePathInOtherEscapesIsTheSameDocument) {
  Editor editor;
  editor.Open("SPEED 5\n", "file:///c%3A/a.S");
  EXPECT_FALSE(editor
                   .Result("textDocument/hover", {{"textDocument", {{"uri", "file:///c:/a.S"}}},
                                                  {"position", ToJson(Position{0, 1})}})
                   .is_null());
}

// An error goes to the request that it is of; to nobody where the id is none.
TEST(Server, AnErrorHasTheIdOfItsRequest) {
  struct Row {
    const char* body;
    Json id;
  };
  for (const Row& row : {Row{R"({"id":1,"method":5})", 1}, Row{R"({"id":"a"})", "a"},
                         Row{R"({"id":{},"method":"shutdown"})", nullptr},
                         Row{R"({"method":5})", nullptr}, Row{"[]", nullptr}}) {
    Editor editor;
    editor.SendBytes(Framed(row.body));
    const auto answers = editor.Handle();
    ASSERT_EQ(answers.size(), 1U) << row.body;
    EXPECT_EQ(answers[0]["id"], row.id) << row.body;
  }
}

// Notices count from initialize to shutdown.
TEST(Server, NoticesBeforeAndBehindTheSessionArePassedOver) {
  const Json opened = {
      {"jsonrpc", "2.0"},
      {"method", "textDocument/didOpen"},
      {"params",
       {{"textDocument",
         {{"uri", kUri}, {"languageId", "optimo-rml"}, {"version", 1}, {"text", "SPEED 101\n"}}}}}};
  const FakeFolder folder;
  Server server(folder);
  server.Receive(Framed(opened.dump()));
  server.HandleNext();
  EXPECT_FALSE(server.unchecked());
  EXPECT_EQ(server.TakeOutput(), "");
  Editor editor;
  EXPECT_TRUE(editor.Result("shutdown", nullptr).is_null());
  editor.Open("SPEED 101\n");
  EXPECT_FALSE(editor.server.unchecked());
}

// What waits is counted in bytes of bodies, so that a client is not read for ever.
TEST(Server, BytesThatWaitAreCounted) {
  const FakeFolder folder;
  Server server(folder);
  const std::string first = Request(1, "initialize").dump();
  const std::string second = Request(2, "shutdown").dump();
  server.Receive(Framed(first) + Framed(second));
  EXPECT_EQ(server.waiting_bytes(), first.size() + second.size());
  server.HandleNext();
  EXPECT_EQ(server.waiting_bytes(), second.size());
  server.HandleNext();
  EXPECT_EQ(server.waiting_bytes(), 0U);
}

}  // namespace
}  // namespace rmlcell::lsp
