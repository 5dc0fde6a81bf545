#pragma once

#include <optional>

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

// Contents that are kept until a time though no record names them. Each counts as one reference of
// its blob, which is the caller's affair.
class UploadTable {
 public:
  explicit UploadTable(Database& database);

  Result<std::optional<WallTime>> Until(std::int64_t blob);
  Status Put(std::int64_t blob, WallTime until);
  Result<std::optional<std::int64_t>> FirstDue(WallTime now);
  Status Remove(std::int64_t blob);

 private:
  Statement until_;
  Statement put_;
  Statement due_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
