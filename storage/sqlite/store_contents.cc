// Contents, whole and piece by piece.
#include <algorithm>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/job_changes.h"
#include "storage/sqlite/sqlite_store_impl.h"

namespace rmlcell::storage::sqlite {
namespace {

Error NoContent(std::string_view sha256) {
  return {ErrorCode::kCellNotFound, "no content with SHA-256 " + std::string(sha256), {}};
}

// Each chunk is a read of its own: a client that reads slowly keeps no reader busy.
class ContentReader final : public BlobReader {
 public:
  ContentReader(ReaderPool& readers, std::string sha256, std::size_t size)
      : readers_(readers), sha256_(std::move(sha256)), size_(size) {}

  std::size_t size() const override { return size_; }

  Result<std::string> Next() override {
    if (read_ == size_) return checked_ ? Result(std::string()) : Check();
    const std::size_t number = read_ / kChunkBytes;
    const std::size_t bytes = std::min(size_ - read_, kChunkBytes);
    Result<std::string> chunk = readers_.Read(
        [&](Tables& tables) { return tables.blobs.ReadChunk(sha256_, number, bytes); });
    if (!chunk) return chunk;
    sum_.Add(*chunk);
    read_ += chunk->size();
    return chunk;
  }

 private:
  Result<std::string> Check() {
    checked_ = true;
    if (sum_.Take() == sha256_) return std::string();
    return Error{ErrorCode::kCellStoreCorrupt,
                 "content " + HexOf(sha256_) + " does not have its SHA-256",
                 {}};
  }

  ReaderPool& readers_;
  const std::string sha256_;  // 32 bytes
  const std::size_t size_;
  std::size_t read_ = 0;
  bool checked_ = false;
  Sha256Sum sum_;
};

// One that was read already.
class WholeReader final : public BlobReader {
 public:
  explicit WholeReader(std::string content)
      : content_(std::move(content)), size_(content_.size()) {}
  std::size_t size() const override { return size_; }
  Result<std::string> Next() override { return std::exchange(content_, {}); }

 private:
  std::string content_;
  const std::size_t size_;
};

template <class T>
Result<T> FoundArtifact(Tables& tables, Result<std::optional<T>> found, std::int64_t job,
                        std::string_view name) {
  if (!found) return found.error();
  if (*found) return **std::move(found);
  if (const auto row = GetRow(tables, job); !row) return row.error();
  return Error{ErrorCode::kCellNotFound,
               "job " + std::to_string(job) + " has no artifact " + std::string(name),
               {}};
}

Result<ArtifactTable::Place> FindArtifact(Tables& tables, std::int64_t job, std::string_view name) {
  return FoundArtifact(tables, tables.artifacts.Find(job, name), job, name);
}

// The bytes that stand in the row of their artifact, or with their job.
Result<std::string> ReadRow(const ArtifactTable::Place& place) {
  const ArtifactRecord& artifact = place.artifact;
  const auto size = static_cast<std::size_t>(artifact.size);
  std::string content;
  if (size > kChunkBytes || !Decode(place.encoded, size, content) ||
      HexOf(Sha256(content)) != artifact.sha256) {
    return Error{ErrorCode::kCellStoreCorrupt,
                 "the bytes of artifact " + artifact.name + " of job " +
                     std::to_string(artifact.job) + " are damaged",
                 {}};
  }
  return content;
}

// A content that nobody names yet becomes one that is kept for so long.
Result<WallTime> KeepUpload(WriteContext& context, const PreparedContent& content,
                            std::chrono::milliseconds kept) {
  Tables& tables = context.tables;
  const Result<std::int64_t> blob = tables.blobs.PutBlob(content);
  if (!blob) return blob.error();
  const Result<std::optional<WallTime>> before = tables.uploads.Until(*blob);
  if (!before) return before.error();
  if (*before) {  // its reference is there already
    if (const Status dropped = tables.blobs.Drop(*blob); !dropped) return dropped.error();
  }
  context.garbage = true;  // earlier ones may be due
  const WallTime until = std::max(before->value_or(WallTime::min()), WallTime(context.now + kept));
  if (const Status put = tables.uploads.Put(*blob, until); !put) return put.error();
  return until;
}

// Chunks go ahead as they come, as those of StagedContent do.
class ContentWriter final : public BlobWriter {
 public:
  ContentWriter(Writer& writer, std::string sha256, std::size_t size)
      : writer_(writer), size_(size), ahead_(writer) {
    content_.sha256 = std::move(sha256);
  }

  Status Append(std::string_view bytes) override {
    if (bytes.size() > size_ - taken_)
      return Error{ErrorCode::kCellTooLarge, "more bytes came than were told", {}};
    sum_.Add(bytes);
    taken_ += bytes.size();
    while (!bytes.empty()) {
      const std::string_view part = bytes.substr(0, kChunkBytes - chunk_.size());
      bytes.remove_prefix(part.size());
      chunk_ += part;
      if (chunk_.size() < kChunkBytes || size_ == kChunkBytes) continue;
      if (const Status ahead = WriteAhead(); !ahead) return ahead.error();
    }
    return {};
  }

  Result<WallTime> Finish(std::chrono::milliseconds kept) override {
    if (taken_ != size_ || sum_.Take() != content_.sha256)
      return Error{ErrorCode::kCellChecksum, "SHA-256 differs", {}};
    if (size_ <= kChunkBytes) {
      Result<std::string> encoded = Encode(chunk_);
      if (!encoded) return encoded.error();
      content_.bytes = chunk_;
      content_.encoded = *std::move(encoded);
    } else {
      if (const Status last = WriteAhead(); !last) return last.error();
      if (const Status flushed = ahead_.Flush(); !flushed) return flushed.error();
      content_.staged_blob = ahead_.blob();
    }
    return writer_.Do([&](WriteContext& context) { return KeepUpload(context, content_, kept); });
  }

 private:
  Status WriteAhead() {
    if (ahead_.blob() == 0) {
      if (const Status begun = ahead_.Begin(content_.sha256, size_); !begun) return begun.error();
    }
    if (chunk_.empty()) return {};
    const Status added = ahead_.Add(chunk_);
    chunk_.clear();
    return added;
  }

  Writer& writer_;
  const std::size_t size_;
  std::size_t taken_ = 0;
  std::string chunk_;
  Sha256Sum sum_;
  PreparedContent content_;
  ChunksAhead ahead_;
};

}  // namespace

Result<std::vector<ArtifactRecord>> SqliteStore::ListArtifacts(std::int64_t job) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<ArtifactRecord>> {
    if (const auto row = GetRow(tables, job); !row) return row.error();
    return tables.artifacts.List(job);
  });
}

Result<ArtifactRecord> SqliteStore::GetArtifact(std::int64_t job, std::string_view name) {
  return readers_->Read([&](Tables& tables) {
    return FoundArtifact(tables, tables.artifacts.Get(job, name), job, name);
  });
}

Result<std::string> SqliteStore::ReadArtifact(std::int64_t job, std::string_view name) {
  return readers_->Read([&](Tables& tables) -> Result<std::string> {
    const Result<ArtifactTable::Place> place = FindArtifact(tables, job, name);
    if (!place) return place.error();
    return place->blob ? tables.blobs.Read(*place->blob) : ReadRow(*place);
  });
}

Result<std::unique_ptr<BlobReader>> SqliteStore::OpenArtifact(std::int64_t job,
                                                              std::string_view name) {
  return readers_->Read([&](Tables& tables) -> Result<std::unique_ptr<BlobReader>> {
    const Result<ArtifactTable::Place> place = FindArtifact(tables, job, name);
    if (!place) return place.error();
    if (!place->blob) {
      Result<std::string> content = ReadRow(*place);
      if (!content) return content.error();
      return std::unique_ptr<BlobReader>(std::make_unique<WholeReader>(*std::move(content)));
    }
    const ArtifactRecord& artifact = place->artifact;
    return std::unique_ptr<BlobReader>(std::make_unique<ContentReader>(
        *readers_, *BytesOfHex(artifact.sha256), static_cast<std::size_t>(artifact.size)));
  });
}

Result<std::string> SqliteStore::ReadBlob(std::string_view sha256) {
  const std::optional<std::string> name = BytesOfHex(sha256);
  if (!name) return NoContent(sha256);
  return readers_->Read([&](Tables& tables) -> Result<std::string> {
    const Result<std::optional<std::int64_t>> blob = tables.blobs.Find(*name);
    if (!blob) return blob.error();
    if (!*blob) return NoContent(sha256);
    return tables.blobs.Read(**blob);
  });
}

Result<std::unique_ptr<BlobReader>> SqliteStore::OpenBlob(std::string_view sha256) {
  const std::optional<std::string> name = BytesOfHex(sha256);
  if (!name) return NoContent(sha256);
  const auto size = readers_->Read([&](Tables& tables) { return tables.blobs.Measure(*name); });
  if (!size) return size.error();
  if (!*size) return NoContent(sha256);
  return std::unique_ptr<BlobReader>(std::make_unique<ContentReader>(*readers_, *name, **size));
}

Result<std::unique_ptr<BlobWriter>> SqliteStore::WriteBlob(std::string_view sha256,
                                                           std::size_t size) {
  std::optional<std::string> name = BytesOfHex(sha256);
  if (!name || name->size() != kSha256Bytes) {
    return Error{
        ErrorCode::kCellInvalidArgument, "sha256 is not 64 hexadecimal digits, a to f small", {}};
  }
  if (size > kProgramBytesMax) {
    return Error{ErrorCode::kCellTooLarge,
                 std::to_string(size) + " bytes; at most " + std::to_string(kProgramBytesMax),
                 {}};
  }
  return std::unique_ptr<BlobWriter>(
      std::make_unique<ContentWriter>(writer_, *std::move(name), size));
}

}  // namespace rmlcell::storage::sqlite
