#include "tests/fuzz/lsp_input.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "clients/lsp/server.h"

namespace rmlcell::lsp {
namespace {

constexpr const char* kUri = "file:///w/12.S";

class NoFolder final : public ProgramFolder {
 public:
  std::vector<machine::NumberedFile> Programs(std::string_view, SourceExtensions) const override {
    return {{44, "file:///w/44.S", "44.S"}};
  }
  Result<std::string> Read(std::string_view) const override {
    return std::string("; a rectangle\nVR[0] = PAR[0]\n");
  }
};

class Client {
 public:
  Client() {
    Ask("initialize", {{"capabilities",
                        {{"textDocument",
                          {{"codeAction", {{"codeActionLiteralSupport", Json::object()}}},
                           {"documentSymbol", {{"hierarchicalDocumentSymbolSupport", true}}}}}}}});
  }

  void Notify(std::string_view method, Json parameters) {
    Send({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(parameters)}});
  }
  Json Ask(std::string_view method, Json parameters) {
    Send({{"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", std::move(parameters)}});
    Json last;
    std::vector<Frame> frames;
    MessageReader().Feed(server.TakeOutput(), frames);
    for (const Frame& frame : frames) {
      Json message = Json::parse(frame.body);
      if (message.contains("id")) last = std::move(message);
    }
    return last;
  }
  // The diagnostics of the one document.
  std::string Check() {
    server.TakeOutput();
    while (server.unchecked()) server.CheckNext();
    return server.TakeOutput();
  }

  NoFolder folder;
  Server server{folder};

 private:
  void Send(const Json& message) {
    server.Receive(Framed(WriteJson(message)));
    while (server.waiting()) server.HandleNext();
  }
};

std::string TryStream(std::string_view bytes) {
  const NoFolder folder;
  Server server(folder);
  const Json first = {{"id", 0}, {"method", "initialize"}, {"params", Json::object()}};
  server.Receive(Framed(first.dump()));
  for (std::size_t at = 0; at < bytes.size(); at += 37) server.Receive(bytes.substr(at, 37));
  while (server.waiting()) server.HandleNext();
  while (server.unchecked()) server.CheckNext();
  std::vector<Frame> frames;
  MessageReader().Feed(server.TakeOutput(), frames);
  for (const Frame& frame : frames) {
    if (!frame.problem.empty() || !Json::accept(frame.body)) return "it sent what is no message";
  }
  return {};
}

// Edits in order, inside the text, not overlapping.
std::string TryEdits(const Json& edits, const Document& document) {
  std::size_t at = 0;
  for (const Json& edit : edits) {
    const auto range = ReadRange(edit["range"]);
    if (!range) return "an edit without range";
    const std::size_t begin = document.OffsetOf(range->start);
    const std::size_t end = document.OffsetOf(range->end);
    if (document.PositionOf(begin) != range->start || document.PositionOf(end) != range->end)
      return "an edit outside the text";
    if (begin < at || end < begin) return "edits that overlap";
    at = end;
  }
  return {};
}

std::string TryText(std::string_view bytes) {
  // Through JSON, so that it is UTF-8.
  const std::string text = Json::parse(WriteJson(Json(std::string(bytes)))).get<std::string>();
  Client client;
  client.Notify("textDocument/didOpen",
                {{"textDocument", {{"uri", kUri}, {"version", 1}, {"text", text}}}});
  Document document(kUri, {}, 1, text, Encoding::kUtf16);
  const Json named = {{"textDocument", {{"uri", kUri}}}};
  const std::size_t step = text.size() / 8 + 1;
  for (std::size_t offset = 0; offset <= text.size(); offset += step) {
    Json place = named;
    place["position"] = ToJson(document.PositionOf(offset));
    place["newName"] = "ZZ9";
    for (const char* method :
         {"hover", "definition", "references", "documentHighlight", "completion", "prepareRename"})
      client.Ask("textDocument/" + std::string(method), place);
    const Json renamed = client.Ask("textDocument/rename", place);
    if (renamed.contains("result")) {
      const std::string wrong = TryEdits(renamed["result"]["changes"][kUri], document);
      if (!wrong.empty()) return "rename: " + wrong;
    }
  }
  for (const char* method : {"foldingRange", "documentSymbol"})
    client.Ask("textDocument/" + std::string(method), named);
  const Json formatted = client.Ask("textDocument/formatting", named);
  if (std::string wrong = TryEdits(formatted["result"], document); !wrong.empty())
    return "formatting: " + wrong;
  Json whole = named;
  whole["range"] = ToJson(Range{{0, 0}, document.PositionOf(text.size())});
  const Json actions = client.Ask("textDocument/codeAction", whole);
  for (const Json& action : actions["result"]) {
    const std::string wrong = TryEdits(action["edit"]["changes"][kUri], document);
    if (!wrong.empty()) return "code action: " + wrong;
  }

  // Halves cut out and put in again, then compared with the text opened anew.
  const std::size_t middle = text.size() / 2;
  const Range cut{document.PositionOf(text.size() / 4), document.PositionOf(middle)};
  client.Notify("textDocument/didChange",
                {{"textDocument", {{"uri", kUri}, {"version", 2}}},
                 {"contentChanges",
                  {{{"range", ToJson(cut)}, {"text", "\r"}},
                   {{"range", ToJson(Range{{0, 0}, {0, 1}})}, {"text", "\n1 "}}}}});
  document.Replace(cut, "\r");
  document.Replace({{0, 0}, {0, 1}}, "\n1 ");
  if (document.lines() != LineTable(document.text())) return "the lines are not those of the text";
  const std::string incremental = client.Check();
  Client fresh;
  fresh.Notify("textDocument/didOpen",
               {{"textDocument", {{"uri", kUri}, {"text", document.text()}}}});
  if (fresh.Check() != incremental) return "an edited text is checked otherwise than a new one";
  return {};
}

}  // namespace

std::string TryLsp(std::string_view bytes) {
  if (bytes.empty()) return {};
  const bool stream = (static_cast<unsigned char>(bytes.front()) & 1U) != 0;
  bytes.remove_prefix(1);
  return stream ? TryStream(bytes) : TryText(bytes);
}

}  // namespace rmlcell::lsp
