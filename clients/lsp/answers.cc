#include "clients/lsp/answers.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/check.h"
#include "engine/core/catalogue.h"

namespace rmlcell::lsp {
namespace {

constexpr std::size_t kFindingsMax = 3;  // of one place; more is a wall of text

std::string RuleLine(std::string_view rule, const machine::Editing* editing) {
  const std::string_view text = editing == nullptr ? std::string_view() : editing->TextOfRule(rule);
  return text.empty() ? "Rule " + std::string(rule)
                      : "Rule " + std::string(rule) + ": " + std::string(text);
}

std::string FindingsText(std::size_t offset, std::span<const Diagnostic> findings,
                         std::string_view text, const machine::Editing* editing) {
  std::string all;
  std::size_t told = 0;
  for (const Diagnostic& finding : findings) {
    const Marked marked = PlaceOf(finding, text);
    if (finding.where.byte_offset < 0 || offset < marked.begin || offset > marked.end) continue;
    if (++told > kFindingsMax) break;
    const CatalogueEntry& entry = Lookup(finding.code);
    if (!all.empty()) all += "\n\n";
    all += "**" + CodeText(finding.code) + "** (" + std::string(SeverityName(finding.severity)) +
           "): " + std::string(entry.when) + "\n\nWhat to do: " + std::string(entry.advice);
    if (!finding.rule.empty()) all += "\n\n" + RuleLine(finding.rule, editing);
  }
  return all;
}

// Of LSP.
int HighlightKind(bool defines) { return defines ? 3 : 2; }

int CompletionKind(machine::Suggestion::Kind kind) {
  using Kind = machine::Suggestion::Kind;
  switch (kind) {
    case Kind::kFunction:
      return 3;
    case Kind::kVariable:
      return 6;
    case Kind::kProgram:
      return 9;
    case Kind::kSequenceNumber:
      return 18;
    case Kind::kConstant:
      return 21;
    case Kind::kWord:
      break;
  }
  return 14;
}

int SymbolKind(machine::OutlinePart::Kind kind) {
  using Kind = machine::OutlinePart::Kind;
  switch (kind) {
    case Kind::kSubroutine:
      return 12;
    case Kind::kVariable:
      return 13;
    case Kind::kConstant:
      return 14;
    case Kind::kSequenceNumber:
      return 20;
    case Kind::kStep:
      break;
  }
  return 24;
}

Json Symbol(const machine::OutlinePart& part, PositionFinder& positions) {
  Json symbol = {{"name", part.name},
                 {"kind", SymbolKind(part.kind)},
                 {"range", ToJson(positions.Span(part.whole.begin, part.whole.end))},
                 {"selectionRange", ToJson(positions.Span(part.name_at.begin, part.name_at.end))}};
  if (!part.detail.empty()) symbol["detail"] = part.detail;
  if (part.parts.empty()) return symbol;
  Json& children = symbol["children"] = Json::array();
  for (const machine::OutlinePart& child : part.parts) children.push_back(Symbol(child, positions));
  return symbol;
}

void Flatten(const Json& symbol, const std::string& uri, const std::string& container, Json& to) {
  Json flat = {{"name", symbol["name"]},
               {"kind", symbol["kind"]},
               {"location", {{"uri", uri}, {"range", symbol["range"]}}}};
  if (!container.empty()) flat["containerName"] = container;
  to.push_back(std::move(flat));
  if (const auto children = symbol.find("children"); children != symbol.end()) {
    for (const Json& child : *children) Flatten(child, uri, symbol["name"], to);
  }
}

}  // namespace

Json HoverAnswer(const Document& document, std::size_t offset,
                 const std::optional<machine::HoverNote>& note,
                 std::span<const Diagnostic> findings, const machine::Editing* editing) {
  std::string text = note ? note->text : std::string();
  const std::string wrong = FindingsText(offset, findings, document.text(), editing);
  if (!wrong.empty()) text += (text.empty() ? "" : "\n\n---\n\n") + wrong;
  if (text.empty()) return nullptr;
  Json hover = {{"contents", Markdown(text)}};
  if (note) hover["range"] = ToJson(PositionFinder(document).Span(note->of.begin, note->of.end));
  return hover;
}

Json Locations(const Document& document, const machine::Places& places) {
  Json found = Json::array();
  PositionFinder positions(document);
  for (const machine::TextSpan& span : places.here)
    found.push_back(Location(document.uri(), positions.Span(span.begin, span.end)));
  for (const machine::PlacesInFile& other : places.elsewhere) {
    const Document text(other.file.uri, {}, 0, other.file.text, document.encoding());
    PositionFinder positions_there(text);
    for (const machine::TextSpan& span : other.spans)
      found.push_back(Location(text.uri(), positions_there.Span(span.begin, span.end)));
  }
  return found;
}

Json Highlights(const Document& document, std::span<const machine::Highlight> highlights) {
  Json found = Json::array();
  PositionFinder positions(document);
  for (const machine::Highlight& one : highlights) {
    found.push_back({{"range", ToJson(positions.Span(one.span.begin, one.span.end))},
                     {"kind", HighlightKind(one.defines)}});
  }
  return found;
}

Json CompletionList(const Document& document, const machine::Suggestions& suggestions) {
  const Range typed = PositionFinder(document).Span(suggestions.typed.begin, suggestions.typed.end);
  Json items = Json::array();
  for (const machine::Suggestion& one : suggestions.list) {
    Json item = {{"label", one.label},
                 {"kind", CompletionKind(one.kind)},
                 {"textEdit", TextEdit(typed, one.label)}};
    if (!one.detail.empty()) item["detail"] = one.detail;
    if (!one.text.empty()) item["documentation"] = Markdown(one.text);
    items.push_back(std::move(item));
  }
  return {{"isIncomplete", suggestions.cut}, {"items", std::move(items)}};
}

Json RenamePlace(const Document& document, const machine::TextSpan& span) {
  return {{"range", ToJson(PositionFinder(document).Span(span.begin, span.end))},
          {"placeholder", document.text().substr(span.begin, span.end - span.begin)}};
}

Json RenameEdits(const Document& document, std::span<const machine::TextSpan> places,
                 std::string_view name) {
  Json edits = Json::array();
  PositionFinder positions(document);
  for (const machine::TextSpan& span : places)
    edits.push_back(TextEdit(positions.Span(span.begin, span.end), name));
  return {{"changes", {{document.uri(), std::move(edits)}}}};
}

Json Symbols(const Document& document, std::span<const machine::OutlinePart> outline, bool nested) {
  PositionFinder positions(document);
  Json symbols = Json::array();
  for (const machine::OutlinePart& part : outline) symbols.push_back(Symbol(part, positions));
  if (nested) return symbols;
  Json flat = Json::array();
  for (const Json& symbol : symbols) Flatten(symbol, document.uri(), {}, flat);
  return flat;
}

Json FoldingRanges(std::span<const machine::FoldedLines> folds) {
  Json ranges = Json::array();
  for (const machine::FoldedLines& fold : folds) {
    Json range = {{"startLine", fold.first}, {"endLine", fold.last}};
    if (fold.kind == machine::FoldedLines::Kind::kComment) range["kind"] = "comment";
    if (fold.kind == machine::FoldedLines::Kind::kRegion) range["kind"] = "region";
    ranges.push_back(std::move(range));
  }
  return ranges;
}

}  // namespace rmlcell::lsp
