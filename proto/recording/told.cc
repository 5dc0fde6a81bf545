#include "proto/recording/told.h"

#include <string>

#include "proto/bridge/findings.h"
#include "proto/bridge/machine_inputs.h"

namespace rmlcell::recording {

v1::RunBegun BegunOf(const machine::RunNote& run) {
  v1::RunBegun told;
  told.set_run(run.number);
  told.set_program(run.program);
  told.set_source(bridge::ToProto(run.source));
  return told;
}

v1::RunOver OverOf(const machine::RunOver& run) {
  v1::RunOver told;
  told.set_run(run.run.number);
  told.set_program(run.run.program);
  *told.mutable_outcome() = bridge::ToProto(run.outcome);
  told.mutable_outcome()->set_cycle_time_ns(run.worked.count());
  if (run.outcome.code == ErrorCode::kCellPowerOff)
    told.mutable_outcome()->set_kind(v1::Outcome::KIND_INTERRUPTED);
  return told;
}

v1::Halted HaltedOf(const machine::Halt& halt) {
  v1::Halted told;
  told.set_reason(bridge::ToProto(halt.reason));
  told.set_message(std::string(halt.why));
  *told.mutable_place() = bridge::ToProto(halt.place);
  return told;
}

v1::Resumed ResumedOf(const machine::Place& place) {
  v1::Resumed told;
  *told.mutable_place() = bridge::ToProto(place);
  return told;
}

v1::RunMessage MessageOf(const machine::Place& place, std::string_view text) {
  v1::RunMessage told;
  told.set_text(bridge::Utf8(std::string(text)));
  *told.mutable_place() = bridge::ToProto(place);
  return told;
}

}  // namespace rmlcell::recording
