#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/completion.h"
#include "clients/lsp/hover.h"
#include "clients/lsp/navigation.h"
#include "clients/lsp/open_document.h"
#include "clients/lsp/outline.h"
#include "clients/lsp/rename.h"
#include "clients/lsp/text_edits.h"

// What editors ask about a document. Streams for mills have findings and nothing else.
namespace rmlcell::lsp {
namespace {

RequestError NotOpen() { return {ErrorNumber::kInvalidParams, "the document is not open"}; }

}  // namespace

struct Server::Place {
  OpenDocument* open = nullptr;
  std::size_t offset = 0;
  bool optimo = true;
};

std::variant<Server::Place, RequestError> Server::ReadPlace(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  const Json* position = Member(parameters, {"position"});
  const auto read = position == nullptr ? std::nullopt : ReadPosition(*position);
  if (!read) return RequestError{ErrorNumber::kInvalidParams, "there is no position"};
  return Place{open, open->document.OffsetOf(*read), FamilyOf(open->document) == Family::kOptimo};
}

Server::Answer Server::OnHover(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  std::span<const Diagnostic> findings;
  if (open->findings) findings = open->findings->list;  // a hover does not wait for a check
  return optimo ? Hover(Program(*open), offset, findings)
                : HoverFindings(open->document, offset, findings);
}

Server::Answer Server::OnDefinition(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  if (!optimo) return Json(nullptr);
  return Definition(Program(*open), offset);
}

Server::Answer Server::OnReferences(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  if (!optimo) return Json(nullptr);
  return References(Program(*open), offset,
                    FlagMember(parameters, {"context", "includeDeclaration"}));
}

Server::Answer Server::OnHighlight(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  if (!optimo) return Json(nullptr);
  return Highlights(Program(*open), offset);
}

Server::Answer Server::OnCompletion(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  if (!optimo) return Json(nullptr);
  return Complete(Program(*open), offset);
}

Server::Answer Server::OnPrepareRename(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  if (!optimo) return RequestError{ErrorNumber::kRequestFailed, "a stream has no names"};
  return PrepareRename(Program(*open), offset);
}

Server::Answer Server::OnRename(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, optimo] = std::get<Place>(place);
  if (!optimo) return RequestError{ErrorNumber::kRequestFailed, "a stream has no names"};
  const auto name = TextMember(parameters, {"newName"});
  if (!name) return RequestError{ErrorNumber::kInvalidParams, "there is no new name"};
  return Rename(Program(*open), offset, *name);
}

Server::Answer Server::OnFormatting(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  const bool formatted = FamilyOf(open->document) == Family::kOptimo &&
                         open->document.text().size() <= kCheckedBytesMax;
  if (!formatted) return Json(nullptr);
  return FormattingEdits(open->document);
}

Server::Answer Server::OnFolding(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  return FoldingRanges(open->document, Index(*open));
}

Server::Answer Server::OnSymbols(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  return Symbols(open->document, Index(*open), nested_symbols_);
}

Server::Answer Server::OnCodeAction(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  const Json* range = Member(parameters, {"range"});
  const auto read = range == nullptr ? std::nullopt : ReadRange(*range);
  if (!read) return RequestError{ErrorNumber::kInvalidParams, "there is no range"};
  if (!literal_actions_) return Json::array();  // a client that knows commands only
  return CodeActions(open->document, Checked(*open), *read,
                     Member(parameters, {"context", "only"}));
}

}  // namespace rmlcell::lsp
