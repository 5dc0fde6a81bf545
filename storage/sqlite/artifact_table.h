#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

class ArtifactTable {
 public:
  explicit ArtifactTable(Database& database);
  // In place of the blob of an artifact: its bytes stand beside the specification of the job.
  static constexpr std::int64_t kWithJob = 0;

  // False, and nothing added, when the job has one of this name.
  Result<bool> Add(std::int64_t job, const NewArtifact& artifact, std::int64_t blob);
  Result<bool> AddWithJob(std::int64_t job, const NewArtifact& artifact,
                          const PreparedContent& content);
  Result<std::vector<ArtifactRecord>> List(std::int64_t job);  // by name
  Result<std::optional<ArtifactRecord>> Get(std::int64_t job, std::string_view name);
  Result<std::int64_t> BlobOf(std::int64_t job, std::string_view name);  // or kWithJob
  // Returns the blobs, whose references are the caller's affair.
  Result<std::vector<std::int64_t>> RemoveOf(std::int64_t job);

 private:
  Statement add_;
  Statement list_;
  Statement get_;
  Statement blob_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
