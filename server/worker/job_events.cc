#include "server/worker/job_events.h"

#include <utility>

#include "engine/simulation/report/trace.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"

namespace rmlcell::server {
namespace {

// Signals that belong into the log; analogue outputs and sensors, which change all the time, are in
// the trace.
bool IsLogged(machine::Signal signal) {
  switch (signal) {
    case machine::Signal::kOutput:
    case machine::Signal::kRotaryTable:
    case machine::Signal::kShutter:
    case machine::Signal::kBeam:
    case machine::Signal::kSchedule:
    case machine::Signal::kGas:
    case machine::Signal::kSpindle:
    case machine::Signal::kSpindleSpeed:
      return true;
    default:
      return false;
  }
}

v1::SignalKind KindOf(machine::Signal signal) {
  switch (signal) {
    case machine::Signal::kShutter:
      return v1::SIGNAL_KIND_SHUTTER;
    case machine::Signal::kBeam:
      return v1::SIGNAL_KIND_BEAM;
    case machine::Signal::kSchedule:
      return v1::SIGNAL_KIND_SCHEDULE;
    case machine::Signal::kGas:
      return v1::SIGNAL_KIND_GAS;
    case machine::Signal::kSpindle:
    case machine::Signal::kSpindleSpeed:
      return v1::SIGNAL_KIND_SPINDLE;
    case machine::Signal::kOutput:
      return v1::SIGNAL_KIND_LOGICAL_OUTPUT;
    case machine::Signal::kAnalogue:
      return v1::SIGNAL_KIND_ANALOGUE_OUTPUT;
    case machine::Signal::kRotaryTable:
    case machine::Signal::kSensor:
      return v1::SIGNAL_KIND_OTHER;
  }
  return v1::SIGNAL_KIND_OTHER;
}

}  // namespace

// What somebody ordered is told however much happened before.
void JobEvents::Tell(v1::JobEvent event) {
  if (count_ >= kEventsMax && !event.has_halted() && !event.has_resumed() &&
      !event.has_input_applied()) {
    if (cut_) return;
    cut_ = true;
    event.mutable_message()->set_text(
        "more happened than the log of a job takes; the report and the trace have the rest");
  }
  ++count_;
  *batch_.add_events() = std::move(event);
  if (batch_.events_size() >= kBatch) Flush();
}

void JobEvents::Flush() {
  if (batch_.events().empty()) return;
  send_(batch_);
  batch_.clear_events();
}

void JobEvents::OnSignal(const machine::SignalChange& change) {
  if (!IsLogged(change.signal)) return;
  v1::JobEvent event;
  event.set_virtual_time_ns(change.at.count());
  v1::Signal& signal = *event.mutable_signal();
  signal.set_kind(KindOf(change.signal));
  signal.set_name(std::string(simulation::SignalName(change.signal)));
  signal.set_index(change.index);
  signal.set_value(change.value);
  signal.set_detail(change.detail);
  *signal.mutable_place() = bridge::ToProto(change.place);
  Tell(std::move(event));
}

void JobEvents::OnHalt(const machine::Halt& halt) {
  v1::JobEvent event;
  event.set_virtual_time_ns(halt.at.count());
  event.mutable_halted()->set_reason(bridge::ToProto(halt.reason));
  event.mutable_halted()->set_message(std::string(halt.why));
  *event.mutable_halted()->mutable_place() = bridge::ToProto(halt.place);
  Tell(std::move(event));
  Flush();
}

void JobEvents::OnResume(SimTime at, const machine::Place& place) {
  v1::JobEvent event;
  event.set_virtual_time_ns(at.count());
  *event.mutable_resumed()->mutable_place() = bridge::ToProto(place);
  Tell(std::move(event));
  Flush();
}

void JobEvents::OnProgram(SimTime at, const machine::Place&, std::string_view what, int program) {
  v1::JobEvent event;
  event.set_virtual_time_ns(at.count());
  if (what == machine::kCompiling) {
    event.mutable_executable_made()->set_program(program);
  } else {
    event.mutable_program_loaded()->set_program(program);
  }
  Tell(std::move(event));
}

void JobEvents::OnMessage(SimTime at, const machine::Place& place, std::string_view text) {
  v1::JobEvent event;
  event.set_virtual_time_ns(at.count());
  event.mutable_message()->set_text(std::string(text));
  *event.mutable_message()->mutable_place() = bridge::ToProto(place);
  Tell(std::move(event));
}

// The first places of a kind at once: whoever watches sees that something is wrong. More of them
// would only push the rest out of sight.
void JobEvents::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  const FindingPlace place{diagnostic.program, diagnostic.step, diagnostic.where.line,
                           diagnostic.where.column};
  std::set<FindingPlace>& places = places_[diagnostic.code];
  if (places.size() < kPlacesMax ? !places.insert(place).second : places.contains(place)) return;
  if (places.size() > kToldOfKindMax) return rest_.Add(diagnostic, at);
  v1::JobEvent event;
  event.set_virtual_time_ns(at.count());
  *event.mutable_diagnostic() = bridge::ToProto(diagnostic);
  Tell(std::move(event));
}

void JobEvents::TellRest() {
  const UntoldFindings rest = std::exchange(rest_, {});
  for (const auto& [code, kind] : rest.kinds()) {
    v1::JobEvent event;
    event.set_virtual_time_ns(kind.last_at.count());
    *event.mutable_gathered() = bridge::ToProto(kind);
    Tell(std::move(event));
  }
}

}  // namespace rmlcell::server
