#include "clients/lsp/check.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/program_folder.h"
#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/offline/translate.h"
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

Diagnostic Plain(ErrorCode code, Severity severity, std::string detail, std::string rule) {
  return {.code = code,
          .severity = severity,
          .detail = std::move(detail),
          .rule = std::move(rule),
          .file = {},
          .where = {},
          .fixes = {}};
}

Findings CheckInch(const Document& document) {
  optimo::Compilation compiled = optimo::Compile(document.text(), {}, {});
  // A short distance in inches is none in millimetres. Contours, whose advice depends on units, are
  // not looked at.
  std::erase_if(compiled.diagnostics,
                [](const Diagnostic& d) { return d.code == ErrorCode::kShortFly; });
  compiled.diagnostics.insert(
      compiled.diagnostics.begin(),
      Plain(ErrorCode::kSourceIsInch, Severity::kAdvice,
            "inches and degrees: convert the file before it is compiled", "OPT-2.04"));
  return {std::move(compiled.diagnostics), compiled.diagnostics_dropped};
}

}  // namespace

Family FamilyOf(const Document& document) {
  const machine::MachineFamily* family = families::FamilyOfFileName(FileNameOfUri(document.uri()));
  if (family != nullptr) return family->info().id == "rml1" ? Family::kRml1 : Family::kOptimo;
  return document.language() == kRml1Language ? Family::kRml1 : Family::kOptimo;
}

Findings CheckDocument(const Document& document) {
  const std::string& text = document.text();
  if (text.empty()) return {};
  if (text.size() > kCheckedBytesMax) {
    return {{Plain(ErrorCode::kCellTooLarge, Severity::kWarning,
                   "the text has " + std::to_string(text.size()) + " bytes; at most " +
                       std::to_string(kCheckedBytesMax) + " are checked",
                   {})},
            0};
  }
  const std::string name = FileNameOfUri(document.uri());
  const bool rml1 = FamilyOf(document) == Family::kRml1;
  if (!rml1 && optimo::FormOfFile(name, text) == optimo::FileForm::kInchSource)
    return CheckInch(document);
  const machine::MachineFamily* family = families::FindFamily(rml1 ? "rml1" : "optimo");
  machine::Translation translation = simulation::TranslateProgram(
      *family, machine::Parameters(family->parameters()),
      {.file_name = name, .bytes = simulation::Borrowed(text), .is_source = true},
      {.advice = true});
  return {std::move(translation.diagnostics), translation.diagnostics_dropped};
}

Marked PlaceOf(const Diagnostic& finding, std::string_view text) {
  if (finding.where.byte_offset < 0) return {};
  const auto begin = std::min(static_cast<std::size_t>(finding.where.byte_offset), text.size());
  const auto length = static_cast<std::size_t>(std::max(finding.where.length, 0));
  return {begin, std::min(text.size(), begin + length)};
}

Json ToJson(const Diagnostic& finding, PositionFinder& positions, std::string_view text) {
  const CatalogueEntry& entry = Lookup(finding.code);
  std::string message = finding.detail.empty() ? std::string(entry.when) : finding.detail;
  if (!finding.rule.empty()) message += " [" + finding.rule + "]";
  if (entry.family != ErrorFamily::kCell) message += "\n" + std::string(entry.advice);
  const Marked marked = PlaceOf(finding, text);
  Json json = {{"range", ToJson(positions.Span(marked.begin, marked.end))},
               {"severity", SeverityOf(finding)},
               {"code", CodeText(finding.code)},
               {"source", "rmlcell"},
               {"message", std::move(message)}};
  if (finding.code == ErrorCode::kPracticeAdvice && finding.rule == "OPT-3.47")
    json["tags"] = Json::array({kTagUnnecessary});  // never reached
  return json;
}

Json ToJson(const Findings& findings, const Document& document) {
  Json list = Json::array();
  PositionFinder positions(document);
  for (const Diagnostic& finding : findings.list)
    list.push_back(ToJson(finding, positions, document.text()));
  if (findings.dropped > 0) {
    const Position end = positions.At(document.text().size());
    list.push_back({{"range", ToJson(Range{end, end})},
                    {"severity", kSeverityWarning},
                    {"source", "rmlcell"},
                    {"message", "and " + std::to_string(findings.dropped) + " more findings"}});
  }
  return list;
}

}  // namespace rmlcell::lsp
