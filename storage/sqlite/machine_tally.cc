#include "storage/sqlite/machine_tally.h"

namespace rmlcell::storage::sqlite {

void MachineTally::Apply(std::span<const JobMove> moves) {
  const std::lock_guard lock(mutex_);
  for (const JobMove& move : moves) {
    Machine& machine = machines_[move.machine];
    const bool was_unfinished = move.from && !IsFinal(*move.from);
    machine.unfinished += (IsFinal(move.to) ? 0 : 1) - (was_unfinished ? 1 : 0);
    if (move.to == JobState::kRunning) {
      machine.running.insert(move.job);
    } else {
      machine.running.erase(move.job);
    }
    if (machine.unfinished == 0) machines_.erase(move.machine);
  }
}

std::vector<MachineJobs> MachineTally::List() const {
  const std::lock_guard lock(mutex_);
  std::vector<MachineJobs> all;
  for (const auto& [machine, jobs] : machines_) {
    all.push_back({.machine = machine,
                   .unfinished = jobs.unfinished,
                   .oldest_running = jobs.running.empty() ? 0 : *jobs.running.begin()});
  }
  return all;
}

}  // namespace rmlcell::storage::sqlite
