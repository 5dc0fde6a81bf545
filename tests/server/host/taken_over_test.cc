// What a host takes over of its predecessor's journal, and says of it (live.md 3.06, 3.30, 5.20).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "server/base/host_protocol.h"
#include "server/base/this_computer.h"
#include "server/base/version.h"
#include "server/host/host_name.h"
#include "server/host/journal.h"
#include "server/host/recovered.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

class TakenOver : public testing::Test {
 protected:
  TakenOver() { std::filesystem::remove(path_); }
  ~TakenOver() override { std::filesystem::remove(path_); }

  static v1::JournalEntry EntryOf(std::int64_t sequence) {
    v1::JournalEntry entry;
    entry.set_fence(7);
    entry.set_sequence(sequence);
    return entry;
  }
  // What a mark says of itself is not what its entry is known by.
  static v1::JournalEntry MarkOf(std::int64_t sequence) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_mark()->set_clean(true);
    entry.mutable_mark()->set_control_lease(100 + sequence);
    entry.mutable_mark()->set_state("large");
    entry.mutable_mark()->mutable_base()->set_program(5);
    return entry;
  }
  static v1::JournalEntry IntentFor(std::int64_t sequence, const std::string& job) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_intent()->mutable_input()->mutable_start()->set_job(job);
    return entry;
  }
  static v1::JournalEntry StartOf(std::int64_t sequence, const std::string& job) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_applied()->mutable_input()->mutable_start()->set_job(job);
    entry.mutable_applied()->set_caller("queue");
    return entry;
  }
  static v1::JournalEntry BegunOf(std::int64_t sequence, const std::string& job) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_run_begun()->set_job(job);
    return entry;
  }
  static v1::JournalEntry OverrideBy(std::int64_t sequence, const std::string& caller) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_applied()->mutable_input()->set_override_percent(50.0);
    entry.mutable_applied()->set_caller(caller);
    return entry;
  }
  static v1::HostWelcome StoredUpTo(std::int64_t sequence) {
    v1::HostWelcome welcome;
    welcome.mutable_mark()->set_fence(7);
    welcome.mutable_mark()->set_sequence(sequence);
    return welcome;
  }
  static std::vector<std::int64_t> NumbersIn(const std::vector<v1::JournalEntry>& entries) {
    std::vector<std::int64_t> numbers;
    for (const v1::JournalEntry& entry : entries) numbers.push_back(entry.sequence());
    return numbers;
  }
  // As a new host says it, which has no fence yet.
  v1::HostHello HelloBehind(const std::vector<v1::JournalEntry>& entries, std::int64_t fence = 0,
                            std::string had_job = {}) {
    std::filesystem::remove(path_);
    EXPECT_TRUE(Journal::Open(path_)->journal->Write(entries));
    v1::HostHello hello =
        HelloOf({.join_token = "let me in", .machine = "machines/m", .journal = path_},
                "workshop/1", fence, had_job);
    had_job_ = had_job;
    return hello;
  }

  const std::string path_ = testing::TempDir() + "/taken-over-" + std::to_string(::getpid());
  std::string had_job_;
};

// LIVE-5.20: what was only about to begin takes nothing with it.
TEST_F(TakenOver, AnIntentAloneTakesNothingBack) {
  std::vector<v1::JournalEntry> journal = {MarkOf(1), IntentFor(2, "jobs/17"),
                                           OverrideBy(3, "anna")};
  EXPECT_FALSE(TakeBack(StoredUpTo(1), journal));
  EXPECT_THAT(NumbersIn(journal), ElementsAre(1, 2, 3));
}

// LIVE-5.20: a server that has no mark at all has not begun the job either, where the journal has
// the mark before.
TEST_F(TakenOver, ABeginIsTakenBackWhereTheStoreHasNothing) {
  std::vector<v1::JournalEntry> journal = {MarkOf(1), StartOf(2, "jobs/17"), BegunOf(3, "jobs/17"),
                                           MarkOf(4)};
  EXPECT_TRUE(TakeBack({}, journal));
  EXPECT_THAT(NumbersIn(journal), ElementsAre(1));
  // Without it nobody knows how the machine stood.
  journal = {StartOf(2, "jobs/17"), BegunOf(3, "jobs/17"), MarkOf(4)};
  EXPECT_FALSE(TakeBack({}, journal));
  EXPECT_THAT(NumbersIn(journal), ElementsAre(2, 3, 4));
}

// LIVE-5.20: of what somebody did since, what stands in a mark counts; what is behind the newest
// one is no part of the state.
TEST_F(TakenOver, OnlyWhatAMarkHasKeepsABegin) {
  const std::vector<v1::JournalEntry> begun = {MarkOf(1), StartOf(2, "jobs/17"),
                                               BegunOf(3, "jobs/17")};
  std::vector<v1::JournalEntry> behind = begun;
  for (const auto& entry : {MarkOf(4), OverrideBy(5, "anna"), OverrideBy(6, "anna")})
    behind.push_back(entry);
  EXPECT_TRUE(TakeBack(StoredUpTo(1), behind));
  EXPECT_THAT(NumbersIn(behind), ElementsAre(1));
  std::vector<v1::JournalEntry> before = begun;
  for (const auto& entry : {OverrideBy(4, "anna"), MarkOf(5)}) before.push_back(entry);
  EXPECT_FALSE(TakeBack(StoredUpTo(1), before));
  EXPECT_THAT(NumbersIn(before), ElementsAre(1, 2, 3, 4, 5));
  // What nobody did keeps nothing.
  std::vector<v1::JournalEntry> alone = begun;
  for (const auto& entry : {OverrideBy(4, ""), MarkOf(5)}) alone.push_back(entry);
  EXPECT_TRUE(TakeBack(StoredUpTo(1), alone));
}

// LIVE-3.30: the newest mark of the journal, by the number that it has there, without what is
// large.
TEST_F(TakenOver, AHelloHasTheNewestMark) {
  const v1::HostHello hello = HelloBehind({MarkOf(1), MarkOf(2), OverrideBy(3, "anna")});
  ASSERT_TRUE(hello.has_journal_mark());
  EXPECT_EQ(hello.journal_mark().fence(), 7);
  EXPECT_EQ(hello.journal_mark().sequence(), 2);
  EXPECT_EQ(hello.journal_mark().control_lease(), 102);
  EXPECT_TRUE(hello.journal_mark().clean());
  EXPECT_EQ(hello.journal_mark().state(), "");
  EXPECT_FALSE(hello.journal_mark().has_base());
  EXPECT_FALSE(hello.has_begin());
  EXPECT_FALSE(HelloBehind({OverrideBy(3, "anna")}).has_journal_mark());
}

// LIVE-3.30, LIVE-5.20: and where it was about to begin a job, what stood before that.
TEST_F(TakenOver, AHelloHasTheBeginOfAJob) {
  const v1::HostHello hello =
      HelloBehind({MarkOf(1), IntentFor(2, "jobs/17"), StartOf(3, "jobs/17"), BegunOf(4, "jobs/17"),
                   MarkOf(5)});
  EXPECT_EQ(hello.journal_mark().sequence(), 5);
  EXPECT_EQ(hello.begin().job(), "jobs/17");
  EXPECT_EQ(hello.begin().fence(), 7);
  EXPECT_EQ(hello.begin().sequence(), 2);
  EXPECT_EQ(hello.begin().mark().sequence(), 1);
  EXPECT_EQ(hello.begin().mark().fence(), 7);
  EXPECT_EQ(hello.begin().mark().control_lease(), 101);
  EXPECT_EQ(had_job_, "jobs/17");
}

// LIVE-5.20: also where nothing stood before, since all of that was stored and dropped.
TEST_F(TakenOver, AHelloHasTheBeginThatIsAllThereIs) {
  const v1::HostHello hello = HelloBehind({IntentFor(2, "jobs/17")});
  EXPECT_FALSE(hello.has_journal_mark());
  EXPECT_EQ(hello.begin().job(), "jobs/17");
  EXPECT_EQ(hello.begin().fence(), 7);
  EXPECT_EQ(hello.begin().sequence(), 2);
  EXPECT_FALSE(hello.begin().has_mark());
}

// LIVE-3.30: once it has a fence its machine is what it has, and not the journal; of a job that was
// about to begin it tells as long as the server does not know.
TEST_F(TakenOver, AHostWithAFenceTellsNoMoreOfItsJournal) {
  const std::vector<v1::JournalEntry> journal = {MarkOf(1), IntentFor(2, "jobs/17")};
  const v1::HostHello first = HelloBehind(journal, 1);
  EXPECT_EQ(first.fence(), 1);
  EXPECT_FALSE(first.has_journal_mark());
  EXPECT_FALSE(first.has_begin());
  const v1::HostHello had = HelloBehind(journal, 9, "jobs/3");
  EXPECT_EQ(had.fence(), 9);
  EXPECT_FALSE(had.has_journal_mark());
  EXPECT_EQ(had.begin().job(), "jobs/3");
  EXPECT_EQ(had_job_, "jobs/3");
}

// Who it is, where it runs, and what it understands.
TEST_F(TakenOver, AHelloSaysWhoItIs) {
  const v1::HostHello hello = HelloBehind({});
  EXPECT_EQ(hello.join_token(), "let me in");
  EXPECT_EQ(hello.machine(), "machines/m");
  EXPECT_EQ(hello.host(), "workshop/1");
  EXPECT_EQ(hello.version(), kVersion);
  EXPECT_EQ(hello.protocol(), kHostProtocol);
  EXPECT_EQ(hello.boot_id(), NameOfBoot());
  EXPECT_EQ(hello.computer(), NameOfComputer());
  EXPECT_EQ(hello.fence(), 0);
}

// LIVE-3.27, LIVE-3.30: of what is behind the newest mark nothing counts, neither an answer nor
// what was told.
TEST_F(TakenOver, WhatIsBehindTheNewestMarkIsGone) {
  const auto answer = [](std::int64_t sequence) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_answered()->set_request_id("once");
    return entry;
  };
  const Recovered found =
      RecoveredFrom(StoredUpTo(2), {answer(1), MarkOf(2), OverrideBy(3, "anna"), answer(4),
                                    MarkOf(5), OverrideBy(6, "anna"), answer(7)});
  EXPECT_TRUE(found.known);
  EXPECT_THAT(NumbersIn(found.untold), ElementsAre(3, 5));
  EXPECT_THAT(NumbersIn(found.answered), ElementsAre(1, 4));
  EXPECT_EQ(found.mark.control_lease(), 105);
}

// A family of a later version.
TEST_F(TakenOver, AFamilyThatIsNotKnownHasNoMachine) {
  v1::HostWelcome welcome;
  welcome.set_family("rml9");
  const auto opened =
      OpenMachine(welcome, {.machine = "machines/m", .journal = path_}, "workshop/1", {});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(opened.error().detail, "'rml9'; there are optimo rml1");
}

}  // namespace
}  // namespace rmlcell::server
