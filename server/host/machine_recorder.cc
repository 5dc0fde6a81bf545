#include "server/host/machine_recorder.h"

#include <algorithm>
#include <utility>

#include "proto/recording/recording.h"

namespace rmlcell::server {
namespace {

std::size_t BytesOf(const machine::MachineMemory& memory) {
  std::size_t bytes = 0;
  for (const auto& [slot, program] : memory.programs)
    bytes += program.object->size() + program.executable->size();
  return bytes;
}

}  // namespace

void MachineRecorder::Begin(v1::MachineRecording head, const machine::MachineMemory& memory,
                            const v1::JournalEntry& mark) {
  Kept made{.job = head.job()};
  made.full = BytesOf(memory) + head.brought().content().size() > kBytesMax;
  if (!made.full) {
    recording::SetMemory(memory, head);
    made.file = recording::BeginFile(head, mark);
  }
  goes_to_file_ = !made.job.empty() && !made.full;
  if (goes_to_file_) fresh_ = {.begins = true, .bytes = made.file};
  kept_.push_back(std::move(made));
  if (kept_.size() > kKept) kept_.pop_front();
}

// The state of a run under way is known by its digest: nothing is played from there.
void MachineRecorder::Add(const v1::JournalEntry& entry) {
  if (kept_.empty() || kept_.back().full || kept_.back().over || entry.has_answered()) return;
  std::string& file = kept_.back().file;
  const std::size_t before = file.size();
  const bool in_a_run = entry.has_mark() && !entry.mark().clean();
  if (in_a_run || !entry.executables().empty()) {
    v1::JournalEntry shorter = entry;
    shorter.clear_executables();  // a replay makes them again
    if (in_a_run) {
      shorter.mutable_mark()->clear_state();
      shorter.mutable_mark()->clear_base();
    }
    recording::AddEntry(shorter, file);
  } else {
    recording::AddEntry(entry, file);
  }
  kept_.back().full = file.size() > kBytesMax;
  if (goes_to_file_) fresh_.bytes.append(file, before);
  // Behind its end the file is as it stays.
  if (entry.has_run_over() && entry.run_over().job() == kept_.back().job) goes_to_file_ = false;
}

void MachineRecorder::Recover(OfJob recorded) {
  goes_to_file_ = !recorded.whole;
  kept_.push_back(
      {.job = std::move(recorded.job), .file = std::move(recorded.file), .over = recorded.whole});
}

Result<v1::HostRecordingPart> MachineRecorder::Part(const v1::HostRecordingRequest& request) const {
  const auto of_job = [&](const Kept& kept) {
    return request.job().empty() || kept.job == request.job();
  };
  const auto found = std::find_if(kept_.rbegin(), kept_.rend(), of_job);
  if (found == kept_.rend())
    return Error{ErrorCode::kCellNotFound, "the host has no recording of " + request.job(), {}};
  if (found->file.empty())
    return Error{ErrorCode::kCellNotFound, "the programs were too large to be recorded", {}};
  const auto offset = static_cast<std::size_t>(std::max<std::int64_t>(0, request.offset()));
  v1::HostRecordingPart part;
  part.set_total(static_cast<std::int64_t>(found->file.size()));
  if (offset < found->file.size()) part.set_chunk(found->file.substr(offset, kPartBytes));
  return part;
}

}  // namespace rmlcell::server
