#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/answers.h"
#include "clients/lsp/open_document.h"
#include "clients/lsp/text_edits.h"

// What editors ask about a document. Streams have findings and nothing else.
namespace rmlcell::lsp {
namespace {

RequestError NotOpen() { return {ErrorNumber::kInvalidParams, "the document is not open"}; }

RequestError NoNames(const Document& document) {
  return {ErrorNumber::kRequestFailed, FamilyOf(document).editing() == nullptr
                                           ? "a stream has no names"
                                           : "the text is too long to be searched"};
}

}  // namespace

struct Server::Place {
  OpenDocument* open = nullptr;
  std::size_t offset = 0;
  const machine::EditedProgram* program = nullptr;  // null: it has findings alone
};

std::variant<Server::Place, RequestError> Server::ReadPlace(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  const Json* position = Member(parameters, {"position"});
  const auto read = position == nullptr ? std::nullopt : ReadPosition(*position);
  if (!read) return RequestError{ErrorNumber::kInvalidParams, "there is no position"};
  return Place{open, open->document.OffsetOf(*read), Look(*open)};
}

Server::Answer Server::OnHover(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  std::span<const Diagnostic> findings;
  if (open->findings) findings = open->findings->list;  // a hover does not wait for a check
  std::optional<machine::HoverNote> note;
  if (program != nullptr) note = program->Hover(offset, Around(*open));
  return HoverAnswer(open->document, offset, note, findings, FamilyOf(open->document).editing());
}

Server::Answer Server::OnDefinition(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  if (program == nullptr) return Json(nullptr);
  return Locations(open->document, program->Definition(offset, Around(*open)));
}

Server::Answer Server::OnReferences(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  if (program == nullptr) return Json(nullptr);
  const bool with_definition = FlagMember(parameters, {"context", "includeDeclaration"});
  return Locations(open->document, program->References(offset, with_definition, Around(*open)));
}

Server::Answer Server::OnHighlight(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  if (program == nullptr) return Json(nullptr);
  return Highlights(open->document, program->Highlights(offset));
}

Server::Answer Server::OnCompletion(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  if (program == nullptr) return Json(nullptr);
  return CompletionList(open->document, program->Complete(offset, Around(*open)));
}

Server::Answer Server::OnPrepareRename(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  if (program == nullptr) return NoNames(open->document);
  const auto found = program->Renamable(offset);
  if (const auto* refused = std::get_if<machine::Refusal>(&found))
    return RequestError{ErrorNumber::kRequestFailed, refused->why};
  return RenamePlace(open->document, std::get<machine::TextSpan>(found));
}

Server::Answer Server::OnRename(const Json& parameters) {
  const auto place = ReadPlace(parameters);
  if (const auto* wrong = std::get_if<RequestError>(&place)) return *wrong;
  const auto& [open, offset, program] = std::get<Place>(place);
  if (program == nullptr) return NoNames(open->document);
  const auto name = TextMember(parameters, {"newName"});
  if (!name) return RequestError{ErrorNumber::kInvalidParams, "there is no new name"};
  const auto places = program->Rename(offset, *name);
  if (const auto* refused = std::get_if<machine::Refusal>(&places))
    return RequestError{ErrorNumber::kRequestFailed, refused->why};
  return RenameEdits(open->document, std::get<std::vector<machine::TextSpan>>(places), *name);
}

Server::Answer Server::OnFormatting(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  if (Look(*open) == nullptr) return Json(nullptr);
  return FormattingEdits(open->document);
}

Server::Answer Server::OnFolding(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  const machine::EditedProgram* program = Look(*open);
  return program == nullptr ? Json::array() : FoldingRanges(program->Folds());
}

Server::Answer Server::OnSymbols(const Json& parameters) {
  OpenDocument* open = Find(parameters);
  if (open == nullptr) return NotOpen();
  const machine::EditedProgram* program = Look(*open);
  return program == nullptr ? Json::array()
                            : Symbols(open->document, program->Outline(), nested_symbols_);
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
