#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "storage/store.h"

namespace rmlcell::server {

// The machines of the store in memory, as of its newest commit: they are asked for with every job,
// and seldom change. Thread-safe.
class KnownMachines {
 public:
  using Machines = std::map<std::string, storage::MachineRecord, std::less<>>;  // by id

  explicit KnownMachines(storage::Store& store) : store_(store) {}  // which outlives this

  // Reads the store when one has changed.
  Result<std::shared_ptr<const Machines>> List();
  // As Store::GetMachine.
  Result<storage::MachineRecord> Get(std::string_view id);
  // Never waits for the store; null: one has changed, and nobody has asked since.
  std::shared_ptr<const Machines> ListAtOnce() const;

 private:
  storage::Store& store_;
  mutable std::mutex mutex_;
  std::shared_ptr<const Machines> machines_;  // guarded by mutex_
  std::uint64_t changes_ = 0;  // guarded by mutex_; when they were read, 0: they do not stand
};

}  // namespace rmlcell::server
