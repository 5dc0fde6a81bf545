#include "engine/optimo/control/alarms.h"

#include <utility>

namespace rmlcell::optimo {

Status Alarms::Raise(const Error& error, Where where) {
  if (s_.deferred) return {};
  const bool at_once = where == Where::kBesideTheMotion || ride_.beside();
  if (at_once) actuators_.BeamOff();
  if (!ride_.EndForError(at_once)) return Handle(error);
  s_.deferred = {.error = error, .place = situation_.place};
  waits_.BeginStandstill();
  return {};
}

Status Alarms::HandleDeferred() {
  if (!s_.deferred) return {};
  const AlarmState::Raised raised = *std::exchange(s_.deferred, std::nullopt);
  situation_.place = raised.place;
  return Handle(raised.error);
}

Status Alarms::Handle(const Error& error) {
  data_.SetLastError(error.code);
  waits_.End();
  waits_.EndInstruction();
  watch_.Clear();
  actuators_.BeamOff();
  Result<bool> caught = false;
  if (!counter_.empty()) {
    works_.EndProgram();
    if (SeverityInRun(error.code) == Severity::kProgram) caught = counter_.JumpToErrorLabel();
  }
  telling_.Warn(error.code, error.detail, {});
  if (!caught) {
    TellNoHandler(caught.error());
    return caught.error();
  }
  if (!*caught) return error;
  return {};
}

// The label of ERR is missing: a second error, which nothing can catch. OPT-3.59, OPT-E.60
void Alarms::TellNoHandler(const Error& error) {
  const machine::Place& place = situation_.place;
  telling_.Tell({.code = error.code,
                 .severity = Severity::kFatal,
                 .detail = error.detail,
                 .rule = "OPT-3.59",
                 .where = {.line = place.line},
                 .program = place.program,
                 .step = place.step});
  data_.SetLastError(error.code);
}

}  // namespace rmlcell::optimo
