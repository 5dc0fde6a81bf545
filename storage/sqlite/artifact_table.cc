#include "storage/sqlite/artifact_table.h"

#include "engine/core/hex.h"
#include "storage/content.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SelectArtifact(const std::string& which) {
  return "SELECT artifact.job, artifact.name, artifact.media_type,"
         " ifnull(blob.sha256, artifact.sha256), ifnull(blob.size, artifact.size) FROM artifact LEFT JOIN blob ON blob.id = artifact.blob WHERE artifact.job = ?1 " +
         which;
}

Result<ArtifactRecord> ReadArtifact(const Query& row) {
  if (row.IsNull(3)) {
    return Error{
        ErrorCode::kCellStoreCorrupt,
        "the bytes of artifact " + row.Text(1) + " of job " + row.Text(0) + " are not there",
        {}};
  }
  return ArtifactRecord{.job = row.Integer(0),
                        .name = row.Text(1),
                        .media_type = row.Text(2),
                        .sha256 = HexOf(row.View(3)),
                        .size = row.Integer(4)};
}

}  // namespace

ArtifactTable::ArtifactTable(Database& database)
    : add_(database,
           "INSERT INTO artifact (job, name, media_type, blob, sha256, size)"
           " VALUES (?1, ?2, ?3, ?4, ?5, ?6)"
           " ON CONFLICT DO NOTHING"),
      list_(database, SelectArtifact("ORDER BY artifact.name")),
      get_(database, SelectArtifact("AND artifact.name = ?2")),
      blob_(database, "SELECT blob FROM artifact WHERE job = ?1 AND name = ?2"),
      remove_(database, "DELETE FROM artifact WHERE job = ?1 RETURNING blob") {}

Result<bool> ArtifactTable::Add(std::int64_t job, const NewArtifact& artifact, std::int64_t blob) {
  if (const Status added =
          add_.With(job, artifact.name, artifact.media_type, blob, std::nullopt, 0).Run();
      !added)
    return added.error();
  return add_.changes() == 1;
}

Result<bool> ArtifactTable::AddWithJob(std::int64_t job, const NewArtifact& artifact,
                                       const PreparedContent& content) {
  if (const Status added = add_.With(job, artifact.name, artifact.media_type, kWithJob,
                                     Bytes{content.sha256}, content.bytes.size())
                               .Run();
      !added)
    return added.error();
  return add_.changes() == 1;
}

Result<std::vector<ArtifactRecord>> ArtifactTable::List(std::int64_t job) {
  return AllRows<ArtifactRecord>(list_.With(job), ReadArtifact);
}

Result<std::optional<ArtifactRecord>> ArtifactTable::Get(std::int64_t job, std::string_view name) {
  return FirstRow<ArtifactRecord>(get_.With(job, name), ReadArtifact);
}

Result<std::int64_t> ArtifactTable::BlobOf(std::int64_t job, std::string_view name) {
  return FirstInteger(blob_.With(job, name));
}

Result<std::vector<std::int64_t>> ArtifactTable::RemoveOf(std::int64_t job) {
  auto blobs =
      AllRows<std::int64_t>(remove_.With(job), [](const Query& row) { return row.Integer(0); });
  if (blobs) std::erase(*blobs, kWithJob);
  return blobs;
}

}  // namespace rmlcell::storage::sqlite
