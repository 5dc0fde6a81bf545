// What a host finds of its predecessor (live.md 3.30, 5.04).
#include "server/host/recovered.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

v1::JournalEntry Entry(std::int64_t sequence) {
  v1::JournalEntry entry;
  entry.set_fence(7);
  entry.set_sequence(sequence);
  return entry;
}

v1::JournalEntry Mark(std::int64_t sequence) {
  v1::JournalEntry entry = Entry(sequence);
  entry.mutable_mark()->set_fence(7);
  entry.mutable_mark()->set_sequence(sequence);
  entry.mutable_mark()->set_clean(true);
  return entry;
}

v1::JournalEntry Intent(std::int64_t sequence, const std::string& job) {
  v1::JournalEntry entry = Entry(sequence);
  entry.mutable_intent()->mutable_input()->mutable_start()->set_job(job);
  return entry;
}

// The newest mark counts, and of what was told before it that which the store does not have.
TEST(Recovered, TheNewestMarkCounts) {
  v1::HostWelcome welcome;
  welcome.mutable_mark()->set_fence(7);
  welcome.mutable_mark()->set_sequence(2);
  v1::JournalEntry told = Entry(3);
  told.mutable_run_begun();
  const Recovered found = RecoveredFrom(welcome, {Mark(1), Mark(2), told, Mark(4), Intent(5, {})});
  EXPECT_TRUE(found.known);
  EXPECT_EQ(found.mark.sequence(), 4);
  ASSERT_EQ(found.untold.size(), 2U);
  EXPECT_TRUE(found.untold.front().has_run_begun());
  EXPECT_EQ(found.begins, "");
}

// LIVE-5.04: a job that was about to begin may have moved the machine; behind a mark it has not.
TEST(Recovered, AJobThatWasAboutToBeginMayHaveMoved) {
  EXPECT_EQ(RecoveredFrom({}, {Mark(1), Intent(2, "jobs/17")}).begins, "jobs/17");
  EXPECT_EQ(RecoveredFrom({}, {Mark(1), Intent(2, "jobs/17"), Mark(3)}).begins, "");
  v1::HostWelcome welcome;  // the store knows more than the journal
  welcome.mutable_mark()->set_fence(8);
  welcome.mutable_mark()->set_sequence(1);
  EXPECT_EQ(RecoveredFrom(welcome, {Mark(1), Intent(2, "jobs/17")}).begins, "");
}

}  // namespace
}  // namespace rmlcell::server
