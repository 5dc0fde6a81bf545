#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

class ArtifactTable {
 public:
  explicit ArtifactTable(Database& database);
  // False, and nothing added, when the job has one of this name.
  Result<bool> Add(std::int64_t job, const NewArtifact& artifact, std::int64_t blob);
  Result<std::vector<ArtifactRecord>> List(std::int64_t job);  // by name
  Result<std::optional<ArtifactRecord>> Get(std::int64_t job, std::string_view name);
  // Returns the blobs, whose references are the caller's affair.
  Result<std::vector<std::int64_t>> RemoveOf(std::int64_t job);

 private:
  Statement add_;
  Statement list_;
  Statement get_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
