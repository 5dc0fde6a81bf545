#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "storage/records.h"

namespace rmlcell::storage::sqlite {

// A job came, or changed its state.
struct JobMove {
  std::string machine{};
  std::int64_t job = 0;
  std::optional<JobState> from{};  // nothing: it is new
  JobState to{};
};

// How many more of the machine's jobs are unfinished by these moves.
std::map<std::string, std::int64_t> GrowthOf(std::span<const JobMove> moves);

// What waits and runs, by machine, as of the newest commit: whoever asks how machines stand, and
// that is after each job, looks at no row. Thread-safe.
class MachineTally {
 public:
  struct Machine {
    std::int64_t unfinished = 0;
    std::set<std::int64_t> running{};
  };
  using Machines = std::map<std::string, Machine>;

  explicit MachineTally(Machines machines) : machines_(std::move(machines)) {}

  void Apply(std::span<const JobMove> moves);
  std::int64_t Unfinished(const std::string& machine) const;
  std::vector<MachineJobs> List() const;  // by id of the machine; those without jobs are left out

 private:
  mutable std::mutex mutex_;
  Machines machines_;
};

}  // namespace rmlcell::storage::sqlite
