#pragma once

#include <cstdint>

namespace rmlcell::server {

// Memory that the job in this thread may hold. While one is in force, an allocation beyond it
// throws std::bad_alloc in this thread; other threads of the process (gRPC) are not counted.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::int64_t bytes);
  ~MemoryBudget();
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  static bool exceeded();  // since this one is in force
};

}  // namespace rmlcell::server
