#include "engine/optimo/control/control.h"

// Errors: whether a program goes on after one, and where.
namespace rmlcell::optimo {
namespace {

// Some codes have more than one severity (optimo.md section C); the catalogue holds the first. This
// is the one in a run.
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

}  // namespace

void Control::Warn(ErrorCode code, std::string detail, std::string_view rule) {
  WarnAt(s_.place, code, std::move(detail), rule);
}

void Control::WarnAt(const machine::Place& place, ErrorCode code, std::string detail,
                     std::string_view rule) {
  Tell({.code = code,
        .severity = SeverityInRun(code),
        .detail = std::move(detail),
        .rule = std::string(rule),
        .where = {.line = place.line},
        .program = place.program,
        .step = place.step});
}

void Control::Tell(const Diagnostic& finding) {
  if (!Allowed(finding)) observer_.OnDiagnostic(s_.now, finding);
}

// Whether a comment of the program lets it pass: `; rmlcell: allow 7321`.
bool Control::Allowed(const Diagnostic& finding) const {
  if (IsError(finding.severity) || !IsSlot(finding.program)) return false;
  const machine::SourceNotes* source = sources_[static_cast<std::size_t>(finding.program)];
  return source != nullptr && std::ranges::any_of(source->allowed, [&](const AllowedFinding& one) {
           return one.number == Lookup(finding.code).number &&
                  (one.line == 0 || one.line == finding.where.line);
         });
}

// The failing instruction has no effect. What moves comes to rest first; an error that was raised
// ahead of a motion is handled when that motion is over.
void Control::Raise(ErrorCode code, std::string detail) {
  const Error error{code, std::move(detail), {}};
  if (s_.deferred) return;
  if (s_.passing || Busy()) {
    if (s_.background && s_.active) EndMotionHere();
    StopMotions();
    s_.deferred = error;
    s_.deferred_place = s_.place;
    s_.pending = {.kind = Pending::Kind::kStandstill};
    return;
  }
  HandleError(error);
}

void Control::HandleError(const Error& error) {
  s_.machine.data.vi[99] = static_cast<float>(Lookup(error.code).number);
  TellWait();
  s_.pending = {};
  s_.condition_met = false;
  Unwatch();
  BeamOff();
  const Severity severity = SeverityInRun(error.code);
  std::optional<std::uint32_t> handler;
  std::size_t catching = 0;
  if (!s_.programs.empty()) {
    program().processes.AllOff();
    program().work_tasks.clear();
    program().due_gosub.reset();
    // The innermost module with an armed ERR, up to the main module of this executable (OPT-3.57).
    std::vector<Frame>& frames = program().frames;
    for (std::size_t n = frames.size(); severity == Severity::kProgram && n-- > 0;) {
      if (!frames[n].error_label) continue;
      catching = n;
      handler = program().program->index[static_cast<std::size_t>(frames[n].module)].FindLabel(
          *frames[n].error_label);
      if (!handler) {
        Warn(error.code, error.detail, {});
        return FailWithoutHandler(*frames[n].error_label);
      }
      break;
    }
  }
  Warn(error.code, error.detail, {});
  if (!handler) return Finish(machine::OutcomeKind::kFailed, error.code, error.detail);
  program().frames.resize(catching + 1);
  frame().error_label.reset();  // taking the handler disarms it, OPT-3.55
  frame().next = *handler;
}

// The label of ERR is missing: a second error, which nothing can catch. OPT-3.59, OPT-E.60
void Control::FailWithoutHandler(int label) {
  const std::string detail = "no sequence number " + std::to_string(label) + " for ERR";
  Tell({.code = ErrorCode::kLabelNotFound,
        .severity = Severity::kFatal,
        .detail = detail,
        .rule = "OPT-3.59",
        .where = {.line = s_.place.line},
        .program = s_.place.program,
        .step = s_.place.step});
  s_.machine.data.vi[99] = static_cast<float>(Lookup(ErrorCode::kLabelNotFound).number);
  Finish(machine::OutcomeKind::kFailed, ErrorCode::kLabelNotFound, detail);
}

}  // namespace rmlcell::optimo
