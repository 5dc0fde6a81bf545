#include "engine/optimo/offline/translate.h"

#include <utility>

#include "engine/core/letters.h"
#include "engine/optimo/offline/house_programs.h"

namespace rmlcell::optimo {
namespace {

constexpr int kAmadaProgramMax = 7;  // OPT-10.17

bool EndsWith(std::string_view name, std::string_view upper_case) {
  return UpperCase(name).ends_with(upper_case);
}

void AddFigures(const Module& module, std::size_t source_bytes, machine::Translation& to) {
  const auto count = [](std::size_t value) { return static_cast<double>(value); };
  to.figures = {{"steps", "", count(module.step_count)},
                {"source_bytes", "", count(source_bytes)},
                {"object_bytes", "", count(to.object.size())},
                {"sequence_numbers", "", count(module.labels.size() + module.end_labels.size())},
                {"names", "", count(module.names.size())}};
}

machine::Translation Refuse(ErrorCode code, Detail detail, const std::string& file) {
  machine::Translation refused;
  refused.diagnostics.push_back({.code = code,
                                 .severity = Lookup(code).severity,
                                 .detail = std::move(detail),
                                 .rule = {},
                                 .file = file,
                                 .where = {},
                                 .fixes = {}});
  return refused;
}

// An inch source that is being written. A short distance in inches is none in millimetres, and
// contours, whose advice depends on units, are not looked at.
machine::Translation CheckUnconverted(const machine::SourceFile& file, bool advice) {
  Compilation compiled = Compile(
      file.bytes, file.name,
      {.advice = advice, .diagnostics_max = machine::kDiagnosticsMax, .further_advice = {}});
  machine::Translation checked;
  checked.diagnostics = std::move(compiled.diagnostics);
  checked.diagnostics_dropped = compiled.diagnostics_dropped;
  std::erase_if(checked.diagnostics,
                [](const Diagnostic& finding) { return finding.code == ErrorCode::kShortFly; });
  if (!advice) return checked;
  checked.diagnostics.insert(
      checked.diagnostics.begin(),
      {.code = ErrorCode::kSourceIsInch,
       .severity = Severity::kAdvice,
       .detail = "inches and degrees: convert the file before it is compiled",
       .rule = "OPT-2.04",
       .file = file.name,
       .where = {},
       .fixes = {}});
  return checked;
}

}  // namespace

FileForm FormOfFile(std::string_view name, std::string_view bytes) {
  if (EndsWith(name, ".SI")) return FileForm::kInchSource;
  if (EndsWith(name, ".S") || EndsWith(name, ".CMP")) return FileForm::kMetricSource;
  constexpr std::string_view kObjectBegin("LMR\x01", 4);
  return EndsWith(name, ".O") || bytes.starts_with(kObjectBegin) ? FileForm::kObject
                                                                 : FileForm::kMetricSource;
}

std::vector<Diagnostic> CheckProgramNumber(int slot, std::string_view text) {
  if (slot < 1 || slot > kAmadaProgramMax || IsHouseProgram(slot, text)) return {};
  Diagnostic reserved{.code = ErrorCode::kReservedVariable,
                      .severity = Lookup(ErrorCode::kReservedVariable).severity,
                      .detail = "programs 1 to 7 are reserved for Amada",
                      .rule = "OPT-10.17"};
  reserved.program = slot;
  return {std::move(reserved)};
}

machine::Translation TranslateOptimo(const machine::SourceFile& file,
                                     const machine::CheckOptions& options,
                                     std::uint32_t object_limit,
                                     const ContourMachine& contour_machine) {
  if (file.bytes.empty())
    return Refuse(ErrorCode::kCellEmptyProgram, "the file is empty", file.name);
  const FileForm form = file.is_object ? FileForm::kObject : FormOfFile(file.name, file.bytes);
  if (form == FileForm::kObject) {
    const Result<Module> module = DecodeObject(file.bytes);
    if (!module) return Refuse(module.error().code, module.error().detail, file.name);
    if (object_limit > 0 && file.bytes.size() > object_limit) {
      return Refuse(ErrorCode::kObjectTooLong,
                    "the object has " + ToldSize("bytes", file.bytes.size()) + " bytes", file.name);
    }
    machine::Translation accepted;
    accepted.ok = true;
    accepted.object = std::string(file.bytes);
    AddFigures(*module, 0, accepted);
    return accepted;
  }
  if (options.unconverted && form == FileForm::kInchSource)
    return CheckUnconverted(file, options.advice);
  Compilation compiled = Compile(file.bytes, file.name,
                                 {.object_limit = object_limit,
                                  .start = contour_machine.start,
                                  .advice = options.advice,
                                  .inch = form == FileForm::kInchSource,
                                  .source = options.source,
                                  .diagnostics_max = machine::kDiagnosticsMax,
                                  .further_advice = ContourAdvice(contour_machine)});
  machine::Translation translation;
  translation.ok = compiled.ok;
  translation.object = std::move(compiled.object);
  translation.diagnostics = std::move(compiled.diagnostics);
  translation.diagnostics_dropped = compiled.diagnostics_dropped;
  if (compiled.ok) AddFigures(compiled.module, file.bytes.size(), translation);
  translation.source = {.step_lines = std::move(compiled.step_lines),
                        .allowed = std::move(compiled.allowed)};
  return translation;
}

}  // namespace rmlcell::optimo
