#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "storage/sqlite/blob_table.h"

namespace rmlcell::storage::sqlite {

class ProjectTable {
 public:
  ProjectTable(Database& database, BlobTable& blobs);

  struct Facts {
    Revision revision;
    WallTime created_at;
    std::optional<std::int64_t> body_blob;
  };
  Result<std::optional<Facts>> Find(std::string_view id);
  Result<std::optional<ProjectRecord>> Get(std::string_view id);
  Result<std::vector<ProjectRecord>> List(std::string_view after_id, int limit);  // by id

  // These leave the references of blobs to the caller.
  Status Put(const ProjectRecord& project, const Stamp& stamp, const ContentColumns& body);
  Status Remove(std::string_view id);

 private:
  Result<ProjectRecord> Read(const Query& row);

  BlobTable& blobs_;
  Statement find_;
  Statement get_;
  Statement list_;
  Statement put_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
