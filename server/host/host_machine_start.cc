// A start at a step (live.md 6): what it would do, and the start.
#include <memory>
#include <utility>

#include "engine/machine/machine_note.h"
#include "proto/bridge/findings.h"
#include "server/host/host_machine.h"

namespace rmlcell::server {

// Its time goes on while it stands, and changes nothing.
StartDesk::Basis HostMachine::Basis() const {
  Result<machine::MachineNote> note = machine::ReadMachineNote(machine().Save());
  if (!note) return {.memory = memory_changes_};
  note->time = SimTime(0);
  return {.state = machine::WriteMachineNote(*note), .memory = memory_changes_};
}

Result<HostMachine::PreviewTask> HostMachine::PreparePreview(const v1::PreviewStartRequest& request,
                                                             const HostTime& now) {
  GoOnTo(now);
  auto start = StartOf(request, machine());
  if (!start) return start.error();
  PreviewTask task{.start = *std::move(start), .basis = Basis()};
  task.run = [&family = *setup_.family, parameters = *parameters_, memory = machine().memory(),
              state = machine().Save(), start = task.start](
                 const machine::ReachLimits& limits) -> Result<machine::StartPreview> {
    machine::RunObserver nobody;
    auto copy = machine::Machine::Make(family, parameters, memory, state, nobody);
    if (!copy) return copy.error();
    return (*copy)->Preview(start, limits);
  };
  return task;
}

v1::HostOrderAnswer HostMachine::Previewed(const v1::HostOrder& order, PreviewTask task,
                                           Result<machine::StartPreview> made,
                                           const HostTime& now) {
  GoOnTo(now);
  v1::HostOrderAnswer answer;
  if (!made) {
    answer = Refuse(made.error());
  } else {
    v1::PreviewStartResponse& preview = *answer.mutable_preview();
    preview = ToProto(*made, setup_.family->info());
    preview.mutable_there()->set_fence(setup_.fence);
    if (made->may_begin()) {
      task.start.prepared = std::make_shared<const machine::StartPreview>(*std::move(made));
      preview.set_preview_token(starts_.Keep(std::move(task.start), std::move(task.basis), now));
      *preview.mutable_expire_time() = Stamp(now.wall + StartDesk::kLasts);
    }
  }
  answer.set_number(order.number());
  *answer.mutable_acted_at() = Stamp(now.wall);
  return answer;
}

Status HostMachine::StartAt(const v1::HostOrder& order, const HostTime& now) {
  const auto start = starts_.Take(order.start_at_step(), Basis(), now);
  if (!start) return start.error();
  if (const Status may = MayApply(*start); !may) return may.error();
  if (const Status begun = Apply(*start, &order); !begun) return begun.error();
  if (start->halt_at_entry) held_for_ = v1::HOLD_REASON_ENTRY;
  return {};
}

}  // namespace rmlcell::server
