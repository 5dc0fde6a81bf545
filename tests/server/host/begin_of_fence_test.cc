// A job that a host began without a mark of its own before it (live.md 5.20).
#include <gtest/gtest.h>

#include "server/host/recovered.h"

namespace rmlcell::server {
namespace {

v1::JournalEntry OfFence(std::int64_t fence, std::int64_t sequence) {
  v1::JournalEntry entry;
  entry.set_fence(fence);
  entry.set_sequence(sequence);
  return entry;
}

v1::JournalEntry MarkOfFence(std::int64_t fence, std::int64_t sequence) {
  v1::JournalEntry entry = OfFence(fence, sequence);
  entry.mutable_mark()->set_clean(true);
  return entry;
}

v1::JournalEntry BegunOfFence(std::int64_t fence, std::int64_t sequence) {
  v1::JournalEntry entry = OfFence(fence, sequence);
  entry.mutable_run_begun()->set_job("jobs/17");
  return entry;
}

v1::HostWelcome KnownTo(std::int64_t fence, std::int64_t sequence) {
  v1::HostWelcome welcome;
  welcome.mutable_mark()->set_fence(fence);
  welcome.mutable_mark()->set_sequence(sequence);
  return welcome;
}

// LIVE-5.20: what an earlier host told, and no mark covers, is not lost with it.
TEST(BeginOfFence, BehindWhatAnotherToldItStays) {
  std::vector<v1::JournalEntry> journal{OfFence(6, 9), BegunOfFence(7, 1), MarkOfFence(7, 2)};
  EXPECT_FALSE(TakeBack(KnownTo(5, 1), journal));
  EXPECT_EQ(journal.size(), 3U);
}

// Behind a mark, whichever host made that, all of it is taken back.
TEST(BeginOfFence, BehindAMarkItIsTakenBack) {
  std::vector<v1::JournalEntry> journal{MarkOfFence(6, 9), OfFence(7, 1), BegunOfFence(7, 2),
                                        MarkOfFence(7, 3)};
  EXPECT_TRUE(TakeBack(KnownTo(5, 1), journal));
  ASSERT_EQ(journal.size(), 1U);
  EXPECT_EQ(journal[0].fence(), 6);
}

// At the beginning of a journal where the store knows how the machine stood.
TEST(BeginOfFence, AtTheBeginningItIsTakenBackWhereTheStoreKnowsMore) {
  std::vector<v1::JournalEntry> journal{OfFence(7, 1), BegunOfFence(7, 2), MarkOfFence(7, 3)};
  std::vector<v1::JournalEntry> again = journal;
  EXPECT_FALSE(TakeBack({}, journal));
  EXPECT_EQ(journal.size(), 3U);
  EXPECT_TRUE(TakeBack(KnownTo(5, 1), again));
  EXPECT_TRUE(again.empty());
}

}  // namespace
}  // namespace rmlcell::server
