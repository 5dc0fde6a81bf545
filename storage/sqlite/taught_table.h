#pragma once

#include <string_view>
#include <vector>

#include "storage/sqlite/statement.h"
#include "storage/store.h"

namespace rmlcell::storage::sqlite {

// What was taught at each machine.
class TaughtTable {
 public:
  explicit TaughtTable(Database& database);
  Result<std::int64_t> Last(std::string_view machine);  // number; 0: there is none
  Status Add(const TeachRecord& record);
  // As Store::ListTeachRecords.
  Result<std::vector<TeachRecord>> List(std::string_view machine, int program, std::int64_t before,
                                        int limit);
  Status RemoveUpTo(std::string_view machine, std::int64_t number);
  Status Remove(std::string_view machine);

 private:
  Statement last_;
  Statement add_;
  Statement list_;
  Statement remove_up_to_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
