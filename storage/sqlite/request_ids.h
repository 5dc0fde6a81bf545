#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "storage/records.h"

namespace rmlcell::storage::sqlite {

// Request ids for jobs whose clients gave none, and the names of parts of the log: UUIDs of
// version 7. They begin with the time, so that new ones lie together in the index. No two of one
// object are equal; those of two differ by 64 random bits. Thread-safe.
class RequestIds {
 public:
  RequestIds();
  std::string Make(WallTime now);

 private:
  const std::uint64_t seed_;
  std::atomic<std::uint64_t> count_{0};
};

}  // namespace rmlcell::storage::sqlite
