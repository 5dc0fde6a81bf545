#include "engine/optimo/control/alarms.h"

#include <utility>

namespace rmlcell::optimo {

Status Alarms::Raise(const Error& error) {
  if (s_.deferred) return {};
  if (!ride_.EndForError()) return Handle(error);
  s_.deferred = error;
  s_.deferred_place = situation_.place;
  waits_.BeginStandstill();
  return {};
}

Status Alarms::HandleDeferred() {
  if (!s_.deferred) return {};
  const Error error = *std::exchange(s_.deferred, std::nullopt);
  situation_.place = s_.deferred_place;
  return Handle(error);
}

Status Alarms::Handle(const Error& error) {
  SetLastError(situation_.machine, error.code);
  waits_.End();
  waits_.EndInstruction();
  watch_.Clear();
  actuators_.BeamOff();
  std::optional<std::uint32_t> handler;
  std::size_t catching = 0;
  if (!counter_.empty()) {
    ProgramContext& program = counter_.program();
    program.processes.AllOff();
    program.work_tasks.clear();
    program.due_gosub.reset();
    // The innermost module with an armed ERR, up to the main module of this executable (OPT-3.57).
    const bool catchable = SeverityInRun(error.code) == Severity::kProgram;
    for (std::size_t n = program.frames.size(); catchable && n-- > 0;) {
      const Frame& frame = program.frames[n];
      if (!frame.error_label) continue;
      catching = n;
      handler = program.program->index[static_cast<std::size_t>(frame.module)].FindLabel(
          *frame.error_label);
      if (handler) break;
      telling_.Warn(error.code, error.detail, {});
      return NoHandler(*frame.error_label);
    }
  }
  telling_.Warn(error.code, error.detail, {});
  if (!handler) return error;
  counter_.program().frames.resize(catching + 1);
  counter_.frame().error_label.reset();  // taking the handler disarms it, OPT-3.55
  counter_.frame().next = *handler;
  return {};
}

// The label of ERR is missing: a second error, which nothing can catch. OPT-3.59, OPT-E.60
Error Alarms::NoHandler(int label) {
  Error error{
      ErrorCode::kLabelNotFound, "no sequence number " + std::to_string(label) + " for ERR", {}};
  const machine::Place& place = situation_.place;
  telling_.Tell({.code = error.code,
                 .severity = Severity::kFatal,
                 .detail = error.detail,
                 .rule = "OPT-3.59",
                 .where = {.line = place.line},
                 .program = place.program,
                 .step = place.step});
  SetLastError(situation_.machine, error.code);
  return error;
}

}  // namespace rmlcell::optimo
