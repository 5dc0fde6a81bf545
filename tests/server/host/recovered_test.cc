// What a host finds of its predecessor (live.md 3.30, 5.04).
#include "server/host/recovered.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>

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

// LIVE-3.33: the computer is gone with its disk: what the store has is what there is.
// LIVE-3.32: of what was not synced nothing is known, and nothing of it is told.
TEST(Recovered, WithoutAJournalTheMarkOfTheStoreCounts) {
  v1::HostWelcome welcome;
  welcome.mutable_mark()->set_fence(7);
  welcome.mutable_mark()->set_sequence(2);
  welcome.mutable_mark()->set_state("where it stood");
  welcome.mutable_mark()->set_run_time_ns(5);
  welcome.mutable_mark()->set_job("jobs/17");
  const Recovered found = RecoveredFrom(welcome, {});
  EXPECT_EQ(found.mark.sequence(), 2);
  EXPECT_TRUE(found.untold.empty());
  const HostMachine::Setup setup = SetupOf(found);
  EXPECT_EQ(setup.state, "where it stood");
  EXPECT_TRUE(setup.cut_off);
  EXPECT_EQ(setup.inspect_job, "jobs/17");
}

// LIVE-4.01: the numbers of control leases count on; time goes as fast as it did, and what the
// newest run came to is known.
TEST(Recovered, WhatAMarkHasBesideTheMachineGoesOn) {
  v1::HostWelcome welcome;
  welcome.mutable_mark()->set_control_lease(41);
  welcome.mutable_mark()->set_factor(10.0);
  welcome.mutable_mark()->mutable_last_run()->set_run(7);
  const HostMachine::Setup setup = SetupOf(RecoveredFrom(welcome, {}));
  EXPECT_EQ(setup.control_lease, 41);
  EXPECT_EQ(setup.factor, 10.0);
  ASSERT_TRUE(setup.last_run);
  EXPECT_EQ(setup.last_run->run(), 7);
}

// LIVE-3.32: cut behind each entry, the newest mark before the cut is the state, and what was told
// behind it is gone.
TEST(Recovered, PowerThatFailsTakesWhatWasNotSynced) {
  v1::JournalEntry told = Entry(2);
  told.mutable_run_begun();
  v1::JournalEntry later = Entry(4);
  later.mutable_run_over();
  const std::vector<v1::JournalEntry> disk = {Mark(1), told, Mark(3), later, Mark(5)};
  const std::array<std::int64_t, 6> state = {0, 1, 1, 3, 3, 5};
  const std::array<std::size_t, 6> untold = {0, 1, 1, 3, 3, 5};
  for (std::size_t cut = 0; cut <= disk.size(); ++cut) {
    const Recovered found =
        RecoveredFrom({}, {disk.begin(), disk.begin() + static_cast<std::ptrdiff_t>(cut)});
    EXPECT_EQ(found.mark.sequence(), state[cut]) << cut;
    EXPECT_EQ(found.untold.size(), untold[cut]) << cut;
    EXPECT_EQ(found.known, cut > 0);
  }
}

// LIVE-5.04: a job that was about to begin may have moved the machine; behind a mark it has not.
TEST(Recovered, AJobThatWasAboutToBeginMayHaveMoved) {
  EXPECT_EQ(RecoveredFrom({}, {Mark(1), Intent(2, "jobs/17")}).begins, "jobs/17");
  EXPECT_EQ(RecoveredFrom({}, {Mark(1), Intent(2, "jobs/17"), Mark(3)}).begins, "");
  // LIVE-5.20: it was cut off before its first step.
  v1::JournalEntry begins = Intent(2, "jobs/17");
  begins.mutable_intent()->mutable_input()->mutable_start()->set_program(45);
  const HostMachine::Setup setup = SetupOf(RecoveredFrom({}, {Mark(1), begins}));
  ASSERT_TRUE(setup.open_run);
  EXPECT_EQ(setup.open_run->place().program(), 45);
  EXPECT_EQ(setup.open_run->place().step(), 0);
  ASSERT_TRUE(setup.cut_off_base);
  EXPECT_EQ(setup.cut_off_base->program(), 45);
  v1::HostWelcome welcome;  // the store knows more than the journal
  welcome.mutable_mark()->set_fence(8);
  welcome.mutable_mark()->set_sequence(1);
  EXPECT_EQ(RecoveredFrom(welcome, {Mark(1), Intent(2, "jobs/17")}).begins, "");
}

}  // namespace
}  // namespace rmlcell::server
