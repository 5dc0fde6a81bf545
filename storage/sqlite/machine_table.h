#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/blob_table.h"

namespace rmlcell::storage::sqlite {

class MachineTable {
 public:
  MachineTable(Database& database, BlobTable& blobs);

  struct Facts {
    Revision revision;
    WallTime created_at;
    std::optional<std::int64_t> state_blob;
  };
  Result<std::optional<Facts>> Find(std::string_view id);
  Result<std::optional<MachineRecord>> Get(std::string_view id);
  Result<std::vector<MachineRecord>> List();  // by id

  // Inserts or replaces; the references of blobs are the caller's affair.
  Status Put(const MachineRecord& machine, const Stamp& stamp, const ContentColumns& state);
  Status Remove(std::string_view id);  // the same

 private:
  Result<MachineRecord> Read(const Query& row);
  Result<std::map<std::string, std::string>> Parameters(std::string_view machine);

  BlobTable& blobs_;
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
