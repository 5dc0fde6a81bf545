#include "storage/sqlite/project_table.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SelectProject(const std::string& which) {
  return "SELECT id, title, revision, created_at, updated_at, body, body_blob FROM project " +
         which;
}

}  // namespace

ProjectTable::ProjectTable(Database& database, BlobTable& blobs)
    : blobs_(blobs),
      find_(database, "SELECT revision, created_at, body_blob FROM project WHERE id = ?1"),
      get_(database, SelectProject("WHERE id = ?1")),
      list_(database, SelectProject("WHERE id > ?1 ORDER BY id LIMIT ?2")),
      put_(database,
           "INSERT OR REPLACE INTO project"
           " (id, title, revision, created_at, updated_at, body, body_blob)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)"),
      remove_(database, "DELETE FROM project WHERE id = ?1") {}

Result<std::optional<ProjectTable::Facts>> ProjectTable::Find(std::string_view id) {
  return FirstRow<Facts>(find_.With(id), [](const Query& row) {
    return Facts{
        .revision = row.Integer(0), .created_at = row.Time(1), .body_blob = row.OptionalInteger(2)};
  });
}

Result<std::optional<ProjectRecord>> ProjectTable::Get(std::string_view id) {
  return FirstRow<ProjectRecord>(get_.With(id), [this](const Query& row) { return Read(row); });
}

Result<std::vector<ProjectRecord>> ProjectTable::List(std::string_view after_id, int limit) {
  return AllRows<ProjectRecord>(list_.With(after_id, limit),
                                [this](const Query& row) { return Read(row); });
}

Status ProjectTable::Put(const ProjectRecord& project, const Stamp& stamp,
                         const ContentColumns& body) {
  return put_
      .With(project.id, project.title, stamp.revision, stamp.created_at, stamp.updated_at,
            body.bytes, body.blob)
      .Run();
}

Status ProjectTable::Remove(std::string_view id) { return remove_.With(id).Run(); }

Result<ProjectRecord> ProjectTable::Read(const Query& row) {
  Result<std::string> body = blobs_.Content(row, 5);
  if (!body) return body.error();
  return ProjectRecord{.id = row.Text(0),
                       .title = row.Text(1),
                       .body = *std::move(body),
                       .revision = row.Integer(2),
                       .created_at = row.Time(3),
                       .updated_at = row.Time(4)};
}

}  // namespace rmlcell::storage::sqlite
