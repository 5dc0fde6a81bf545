#pragma once

#include <string_view>

#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/writer.h"

namespace rmlcell::storage::sqlite {

// The chunks of a content that is larger than one, written ahead of the record that will name it.
// Held by this object until then; what is not named in the end, also because the process was
// killed, is removed.
class ChunksAhead {
 public:
  explicit ChunksAhead(Writer& writer) : writer_(&writer) {}
  ChunksAhead(ChunksAhead&& other) noexcept;
  ChunksAhead& operator=(ChunksAhead&&) = delete;
  ~ChunksAhead();

  Status Begin(std::string_view sha256, std::size_t size);
  Status Add(std::string_view chunk);          // in order; kChunkBytes, but for the last one
  Status Flush();                              // behind the last one
  std::int64_t blob() const { return blob_; }  // 0: not begun

 private:
  Writer* writer_;
  std::int64_t blob_ = 0;
  bool whole_ = false;  // the store has the content already
  std::size_t written_ = 0;
  std::size_t bytes_ = 0;  // of `encoded_`
  std::vector<std::string> encoded_;
};

// A content on its way into the store. Hashing and encoding are done here, on the thread of the
// caller; what is larger than a chunk is written ahead piece by piece, so that the writer never
// stops for a whole program of 256 MiB.
class StagedContent {
 public:
  enum class Place { kBlob, kRecordWhenSmall };

  // `bytes` must outlive the object.
  static Result<StagedContent> Make(Writer& writer, std::string_view bytes, Place place);
  // The bytes of an artifact, or the content that it names: CellNotFound when it cannot be a name.
  static Result<StagedContent> Of(Writer& writer, const NewArtifact& artifact);

  // For BlobTable::Put() and PutBlob().
  const PreparedContent& content() const { return content_; }

 private:
  explicit StagedContent(Writer& writer) : ahead_(writer) {}
  Status WriteAhead();

  ChunksAhead ahead_;
  PreparedContent content_;
};

}  // namespace rmlcell::storage::sqlite
