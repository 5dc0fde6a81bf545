#include "storage/sqlite/artifact_table.h"

#include "engine/core/hex.h"
#include "storage/content.h"

namespace rmlcell::storage::sqlite {
namespace {

// `place`: whether the columns of Place are wanted, which may lie on pages of their own.
std::string SelectArtifact(bool by_name, bool place) {
  const std::string of_row = place ? ", artifact.blob, artifact.content" : "";
  const std::string of_job = place ? ", NULL, attachment" : "";
  return "SELECT artifact.job, artifact.name AS name, artifact.media_type,"
         " ifnull(blob.sha256, artifact.sha256), ifnull(blob.size, artifact.size)" +
         of_row +
         " FROM artifact LEFT JOIN blob ON blob.id = artifact.blob WHERE artifact.job = ?1" +
         (by_name ? " AND artifact.name = ?2" : "") +
         " UNION ALL SELECT job, attachment_name, attachment_media_type, attachment_sha256,"
         " attachment_size" +
         of_job + " FROM job_specification WHERE job = ?1 AND attachment_name " +
         (by_name ? "= ?2" : "IS NOT NULL ORDER BY name");
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

Result<ArtifactTable::Place> ReadPlace(const Query& row) {
  Result<ArtifactRecord> artifact = ReadArtifact(row);
  if (!artifact) return artifact.error();
  return ArtifactTable::Place{
      .artifact = *std::move(artifact), .blob = row.OptionalInteger(5), .encoded = row.Text(6)};
}

}  // namespace

ArtifactTable::ArtifactTable(Database& database)
    : add_(database,
           "INSERT INTO artifact (job, name, media_type, blob, sha256, size, content)"
           " SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7 WHERE NOT EXISTS"
           " (SELECT 1 FROM job_specification WHERE job = ?1 AND attachment_name = ?2)"
           " ON CONFLICT DO NOTHING"),
      list_(database, SelectArtifact(false, false)),
      get_(database, SelectArtifact(true, false)),
      find_(database, SelectArtifact(true, true)),
      remove_(database, "DELETE FROM artifact WHERE job = ?1 RETURNING blob") {}

Result<bool> ArtifactTable::Add(std::int64_t job, const NewArtifact& artifact, std::int64_t blob) {
  if (const Status added = add_.With(job, artifact.name, artifact.media_type, blob, std::nullopt,
                                     std::nullopt, std::nullopt)
                               .Run();
      !added)
    return added.error();
  return add_.changes() == 1;
}

Result<bool> ArtifactTable::AddWhole(std::int64_t job, const NewArtifact& artifact,
                                     const PreparedContent& content) {
  if (const Status added =
          add_.With(job, artifact.name, artifact.media_type, std::nullopt, Bytes{content.sha256},
                    content.bytes.size(), Bytes{content.encoded})
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

Result<std::optional<ArtifactTable::Place>> ArtifactTable::Find(std::int64_t job,
                                                                std::string_view name) {
  return FirstRow<Place>(find_.With(job, name), ReadPlace);
}

Result<std::vector<std::int64_t>> ArtifactTable::RemoveOf(std::int64_t job) {
  std::vector<std::int64_t> blobs;
  Query removed = remove_.With(job);
  Result<bool> row = removed.Step();
  for (; row && *row; row = removed.Step()) {
    if (const auto blob = removed.OptionalInteger(0)) blobs.push_back(*blob);
  }
  if (!row) return row.error();
  return blobs;
}

}  // namespace rmlcell::storage::sqlite
