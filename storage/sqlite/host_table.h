#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/sqlite/statement.h"
#include "storage/store.h"

namespace rmlcell::storage::sqlite {

// Which process hosts which machine, and where each machine stands.
class HostTable {
 public:
  explicit HostTable(Database& database);
  Result<std::optional<MachineLease>> Find(std::string_view machine);
  Result<std::vector<MachineLease>> List();  // by machine
  Status Put(const MachineLease& lease);
  Status Remove(std::string_view machine);

  Result<std::optional<MachineMark>> Mark(std::string_view machine);
  Status PutMark(std::string_view machine, const MachineMark& mark);
  Status RemoveMark(std::string_view machine);

 private:
  Statement find_;
  Statement list_;
  Statement put_;
  Statement remove_;
  Statement mark_;
  Statement put_mark_;
  Statement remove_mark_;
};

}  // namespace rmlcell::storage::sqlite
