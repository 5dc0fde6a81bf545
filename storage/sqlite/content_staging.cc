#include "storage/sqlite/content_staging.h"

#include "engine/core/hex.h"
#include "storage/content.h"

namespace rmlcell::storage::sqlite {
namespace {

// Compressed bytes that go ahead in one write: a few milliseconds of the writer's time.
constexpr std::size_t kWriteAheadBytes = std::size_t{4} << 20;

class ReleaseOperation final : public WriteOperation {
 public:
  explicit ReleaseOperation(std::int64_t blob) : blob_(blob) {}
  Status Run(WriteContext& context) override {
    context.garbage = true;
    return context.tables.blobs.Release(blob_);
  }
  // When this failed the blob stays held, that is on the disk, until the next start.
  void Answer(const Status& /*status*/) override {}

 private:
  std::int64_t blob_;
};

}  // namespace

ChunksAhead::ChunksAhead(ChunksAhead&& other) noexcept
    : writer_(other.writer_),
      blob_(std::exchange(other.blob_, 0)),
      whole_(other.whole_),
      written_(other.written_),
      bytes_(other.bytes_),
      encoded_(std::move(other.encoded_)) {}

ChunksAhead::~ChunksAhead() {
  if (blob_ != 0) writer_->Post(std::make_unique<ReleaseOperation>(blob_), 0);
}

Status ChunksAhead::Begin(std::string_view sha256, std::size_t size) {
  const Result<BlobTable::Held> held =
      writer_->Do([&](WriteContext& context) { return context.tables.blobs.Hold(sha256, size); });
  if (!held) return held.error();
  blob_ = held->blob;
  whole_ = held->whole;
  return {};
}

Status ChunksAhead::Add(std::string_view chunk) {
  if (whole_) return {};
  Result<std::string> encoded = Encode(chunk);
  if (!encoded) return encoded.error();
  bytes_ += encoded->size();
  encoded_.push_back(*std::move(encoded));
  return bytes_ < kWriteAheadBytes ? Status() : Flush();
}

Status ChunksAhead::Flush() {
  if (encoded_.empty()) return {};
  const Status written = writer_->Do([&](WriteContext& context) {
    return context.tables.blobs.AddChunks(blob_, written_, encoded_);
  });
  if (!written) return written.error();
  written_ += encoded_.size();
  bytes_ = 0;
  encoded_.clear();
  return {};
}

Result<StagedContent> StagedContent::Make(Writer& writer, std::string_view bytes, Place place) {
  StagedContent staged(writer);
  PreparedContent& content = staged.content_;
  content.bytes = bytes;
  content.in_record = place == Place::kRecordWhenSmall && bytes.size() <= kContentInRecordMax;
  if (content.in_record) return staged;
  content.sha256 = Sha256(bytes);
  if (bytes.size() <= kChunkBytes) {
    Result<std::string> encoded = Encode(bytes);
    if (!encoded) return encoded.error();
    content.encoded = *std::move(encoded);
    return staged;
  }
  if (const Status written = staged.WriteAhead(); !written) return written.error();
  return staged;
}

Result<StagedContent> StagedContent::Of(Writer& writer, const NewArtifact& artifact) {
  if (artifact.existing_sha256.empty()) return Make(writer, artifact.bytes, Place::kBlob);
  std::optional<std::string> name = BytesOfHex(artifact.existing_sha256);
  if (!name) {
    return Error{
        ErrorCode::kCellNotFound, "no content with SHA-256 " + artifact.existing_sha256, {}};
  }
  StagedContent staged(writer);
  staged.content_.sha256 = *std::move(name);
  staged.content_.must_exist = true;
  return staged;
}

Status StagedContent::WriteAhead() {
  if (const Status begun = ahead_.Begin(content_.sha256, content_.bytes.size()); !begun)
    return begun.error();
  content_.staged_blob = ahead_.blob();
  for (std::size_t number = 0; number < ChunkCount(content_.bytes.size()); ++number) {
    if (const Status added = ahead_.Add(Chunk(content_.bytes, number)); !added)
      return added.error();
  }
  return ahead_.Flush();
}

}  // namespace rmlcell::storage::sqlite
