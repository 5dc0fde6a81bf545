// Memory of a job that stands at an address of its own kind.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdint>
#include <cstring>
#include <new>

#include "server/worker/memory_budget.h"

namespace rmlcell::server {
namespace {

// It is as large as was asked for, stands where it was asked for, and takes no further block.
TEST(AlignedMemory, IsWhatWasAskedFor) {
  constexpr std::align_val_t kAt{4096};
  for (const std::size_t size : {std::size_t{4096}, std::size_t{8192}, std::size_t{100}}) {
    void* memory = ::operator new(size, kAt);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 4096U, 0U) << size;
    const std::size_t used = ::malloc_usable_size(memory);
    EXPECT_GE(used, size);
    EXPECT_LT(used, size + 4096) << size;
    std::memset(memory, 7, size);
    ::operator delete(memory, kAt);
  }
}

}  // namespace
}  // namespace rmlcell::server
