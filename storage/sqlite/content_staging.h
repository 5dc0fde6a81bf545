#pragma once

#include <string_view>

#include "storage/sqlite/blob_table.h"
#include "storage/sqlite/writer.h"

namespace rmlcell::storage::sqlite {

// A content on its way into the store. Hashing and encoding are done here, on the thread of the
// caller; what is larger than a chunk is written ahead piece by piece, so that the writer never
// stops for a whole program of 256 MiB. Until a record names it such a blob is held by this object;
// what is not named in the end, also because the process was killed, is removed.
class StagedContent {
 public:
  enum class Place { kBlob, kRecordWhenSmall };

  // `bytes` must outlive the object.
  static Result<StagedContent> Make(Writer& writer, std::string_view bytes, Place place);
  // The bytes of an artifact, or the content that it names: CellNotFound when it cannot be a name.
  static Result<StagedContent> Of(Writer& writer, const NewArtifact& artifact);

  StagedContent(StagedContent&& other) noexcept;
  StagedContent& operator=(StagedContent&&) = delete;
  ~StagedContent();

  // For BlobTable::Put() and PutBlob().
  const PreparedContent& content() const { return content_; }

 private:
  explicit StagedContent(Writer& writer) : writer_(&writer) {}
  Status WriteAhead();

  Writer* writer_;
  PreparedContent content_;
};

}  // namespace rmlcell::storage::sqlite
