#include "server/machines/host_words.h"

#include "server/records/machine_messages.h"

namespace rmlcell::server {

std::optional<v1::MachineEvent> EventOf(const v1::JournalEntry& entry) {
  v1::MachineEvent event;
  switch (entry.what_case()) {
    case v1::JournalEntry::kApplied:
      *event.mutable_input_applied() = entry.applied();
      break;
    case v1::JournalEntry::kEvent:
      *event.mutable_run() = entry.event();
      break;
    case v1::JournalEntry::kRunBegun:
      *event.mutable_run_begun() = entry.run_begun();
      event.set_run_number(entry.run_begun().run());
      break;
    case v1::JournalEntry::kRunOver:
      *event.mutable_run_over() = entry.run_over();
      event.set_run_number(entry.run_over().run());
      break;
    case v1::JournalEntry::kClockSlipped:
      *event.mutable_clock_slipped() = entry.clock_slipped();
      break;
    default:
      return std::nullopt;
  }
  event.set_fence(entry.fence());
  event.set_virtual_time_ns(entry.virtual_time_ns());
  return event;
}

storage::NewEvent ToRecord(const v1::MachineEvent& event) {
  return {.kind = std::string(kMachineEvent),
          .payload = event.SerializeAsString(),
          .caller = event.input_applied().caller()};
}

v1::JobProgress ProgressOf(const v1::MachineStatus& status) {
  v1::JobProgress progress;
  progress.set_job(status.run().job());
  progress.set_attempt(1);  // a RUN has no other
  progress.set_virtual_time_ns(status.run().run_time_ns());
  *progress.mutable_place() = status.run().place();
  progress.set_instruction(status.run().instruction());
  *progress.mutable_position()->mutable_tip() = status.tip();
  progress.set_speed_mm_s(status.speed_mm_s());
  progress.set_override_percent(status.override_percent());
  return progress;
}

v1::HostMemory MemoryOf(const storage::MachineMemory& memory) {
  v1::HostMemory message;
  message.set_whole(true);
  for (const storage::ProgramRecord& program : memory.programs) {
    v1::AssignedProgram& made = *message.add_programs();
    made.set_slot(program.slot);
    made.set_title(program.name);
    made.set_content(program.object);
    made.set_size(static_cast<std::int64_t>(program.object.size()));
    if (program.executable) made.set_executable(*program.executable);
    made.set_object_revision(program.revision);
  }
  for (const int slot : memory.deleted) message.add_deleted_programs(slot);
  message.set_schedules_changed(true);
  for (const storage::ScheduleRecord& schedule : memory.schedules)
    *message.add_schedules() = ToAssigned(schedule);
  return message;
}

}  // namespace rmlcell::server
