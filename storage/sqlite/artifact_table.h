#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/recent_contents.h"
#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

// What a job was given and what it made. Small bytes stand in the row of the artifact, those of the
// program beside the specification of its job (JobTable::PutSpecification), all others in a blob,
// and what comes again and again, too.
// Rows go to the end of the table, whichever job ends first: with their bytes in them a place among
// the rows of other jobs would have pages divided.
class ArtifactTable {
 public:
  explicit ArtifactTable(Database& database);

  // Of those that are small enough for a row.
  RecentContents& recent() { return recent_; }

  // False, and nothing added, when the job has one of this name.
  Result<bool> Add(std::int64_t job, const NewArtifact& artifact, std::int64_t blob);
  Result<bool> AddWhole(std::int64_t job, const NewArtifact& artifact,
                        const PreparedContent& content);

  Result<std::vector<ArtifactRecord>> List(std::int64_t job);  // by name
  Result<std::optional<ArtifactRecord>> Get(std::int64_t job, std::string_view name);

  struct Place {
    ArtifactRecord artifact;
    std::optional<std::int64_t> blob;
    std::string encoded;  // without a blob: the bytes, as content.h says
  };
  Result<std::optional<Place>> Find(std::int64_t job, std::string_view name);

  // Returns the blobs, whose references are the caller's affair.
  Result<std::vector<std::int64_t>> RemoveOf(std::int64_t job);

 private:
  RecentContents recent_;
  Statement add_;
  Statement list_;
  Statement get_;
  Statement find_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
