#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/clients/lsp/editor.h"

// Whole answers, word by word: what an editor shows.
namespace rmlcell::lsp {
namespace {

const Json kTheDocument = {{"uri", kUri}};

Json PlaceAt(std::uint32_t line, std::uint32_t character) {
  return {{"textDocument", kTheDocument}, {"position", ToJson(Position{line, character})}};
}

Json Refused(int code, std::string_view message) { return {{"code", code}, {"message", message}}; }

TEST(Answers, InitializeSaysWhatTheServerCan) {
  const FakeFolder folder;
  Server server(folder);
  server.Receive(Framed(
      R"({"jsonrpc":"2.0","id":"a","method":"initialize","params":{"processId":77,"capabilities":{}}})"));
  EXPECT_TRUE(server.waiting());
  server.HandleNext();
  EXPECT_FALSE(server.waiting());
  EXPECT_EQ(server.parent_process(), 77);
  MessageReader reader;
  std::vector<Frame> frames;
  reader.Feed(server.TakeOutput(), frames);
  ASSERT_EQ(frames.size(), 1U);
  const Json expected = {
      {"jsonrpc", "2.0"},
      {"id", "a"},
      {"result",
       {{"serverInfo", {{"name", "rmlcell"}}},
        {"capabilities",
         {{"positionEncoding", "utf-16"},
          {"textDocumentSync",
           {{"openClose", true}, {"change", 2}, {"save", {{"includeText", false}}}}},
          {"hoverProvider", true},
          {"definitionProvider", true},
          {"referencesProvider", true},
          {"documentHighlightProvider", true},
          {"documentSymbolProvider", true},
          {"foldingRangeProvider", true},
          {"documentFormattingProvider", true},
          {"completionProvider", {{"triggerCharacters", {"/", "[", "$"}}}},
          {"renameProvider", {{"prepareProvider", true}}},
          {"codeActionProvider", {{"codeActionKinds", {"quickfix", "source.fixAll.rmlcell"}}}}}}}}};
  EXPECT_EQ(Json::parse(frames[0].body), expected);
  EXPECT_EQ(server.TakeOutput(), "");  // told once
}

TEST(Answers, WhatARequestLacksIsSaid) {
  Editor editor;
  editor.Open("10 SPEED 5\n");
  EXPECT_EQ(editor.Ask("initialize", Json::object())["error"],
            Refused(-32600, "initialize came before"));
  EXPECT_EQ(editor.Ask("textDocument/new", {})["error"],
            Refused(-32601, "there is no method textDocument/new"));
  const Json other = {{"textDocument", {{"uri", "file:///other.S"}}}};
  for (const char* method :
       {"hover", "definition", "references", "documentHighlight", "completion", "prepareRename",
        "rename", "formatting", "foldingRange", "documentSymbol", "codeAction"}) {
    EXPECT_EQ(editor.Ask("textDocument/" + std::string(method), other)["error"],
              Refused(-32602, "the document is not open"))
        << method;
  }
  for (const char* method : {"hover", "definition", "references", "documentHighlight", "completion",
                             "prepareRename", "rename"}) {
    EXPECT_EQ(editor.Ask("textDocument/" + std::string(method),
                         {{"textDocument", kTheDocument}})["error"],
              Refused(-32602, "there is no position"))
        << method;
  }
  EXPECT_EQ(editor.Ask("textDocument/codeAction", {{"textDocument", kTheDocument}})["error"],
            Refused(-32602, "there is no range"));
  EXPECT_EQ(editor.Ask("textDocument/rename", PlaceAt(0, 1))["error"],
            Refused(-32602, "there is no new name"));
  EXPECT_TRUE(editor.Result("shutdown", nullptr).is_null());
  EXPECT_EQ(editor.Ask("textDocument/hover", PlaceAt(0, 4))["error"],
            Refused(-32600, "the server is shut down"));
}

// A stream has findings and nothing else.
TEST(Answers, AStreamHasNoNamesAndNoPlaces) {
  Editor editor;
  editor.Open("PU0,0;PD9,9;", "file:///work/a.rml", "rml1");
  Json place = PlaceAt(0, 1);
  place["textDocument"]["uri"] = "file:///work/a.rml";
  for (const char* method :
       {"definition", "references", "documentHighlight", "completion", "formatting"}) {
    EXPECT_TRUE(editor.Result("textDocument/" + std::string(method), place).is_null()) << method;
  }
  place["newName"] = "X";
  for (const char* method : {"prepareRename", "rename"}) {
    EXPECT_EQ(editor.Ask("textDocument/" + std::string(method), place)["error"],
              Refused(-32803, "a stream has no names"));
  }
}

TEST(Answers, NoticesThatCannotBeActedUponAreLogged) {
  Editor editor;
  const auto logged = [&](std::string_view method, Json parameters) {
    const std::size_t before = editor.notices.size();
    editor.Notify(method, std::move(parameters));
    if (editor.notices.size() != before + 1) return std::string("nothing");
    const Json& notice = editor.notices.back();
    EXPECT_EQ(notice["method"], "window/logMessage");
    EXPECT_EQ(notice["params"]["type"], 1);
    return notice["params"]["message"].get<std::string>();
  };
  const Json nameless = {{"text", "SPEED 5\n"}};
  EXPECT_EQ(logged("textDocument/didOpen", {{"textDocument", nameless}}),
            "didOpen without uri or text");
  EXPECT_EQ(logged("textDocument/didOpen", {{"textDocument", kTheDocument}}),
            "didOpen without uri or text");
  EXPECT_EQ(logged("textDocument/didChange", {{"textDocument", kTheDocument}}),
            "didChange of a document that is not open");
  editor.Open("SPEED 5\n");
  EXPECT_EQ(logged("textDocument/didChange", {{"textDocument", kTheDocument}}),
            "didChange without contentChanges");
  EXPECT_EQ(
      logged("textDocument/didChange", {{"textDocument", kTheDocument}, {"contentChanges", 5}}),
      "didChange without contentChanges");
  EXPECT_EQ(
      logged("textDocument/didChange", {{"textDocument", kTheDocument},
                                        {"contentChanges", Json::array({{{"range", nullptr}}})}}),
      "didChange with a change that cannot be read; close and open the document");
  EXPECT_EQ(logged("textDocument/didClose", {{"textDocument", {{"uri", "file:///other.S"}}}}),
            "nothing");
  EXPECT_EQ(logged("textDocument/didSave", {{"textDocument", kTheDocument}}), "nothing");
}

// A change with a null range is the whole text; a version that is not told stays.
TEST(Answers, FindingsComeWithTheVersionWhereTheEditorKnowsVersions) {
  for (const bool versions : {true, false}) {
    Editor editor(Json{{"textDocument", {{"publishDiagnostics", {{"versionSupport", versions}}}}}});
    editor.Open("SPEED 101\n");
    editor.Notify("textDocument/didChange",
                  {{"textDocument", kTheDocument},
                   {"contentChanges", Json::array({{{"range", nullptr}, {"text", "SPEED 5\n"}}})}});
    Json expected = {{"uri", kUri}, {"diagnostics", Json::array()}};
    if (versions) expected["version"] = 1;
    EXPECT_EQ(editor.Diagnostics(), expected);
    editor.Notify("textDocument/didClose", {{"textDocument", kTheDocument}});
    EXPECT_EQ(editor.notices.back()["method"], "textDocument/publishDiagnostics");
    EXPECT_EQ(editor.notices.back()["params"],
              (Json{{"uri", kUri}, {"diagnostics", Json::array()}}));
  }
}

// OPT-2.35, OPT-E.7004: what is said of a finding, with what to do about it.
TEST(Answers, AFindingIsToldWithItsAdvice) {
  Editor editor;
  editor.Open("\n SPEED 101\n");
  const Json told = editor.Diagnostics()["diagnostics"];
  ASSERT_EQ(told.size(), 1U);
  const CatalogueEntry& entry = Lookup(ErrorCode::kLiteralRange);
  const std::string message = told[0]["message"];
  EXPECT_TRUE(message.ends_with(" [OPT-2.35]\n" + std::string(entry.advice))) << message;
  EXPECT_EQ(told[0]["range"], ToJson(Range{{1, 7}, {1, 10}}));
}

// OPT-1.27, OPT-7.20: each symbol with its kind, its place and the place of its name.
TEST(Answers, SymbolsHaveTheirPlaces) {
  Editor editor;
  editor.Open("DECLARE XHOME = VR[0]\nDECLARE N = 5\nGOSUB 20\nSTOP\n20 SPEED 5\n  RETURN\n");
  const auto symbol = [](std::string_view name, int kind, const Range& range,
                         const Range& selection) {
    return Json{{"name", name},
                {"kind", kind},
                {"range", ToJson(range)},
                {"selectionRange", ToJson(selection)}};
  };
  Json xhome = symbol("XHOME", 13, {{0, 0}, {0, 21}}, {{0, 8}, {0, 13}});
  xhome["detail"] = "VR[0]";
  Json n = symbol("N", 14, {{1, 0}, {1, 13}}, {{1, 8}, {1, 9}});
  n["detail"] = "5";
  Json part = symbol("20", 12, {{4, 0}, {5, 8}}, {{4, 0}, {4, 2}});
  part["detail"] = "step 3";
  part["children"] = {symbol("3 SPEED 5", 24, {{4, 3}, {4, 10}}, {{4, 3}, {4, 10}}),
                      symbol("4 RETURN", 24, {{5, 2}, {5, 8}}, {{5, 2}, {5, 8}})};
  const Json expected = {xhome, n, symbol("1 GOSUB 20", 24, {{2, 0}, {2, 8}}, {{2, 0}, {2, 8}}),
                         symbol("2 STOP", 24, {{3, 0}, {3, 4}}, {{3, 0}, {3, 4}}), part};
  EXPECT_EQ(editor.Result("textDocument/documentSymbol", {{"textDocument", kTheDocument}}),
            expected);
  Editor flat(Json::object());
  flat.Open("10 SPEED 5\n");
  const auto listed = [](std::string_view name, int kind, const Range& range) {
    return Json{{"name", name}, {"kind", kind}, {"location", Location(kUri, range)}};
  };
  Json step = listed("1 SPEED 5", 24, {{0, 3}, {0, 10}});
  step["containerName"] = "10";
  EXPECT_EQ(flat.Result("textDocument/documentSymbol", {{"textDocument", kTheDocument}}),
            (Json{listed("10", 20, {{0, 0}, {0, 10}}), step}));
}

// A statement of 60 bytes stands whole in the outline, a longer one is cut; it takes one line.
TEST(Answers, LongStatementsAreCutInTheOutline) {
  const auto name = [](std::size_t bytes) {
    Editor editor;
    std::string statement = "VR[1]=\r\n\t1.";
    while (statement.size() < bytes) statement += '0';
    editor.Open(statement + "\n");
    return editor.Result("textDocument/documentSymbol", {{"textDocument", kTheDocument}})[0]["name"]
        .get<std::string>();
  };
  EXPECT_EQ(name(60), "1 VR[1]=   1." + std::string(49, '0'));
  EXPECT_EQ(name(61), "1 VR[1]=   1." + std::string(49, '0') + " ...");
}

// OPT-7.45, OPT-7.46, OPT-7.48, OPT-1.23, OPT-1.25: why something cannot be renamed, or not like
// that.
TEST(Answers, WhyARenameIsRefused) {
  const std::string text =
      "DECLARE XHOME = VR[0]\nDECLARE OTHERNAME = 5\n10 SPEED XHOME\n20 GOTO 10\nGOTO 30\n"
      "CALL 44\nVR[1] = NONE\n; XHOME\n";
  Editor editor;
  editor.Open(text);
  const auto why = [&](std::uint32_t line, std::uint32_t character, const std::string& name) {
    Json asked = PlaceAt(line, character);
    asked["newName"] = name;
    const Json answer = editor.Ask("textDocument/rename", asked);
    if (!answer.contains("error")) return std::string();
    EXPECT_EQ(answer["error"]["code"], -32803);
    return answer["error"]["message"].get<std::string>();
  };
  const std::string letters = "a name begins with a letter and has letters and digits (OPT-7.45)";
  for (const std::string name : {"", "1X", "X Y", "X_", "[", "@", "`", "{", "X/", "X:"})
    EXPECT_EQ(why(0, 9, name), letters) << name;
  EXPECT_EQ(why(0, 9, std::string(65, 'X')), letters);
  for (const std::string name : {"A", "Z", "a", "z", "A0", "A9"})
    EXPECT_EQ(why(0, 9, name), "") << name;
  EXPECT_EQ(why(0, 9, std::string(64, 'X')), "");
  EXPECT_EQ(why(0, 9, "speed"), "'speed' is reserved: SPEED (OPT-7.48)");
  EXPECT_EQ(
      why(0, 9, "OTHERNAM2"),
      "'OTHERNAM2' is the same name as 'OTHERNAME' of this program: eight characters count (OPT-7.46)");
  EXPECT_EQ(why(1, 9, "OTHERNAM2"), "");  // its own name
  EXPECT_EQ(why(6, 9, "X"), "'NONE' is not declared in this program");
  EXPECT_EQ(why(4, 6, "5"), "the program has no sequence number 30");
  EXPECT_EQ(why(2, 4, "X"), "a reserved word has no other name");
  EXPECT_EQ(why(6, 1, "X"), "a variable of the control has no other name; DECLARE gives it one");
  EXPECT_EQ(why(5, 6, "5"), "a program is renamed by renaming its file");
  EXPECT_EQ(why(7, 3, "X"), "there is no name or sequence number here");
  const std::string range = "a sequence number goes from 0 to 9999 (OPT-1.23)";
  for (const std::string number : {"", "-1", "10000", "00010", "x", "1.5", "+5"})
    EXPECT_EQ(why(2, 1, number), range) << number;
  for (const std::string number : {"0", "9999", "0010", "10"})
    EXPECT_EQ(why(2, 1, number), "") << number;
  EXPECT_EQ(why(2, 1, "20"), "sequence number 20 is taken (OPT-1.25)");
  EXPECT_EQ(why(2, 1, "30"), "there are jumps to 30 already, which now lead nowhere (OPT-7.16)");
}

// OPT-7.44: where a name is, where it is given, and where it is used.
TEST(Answers, UsesOfAName) {
  Editor editor;
  editor.Open("DECLARE X = VR[0]\nSPEED X\n10 SPEED x\nGOTO 10\n");
  const Range given{{0, 8}, {0, 9}}, first{{1, 6}, {1, 7}}, second{{2, 9}, {2, 10}};
  const Range label{{2, 0}, {2, 2}}, jump{{3, 5}, {3, 7}};
  EXPECT_EQ(editor.Result("textDocument/definition", PlaceAt(2, 9)),
            Json::array({Location(kUri, given)}));
  EXPECT_EQ(editor.Result("textDocument/definition", PlaceAt(3, 6)),
            Json::array({Location(kUri, label)}));
  EXPECT_EQ(editor.Result("textDocument/references", PlaceAt(1, 6)),
            (Json{Location(kUri, first), Location(kUri, second)}));
  Json with = PlaceAt(3, 6);
  with["context"] = {{"includeDeclaration", true}};
  EXPECT_EQ(editor.Result("textDocument/references", with),
            (Json{Location(kUri, label), Location(kUri, jump)}));
  const auto mark = [](const Range& range, int kind) {
    return Json{{"range", ToJson(range)}, {"kind", kind}};
  };
  EXPECT_EQ(editor.Result("textDocument/documentHighlight", PlaceAt(1, 6)),
            (Json{mark(given, 3), mark(first, 2), mark(second, 2)}));
  EXPECT_EQ(editor.Result("textDocument/prepareRename", PlaceAt(2, 9)),
            (Json{{"range", ToJson(second)}, {"placeholder", "x"}}));
}

}  // namespace
}  // namespace rmlcell::lsp
