#include "server/worker/memory_budget.h"

#include <malloc.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace rmlcell::server {
namespace {

struct Count {
  std::int64_t limit = 0;  // 0: none in force
  std::int64_t held = 0;
  bool exceeded = false;
};
thread_local Count count;

}  // namespace

MemoryBudget::MemoryBudget(std::int64_t bytes) {
  count = {.limit = bytes, .held = 0, .exceeded = false};
}
MemoryBudget::~MemoryBudget() { count = {}; }
bool MemoryBudget::exceeded() { return count.exceeded; }

namespace {

void* Take(std::size_t size, std::size_t alignment) {
  if (count.limit > 0 && count.held + static_cast<std::int64_t>(size) > count.limit) {
    count.exceeded = true;
    throw std::bad_alloc();
  }
  void* memory =
      alignment <= alignof(std::max_align_t)
          ? std::malloc(size > 0 ? size : 1)
          : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  if (count.limit > 0) count.held += static_cast<std::int64_t>(malloc_usable_size(memory));
  return memory;
}

void Give(void* memory) {
  if (memory == nullptr) return;
  if (count.limit > 0) count.held -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace
}  // namespace rmlcell::server

// The replaceable functions of the language; the others call these.
void* operator new(std::size_t size) {
  return rmlcell::server::Take(size, alignof(std::max_align_t));
}
void* operator new[](std::size_t size) {
  return rmlcell::server::Take(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return rmlcell::server::Take(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return rmlcell::server::Take(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { rmlcell::server::Give(memory); }
void operator delete[](void* memory) noexcept { rmlcell::server::Give(memory); }
void operator delete(void* memory, std::size_t) noexcept { rmlcell::server::Give(memory); }
void operator delete[](void* memory, std::size_t) noexcept { rmlcell::server::Give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { rmlcell::server::Give(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { rmlcell::server::Give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  rmlcell::server::Give(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  rmlcell::server::Give(memory);
}
