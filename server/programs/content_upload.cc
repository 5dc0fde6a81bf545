#include "server/programs/content_upload.h"

#include "server/base/names.h"
#include "server/programs/program_book.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {
namespace {

// Long enough to send a job that names it, short enough that what nobody names does not pile up.
constexpr std::chrono::hours kKept{1};

}  // namespace

Status ContentUpload::Begin(std::int64_t size, std::string_view sha256) {
  if (begun_) return InvalidArgument("a second header");
  if (size == 0) return Error{ErrorCode::kCellEmptyProgram, "the content", {}};
  if (!sha256.empty()) {
    std::optional<std::string> digest = bridge::ReadSha256(sha256);
    if (!digest) return InvalidArgument("sha256 is not 64 hexadecimal digits");
    sha256_ = *std::move(digest);
  }
  if (const Status fits = programs_.CheckSize(size); !fits) return fits.error();
  begun_ = true;
  told_ = size;
  return size > 0 && !sha256_.empty() ? BeginWriting(sha256_, size) : Status();
}

Status ContentUpload::BeginWriting(std::string_view sha256, std::int64_t size) {
  auto writer = store_.WriteBlob(sha256, static_cast<std::size_t>(size));
  if (!writer) return writer.error();
  writer_ = *std::move(writer);
  return {};
}

Status ContentUpload::Add(std::string_view chunk) {
  if (!begun_) return InvalidArgument("the first message must be the header");
  size_ += static_cast<std::int64_t>(chunk.size());
  if (told_ >= 0 && size_ > told_)
    return Error{ErrorCode::kCellChecksum, "more bytes came than were announced", {}};
  if (const Status fits = programs_.CheckSize(size_); !fits) return fits.error();
  if (writer_ != nullptr) return writer_->Append(chunk);
  waiting_ += chunk;
  return {};
}

Result<v1::UploadContentResponse> ContentUpload::End() {
  if (!begun_) return InvalidArgument("no header");
  if (size_ == 0) return Error{ErrorCode::kCellEmptyProgram, "the content", {}};
  if (told_ >= 0 && size_ != told_) {
    return Error{
        ErrorCode::kCellChecksum,
        std::to_string(size_) + " bytes came, " + std::to_string(told_) + " were announced",
        {}};
  }
  if (writer_ == nullptr) {
    if (sha256_.empty()) sha256_ = bridge::Sha256Hex(waiting_);
    if (const Status begun = BeginWriting(sha256_, size_); !begun) return begun.error();
    if (const Status added = writer_->Append(waiting_); !added) return added.error();
  }
  const Result<storage::WallTime> until = writer_->Finish(kKept);
  if (!until) return until.error();
  v1::UploadContentResponse response;
  response.set_sha256(sha256_);
  response.set_size(size_);
  *response.mutable_expire_time() = ToProto(*until);
  return response;
}

}  // namespace rmlcell::server
