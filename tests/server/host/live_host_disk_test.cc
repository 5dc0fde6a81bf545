// A host whose disk does not answer, as its server sees it (live.md 3.20, 3.21).
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/proto/bridge/small_files.h"
#include "tests/server/host/live_host_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class LiveHostDisk : public LiveHost {
 protected:
  static bool IsLate(const v1::MachineStatus& status) {
    return IsBlockedBy(status, ErrorCode::kCellJournal);
  }
  // What is written is late as soon as it is where nobody says otherwise.
  void LiveWithLittlePatience() {
    patience_.durable = HostPatience{}.durable;
    Live();
  }
  // Longer than what is written may take then.
  void StandForAWhile() {
    server_->Told(v1::HostRequest::kStatus, Count(v1::HostRequest::kStatus) + 3);
  }
  // The square, until it runs and is not late. A computer that is slow for a second holds it before
  // that is told: then once more.
  void RunOnADiskThatAnswers() {
    AskUntilItActs(StartOf());
    const auto is_told = [](const v1::MachineStatus& one) {
      const bool runs = one.state() == v1::MACHINE_STATE_RUNNING;
      return !IsLate(one) && (runs || one.state() == v1::MACHINE_STATE_HELD);
    };
    v1::MachineStatus status = AwaitStatus(is_told);
    for (int tries = 0; status.state() == v1::MACHINE_STATE_HELD && tries < 20; ++tries) {
      v1::HostOrder resume;
      resume.mutable_resume()->set_control_token(token_);
      resume.mutable_resume()->set_request_id("resume " + std::to_string(number_));
      AskUntilItActs(resume);
      status = AwaitStatus(is_told, Count(v1::HostRequest::kStatus));
    }
    EXPECT_EQ(status.state(), v1::MACHINE_STATE_RUNNING);
  }
  // Keys wait for less than the disk is waited for.
  void LiveUntilKeysAreLate() {
    patience_.keys = HostPatience{}.keys;
    patience_.intent = HostPatience{}.intent;
    Live();
  }
  // A key that the disk refuses, and the one behind it.
  void ExpectTheNextToAct(std::int64_t sequence) {
    ASSERT_GT(patience_.intent, patience_.keys);
    ASSERT_FALSE(Ask(OverrideOf(90.0)).has_refusal());
    ASSERT_FALSE(Ask(OverrideOf(100.0)).has_refusal());  // all of it is on the disk
    auto disk = std::make_optional<SmallFiles>(0);
    const std::int64_t first = Send(PanelKey("X+", sequence));
    const std::int64_t second = Send(PanelKey("COVER", sequence + 1));
    const v1::HostOrderAnswer refused = AnswerTo(first);
    const v1::HostOrderAnswer behind = AnswerTo(second);
    disk.reset();
    EXPECT_EQ(refused.refusal().code(), CodeText(ErrorCode::kCellJournal));
    EXPECT_FALSE(behind.has_refusal()) << behind.refusal().message();
  }
};

// Nothing is on its way to the disk: however long it stands, the disk is not late.
TEST_F(LiveHostDisk, AMachineThatStandsWaitsForNoDisk) {
  LiveWithLittlePatience();
  TakeControl();
  // It has answered: what was to be written is.
  AwaitStatus([](const v1::MachineStatus& one) { return one.has_control() && !IsLate(one); });
  const std::size_t before = Count(v1::HostRequest::kStatus);
  StandForAWhile();
  const std::vector<v1::HostRequest> told = server_->Told(v1::HostRequest::kStatus, before);
  for (auto one = told.begin() + static_cast<std::ptrdiff_t>(before); one != told.end(); ++one)
    EXPECT_FALSE(IsLate(one->status()));
  EXPECT_EQ(Count(v1::HostRequest::kAnswer), static_cast<std::size_t>(number_));  // each once
}

// LIVE-3.21: the disk is late when a write takes more than a second, and not since the last one
// was long ago; whoever waits for it is told so.
TEST_F(LiveHostDisk, ADiskIsLateByWhatIsWrittenNow) {
  LiveWithLittlePatience();
  bool late_at_once = true;
  // On a slow computer a second may be over before the first status: then once more.
  for (int lease = 1; late_at_once && lease <= 20; ++lease) {
    TakeControl();
    AwaitStatus([&](const v1::MachineStatus& one) {
      return one.control().number() == lease && !IsLate(one);
    });
    StandForAWhile();
    const std::size_t before = Count(v1::HostRequest::kStatus);
    auto disk = std::make_optional<SmallFiles>(0);
    const v1::HostOrderAnswer answer = Ask(ReleaseOfControl());
    AwaitStatus(IsLate, before);
    disk.reset();
    EXPECT_EQ(answer.refusal().code(), CodeText(ErrorCode::kCellJournal));
    EXPECT_EQ(answer.refusal().message(), "it acts, but the disk does not answer");
    late_at_once = IsLate(
        AwaitStatus([](const v1::MachineStatus& one) { return !one.has_control(); }, before));
  }
  EXPECT_FALSE(late_at_once);
  const std::size_t before = Count(v1::HostRequest::kStatus);
  TakeControl();
  AwaitStatus([](const v1::MachineStatus& one) { return one.has_control() && !IsLate(one); },
              before);
}

// LIVE-3.21: what may move does not begin before that is on the disk.
TEST_F(LiveHostDisk, NothingBeginsWhileTheDiskIsStuck) {
  patience_.intent = HostPatience{}.intent;
  LiveWithLittlePatience();
  TakeControl();
  AwaitStatus([](const v1::MachineStatus& one) { return one.has_control() && !IsLate(one); });
  const std::size_t before = Count(v1::HostRequest::kStatus);
  auto disk = std::make_optional<SmallFiles>(0);
  const v1::HostOrderAnswer late = Ask(StartOf());
  const v1::MachineStatus status = AwaitStatus(IsLate, before);
  // As long as the disk has not refused it yet it is waited for, as the first time.
  v1::HostOrderAnswer troubled = Ask(StartOf());
  for (int tries = 0; troubled.refusal().message() == late.refusal().message() && tries < 100;
       ++tries)
    troubled = Ask(StartOf());
  disk.reset();
  EXPECT_EQ(late.refusal().code(), CodeText(ErrorCode::kCellJournal));
  EXPECT_EQ(late.refusal().message(), "the disk does not answer");
  EXPECT_EQ(troubled.refusal().code(), CodeText(ErrorCode::kCellJournal));
  EXPECT_THAT(troubled.refusal().message(), HasSubstr("machine.journal"));
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_IDLE);
  RunOnADiskThatAnswers();
}

// LIVE-3.21: what moves is held, and the log says why once it can.
TEST_F(LiveHostDisk, ARunIsHeldWhileTheDiskIsStuck) {
  LiveWithLittlePatience();
  TakeControl();
  RunOnADiskThatAnswers();
  const std::size_t before = Count(v1::HostRequest::kStatus);
  auto disk = std::make_optional<SmallFiles>(0);
  const auto is_held = [](const v1::MachineStatus& one) {
    return one.state() == v1::MACHINE_STATE_HELD;
  };
  // On a slow computer it may have been held for a write before, which is over, and what stands
  // writes nothing by itself.
  if (!IsLate(AwaitStatus(is_held, before))) Send(OverrideOf(90.0));
  const v1::MachineStatus held = AwaitStatus(
      [&](const v1::MachineStatus& one) { return is_held(one) && IsLate(one); }, before);
  disk.reset();
  EXPECT_EQ(held.hold_reason(), v1::HOLD_REASON_LATE);
  const v1::JournalEntry why =
      AwaitEntry([](const v1::JournalEntry& one) { return one.event().has_message(); });
  EXPECT_THAT(why.event().message().text(), HasSubstr(CodeText(ErrorCode::kCellJournal)));
}

// Whoever stops the machine stops what is on its way to the disk, too. LIVE-2.05
TEST_F(LiveHostDisk, AStopStopsWhatWaitsForTheDisk) {
  Live();
  TakeControl();
  auto disk = std::make_optional<SmallFiles>(0);
  const std::int64_t started = Send(StartOf());
  const v1::HostOrderAnswer stopped = Ask(StopOrder());
  const v1::HostOrderAnswer answer = AnswerTo(started);
  disk.reset();
  EXPECT_TRUE(stopped.has_halt());
  EXPECT_EQ(answer.refusal().message(), "it was stopped before it began");
  ASSERT_FALSE(Ask(OverrideOf(90.0)).has_refusal());
  ASSERT_FALSE(Ask(OverrideOf(100.0)).has_refusal());  // written behind what waited
  EXPECT_EQ(Ask(StopOrder()).halt().status().state(), v1::MACHINE_STATE_IDLE);
}

// Numbers of orders are those of their line: what is asked over the next one is something else.
TEST_F(LiveHostDisk, AnAnswerIsForTheLineThatAsked) {
  Live();
  TakeControl();
  AwaitStatus([](const v1::MachineStatus& one) { return one.has_control(); });
  const std::size_t before = Count(v1::HostRequest::kStatus);
  auto disk = std::make_optional<SmallFiles>(0);
  const std::int64_t released = Send(ReleaseOfControl());
  AwaitStatus([](const v1::MachineStatus& one) { return !one.has_control(); }, before);
  server_->EndLine();
  server_->Told(v1::HostRequest::kHello, 2);
  disk.reset();
  AwaitEntry([](const v1::JournalEntry& one) {
    return one.applied().input().control().kind() == v1::ControlChanged::KIND_RELEASED;
  });
  AskWhereItIs();
  for (const v1::HostRequest& told : server_->Told(v1::HostRequest::kAnswer, 0))
    EXPECT_NE(told.answer().number(), released);
}

// LIVE-5.20: of a job whose begin is on its way to the disk it is not known yet whether it begins;
// whoever stops that job stops it, and the machine, which stands, has nothing against it.
TEST_F(LiveHostDisk, AJobThatIsAboutToBeginIsNotUnknown) {
  Live();
  TakeControl();
  auto disk = std::make_optional<SmallFiles>(0);
  const std::int64_t job = Send(JobOrder("jobs/17"));
  const v1::HostOrderAnswer about = Ask(WhereIs("jobs/17"));
  const v1::HostOrderAnswer other = Ask(WhereIs("jobs/18"));
  v1::HostOrder stop = StopOrder();
  stop.set_for_job("jobs/17");
  const v1::HostOrderAnswer stopped = Ask(stop);
  const v1::HostOrderAnswer answer = AnswerTo(job);
  disk.reset();
  EXPECT_EQ(about.refusal().code(), CodeText(ErrorCode::kCellNotLive));
  EXPECT_EQ(about.refusal().message(), "it is about to begin");
  EXPECT_EQ(other.refusal().code(), CodeText(ErrorCode::kCellNotFound));
  EXPECT_TRUE(stopped.has_halt()) << stopped.refusal().message();
  EXPECT_EQ(answer.refusal().message(), "it was stopped before it began");
}

// LIVE-7.04: a key that is on its way to the disk is not missing, however long that takes; one that
// the disk refuses has had its turn.
TEST_F(LiveHostDisk, AKeyWaitsForTheOneThatTheDiskHas) {
  LiveUntilKeysAreLate();
  TakeControl();
  ASSERT_FALSE(Ask(PanelKey("COVER", 1)).has_refusal());
  ExpectTheNextToAct(2);
}
TEST_F(LiveHostDisk, TheFirstKeyOfALeaseHasHadItsTurn) {
  LiveUntilKeysAreLate();
  TakeControl();
  ExpectTheNextToAct(1);
}

// LIVE-3.31: nobody is left who would see it begin, however soon the disk answers.
TEST_F(LiveHostDisk, WhatWaitsForTheDiskEndsWithItsLine) {
  Live();
  TakeControl();
  auto disk = std::make_optional<SmallFiles>(0);
  const std::int64_t started = Send(StartOf());
  AskWhereItIs();  // it came behind the start
  server_->EndLine();
  server_->Told(v1::HostRequest::kHello, 2);
  disk.reset();
  ASSERT_FALSE(Ask(OverrideOf(90.0)).has_refusal());
  // Written behind what waited.
  AwaitEntry(
      [](const v1::JournalEntry& one) { return one.applied().input().override_percent() == 90.0; });
  EXPECT_EQ(Ask(StopOrder()).halt().status().state(), v1::MACHINE_STATE_IDLE);
  for (const v1::HostRequest& told : server_->Told(v1::HostRequest::kAnswer, 0))
    EXPECT_NE(told.answer().number(), started);
}

}  // namespace
}  // namespace rmlcell::server
