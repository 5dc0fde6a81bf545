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
  // Longer than what is written may take.
  void StandForAWhile() {
    server_->Told(v1::HostRequest::kStatus, Count(v1::HostRequest::kStatus) + 3);
  }
};

// Nothing is on its way to the disk: however long it stands, the disk is not late.
TEST_F(LiveHostDisk, AMachineThatStandsWaitsForNoDisk) {
  Live();
  TakeControl();
  StandForAWhile();
  for (const v1::HostRequest& told : server_->Told(v1::HostRequest::kStatus, 0))
    EXPECT_FALSE(IsLate(told.status()));
}

// LIVE-3.21: the disk is late when a write takes more than a second, and not since the last one
// was long ago; whoever waits for it is told so.
TEST_F(LiveHostDisk, ADiskIsLateByWhatIsWrittenNow) {
  Live();
  TakeControl();
  AwaitStatus([](const v1::MachineStatus& one) { return one.has_control(); });
  StandForAWhile();
  const std::size_t before = Count(v1::HostRequest::kStatus);
  auto disk = std::make_optional<SmallFiles>(0);
  const v1::HostOrderAnswer answer = Ask(ReleaseOfControl());
  AwaitStatus(IsLate);
  disk.reset();
  EXPECT_EQ(answer.refusal().code(), CodeText(ErrorCode::kCellJournal));
  EXPECT_EQ(answer.refusal().message(), "it acts, but the disk does not answer");
  EXPECT_FALSE(
      IsLate(AwaitStatus([](const v1::MachineStatus& one) { return !one.has_control(); }, before)));
  TakeControl();
  EXPECT_FALSE(IsLate(AwaitStatus([](const v1::MachineStatus& one) {
    return one.has_control() && one.control().number() == 2 && !IsLate(one);
  })));
}

// LIVE-3.21: what may move does not begin before that is on the disk.
TEST_F(LiveHostDisk, NothingBeginsWhileTheDiskIsStuck) {
  Live();
  TakeControl();
  auto disk = std::make_optional<SmallFiles>(0);
  const v1::HostOrderAnswer late = Ask(StartOf());
  const v1::HostOrderAnswer troubled = Ask(StartOf());
  const v1::MachineStatus status = AwaitStatus(IsLate);
  disk.reset();
  EXPECT_EQ(late.refusal().code(), CodeText(ErrorCode::kCellJournal));
  EXPECT_EQ(late.refusal().message(), "the disk does not answer");
  EXPECT_EQ(troubled.refusal().code(), CodeText(ErrorCode::kCellJournal));
  EXPECT_THAT(troubled.refusal().message(), HasSubstr("machine.journal"));
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_IDLE);
  AskUntilItActs(StartOf());
  EXPECT_FALSE(IsLate(AwaitState(v1::MACHINE_STATE_RUNNING)));
}

// LIVE-3.21: what moves is held, and the log says why once it can.
TEST_F(LiveHostDisk, ARunIsHeldWhileTheDiskIsStuck) {
  Live();
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  AwaitState(v1::MACHINE_STATE_RUNNING);
  auto disk = std::make_optional<SmallFiles>(0);
  const v1::MachineStatus held = AwaitState(v1::MACHINE_STATE_HELD);
  disk.reset();
  EXPECT_EQ(held.hold_reason(), v1::HOLD_REASON_LATE);
  EXPECT_TRUE(IsLate(held));
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
  AwaitStatus([](const v1::MachineStatus& one) { return !one.start_blockers().empty(); });
  EXPECT_FALSE(AskWhereItIs().has_refusal());
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

}  // namespace
}  // namespace rmlcell::server
