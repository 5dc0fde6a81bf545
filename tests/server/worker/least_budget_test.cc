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

// A byte is a byte: one can be had, and a second one when the first is given back.
TEST(LeastBudget, OfOneByteIsUsedUpByOne) {
  bool refused = false;
  const MemoryBudget budget(1);
  void* first = ::operator new(1);
  try {
    ::operator delete(::operator new(1));
  } catch (const std::bad_alloc&) {
    refused = true;
  }
  ::operator delete(first);
  ::operator delete(::operator new(1));
  EXPECT_TRUE(refused);
}

}  // namespace
}  // namespace rmlcell::server
