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

StagedContent::StagedContent(StagedContent&& other) noexcept
    : writer_(std::exchange(other.writer_, nullptr)), content_(std::move(other.content_)) {}

StagedContent::~StagedContent() {
  if (writer_ == nullptr || content_.staged_blob == 0) return;
  writer_->Post(std::make_unique<ReleaseOperation>(content_.staged_blob), 0);
}

Status StagedContent::WriteAhead() {
  const Result<BlobTable::Held> held = writer_->Do([this](WriteContext& context) {
    return context.tables.blobs.Hold(content_.sha256, content_.bytes.size());
  });
  if (!held) return held.error();
  content_.staged_blob = held->blob;
  if (held->whole) return {};

  const std::size_t count = ChunkCount(content_.bytes.size());
  std::size_t first = 0;
  std::size_t size = 0;
  std::vector<std::string> encoded;
  for (std::size_t number = 0; number < count; ++number) {
    Result<std::string> chunk = Encode(Chunk(content_.bytes, number));
    if (!chunk) return chunk.error();
    size += chunk->size();
    encoded.push_back(*std::move(chunk));
    if (size < kWriteAheadBytes && number + 1 < count) continue;
    const Status written = writer_->Do([&](WriteContext& context) {
      return context.tables.blobs.AddChunks(held->blob, first, encoded);
    });
    if (!written) return written.error();
    first = number + 1;
    size = 0;
    encoded.clear();
  }
  return {};
}

}  // namespace rmlcell::storage::sqlite
