#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/sqlite/blob_table.h"

namespace rmlcell::storage::sqlite {

class ProgramTable {
 public:
  ProgramTable(Database& database, BlobTable& blobs);

  struct Row {
    Revision revision;
    WallTime created_at;
    WallTime updated_at;
    std::int64_t object_blob;
    std::optional<std::int64_t> source_blob;
    std::optional<std::int64_t> executable_blob;
  };
  Result<std::optional<Row>> Find(std::string_view machine, int slot);

  enum class Parts { kAll, kWithoutSource };
  Result<std::optional<ProgramRecord>> Get(std::string_view machine, int slot);
  Result<std::vector<ProgramRecord>> Memory(std::string_view machine, Parts parts);
  Result<std::vector<ProgramSummary>> List(std::string_view machine, int after_slot, int limit);
  Result<std::optional<ProgramSummary>> Summary(std::string_view machine, int slot);

  // These leave the references of blobs to the caller.
  Status Put(std::string_view machine, int slot, std::string_view name,
             std::string_view source_name, const Row& row);
  Status PutExecutable(std::string_view machine, int slot, std::optional<std::int64_t> blob);
  Status Remove(std::string_view machine, int slot);

 private:
  Result<ProgramRecord> Read(const Query& row, std::string_view machine, Parts parts);

  BlobTable& blobs_;
  Statement find_;
  Statement get_;
  Statement memory_;
  Statement list_;
  Statement summary_;
  Statement put_;
  Statement put_executable_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
