#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "storage/sqlite/statement.h"

namespace rmlcell::storage::sqlite {

// Content made ready for the store outside of the writer: see content_staging.h.
struct PreparedContent {
  std::string_view bytes{};      // of the caller
  bool in_record = false;        // small: goes into the record itself, and nothing below counts
  std::string sha256{};          // 32 bytes
  bool must_exist = false;       // only the name is known, and nothing below counts
  std::string encoded{};         // the only chunk, where there is one
  std::int64_t staged_blob = 0;  // rows written ahead and held; 0: none
};

// What a record keeps in its columns `x` and `x_blob`.
struct ContentColumns {
  std::optional<Bytes> bytes;
  std::optional<std::int64_t> blob;
};

// Contents, each kept once, with the number of columns that name it. A content that is named no
// more is garbage: it goes when Sweep() comes by.
class BlobTable {
 public:
  explicit BlobTable(Database& database);

  // The columns for a content; its blob counts one reference more. CellNotFound: it must exist, but
  // does not.
  Result<ContentColumns> Put(const PreparedContent& content);
  Result<std::int64_t> PutBlob(const PreparedContent& content);  // never in the record
  Status Drop(std::optional<std::int64_t> blob);                 // one reference less

  // Staging. Each keeps the blob from being swept until Release().
  struct Held {
    std::int64_t blob;
    bool whole;  // the content is there already: no chunk is wanted
  };
  Result<Held> Hold(std::string_view sha256, std::size_t size);
  Status AddChunks(std::int64_t blob, std::size_t first, std::span<const std::string> encoded);
  Status Release(std::int64_t blob);
  Status ReleaseAll();  // what writers held that died with their process

  Result<std::string> Read(std::int64_t blob);  // CellStoreCorrupt
  // Its size in bytes; nothing: it is not there.
  Result<std::optional<std::size_t>> Measure(std::string_view sha256);
  // Chunk `number` of a content, of `bytes` bytes. CellNotFound: the content is not there (any
  // more).
  Result<std::string> ReadChunk(std::string_view sha256, std::size_t number, std::size_t bytes);
  Result<std::optional<std::int64_t>> Find(std::string_view sha256);

  // The content of the columns `column` and the one after it, of the row that is ready.
  Result<std::string> Content(const Query& row, int column);

  // Removes garbage: up to `blobs_max` blobs and `chunks_max` chunks. False: there is no more.
  Result<bool> Sweep(int blobs_max, int chunks_max);

 private:
  Result<std::int64_t> InsertWhole(const PreparedContent& content);
  Result<std::int64_t> Seal(const PreparedContent& content);
  Status ReadChunks(std::int64_t blob, std::size_t size, std::string& content);

  Database& database_;
  Statement find_;
  Statement measure_;
  Statement piece_;
  Statement get_;
  Statement insert_;
  Statement seal_;
  Statement refer_;
  Statement hold_;
  Statement release_all_;
  Statement add_chunk_;
  Statement chunks_;
  Statement garbage_;
  Statement unseal_;
  Statement remove_chunks_;
  Statement remove_;
};

}  // namespace rmlcell::storage::sqlite
