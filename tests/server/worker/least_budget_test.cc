// The least budget of memory that there is.
#include <gtest/gtest.h>

#include <memory>
#include <new>

#include "server/worker/memory_budget.h"

namespace rmlcell::server {
namespace {

// Of a single byte nothing else can be had, and that is noted; none at all is no budget.
TEST(LeastBudget, OfOneByteIsInForce) {
  bool refused = false;
  bool exceeded = false;
  {
    const MemoryBudget budget(1);
    try {
      const auto bytes = std::make_unique<char[]>(1'000);
      refused = bytes == nullptr;
    } catch (const std::bad_alloc&) {
      refused = true;
    }
    exceeded = MemoryBudget::exceeded();
  }
  EXPECT_TRUE(refused);
  EXPECT_TRUE(exceeded);
  const MemoryBudget none(0);
  EXPECT_NE(std::make_unique<char[]>(1'000), nullptr);
  EXPECT_FALSE(MemoryBudget::exceeded());
}

}  // namespace
}  // namespace rmlcell::server
