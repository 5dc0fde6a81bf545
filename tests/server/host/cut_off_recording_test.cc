// The recording of a run that the death of its host cut off (live.md 3, replay).
#include <filesystem>
#include <fstream>
#include <utility>

#include "proto/recording/records.h"
#include "proto/recording/replay.h"
#include "server/host/recording_file.h"
#include "server/host/recovered.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using recording::Recording;

class CutOffRecordingTest : public HostMachineTest {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "/cut_off." + std::to_string(::getpid());
    std::filesystem::remove(path_);
    file_.emplace(path_);
  }
  void TearDown() override { std::filesystem::remove(path_); }

  // As a host does it: what is recorded goes to the file.
  std::vector<v1::JournalEntry> Write() {
    std::vector<v1::JournalEntry> entries = host_->TakeEntries(now_, true);
    file_->Add(host_->TakeRecorded());
    return entries;
  }
  v1::MachineMark WriteMark() {
    const std::vector<v1::JournalEntry> entries = Write();
    EXPECT_TRUE(entries.back().has_mark());
    return entries.back().mark();
  }
  v1::MachineMark RunFor(std::chrono::milliseconds time) {
    for (std::chrono::milliseconds gone{0}; gone < time; gone += 500ms) {
      Pass(500ms, 50ms);
      Write();
    }
    return WriteMark();
  }
  void BeginJob(const std::string& name = "jobs/17") {
    v1::HostOrder order;
    v1::WorkerAssignment& assignment = *order.mutable_run_job();
    assignment.mutable_job()->set_name(name);
    assignment.set_main_program(5);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(5);
    program.set_file_name("square.rml");
    program.set_is_source(true);
    program.set_content(kSquare);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  // The next host, which finds this mark, and what of the run is in the file.
  void DiesAt(const v1::MachineMark& mark) {
    recording_ = RecordingOf(mark, path_);
    inspect_job_ = mark.job();
    Make(mark.state(), true, mark);
    host_->Begin({}, now_);
  }
  std::string Served(const std::string& job) {
    v1::HostOrder order;
    order.mutable_recording()->set_job(job);
    const v1::HostOrderAnswer answer = Do(order);
    return answer.has_recording() ? answer.recording().chunk() : answer.refusal().code();
  }

  std::string path_;
  std::optional<RecordingFile> file_;
};

// LIVE-3.40, LIVE-3.41: what the run did up to the mark is played again, and it is over there.
TEST_F(CutOffRecordingTest, ARunThatWasCutOffIsPlayedUpToItsMark) {
  Make();
  host_->Begin({}, now_);
  BeginJob();
  const v1::MachineMark mark = RunFor(7s);
  ASSERT_EQ(mark.job(), "jobs/17");
  RunFor(2s);  // recorded, and not found again
  DiesAt(mark);
  const auto read = recording::ReadFile(Served("jobs/17"));
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(read->head.job(), "jobs/17");
  ASSERT_TRUE(read->entries.back().has_run_over());
  EXPECT_EQ(read->entries.back().virtual_time_ns(), mark.virtual_time_ns());
  int times = 0;
  recording::ReplayOptions options;
  options.cut_off = [&](const machine::RunOver& over, const v1::Outcome& outcome) {
    ++times;
    EXPECT_EQ(over.lasted, SimTime(mark.run_time_ns()));
    EXPECT_EQ(outcome.kind(), v1::Outcome::KIND_INTERRUPTED);
    EXPECT_EQ(outcome.code(), "CELL-E9411");
  };
  const auto played = recording::Replay(*read, options);
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_FALSE(played->difference);
  EXPECT_EQ(times, 1);
  EXPECT_EQ(played->until, SimTime(mark.virtual_time_ns()));
  EXPECT_GE(played->marks, 14);  // two a second
}

// LIVE-3.40: the host that found it dies, too; its marks are behind the end of the run.
TEST_F(CutOffRecordingTest, ItOutlivesTheNextHost) {
  Make();
  host_->Begin({}, now_);
  BeginJob();
  DiesAt(RunFor(3s));
  const std::string served = Served("jobs/17");
  v1::MachineMark mark = WriteMark();
  mark.set_fence(8);  // the fence of this host, had it been given another one
  ASSERT_EQ(mark.job(), "jobs/17");
  mark.set_sequence(mark.sequence() + 1000);
  recording_.reset();
  const auto again = RecordingOf(mark, path_);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->file, served);
}

// LIVE-5.09: a host that ends in order leaves it with the end of the run.
TEST_F(CutOffRecordingTest, AnOrderlyEndLeavesIt) {
  Make();
  host_->Begin({}, now_);
  BeginJob();
  RunFor(3s);
  host_->EndRun(now_);
  const auto left = RecordingOf(WriteMark(), path_);
  ASSERT_TRUE(left);
  std::vector<std::string> codes;
  recording::ReplayOptions options;
  options.cut_off = [&](const machine::RunOver&, const v1::Outcome& outcome) {
    codes.push_back(outcome.code());
  };
  const auto played = recording::Replay(*recording::ReadFile(left->file), options);
  ASSERT_TRUE(played);
  EXPECT_THAT(codes, testing::ElementsAre("CELL-E9432"));
}

// LIVE-3.40: a file that is torn in front of the mark, of another run, or not there is none.
TEST_F(CutOffRecordingTest, HalfOfOneIsNone) {
  Make();
  host_->Begin({}, now_);
  BeginJob();
  const v1::MachineMark mark = RunFor(3s);
  ASSERT_TRUE(RecordingOf(mark, path_));
  v1::MachineMark of_another = mark;
  of_another.set_job("jobs/18");
  EXPECT_FALSE(RecordingOf(of_another, path_));
  v1::MachineMark later = mark;
  later.set_sequence(mark.sequence() + 1);
  EXPECT_FALSE(RecordingOf(later, path_));
  const auto size = std::filesystem::file_size(path_);
  std::filesystem::resize_file(path_, size - 1);
  EXPECT_FALSE(RecordingOf(mark, path_));
  std::filesystem::remove(path_);
  EXPECT_FALSE(RecordingOf(mark, path_));
}

// A host that ends behind the end of a run has what is needed for its report; the next run begins
// another file, one by hand does not go there.
TEST_F(CutOffRecordingTest, TheFileIsOfTheNewestRunOfAJob) {
  Make();
  host_->Begin({}, now_);
  BeginJob();
  const v1::MachineMark over = RunFor(120s);
  ASSERT_TRUE(over.clean());
  const auto whole = RecordingOf(over, path_);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->job, "jobs/17");
  Control();
  ASSERT_FALSE(Do(Start()).has_refusal());
  RunFor(1s);
  EXPECT_FALSE(host_->TakeRecorded().begins);
  EXPECT_EQ(RecordingOf(over, path_)->file, whole->file);
}

}  // namespace
}  // namespace rmlcell::server
