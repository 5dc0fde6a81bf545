#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

class ScheduleTable {
 public:
  explicit ScheduleTable(Database& database);
  Result<std::optional<ScheduleRecord>> Get(std::string_view machine, int number);
  Result<std::vector<ScheduleRecord>> List(std::string_view machine);  // by number
  Status Put(const ScheduleRecord& schedule);
  Status Remove(std::string_view machine, int number);

 private:
  Statement get_;
  Statement list_;
  Statement put_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
