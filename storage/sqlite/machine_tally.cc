#include "storage/sqlite/machine_tally.h"

namespace rmlcell::storage::sqlite {

namespace {

int GrowthOf(const JobMove& move) {
  const bool was_unfinished = move.from && !IsFinal(*move.from);
  return (IsFinal(move.to) ? 0 : 1) - (was_unfinished ? 1 : 0);
}

}  // namespace

std::map<std::string, std::int64_t> GrowthOf(std::span<const JobMove> moves) {
  std::map<std::string, std::int64_t> growth;
  for (const JobMove& move : moves) {
    if (const int more = GrowthOf(move); more != 0) growth[move.machine] += more;
  }
  std::erase_if(growth, [](const auto& machine) { return machine.second == 0; });
  return growth;
}

void MachineTally::Apply(std::span<const JobMove> moves) {
  const std::lock_guard lock(mutex_);
  for (const JobMove& move : moves) {
    Machine& machine = machines_[move.machine];
    machine.unfinished += GrowthOf(move);
    if (move.to == JobState::kRunning) {
      machine.running.insert(move.job);
    } else {
      machine.running.erase(move.job);
    }
    if (machine.unfinished == 0) machines_.erase(move.machine);
  }
}

std::int64_t MachineTally::Unfinished(const std::string& machine) const {
  const std::lock_guard lock(mutex_);
  const auto found = machines_.find(machine);
  return found == machines_.end() ? 0 : found->second.unfinished;
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
