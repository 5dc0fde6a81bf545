#include "clients/lsp/check.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/program_folder.h"
#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"

namespace rmlcell::lsp {
namespace {

// Of LSP.
constexpr int kSeverityError = 1, kSeverityWarning = 2, kSeverityInformation = 3;
constexpr int kTagUnnecessary = 1;

int SeverityOf(const Diagnostic& finding) {
  if (IsError(finding.severity)) return kSeverityError;
  return finding.severity == Severity::kAdvice ? kSeverityInformation : kSeverityWarning;
}

}  // namespace

const machine::MachineFamily& FamilyOf(const Document& document) {
  const machine::MachineFamily* family = families::FamilyOfFileName(FileNameOfUri(document.uri()));
  if (family != nullptr) return *family;
  const auto& known = families::Families();
  const auto named = std::ranges::find_if(known, [&](const machine::MachineFamily* one) {
    return one->info().editor_language == document.language();
  });
  if (named != known.end() && !document.language().empty()) return **named;
  const auto written = std::ranges::find_if(
      known, [](const machine::MachineFamily* one) { return one->editing() != nullptr; });
  return written != known.end() ? **written : *known.front();
}

Findings CheckDocument(const Document& document) {
  const std::string& text = document.text();
  if (text.empty()) return {};
  if (text.size() > kCheckedBytesMax) {
    return {{{.code = ErrorCode::kCellTooLarge,
              .severity = Severity::kWarning,
              .detail = "the text has " + std::to_string(text.size()) + " bytes; at most " +
                        std::to_string(kCheckedBytesMax) + " are checked",
              .rule = {},
              .file = {},
              .where = {},
              .fixes = {}}},
            {}};
  }
  const machine::MachineFamily& family = FamilyOf(document);
  machine::Translation translation =
      simulation::TranslateProgram(family, machine::Parameters(family.parameters()),
                                   {.file_name = FileNameOfUri(document.uri()),
                                    .bytes = machine::Bytes::Borrowed(text),
                                    .is_source = true},
                                   {.advice = true, .unconverted = true});
  return {std::move(translation.diagnostics), translation.diagnostics_dropped};
}

Marked PlaceOf(const Diagnostic& finding, std::string_view text) {
  if (finding.where.byte_offset < 0) return {};
  const auto begin = std::min(static_cast<std::size_t>(finding.where.byte_offset), text.size());
  const auto length = static_cast<std::size_t>(std::max(finding.where.length, 0));
  return {begin, std::min(text.size(), begin + length)};
}

Json ToJson(const Diagnostic& finding, PositionFinder& positions, const Document& document) {
  const std::string_view text = document.text();
  const CatalogueEntry& entry = Lookup(finding.code);
  std::string message = Said(finding.code, finding.detail);
  if (!finding.rule.empty()) message += " [" + finding.rule + "]";
  if (entry.family != ErrorFamily::kCell) message += "\n" + std::string(entry.advice);
  const Marked marked = PlaceOf(finding, text);
  Json json = {{"range", ToJson(positions.Span(marked.begin, marked.end))},
               {"severity", SeverityOf(finding)},
               {"code", CodeText(finding.code)},
               {"source", "rmlcell"},
               {"message", std::move(message)}};
  const machine::Editing* editing = FamilyOf(document).editing();
  if (editing != nullptr && editing->IsNeverReached(finding))
    json["tags"] = Json::array({kTagUnnecessary});
  return json;
}

Json ToJson(const Findings& findings, const Document& document) {
  Json list = Json::array();
  PositionFinder positions(document);
  for (const Diagnostic& finding : findings.list)
    list.push_back(ToJson(finding, positions, document));
  if (!findings.dropped.empty()) {
    const Position end = positions.At(document.text().size());
    list.push_back(
        {{"range", ToJson(Range{end, end})},
         {"severity", kSeverityWarning},
         {"source", "rmlcell"},
         {"message", "and " + std::to_string(findings.dropped.count()) + " more findings"}});
  }
  return list;
}

}  // namespace rmlcell::lsp
