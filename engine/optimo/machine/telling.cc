#include "engine/optimo/machine/telling.h"

#include <algorithm>

namespace rmlcell::optimo {

Severity SeverityInRun(ErrorCode code) {
  switch (code) {
    case ErrorCode::kScheduleRange:  // computed; a literal never comes to a run (OPT-B.36)
      return Severity::kProgram;
    case ErrorCode::kCmosFull:
    case ErrorCode::kObjectCorrupt:  // when it is linked or loaded, OPT-B.56
      return Severity::kFatal;
    default:
      return Lookup(code).severity;
  }
}

Telling::Telling(const Situation& situation, const machine::RunSetup& setup,
                 machine::RunObserver& observer)
    : situation_(situation), observer_(observer) {
  for (const auto& [slot, program] : setup.programs) {
    if (IsSlot(slot)) sources_[static_cast<std::size_t>(slot)] = program.source.get();
  }
}

std::span<const int> Telling::LinesOf(int slot) const {
  const machine::SourceNotes* source = sources_[static_cast<std::size_t>(slot)];
  return source != nullptr ? std::span<const int>(source->step_lines) : std::span<const int>();
}

machine::Place Telling::PlaceOf(int slot, std::uint32_t step) const {
  const std::span<const int> lines = LinesOf(slot);
  const bool known = step >= 1 && step <= lines.size();
  return {.program = slot, .step = static_cast<int>(step), .line = known ? lines[step - 1] : 0};
}

void Telling::Warn(ErrorCode code, Detail detail, std::string_view rule) const {
  WarnAt(situation_.place, code, std::move(detail), rule);
}

void Telling::WarnAt(const machine::Place& place, ErrorCode code, Detail detail,
                     std::string_view rule) const {
  Tell({.code = code,
        .severity = SeverityInRun(code),
        .detail = std::move(detail),
        .rule = std::string(rule),
        .where = {.line = place.line},
        .program = place.program,
        .step = place.step});
}

void Telling::Tell(const Diagnostic& finding) const {
  if (!Allowed(finding)) observer_.OnDiagnostic(situation_.now, finding);
}

bool Telling::Allowed(const Diagnostic& finding) const {
  if (IsError(finding.severity) || !IsSlot(finding.program)) return false;
  const machine::SourceNotes* source = sources_[static_cast<std::size_t>(finding.program)];
  return source != nullptr && std::ranges::any_of(source->allowed, [&](const AllowedFinding& one) {
           return one.number == Lookup(finding.code).number &&
                  (one.line == 0 || one.line == finding.where.line);
         });
}

void Telling::Signal(machine::Signal signal, int index, double value, double detail) const {
  observer_.OnSignal({.at = situation_.now,
                      .place = situation_.place,
                      .signal = signal,
                      .index = index,
                      .value = value,
                      .detail = detail});
}

}  // namespace rmlcell::optimo
