#include "engine/simulation/report/trace.h"

#include <utility>

#include "engine/core/check.h"

namespace rmlcell::simulation {

TraceRecorder::TraceRecorder(TraceSink sink, std::uint64_t records_max)
    : sink_(std::move(sink)), records_max_(records_max) {
  RMLCELL_CHECK(sink_);
}

TraceRecord* TraceRecorder::Begin(TraceKind kind, SimTime at, const machine::Place& place) {
  if (closed_ || records_ >= records_max_) {
    ++dropped_;
    return nullptr;
  }
  record_ = {};
  record_.kind = kind;
  record_.at = at;
  record_.place = place;
  return &record_;
}

void TraceRecorder::Emit() {
  record_.number = ++records_;
  if (!sink_(record_)) closed_ = true;
}

void TraceRecorder::OnMove(const machine::MoveDone& move) {
  TraceRecord* record = Begin(TraceKind::kMove, move.at, move.place);
  if (record == nullptr) return;
  record->text = move.path;
  record->tip = move.tip;
  record->axes = move.axes;
  record->program_point = move.program_point;
  record->program_a = move.rotary_a;
  record->program_b = move.tip.b_rad;
  record->feed_mm_s = move.feed_mm_s;
  Emit();
}

void TraceRecorder::OnSignal(const machine::SignalChange& change) {
  TraceRecord* record = Begin(TraceKind::kSignal, change.at, change.place);
  if (record == nullptr) return;
  record->signal = change.signal;
  record->index = change.index;
  record->value = change.value;
  record->detail = change.detail;
  Emit();
}

void TraceRecorder::OnWait(const machine::Wait& wait) {
  TraceRecord* record = Begin(TraceKind::kWait, wait.end, wait.place);
  if (record == nullptr) return;
  record->wait = wait.kind;
  record->duration = wait.end - wait.start;
  Emit();
}

void TraceRecorder::OnHalt(const machine::Halt& halt) {
  TraceRecord* record = Begin(TraceKind::kHalt, halt.at, halt.place);
  if (record == nullptr) return;
  record->text = halt.why;
  Emit();
}

void TraceRecorder::OnResume(SimTime at, const machine::Place& place) {
  if (Begin(TraceKind::kResume, at, place) != nullptr) Emit();
}

void TraceRecorder::OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                              int program) {
  TraceRecord* record = Begin(TraceKind::kProgram, at, place);
  if (record == nullptr) return;
  record->text = what;
  record->index = program;
  Emit();
}

void TraceRecorder::OnMessage(SimTime at, const machine::Place& place, std::string_view text) {
  TraceRecord* record = Begin(TraceKind::kMessage, at, place);
  if (record == nullptr) return;
  record->text = text;
  Emit();
}

void TraceRecorder::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  const machine::Place place{.program = diagnostic.program,
                             .step = diagnostic.step,
                             .line = diagnostic.where.line,
                             .byte_offset = diagnostic.where.byte_offset};
  TraceRecord* record = Begin(TraceKind::kFinding, at, place);
  if (record == nullptr) return;
  record->text = diagnostic.detail;
  record->code = diagnostic.code;
  record->severity = diagnostic.severity;
  Emit();
}

void TraceRecorder::End(SimTime at, const machine::Outcome& outcome) {
  if (closed_) return;
  record_ = {};
  record_.kind = TraceKind::kEnd;
  record_.at = at;
  record_.place = outcome.place;
  record_.text = outcome.detail;
  record_.code = outcome.code;
  if (outcome.code) record_.severity = Lookup(*outcome.code).severity;
  record_.outcome = outcome.kind;
  Emit();
  closed_ = true;
}

}  // namespace rmlcell::simulation
