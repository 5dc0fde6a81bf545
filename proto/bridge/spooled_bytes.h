#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/bytes.h"
#include "proto/bridge/nameless_file.h"

namespace rmlcell::bridge {

// Collects bytes, of a program or a product. Few lie in memory; more lie in a nameless file of the
// temporary folder (TMPDIR, else /tmp), of which only what is being read takes memory: a stream of
// any length is checked and run in little. Where there is no room for such a file, they stay in
// memory. The file of a user is not read again: it may change meanwhile.
class SpooledBytes {
 public:
  void append(std::string_view bytes);
  std::int64_t size() const { return spooled_ + static_cast<std::int64_t>(held_.size()); }

  // At most `most` of the bytes that are there, from `offset` on; empty at their end.
  // CellFileUnreadable.
  Result<std::string> Part(std::int64_t offset, std::size_t most) const;

  // When all is there; it begins anew after that.
  machine::Bytes Finish();

 private:
  bool Spool();
  void TakeBack();

  std::string held_;  // the newest bytes, or all
  OpenFile file_;
  std::int64_t spooled_ = 0;  // bytes in the file, before those that are held
  bool in_memory_ = false;    // there is no room for a file
};

// The file of a program. Errors: CellFileUnreadable; CellTooLarge above `limit` bytes.
Result<machine::Bytes> ReadProgram(const std::string& path, std::int64_t limit);

}  // namespace rmlcell::bridge
