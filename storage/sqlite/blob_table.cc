#include "storage/sqlite/blob_table.h"

#include <algorithm>

#include "engine/core/hex.h"
#include "storage/content.h"

namespace rmlcell::storage::sqlite {
namespace {

// Room for a content of this size is made at once. A damaged row that tells a larger one costs time
// only.
constexpr std::size_t kReserveMax = kProgramBytesMax;

Error Damaged(std::int64_t blob, const std::string& what) {
  return Error{ErrorCode::kCellStoreCorrupt, "blob " + std::to_string(blob) + ": " + what, {}};
}

}  // namespace

BlobTable::BlobTable(Database& database)
    : database_(database),
      find_(database, "SELECT id FROM blob WHERE sha256 = ?1"),
      measure_(database, "SELECT size FROM blob WHERE sha256 = ?1"),
      piece_(database,
             "SELECT ifnull(blob.content, blob_chunk.content) FROM blob"
             " LEFT JOIN blob_chunk ON blob_chunk.blob = blob.id AND blob_chunk.number = ?2"
             " WHERE blob.sha256 = ?1"),
      get_(database, "SELECT sha256, size, content FROM blob WHERE id = ?1"),
      insert_(database,
              "INSERT INTO blob (sha256, size, refs, holds, content) VALUES (?1, ?2, ?3, ?4, ?5)"),
      seal_(database, "UPDATE blob SET sha256 = ?2 WHERE id = ?1"),
      refer_(database, "UPDATE blob SET refs = refs + ?2 WHERE id = ?1 AND refs + ?2 >= 0"),
      hold_(database, "UPDATE blob SET holds = holds + ?2 WHERE id = ?1 AND holds + ?2 >= 0"),
      release_all_(database, "UPDATE blob SET holds = 0 WHERE holds <> 0"),
      add_chunk_(database, "INSERT INTO blob_chunk (blob, number, content) VALUES (?1, ?2, ?3)"),
      chunks_(database, "SELECT content FROM blob_chunk WHERE blob = ?1 ORDER BY number"),
      garbage_(database, "SELECT id FROM blob WHERE refs = 0 AND holds = 0 LIMIT 1"),
      unseal_(database, "UPDATE blob SET sha256 = NULL WHERE id = ?1 AND sha256 IS NOT NULL"),
      remove_chunks_(database,
                     "DELETE FROM blob_chunk WHERE blob = ?1 AND number IN"
                     " (SELECT number FROM blob_chunk WHERE blob = ?1 LIMIT ?2)"),
      remove_(database, "DELETE FROM blob WHERE id = ?1") {}

Result<ContentColumns> BlobTable::Put(const PreparedContent& content) {
  if (content.in_record) return ContentColumns{.bytes = Bytes{content.bytes}, .blob = {}};
  const Result<std::int64_t> blob = PutBlob(content);
  if (!blob) return blob.error();
  return ContentColumns{.bytes = {}, .blob = *blob};
}

Result<std::int64_t> BlobTable::PutBlob(const PreparedContent& content) {
  const Result<std::optional<std::int64_t>> known = Find(content.sha256);
  if (!known) return known.error();
  if (*known) {  // also a content that lost its last reference and was not swept yet
    if (const Status referred = refer_.With(**known, 1).Run(); !referred) return referred.error();
    return **known;
  }
  if (content.must_exist) {
    return Error{ErrorCode::kCellNotFound, "no content with SHA-256 " + HexOf(content.sha256), {}};
  }
  return content.staged_blob != 0 ? Seal(content) : InsertWhole(content);
}

Result<std::int64_t> BlobTable::InsertWhole(const PreparedContent& content) {
  const bool in_row = content.encoded.size() <= kContentInRowMax;
  const std::optional<Bytes> bytes = in_row ? std::optional(Bytes{content.encoded}) : std::nullopt;
  if (const Status inserted =
          insert_.With(Bytes{content.sha256}, content.bytes.size(), 1, 0, bytes).Run();
      !inserted)
    return inserted.error();
  const std::int64_t blob = sqlite3_last_insert_rowid(database_.handle());
  if (in_row) return blob;
  if (const Status added = AddChunks(blob, 0, std::span(&content.encoded, 1)); !added)
    return added.error();
  return blob;
}

Result<std::int64_t> BlobTable::Seal(const PreparedContent& content) {
  if (const Status sealed = seal_.With(content.staged_blob, Bytes{content.sha256}).Run(); !sealed)
    return sealed.error();
  if (const Status referred = refer_.With(content.staged_blob, 1).Run(); !referred)
    return referred.error();
  return content.staged_blob;
}

Status BlobTable::Drop(std::optional<std::int64_t> blob) {
  if (!blob) return {};
  const Status dropped = refer_.With(*blob, -1).Run();
  if (dropped && refer_.changes() != 1) return Damaged(*blob, "has no reference to drop");
  return dropped;
}

Result<BlobTable::Held> BlobTable::Hold(std::string_view sha256, std::size_t size) {
  const Result<std::optional<std::int64_t>> known = Find(sha256);
  if (!known) return known.error();
  if (*known) {
    if (const Status held = hold_.With(**known, 1).Run(); !held) return held.error();
    return Held{.blob = **known, .whole = true};
  }
  if (const Status inserted = insert_.With(std::nullopt, size, 0, 1, std::nullopt).Run(); !inserted)
    return inserted.error();
  return Held{.blob = sqlite3_last_insert_rowid(database_.handle()), .whole = false};
}

Status BlobTable::AddChunks(std::int64_t blob, std::size_t first,
                            std::span<const std::string> encoded) {
  for (const std::string& chunk : encoded) {
    if (const Status added = add_chunk_.With(blob, first++, Bytes{chunk}).Run(); !added)
      return added.error();
  }
  return {};
}

Status BlobTable::Release(std::int64_t blob) { return hold_.With(blob, -1).Run(); }

Status BlobTable::ReleaseAll() { return release_all_.With().Run(); }

Result<std::string> BlobTable::Read(std::int64_t blob) {
  Query query = get_.With(blob);
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  if (!*row) return Damaged(blob, "is named but not there");
  const std::int64_t told = query.Integer(1);
  if (told < 0) return Damaged(blob, "has a size below 0");
  const auto size = static_cast<std::size_t>(told);
  std::string content;
  content.reserve(std::min(size, kReserveMax));
  const bool in_row = !query.IsNull(2);
  const Status read = in_row ? Decode(query.View(2), std::min(size, kChunkBytes), content)
                             : ReadChunks(blob, size, content);
  if (!read)
    return Error{
        read.error().code, "blob " + std::to_string(blob) + ": " + read.error().detail, {}};
  if (Sha256(content) != query.View(0)) return Damaged(blob, "does not have its SHA-256");
  return content;
}

Status BlobTable::ReadChunks(std::int64_t blob, std::size_t size, std::string& content) {
  Query chunks = chunks_.With(blob);
  for (;;) {
    const Result<bool> row = chunks.Step();
    if (!row) return row.error();
    if (!*row) return {};
    const std::size_t left = size - std::min(size, content.size());
    if (const Status read = Decode(chunks.View(0), std::min(left, kChunkBytes), content); !read)
      return read.error();
  }
}

Result<std::optional<std::size_t>> BlobTable::Measure(std::string_view sha256) {
  return FirstRow<std::size_t>(measure_.With(Bytes{sha256}), [](const Query& row) {
    return static_cast<std::size_t>(row.Integer(0));
  });
}

Result<std::string> BlobTable::ReadChunk(std::string_view sha256, std::size_t number,
                                         std::size_t bytes) {
  Query query = piece_.With(Bytes{sha256}, number);
  const Result<bool> row = query.Step();
  if (!row) return row.error();
  if (!*row) {
    return Error{ErrorCode::kCellNotFound, "no content with SHA-256 " + HexOf(sha256), {}};
  }
  std::string content;
  if (const Status read = Decode(query.View(0), bytes, content); !read) return read.error();
  return content;
}

Result<std::optional<std::int64_t>> BlobTable::Find(std::string_view sha256) {
  return FirstRow<std::int64_t>(find_.With(Bytes{sha256}),
                                [](const Query& row) { return row.Integer(0); });
}

Result<std::string> BlobTable::Content(const Query& row, int column) {
  return row.IsNull(column + 1) ? Result(row.Text(column)) : Read(row.Integer(column + 1));
}

Result<bool> BlobTable::Sweep(int blobs_max, int chunks_max) {
  for (int i = 0; i < blobs_max; ++i) {
    const Result<std::int64_t> blob = FirstInteger(garbage_.With());
    if (!blob) return blob.error();
    if (*blob == 0) return false;
    // From now on the content counts as missing: with a part of its chunks it must not be found
    // again.
    if (const Status unsealed = unseal_.With(*blob).Run(); !unsealed) return unsealed.error();
    if (const Status chunks = remove_chunks_.With(*blob, chunks_max).Run(); !chunks)
      return chunks.error();
    chunks_max -= static_cast<int>(remove_chunks_.changes());
    if (chunks_max <= 0) return true;  // it may have more
    if (const Status removed = remove_.With(*blob).Run(); !removed) return removed.error();
    if (remove_.changes() != 1) return Damaged(*blob, "is not there");
  }
  return true;
}

}  // namespace rmlcell::storage::sqlite
