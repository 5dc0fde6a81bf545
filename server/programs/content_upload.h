#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "proto/bridge/sha256.h"
#include "rmlcell/v1/program.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

class ProgramBook;

// Bytes for jobs that take no slot (ProgramService.UploadContent). With size and digest told
// before, they go to the store as they come; else they wait in memory, up to limits.program_bytes.
// Not thread-safe; blocks on the store.
class ContentUpload {
 public:
  ContentUpload(storage::Store& store, const ProgramBook& programs)
      : store_(store), programs_(programs) {}

  // `size` below 0, `sha256` empty: not known. Errors: CellInvalidArgument, CellTooLarge,
  // CellEmptyProgram.
  Status Begin(std::int64_t size, std::string_view sha256);
  Status Add(std::string_view chunk);  // CellTooLarge, CellChecksum
  // All have come; once. Errors: CellInvalidArgument: not begun; CellEmptyProgram, CellChecksum.
  Result<v1::UploadContentResponse> End();

 private:
  Status BeginWriting(std::string_view sha256, std::int64_t size);

  storage::Store& store_;
  const ProgramBook& programs_;
  bool begun_ = false;
  std::int64_t told_ = -1;
  std::int64_t size_ = 0;
  std::string sha256_;  // lower case; empty: not known yet
  std::string waiting_;
  std::unique_ptr<storage::BlobWriter> writer_;
};

}  // namespace rmlcell::server
