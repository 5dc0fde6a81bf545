#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/result.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/program.pb.h"

namespace rmlcell::server {

// A program that comes in messages: a header, then the bytes in chunks. They are kept in memory up
// to the size that the header announces, which is checked before the first of them.
class ProgramUpload {
 public:
  // Whether a program of so many bytes would be taken: ProgramBook::CheckSize.
  using SizeCheck = std::function<Status(std::int64_t bytes)>;
  explicit ProgramUpload(SizeCheck fits) : fits_(std::move(fits)) {}

  // Errors: CellInvalidArgument for messages out of order and headers that say too little or
  // nonsense, those of the size check, CellChecksum for more bytes than were announced.
  Status Add(const v1::UploadProgramRequest& message);

  // All have come; once. Errors: CellInvalidArgument without a header, CellEmptyProgram,
  // CellChecksum when the bytes are not those that were announced.
  Status End();

  // Its digest in lower case. Precondition: a message was added.
  const v1::UploadProgramRequest::Header& header() const { return *header_; }
  std::string TakeBytes() { return std::move(bytes_); }

 private:
  Status Begin(const v1::UploadProgramRequest::Header& header);

  SizeCheck fits_;
  std::optional<v1::UploadProgramRequest::Header> header_;
  bridge::Sha256 digest_;
  std::string bytes_;
};

}  // namespace rmlcell::server
