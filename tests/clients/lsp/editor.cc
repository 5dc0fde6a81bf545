#include "tests/clients/lsp/editor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace rmlcell::lsp {

std::vector<machine::NumberedFile> FakeFolder::Programs(std::string_view uri,
                                                        SourceExtensions extensions) const {
  const std::string_view home = uri.substr(0, uri.rfind('/') + 1);
  std::vector<machine::NumberedFile> found;
  for (const auto& [name, text] : files) {
    const auto number = ProgramNumberOf(name, extensions);
    if (number && name.starts_with(home)) found.push_back({*number, name, FileNameOfUri(name)});
  }
  std::ranges::stable_sort(found, {}, &machine::NumberedFile::number);
  return found;
}

Result<std::string> FakeFolder::Read(std::string_view uri) const {
  const auto found = files.find(uri);
  if (found == files.end()) return Error{ErrorCode::kCellFileUnreadable, std::string(uri), {}};
  return found->second;
}

WithCursor Cursor(std::string_view marked) {
  const std::size_t at = marked.find('|');
  EXPECT_NE(at, std::string_view::npos) << marked;
  std::string text(marked);
  text.erase(at, 1);
  return {text, at};
}

Json Editor::DefaultCapabilities() {
  return {{"textDocument",
           {{"documentSymbol", {{"hierarchicalDocumentSymbolSupport", true}}},
            {"publishDiagnostics", {{"versionSupport", true}}},
            {"codeAction", {{"codeActionLiteralSupport", Json::object()}}}}}};
}

Editor::Editor(Json offered) {
  capabilities = Result("initialize", {{"processId", nullptr},
                                       {"rootUri", nullptr},
                                       {"capabilities", std::move(offered)}})["capabilities"];
  Notify("initialized", Json::object());
}

void Editor::Send(const Json& message) { server.Receive(Framed(message.dump())); }

void Editor::Notify(std::string_view method, Json parameters) {
  Send({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(parameters)}});
  Handle();
}

Json Editor::Ask(std::string_view method, Json parameters) {
  const int id = ++next_id_;
  Send({{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", std::move(parameters)}});
  for (Json& message : Handle()) {
    if (message.contains("id") && message["id"] == id) return std::move(message);
  }
  ADD_FAILURE() << "no answer to " << method;
  return {};
}

Json Editor::Result(std::string_view method, Json parameters) {
  Json answer = Ask(method, std::move(parameters));
  EXPECT_TRUE(answer.contains("result")) << method << ": " << answer.dump();
  return answer.contains("result") ? answer["result"] : Json();
}

void Editor::Open(std::string_view text, std::string_view uri, std::string_view language) {
  Notify(
      "textDocument/didOpen",
      {{"textDocument", {{"uri", uri}, {"languageId", language}, {"version", 1}, {"text", text}}}});
}

Json Editor::At(std::string_view method, std::string_view marked, Json more) {
  const WithCursor place = Cursor(marked);
  Open(place.text);
  const Document document(kUri, {}, 0, place.text, Encoding::kUtf16);
  more["textDocument"] = {{"uri", kUri}};
  more["position"] = ToJson(document.PositionOf(place.offset));
  return Ask(method, std::move(more));
}

std::vector<Json> Editor::Handle() {
  while (server.waiting()) server.HandleNext();
  MessageReader reader;
  std::vector<Frame> frames;
  reader.Feed(server.TakeOutput(), frames);
  std::vector<Json> messages;
  for (const Frame& frame : frames) {
    EXPECT_EQ(frame.problem, "");
    messages.push_back(Json::parse(frame.body));
    if (!messages.back().contains("id")) notices.push_back(messages.back());
  }
  return messages;
}

Json Editor::Diagnostics() {
  while (server.unchecked()) server.CheckNext();
  Json last;
  Handle();
  for (const Json& notice : notices) {
    if (notice["method"] == "textDocument/publishDiagnostics") last = notice["params"];
  }
  return last;
}

std::string Applied(std::string text, const Json& edits, Encoding encoding) {
  const Document document({}, {}, 0, text, encoding);
  struct Edit {
    std::size_t begin, end;
    std::string text;
  };
  std::vector<Edit> ordered;
  for (const Json& edit : edits) {
    const Range range = *ReadRange(edit["range"]);
    ordered.push_back({document.OffsetOf(range.start), document.OffsetOf(range.end),
                       edit["newText"].get<std::string>()});
  }
  std::ranges::stable_sort(ordered, {}, &Edit::begin);
  for (std::size_t i = 1; i < ordered.size(); ++i) EXPECT_GE(ordered[i].begin, ordered[i - 1].end);
  for (std::size_t i = ordered.size(); i-- > 0;)
    text.replace(ordered[i].begin, ordered[i].end - ordered[i].begin, ordered[i].text);
  return text;
}

}  // namespace rmlcell::lsp
