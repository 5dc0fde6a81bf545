#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/statement.h"
#include "storage/store.h"

namespace rmlcell::storage::sqlite {

class MachineTable {
 public:
  explicit MachineTable(Database& database);

  struct Facts {
    Revision revision;
    WallTime created_at;
  };
  Result<std::optional<Facts>> Find(std::string_view id);
  Result<std::optional<MachineRecord>> Get(std::string_view id);
  Result<std::vector<MachineRecord>> List();  // by id

  Status Put(const MachineRecord& machine, const Stamp& stamp);  // inserts or replaces
  Status Remove(std::string_view id);

 private:
  Result<MachineRecord> Read(const Query& row);
  Result<std::map<std::string, std::string>> Parameters(std::string_view machine);

  Statement find_;
  Statement get_;
  Statement list_;
  Statement put_;
  Statement parameters_;
  Statement remove_;
  Statement remove_parameters_;
  Statement add_parameter_;
};

}  // namespace rmlcell::storage::sqlite
