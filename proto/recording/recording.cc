#include "proto/recording/recording.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "proto/bridge/machine_inputs.h"
#include "proto/recording/records.h"

namespace rmlcell::recording {
namespace {

constexpr std::string_view kTitle = "rmlcell recording 1\n";

Error Bad(std::size_t byte, const std::string& why) {
  return {
      ErrorCode::kCellBadText, "byte " + std::to_string(byte) + " of the recording: " + why, {}};
}

bool HasState(const v1::JournalEntry& entry) {
  return entry.has_mark() && !entry.mark().state().empty();
}

}  // namespace

std::string BeginFile(const v1::MachineRecording& head, const v1::JournalEntry& mark) {
  std::string file(kTitle);
  AddRecord(head.SerializeAsString(), file);
  AddEntry(mark, file);
  return file;
}

void AddEntry(const v1::JournalEntry& entry, std::string& file) {
  AddRecord(entry.SerializeAsString(), file);
}

std::string FileOf(const Recording& recording) {
  std::string file(kTitle);
  AddRecord(recording.head.SerializeAsString(), file);
  for (const v1::JournalEntry& entry : recording.entries) AddEntry(entry, file);
  return file;
}

namespace {

bool Parse(std::string_view record, google::protobuf::MessageLite& message) {
  return message.ParseFromArray(record.data(), static_cast<int>(record.size()));
}

// Title and head; behind them come entries.
Result<Records> ReadTitled(std::string_view file, v1::MachineRecording& head) {
  if (!file.starts_with(kTitle)) return Bad(0, "it does not begin as one");
  Records read = ReadRecords(file.substr(kTitle.size()));
  read.end += static_cast<std::int64_t>(kTitle.size());
  if (read.records.empty()) return Bad(static_cast<std::size_t>(read.end), "it has no head");
  if (!Parse(read.records.front(), head)) return Bad(kTitle.size(), "no head is there");
  return read;
}

}  // namespace

Result<Recording> ReadFile(std::string_view file) {
  Recording recording;
  const Result<Records> read = ReadTitled(file, recording.head);
  if (!read) return read.error();
  const auto end = static_cast<std::size_t>(read->end);
  if (end != file.size()) return Bad(end, "from here on it is damaged or cut off");
  for (std::size_t i = 1; i < read->records.size(); ++i) {
    if (!Parse(read->records[i], recording.entries.emplace_back()))
      return Bad(static_cast<std::size_t>(read->records[i].data() - file.data()),
                 "no entry is there");
  }
  if (recording.entries.empty() || !HasState(recording.entries.front()))
    return Bad(end, "it does not say where the machine stood");
  return recording;
}

Result<Durable> DurableIn(std::string_view file, std::int64_t fence, std::int64_t sequence) {
  v1::MachineRecording head;
  const Result<Records> read = ReadTitled(file, head);
  if (!read) return read.error();
  const std::pair mark(fence, sequence);
  Durable found{.job = head.job()};
  for (std::size_t i = 1; i < read->records.size(); ++i) {
    const std::string_view record = read->records[i];
    v1::JournalEntry entry;
    if (!Parse(record, entry)) break;
    const std::pair number(entry.fence(), entry.sequence());
    if (number > mark) break;
    found.whole = entry.has_run_over() && entry.run_over().job() == head.job();
    found.bytes = static_cast<std::size_t>(record.data() - file.data()) + record.size();
    if (found.whole || number == mark) return found;
  }
  return Bad(
      static_cast<std::size_t>(read->end),
      "it does not reach entry " + std::to_string(sequence) + " of fence " + std::to_string(fence));
}

Recording From(Recording recording, SimTime time) {
  const auto newest =
      std::find_if(recording.entries.rbegin(), recording.entries.rend(), [&](const auto& entry) {
        return HasState(entry) && entry.virtual_time_ns() <= time.count();
      });
  if (newest == recording.entries.rend()) return recording;
  // What was brought for a run that lies before it says nothing behind it.
  recording.entries.erase(recording.entries.begin(), std::prev(newest.base()));
  return recording;
}

Result<machine::StoredProgram> ProgramOf(const v1::AssignedProgram& message,
                                         const machine::MachineFamily& family,
                                         const machine::Parameters& parameters) {
  machine::StoredProgram made{
      .name = message.title().empty() ? message.file_name() : message.title(),
      .object = machine::Bytes::Of(message.content())};
  if (!message.executable().empty()) made.executable = machine::Bytes::Of(message.executable());
  if (!message.is_source()) return made;
  machine::Translation translation = family.Translate(
      {.name = message.file_name(), .bytes = *made.object, .keeper = made.object.keeper()},
      parameters, {.advice = false, .source = true});
  if (!translation.ok) {
    const auto first = std::ranges::find_if(
        translation.diagnostics, [](const Diagnostic& one) { return IsError(one.severity); });
    if (first == translation.diagnostics.end())
      return Error{ErrorCode::kCellInvalidArgument, "the program cannot be translated", {}};
    return Error{first->code, first->detail, first->where};
  }
  if (!translation.as_it_came) made.object = machine::Bytes::Of(std::move(translation.object));
  made.source = std::make_shared<const machine::SourceNotes>(std::move(translation.source));
  return made;
}

void SetMemory(const machine::MachineMemory& memory, v1::MachineRecording& head) {
  for (const auto& [slot, program] : memory.programs) {
    v1::AssignedProgram& message = *head.add_programs();
    message.set_slot(slot);
    message.set_title(program.name);
    message.set_content(std::string(*program.object));
    message.set_size(static_cast<std::int64_t>(program.object->size()));
    message.set_executable(std::string(*program.executable));
  }
  for (const int slot : memory.deleted) head.add_deleted_programs(slot);
  head.set_default_schedules(memory.schedules.empty());
  for (const machine::LaserSchedule& schedule : memory.schedules) {
    v1::AssignedSchedule& made = *head.add_schedules();
    made.set_number(schedule.number);
    made.set_title(schedule.name);
    made.set_mode(schedule.mode);
    made.set_power_percent(schedule.power_percent);
  }
}

machine::MachineMemory MemoryOf(const v1::MachineRecording& head) {
  machine::MachineMemory memory;
  for (const v1::AssignedProgram& program : head.programs()) {
    machine::StoredProgram& made = memory.programs[program.slot()];
    made = {.name = program.title(), .object = machine::Bytes::Of(program.content())};
    if (!program.executable().empty()) made.executable = machine::Bytes::Of(program.executable());
  }
  memory.deleted = {head.deleted_programs().begin(), head.deleted_programs().end()};
  for (const v1::AssignedSchedule& schedule : head.schedules())
    memory.schedules.push_back(bridge::FromProto(schedule));
  return memory;
}

}  // namespace rmlcell::recording
