#include "server/records/known_machines.h"

#include <utility>

namespace rmlcell::server {

std::shared_ptr<const KnownMachines::Machines> KnownMachines::ListAtOnce() const {
  const std::uint64_t changes = store_.MachineChanges();
  const std::lock_guard lock(mutex_);
  return changes_ != 0 && changes_ == changes ? machines_ : nullptr;
}

Result<std::shared_ptr<const KnownMachines::Machines>> KnownMachines::List() {
  if (auto known = ListAtOnce()) return known;
  const std::uint64_t changes = store_.MachineChanges();
  auto records = store_.ListMachines();
  if (!records) return records.error();
  Machines machines;
  for (storage::MachineRecord& record : *records) {
    std::string id = record.id;
    machines.emplace(std::move(id), std::move(record));
  }
  auto read = std::make_shared<const Machines>(std::move(machines));
  const std::lock_guard lock(mutex_);
  machines_ = read;
  changes_ = changes;
  return read;
}

Result<storage::MachineRecord> KnownMachines::Get(std::string_view id) {
  const auto known = List();
  if (!known) return known.error();
  const auto found = (*known)->find(id);
  if (found == (*known)->end()) return store_.GetMachine(id);  // which says what is wrong
  return found->second;
}

}  // namespace rmlcell::server
