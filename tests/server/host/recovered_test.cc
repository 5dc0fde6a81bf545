// What a host finds of its predecessor (live.md 3.30, 5.04).
#include "server/host/recovered.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>

#include "proto/bridge/files.h"
#include "server/host/journal.h"

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

// The first entries of a job that begins: START, the run, and where the machine stands.
std::vector<v1::JournalEntry> Begin(std::int64_t sequence) {
  v1::JournalEntry start = Entry(sequence + 1);
  start.mutable_applied()->mutable_input()->mutable_start()->set_job("jobs/17");
  v1::JournalEntry begun = Entry(sequence + 2);
  begun.mutable_run_begun()->set_job("jobs/17");
  v1::JournalEntry mark = Mark(sequence + 3);
  mark.mutable_mark()->set_clean(false);
  mark.mutable_mark()->set_job("jobs/17");
  mark.mutable_mark()->set_run_time_ns(0);
  return {Intent(sequence, "jobs/17"), start, begun, mark};
}

std::vector<v1::JournalEntry> Behind(std::vector<v1::JournalEntry> first,
                                     const std::vector<v1::JournalEntry>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

v1::HostWelcome Stored(std::int64_t sequence) {
  v1::HostWelcome welcome;
  welcome.mutable_mark()->set_fence(7);
  welcome.mutable_mark()->set_sequence(sequence);
  welcome.mutable_mark()->set_clean(true);
  return welcome;
}

// LIVE-5.20, first row: a job whose begin the store does not have has moved nothing (5.04); the
// machine is as it was marked before, and nothing of the begin is told.
TEST(Recovered, AJobThatTheStoreHasNotBegunHasNotBegun) {
  const auto journal = Behind({Mark(1)}, Begin(2));
  for (std::size_t cut = 1; cut <= journal.size(); ++cut) {
    const Recovered found = RecoveredFrom(
        Stored(1), {journal.begin(), journal.begin() + static_cast<std::ptrdiff_t>(cut)});
    EXPECT_EQ(found.mark.sequence(), 1) << cut;
    EXPECT_TRUE(found.untold.empty()) << cut;
    const HostMachine::Setup setup = SetupOf(found);
    EXPECT_FALSE(setup.cut_off);
    EXPECT_FALSE(setup.open_run);
  }
  // What came before it is told.
  v1::JournalEntry before = Entry(2);
  before.mutable_applied()->mutable_input()->mutable_resume();
  const Recovered told = RecoveredFrom(Stored(1), Behind({Mark(1), before, Mark(3)}, Begin(4)));
  EXPECT_EQ(told.mark.sequence(), 3);
  EXPECT_EQ(told.untold.size(), 2U);
}

// LIVE-5.20, second row: one that the store has begun may have moved; and one behind whose begin
// somebody did something must not be lost with it.
TEST(Recovered, AJobThatMayHaveMovedIsCutOff) {
  v1::HostWelcome begun = Stored(5);
  begun.mutable_mark()->set_clean(false);
  EXPECT_TRUE(SetupOf(RecoveredFrom(begun, Behind({Mark(1)}, Begin(2)))).cut_off);
  v1::JournalEntry stop = Entry(6);
  stop.mutable_applied()->mutable_input()->set_stop(v1::HOLD_REASON_STOP);
  stop.mutable_applied()->set_caller("anna");
  v1::JournalEntry held = Begin(4).back();  // number 7
  const auto journal = Behind(Behind({Mark(1)}, Begin(2)), {stop, held});
  const HostMachine::Setup stopped = SetupOf(RecoveredFrom(Stored(1), journal));
  EXPECT_TRUE(stopped.cut_off);
  ASSERT_TRUE(stopped.open_run);
  EXPECT_EQ(stopped.open_run->job(), "jobs/17");
  v1::JournalEntry over = Entry(6);
  over.mutable_run_over()->set_job("jobs/17");
  const Recovered ended =
      RecoveredFrom(Stored(1), Behind(Behind({Mark(1)}, Begin(2)), {over, Mark(7)}));
  EXPECT_EQ(ended.mark.sequence(), 7);
  EXPECT_TRUE(std::ranges::any_of(ended.untold, &v1::JournalEntry::has_run_over));
}

// LIVE-3.27: behind a journal that was trimmed there are answers and no mark; they count on.
TEST(Recovered, AnswersOutliveATrimmedJournal) {
  v1::JournalEntry answer = Entry(3);
  answer.mutable_answered()->set_request_id("once");
  EXPECT_EQ(RecoveredFrom(Stored(5), {answer}).answered.size(), 1U);
  EXPECT_EQ(RecoveredFrom(Stored(5), {answer, Intent(6, "jobs/17")}).answered.size(), 1U);
}

// LIVE-3.30, LIVE-5.20: the server is told of the job that was about to begin, and of the mark
// before, to which the machine is taken back where the store does not have the begin.
TEST(Recovered, TheServerHearsOfWhatWasAboutToBegin) {
  const std::string path = testing::TempDir() + "/begins-" + std::to_string(getpid());
  const auto hello_of = [&](const std::vector<v1::JournalEntry>& entries) {
    std::remove(path.c_str());
    EXPECT_TRUE(Journal::Open(path)->journal->Write(entries));
    v1::HostHello hello;
    AddNewestMark(path, hello);
    return hello;
  };
  const v1::HostHello begun = hello_of(Behind({Mark(1)}, Begin(2)));
  EXPECT_EQ(begun.journal_mark().sequence(), 5);
  EXPECT_EQ(begun.begin().job(), "jobs/17");
  EXPECT_EQ(begun.begin().sequence(), 2);
  EXPECT_EQ(begun.begin().mark().sequence(), 1);
  const v1::HostHello meant = hello_of({Mark(1), Intent(2, "jobs/17")});
  EXPECT_EQ(meant.begin().job(), "jobs/17");
  EXPECT_EQ(meant.begin().mark().sequence(), 1);
  EXPECT_FALSE(hello_of({Mark(1), Intent(2, "jobs/17"), Mark(3)}).has_begin());
  std::remove(path.c_str());
}

// LIVE-3.27, LIVE-3.35, LIVE-5.20: what was taken back is gone for the host after the next one,
// too: a repeated request acts. That a host had the job is told by each, until it has begun after
// all.
TEST(Recovered, WhatWasTakenBackStaysSo) {
  std::vector<v1::JournalEntry> journal = Behind({Mark(1)}, Begin(2));
  v1::JournalEntry answer = Entry(6);
  answer.mutable_answered()->set_kind(v1::HostOrder::kRunJob);
  journal.insert(journal.end() - 1, answer);
  v1::HostWelcome welcome = Stored(5);
  std::vector<v1::JournalEntry> kept = journal;
  EXPECT_FALSE(TakeBack(welcome, kept));
  welcome = Stored(1);
  EXPECT_TRUE(TakeBack(welcome, journal));
  ASSERT_EQ(journal.size(), 2U);
  EXPECT_TRUE(journal.back().has_intent());
  v1::JournalEntry later = Mark(1);
  later.set_fence(8);
  later.mutable_mark()->set_fence(8);
  journal.push_back(later);
  EXPECT_TRUE(RecoveredFrom(welcome, journal).answered.empty());
  const std::string path = testing::TempDir() + "/taken-back-" + std::to_string(getpid());
  const auto hello_of = [&](const std::vector<v1::JournalEntry>& entries) {
    std::remove(path.c_str());
    EXPECT_TRUE(Journal::Open(path)->journal->Replace(entries));
    v1::HostHello hello;
    AddNewestMark(path, hello);
    return hello;
  };
  EXPECT_EQ(hello_of(journal).begin().job(), "jobs/17");
  EXPECT_EQ(hello_of(journal).begin().fence(), 0);
  for (v1::JournalEntry& entry : journal = Behind(journal, Begin(2))) {
    if (entry.sequence() >= 2 && !entry.has_intent()) entry.set_fence(8);
  }
  journal[3].set_fence(8);  // its intent
  v1::JournalEntry moved = Entry(6);
  moved.set_fence(8);
  moved.mutable_applied()->mutable_input()->set_override_percent(50.0);
  moved.mutable_applied()->set_caller("anna");
  journal.push_back(moved);
  v1::JournalEntry mark = Mark(7);
  mark.set_fence(8);
  journal.push_back(mark);
  EXPECT_FALSE(hello_of(journal).has_begin());
  std::remove(path.c_str());
}

// LIVE-3.27, LIVE-5.20: the answer to the order that begins a job is of its begin, at a step, too;
// that to another order is something that somebody did since.
TEST(Recovered, WhatWasAnsweredIsOfTheBegin) {
  const auto taken_back = [](int kind) {
    std::vector<v1::JournalEntry> journal = Behind({Mark(1)}, Begin(2));
    v1::JournalEntry answer = Entry(6);
    answer.mutable_answered()->set_kind(kind);
    journal.insert(journal.end() - 1, answer);
    return TakeBack(Stored(1), journal);
  };
  EXPECT_TRUE(taken_back(v1::HostOrder::kRunJob));
  EXPECT_TRUE(taken_back(v1::HostOrder::kContinueJob));
  EXPECT_FALSE(taken_back(v1::HostOrder::kOverride));
}

// What a host was about to tell when it died was told again by the next one, before its first mark;
// the one behind that tells it once.
TEST(Recovered, WhatWasToldAgainIsToldOnce) {
  v1::JournalEntry event = Entry(2);
  event.mutable_event()->mutable_message()->set_text("once");
  v1::JournalEntry again = event;
  again.set_fence(8);
  again.set_sequence(1);
  v1::JournalEntry mark = Mark(2);
  mark.set_fence(8);
  mark.mutable_mark()->set_fence(8);
  const Recovered found = RecoveredFrom(Stored(1), {Mark(1), event, Mark(3), again, mark});
  EXPECT_EQ(found.mark.fence(), 8);
  EXPECT_EQ(std::ranges::count_if(found.untold, &v1::JournalEntry::has_event), 1);
}

// LIVE-3.05: of a host that was killed while another one took the machine nothing is thrown away.
TEST(Recovered, WhatWasToldBeforeAnotherHadTheMachineIsKept) {
  const std::string journal = testing::TempDir() + "/recovered-" + std::to_string(getpid());
  v1::JournalEntry event = Entry(2);
  event.mutable_event()->mutable_message()->set_text("of the earlier one");
  v1::HostWelcome same = Stored(1);
  EXPECT_EQ(KeepOfEarlierHost(same, {Mark(1), event, Mark(3)}, journal).value(), "");
  same.mutable_mark()->set_fence(8);
  EXPECT_EQ(KeepOfEarlierHost(same, {Mark(1)}, journal).value(), "") << "nothing was told";
  const auto kept = KeepOfEarlierHost(same, {Mark(1), event, Mark(3)}, journal);
  ASSERT_TRUE(kept);
  EXPECT_EQ(*kept, journal + ".orphan");
  const auto bytes = bridge::ReadFile(*kept, 1 << 20);
  ASSERT_TRUE(bytes);
  const ReadRecords read = ReadJournal(*bytes);
  EXPECT_TRUE(std::ranges::any_of(read.entries, &v1::JournalEntry::has_event));
  std::remove(kept->c_str());
}

}  // namespace
}  // namespace rmlcell::server
