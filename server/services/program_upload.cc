#include "server/services/program_upload.h"

#include <utility>

namespace rmlcell::server {

Status ProgramUpload::Add(const v1::UploadProgramRequest& message) {
  if (message.has_header()) {
    return header_ ? InvalidArgument("a second header") : Begin(message.header());
  }
  if (!header_) return InvalidArgument("the first message must be the header");
  const std::string& chunk = message.chunk();
  const auto announced = static_cast<std::size_t>(header_->size());
  if (announced == 0 && !chunk.empty())
    return InvalidArgument("header.size is missing: give the number of bytes that follow");
  if (chunk.size() > announced - bytes_.size())
    return Error{ErrorCode::kCellChecksum, "more bytes than the header says", {}};
  digest_.Add(chunk);
  bytes_ += chunk;
  return {};
}

// What is wrong with it is told before the first byte of the program.
Status ProgramUpload::Begin(const v1::UploadProgramRequest::Header& header) {
  if (header.size() < 0) return InvalidArgument("header.size is " + std::to_string(header.size()));
  if (header.sha256().empty()) return InvalidArgument("header.sha256 is missing");
  std::optional<std::string> digest = bridge::ReadSha256(header.sha256());
  if (!digest) return InvalidArgument("header.sha256 is not 64 hexadecimal digits");
  if (const Status taken = fits_(header.size()); !taken) return taken.error();
  header_ = header;
  header_->set_sha256(*std::move(digest));
  return {};
}

Status ProgramUpload::End() {
  if (!header_) return InvalidArgument("no header");
  if (header_->size() == 0) return Error{ErrorCode::kCellEmptyProgram, header_->file_name(), {}};
  if (bytes_.size() != static_cast<std::size_t>(header_->size())) {
    return Error{ErrorCode::kCellChecksum,
                 std::to_string(bytes_.size()) + " bytes came, " + std::to_string(header_->size()) +
                     " were announced",
                 {}};
  }
  if (digest_.Hex() != header_->sha256())
    return Error{ErrorCode::kCellChecksum, "SHA-256 differs", {}};
  return {};
}

}  // namespace rmlcell::server
