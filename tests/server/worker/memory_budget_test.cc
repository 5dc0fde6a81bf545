#include "server/worker/memory_budget.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <memory>
#include <new>
#include <thread>
#include <vector>

namespace rmlcell::server {
namespace {

// Calls the function of the language, which a compiler may not leave out.
void* Allocate(std::size_t size) { return ::operator new(size); }
void Free(void* memory) { ::operator delete(memory); }

TEST(MemoryBudget, AllowsAllOfItAndNotAByteMore) {
  constexpr std::int64_t kBudget = 1 << 20;
  EXPECT_FALSE(MemoryBudget::exceeded());
  {
    const MemoryBudget budget(kBudget);
    EXPECT_THROW((void)Allocate(kBudget + 1), std::bad_alloc);
    EXPECT_TRUE(MemoryBudget::exceeded());
  }
  EXPECT_FALSE(MemoryBudget::exceeded());  // none is in force
  void* memory = nullptr;
  {
    const MemoryBudget budget(kBudget);
    memory = Allocate(kBudget);
    EXPECT_FALSE(MemoryBudget::exceeded());
    EXPECT_THROW((void)Allocate(1), std::bad_alloc);
    EXPECT_TRUE(MemoryBudget::exceeded());
    Free(memory);
  }
}

TEST(MemoryBudget, WhatIsGivenBackMayBeTakenAgain) {
  const MemoryBudget budget(1 << 20);
  for (int i = 0; i < 100; ++i) Free(Allocate(900'000));
  void* half = Allocate(600'000);
  EXPECT_THROW((void)Allocate(600'000), std::bad_alloc);
  Free(half);
  Free(Allocate(600'000));
  Free(nullptr);
}

TEST(MemoryBudget, CountsAlignedMemoryToo) {
  const MemoryBudget budget(1 << 20);
  constexpr auto kPage = std::align_val_t(4096);
  EXPECT_THROW((void)::operator new(2 << 20, kPage), std::bad_alloc);
  void* memory = ::operator new(10'000, kPage);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 4096, 0U);
  ::operator delete(memory, kPage);
  for (int i = 0; i < 1000; ++i) ::operator delete(::operator new(10'000, kPage), kPage);
}

// The threads of gRPC are not the job.
TEST(MemoryBudget, IsThatOfItsThread) {
  const MemoryBudget budget(1 << 20);
  bool other_exceeded = true;
  std::thread([&] {
    Free(Allocate(4 << 20));
    other_exceeded = MemoryBudget::exceeded();
  }).join();
  EXPECT_FALSE(other_exceeded);
  EXPECT_THROW((void)Allocate(2 << 20), std::bad_alloc);
}

TEST(MemoryBudget, WithoutOneNothingIsCounted) {
  Free(Allocate(64 << 20));
  EXPECT_FALSE(MemoryBudget::exceeded());
}

// In whichever form it is taken and given back.
TEST(MemoryBudget, EachFormGivesBackWhatItTook) {
  constexpr std::size_t kSize = 900'000;
  constexpr auto kPage = std::align_val_t(4096);
  const std::vector<void (*)()> forms = {
      [] { ::operator delete(::operator new(kSize), kSize); },
      [] { ::operator delete[](::operator new[](kSize)); },
      [] { ::operator delete[](::operator new[](kSize), kSize); },
      [] { ::operator delete[](::operator new[](kSize, kPage), kPage); },
      [] { ::operator delete(::operator new(kSize, kPage), kSize, kPage); },
      [] { ::operator delete[](::operator new[](kSize, kPage), kSize, kPage); }};
  for (const auto form : forms) {
    const MemoryBudget budget(1 << 20);
    for (int time = 0; time < 3; ++time) form();
    EXPECT_FALSE(MemoryBudget::exceeded());
  }
}

// What is given back is the computer's again.
TEST(MemoryBudget, NothingStaysOfWhatIsGivenBack) {
  const auto held = [] { return ::mallinfo2().hblkhd + ::mallinfo2().uordblks; };
  Free(Allocate(64 << 20));
  const std::size_t before = held();
  Free(Allocate(64 << 20));
  EXPECT_LT(held(), before + (32 << 20));
}

}  // namespace
}  // namespace rmlcell::server
