#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/open_document.h"

// Documents as the editor opens, changes and closes them, and what is said of them.
namespace rmlcell::lsp {
namespace {

// Without one, or with null as some clients have it, the change is the whole text.
const Json* RangeOf(const Json& change) {
  const Json* range = Member(change, {"range"});
  return range == nullptr || range->is_null() ? nullptr : range;
}

}  // namespace

void Server::DidOpen(const Json& parameters) {
  const auto uri = TextMember(parameters, {"textDocument", "uri"});
  auto text = TextMember(parameters, {"textDocument", "text"});
  if (!uri || !text) return Log("didOpen without uri or text");
  const auto language = TextMember(parameters, {"textDocument", "languageId"});
  const auto version = NumberMember(parameters, {"textDocument", "version"});
  documents_[*uri] = std::make_unique<OpenDocument>(
      Document(*uri, language.value_or(""), version.value_or(0), *std::move(text), encoding_));
}

// All changes or none: after half of them the texts of editor and server would differ unnoticed.
void Server::DidChange(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return Log("didChange of a document that is not open");
  const Json* changes = Member(parameters, {"contentChanges"});
  if (changes == nullptr || !changes->is_array()) return Log("didChange without contentChanges");
  for (const Json& change : *changes) {
    const Json* range = RangeOf(change);
    if (!TextMember(change, {"text"}) || (range != nullptr && !ReadRange(*range)))
      return Log("didChange with a change that cannot be read; close and open the document");
  }
  for (const Json& change : *changes) {
    std::string text = *TextMember(change, {"text"});
    if (const Json* range = RangeOf(change)) {
      open->document.Replace(*ReadRange(*range), text);
    } else {
      open->document.ReplaceAll(std::move(text));
    }
  }
  if (const auto version = NumberMember(parameters, {"textDocument", "version"}))
    open->document.set_version(*version);
  open->Changed();
}

void Server::DidClose(const Json& parameters) {
  const auto uri = TextMember(parameters, {"textDocument", "uri"});
  const auto found = uri ? documents_.find(*uri) : documents_.end();
  if (found == documents_.end()) return;
  Notify("textDocument/publishDiagnostics", {{"uri", *uri}, {"diagnostics", Json::array()}});
  documents_.erase(found);
}

void Server::DidSave(const Json&) {}

bool Server::unchecked() const {
  return std::ranges::any_of(documents_, [](const auto& one) { return one.second->unpublished; });
}

void Server::CheckNext() {
  const auto found =
      std::ranges::find_if(documents_, [](const auto& one) { return one.second->unpublished; });
  if (found == documents_.end()) return;
  OpenDocument& open = *found->second;
  open.unpublished = false;
  Checked(open);
  Publish(open);
}

void Server::Publish(const OpenDocument& open) {
  Json parameters = {{"uri", open.document.uri()},
                     {"diagnostics", ToJson(*open.findings, open.document)}};
  if (versions_) parameters["version"] = open.document.version();
  Notify("textDocument/publishDiagnostics", std::move(parameters));
}

const Findings& Server::Checked(OpenDocument& open) {
  if (!open.findings) open.findings = CheckDocument(open.document);
  return *open.findings;
}

// Null: a stream, or a text that is too long to be searched.
const machine::EditedProgram* Server::Look(OpenDocument& open) {
  const machine::Editing* editing = FamilyOf(open.document).editing();
  const std::string& text = open.document.text();
  if (open.program == nullptr && editing != nullptr && text.size() <= kCheckedBytesMax)
    open.program = editing->Look(text);
  return open.program.get();
}

DocumentSurroundings Server::Around(const OpenDocument& open) {
  const machine::Editing* editing = FamilyOf(open.document).editing();
  return {open.document, folder_,
          editing == nullptr ? SourceExtensions() : editing->source_extensions(),
          [this](std::string_view uri) -> const Document* {
            const OpenDocument* found = FindUri(uri);
            return found == nullptr ? nullptr : &found->document;
          }};
}

Server::OpenDocument* Server::Find(const Json& parameters) {
  const auto uri = TextMember(parameters, {"textDocument", "uri"});
  return uri ? FindUri(*uri) : nullptr;
}

// Editors escape different characters: the same path is the same document.
Server::OpenDocument* Server::FindUri(std::string_view uri) {
  if (const auto found = documents_.find(uri); found != documents_.end())
    return found->second.get();
  const auto path = PathOfUri(uri);
  if (!path) return nullptr;
  for (const auto& [other, open] : documents_) {
    if (PathOfUri(other) == path) return open.get();
  }
  return nullptr;
}

}  // namespace rmlcell::lsp
