// A machine as a host opens it: by what its server and its journal have, and what is left of that
// (live.md 3.05, 3.27, 5.20).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/recording.h"
#include "server/host/recovered.h"

namespace rmlcell::server {
namespace {

class OpenedMachines : public testing::Test {
 protected:
  OpenedMachines() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~OpenedMachines() override { std::filesystem::remove_all(folder_); }

  static v1::JournalEntry EntryOf(std::int64_t sequence) {
    v1::JournalEntry entry;
    entry.set_fence(7);
    entry.set_sequence(sequence);
    return entry;
  }
  static v1::JournalEntry MarkOf(std::int64_t sequence, bool clean) {
    v1::JournalEntry entry = EntryOf(sequence);
    entry.mutable_mark()->set_fence(7);
    entry.mutable_mark()->set_sequence(sequence);
    entry.mutable_mark()->set_clean(clean);
    return entry;
  }
  // A host told something and answered somebody, with fence 7.
  void WriteWhatWasTold() {
    v1::JournalEntry told = EntryOf(2);
    told.mutable_event()->mutable_message()->set_text("of the earlier one");
    v1::JournalEntry answer = EntryOf(3);
    answer.mutable_answered()->set_request_id("a request");
    Write({MarkOf(1, true), told, answer});
  }
  // It began a job, and ended before the store had that.
  void WriteABegin() {
    v1::JournalEntry intent = EntryOf(2);
    intent.mutable_intent()->mutable_input()->mutable_start()->set_job("jobs/17");
    v1::JournalEntry start = EntryOf(3);
    start.mutable_applied()->mutable_input()->mutable_start()->set_job("jobs/17");
    v1::JournalEntry begun = EntryOf(4);
    begun.mutable_run_begun()->set_job("jobs/17");
    v1::JournalEntry mark = MarkOf(5, false);
    mark.mutable_mark()->set_job("jobs/17");
    Write({MarkOf(1, true), intent, start, begun, mark});
  }
  void Write(const std::vector<v1::JournalEntry>& entries) {
    std::filesystem::remove(journal_);
    ASSERT_TRUE(Journal::Open(journal_)->journal->Write(entries));
  }
  std::vector<v1::JournalEntry> Left() const {
    std::ifstream file(journal_, std::ios::binary);
    return ReadJournal(std::string(std::istreambuf_iterator<char>(file), {})).entries;
  }
  // The store has this mark.
  static v1::HostWelcome WelcomeWith(std::int64_t fence) {
    v1::HostWelcome welcome;
    welcome.set_fence(9);
    welcome.set_family("rml1");
    welcome.set_profile("srm-20");
    welcome.mutable_mark()->set_fence(fence);
    welcome.mutable_mark()->set_sequence(1);
    welcome.mutable_mark()->set_clean(true);
    return welcome;
  }
  // Why there is no machine.
  std::optional<ErrorCode> Open(const v1::HostWelcome& welcome) const {
    const auto opened = OpenMachine(
        welcome, {.server = "", .join_token = "", .machine = "machines/m", .journal = journal_},
        "workshop/1", {.steady = std::chrono::hours(1), .wall = WallTime(std::chrono::hours(9))});
    return opened ? std::nullopt : std::optional(opened.error().code);
  }
  // Nothing can be made beside the journal to take its place.
  void BlockANewOne() const { std::filesystem::create_directories(journal_ + ".new"); }

  const std::string folder_ = testing::TempDir() + "/opened-" + std::to_string(::getpid());
  const std::string journal_ = folder_ + "/m.journal";
};

// LIVE-3.05, LIVE-3.27: behind another host what was told is kept beside it; answers stay.
TEST_F(OpenedMachines, OfAnEarlierHostAnswersStay) {
  WriteWhatWasTold();
  EXPECT_EQ(Open(WelcomeWith(8)), std::nullopt);
  const std::vector<v1::JournalEntry> left = Left();
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left.front().answered().request_id(), "a request");
  EXPECT_TRUE(std::filesystem::exists(journal_ + ".orphan"));
}

// LIVE-5.20: what is taken back is taken back for good.
TEST_F(OpenedMachines, ABeginThatTheStoreDoesNotHaveIsGone) {
  WriteABegin();
  EXPECT_EQ(Open(WelcomeWith(7)), std::nullopt);
  const std::vector<v1::JournalEntry> left = Left();
  ASSERT_EQ(left.size(), 2U);
  EXPECT_TRUE(left.front().has_mark());
  EXPECT_TRUE(left.back().has_intent());
}

// LIVE-3.21: else it would come alive for the host after this one.
TEST_F(OpenedMachines, WhereThatCannotBeWrittenThereIsNoMachine) {
  BlockANewOne();
  WriteWhatWasTold();
  EXPECT_EQ(Open(WelcomeWith(8)), ErrorCode::kCellJournal);
  WriteABegin();
  EXPECT_EQ(Open(WelcomeWith(7)), ErrorCode::kCellJournal);
  std::filesystem::remove_all(folder_);
  EXPECT_EQ(Open(WelcomeWith(7)), ErrorCode::kCellJournal);
}

// It is the one that its server means, by the fence that it was given, set up as it says.
TEST_F(OpenedMachines, AMachineIsAsItsServerSays) {
  v1::HostWelcome welcome = WelcomeWith(7);
  welcome.mutable_options()->set_start(v1::MachineOptions::START_PERSON);
  (*welcome.mutable_parameters())["ORIGIN_X"] = "5";
  const HostTime now{.steady = std::chrono::hours(1), .wall = WallTime(std::chrono::hours(9))};
  const auto opened = OpenMachine(
      welcome, {.server = "", .join_token = "", .machine = "machines/m", .journal = journal_},
      "workshop/1", now);
  ASSERT_TRUE(opened) << opened.error().detail;
  const v1::MachineStatus status = opened->machine->StatusAt(now);
  EXPECT_EQ(status.machine(), "machines/m");
  EXPECT_EQ(status.host(), "workshop/1");
  EXPECT_EQ(status.fence(), 9);
  ASSERT_EQ(status.start_blockers_size(), 1);
  EXPECT_EQ(status.start_blockers(0).code(), CodeText(ErrorCode::kCellMode));
  opened->machine->Begin({}, now);
  v1::HostOrder order;
  order.mutable_recording();
  const auto recorded = recording::ReadFile(opened->machine->Do(order, now).recording().chunk());
  ASSERT_TRUE(recorded) << recorded.error().detail;
  EXPECT_EQ(recorded->head.family(), "rml1");
  EXPECT_EQ(recorded->head.profile(), "srm-20");
  ASSERT_EQ(recorded->head.parameters_size(), 1);
  EXPECT_EQ(recorded->head.parameters().at("ORIGIN_X"), "5");
}

TEST_F(OpenedMachines, WhatNoMachineCanBeMadeOfIsRefused) {
  v1::HostWelcome welcome = WelcomeWith(7);
  welcome.set_family("lathe");
  EXPECT_EQ(Open(welcome), ErrorCode::kCellUnknownFamily);
  welcome = WelcomeWith(7);
  (*welcome.mutable_parameters())["NONE"] = "1";
  EXPECT_NE(Open(welcome), std::nullopt);
  welcome = WelcomeWith(7);
  welcome.mutable_mark()->set_state("no state");
  EXPECT_NE(Open(welcome), std::nullopt);
  EXPECT_EQ(Open(WelcomeWith(7)), std::nullopt);
}

}  // namespace
}  // namespace rmlcell::server
