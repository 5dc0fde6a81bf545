#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/statement.h"
#include "storage/store.h"

namespace rmlcell::storage::sqlite {

// What clients ask of jobs that another server runs, until that takes it. Nearly always empty.
class OrderTable {
 public:
  explicit OrderTable(Database& database);
  Result<bool> Any();
  Status Add(const Lease& lease, std::string_view payload);
  // Of the leases that this server holds, in the order in which they were added.
  Result<std::vector<TakenOrder>> Of(std::string_view server);
  Status RemoveOf(std::string_view server);
  Status RemoveStale();  // those whose lease is gone

 private:
  Statement any_;
  Statement add_;
  Statement of_;
  Statement remove_of_;
  Statement remove_stale_;
};

}  // namespace rmlcell::storage::sqlite
