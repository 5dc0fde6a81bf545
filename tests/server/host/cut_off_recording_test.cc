// The recording of a run that the end of its host cut off (live.md 3, replay).
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <utility>

#include "proto/recording/replay.h"
#include "server/host/recording_file.h"
#include "server/host/recovered.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

namespace fs = std::filesystem;
using recording::Recording;

class CutOffRecordingTest : public HostMachineTest {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "/cut_off." + std::to_string(::getpid());
    fs::remove(path_);
    file_.emplace(path_);
  }
  void TearDown() override { fs::remove(path_); }

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
  void BeginJob(const std::string& text = kSquare, const std::string& file_name = "square.rml") {
    const v1::HostOrderAnswer answer = Do(JobOf(text, file_name));
    ASSERT_FALSE(answer.has_refusal()) << answer.refusal().message();
  }
  void Live() {
    Make();
    host_->Begin(memory_, now_);
  }
  std::optional<MachineRecorder::OfJob> Found(const v1::MachineMark& mark) const {
    return RecoverRecording({.known = true, .mark = mark}, path_);
  }
  // The next host, which finds this mark, and what of the run is in the file.
  void DiesAt(const v1::MachineMark& mark) {
    recording_ = Found(mark);
    file_.emplace(path_);
    inspect_job_ = mark.job();
    Make(mark.state(), !mark.clean(), mark.has_run_time_ns() ? std::optional(mark) : std::nullopt);
    host_->Begin(memory_, now_);
  }
  std::string Served(const std::string& job) {
    v1::HostOrder order;
    order.mutable_recording()->set_job(job);
    const v1::HostOrderAnswer answer = Do(order);
    return answer.has_recording() ? answer.recording().chunk() : answer.refusal().code();
  }
  std::string FileNow() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // Cut at each mark on the way, each is played again without a difference, and is over there.
  void CutAnywhere(std::chrono::milliseconds time) {
    std::vector<v1::MachineMark> marks;
    for (std::chrono::milliseconds gone{0}; gone < time; gone += 230ms) {
      Pass(230ms, 10ms);
      marks.push_back(WriteMark());
    }
    const std::string whole = FileNow();
    for (const v1::MachineMark& mark : marks) {
      ASSERT_EQ(mark.job(), "jobs/17");
      std::ofstream(path_, std::ios::binary | std::ios::trunc) << whole;
      const auto found = Found(mark);
      ASSERT_TRUE(found) << mark.run_time_ns();
      Recording cut = *recording::ReadFile(found->file);
      v1::JournalEntry& end = cut.entries.emplace_back();
      end.set_virtual_time_ns(mark.virtual_time_ns());
      end.mutable_run_over()->mutable_outcome()->set_kind(v1::Outcome::KIND_INTERRUPTED);
      int times = 0;
      recording::ReplayOptions options;
      options.cut_off = [&](const machine::RunOver& over, const v1::Outcome&) {
        ++times;
        EXPECT_EQ(over.lasted, SimTime(mark.run_time_ns()));
      };
      const auto played = recording::Replay(cut, options);
      ASSERT_TRUE(played) << played.error().detail;
      EXPECT_FALSE(played->difference) << mark.run_time_ns() << played->difference->field;
      EXPECT_EQ(times, 1) << mark.run_time_ns();
    }
  }

  std::string path_;
  std::optional<RecordingFile> file_;
  v1::HostMemory memory_;
};

// LIVE-3.40, LIVE-3.41: what the run did up to the mark is played again, and it is over there.
TEST_F(CutOffRecordingTest, ARunThatWasCutOffIsPlayedUpToItsMark) {
  v1::AssignedProgram& stored = *memory_.add_programs();  // its host is told of it when it begins
  stored.set_slot(9);
  stored.set_content(kSquare);
  Live();
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
  EXPECT_EQ(read->entries.back().run_over().program(), 5);
  std::vector<std::string> codes;
  recording::ReplayOptions options;
  options.cut_off = [&](const machine::RunOver& over, const v1::Outcome& outcome) {
    codes.push_back(outcome.code());
    EXPECT_EQ(over.lasted, SimTime(mark.run_time_ns()));
    EXPECT_EQ(outcome.kind(), v1::Outcome::KIND_INTERRUPTED);
  };
  const auto played = recording::Replay(*read, options);
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_FALSE(played->difference);
  EXPECT_THAT(codes, testing::ElementsAre("CELL-E9411"));
  EXPECT_EQ(played->until, SimTime(mark.virtual_time_ns()));
  EXPECT_GE(played->marks, 14);  // two a second
}

// LIVE-3.40: wherever it is cut, moving, at rest, held or waiting; a mill and a laser.
TEST_F(CutOffRecordingTest, WhereverItIsCut) {
  Live();
  BeginJob();
  CutAnywhere(5s);
  Do(Stop());
  CutAnywhere(3s);
  fs::remove(path_);
  file_.emplace(path_);
  MakeOptimo();
  BeginJob(
      "COORD ABSOL\nPATH PTP\nMOVE (0.,2000.,-400.,0.,0.)\nPATH LIN\nSPEED 10\nWORK 0,0/ON\n"
      "MOVE (100.,2000.,-400.,0.,0.)/FLY\nMOVE (100.,2100.,-400.,0.,0.)\nWORK 0,0/OFF\n"
      "OL[16] = ON\nDELAY 300\n",
      "A.S");
  CutAnywhere(20s);
}

// LIVE-3.40: the host that found it dies, too, before and behind its first mark.
TEST_F(CutOffRecordingTest, ItOutlivesTheNextHost) {
  Live();
  BeginJob();
  const v1::MachineMark mark = RunFor(3s);
  DiesAt(mark);
  DiesAt(mark);
  const std::string served = Served("jobs/17");
  v1::MachineMark next = WriteMark();
  ASSERT_EQ(next.job(), "jobs/17");
  EXPECT_EQ(FileNow(), served);
  next.set_fence(8);  // of this host, had it been given another one
  const auto again = Found(next);
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->whole);
  EXPECT_EQ(again->file, served);
}

// LIVE-5.09: a host that ends in order leaves it with the end of the run.
TEST_F(CutOffRecordingTest, AnOrderlyEndLeavesIt) {
  Live();
  BeginJob();
  RunFor(3s);
  host_->EndRun(now_);
  const auto left = Found(WriteMark());
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->whole);
  std::vector<std::string> codes;
  recording::ReplayOptions options;
  options.cut_off = [&](const machine::RunOver&, const v1::Outcome& outcome) {
    codes.push_back(outcome.code());
  };
  const auto played = recording::Replay(*recording::ReadFile(left->file), options);
  ASSERT_TRUE(played);
  EXPECT_THAT(codes, testing::ElementsAre("CELL-E9432"));
}

// LIVE-3.40: what is torn in front of the mark, of another run, or behind what is durable is none,
// and is gone: no later mark finds it.
TEST_F(CutOffRecordingTest, HalfOfOneIsNone) {
  Live();
  const v1::MachineMark before = WriteMark();
  BeginJob();
  const v1::MachineMark mark = RunFor(3s);
  const std::string whole = FileNow();
  const auto none = [&](const Recovered& found, const std::string& bytes) {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bytes;
    EXPECT_FALSE(RecoverRecording(found, path_));
    EXPECT_FALSE(fs::exists(path_));
  };
  v1::MachineMark of_another = mark;
  of_another.set_job("jobs/18");
  none({.known = true, .mark = of_another}, whole);
  v1::MachineMark later = mark;
  later.set_sequence(mark.sequence() + 1);
  none({.known = true, .mark = later}, whole);
  none({.known = true, .mark = mark}, whole.substr(0, whole.size() - 1));
  none({.known = true, .mark = before}, whole);
  none({.known = true, .mark = mark}, "no recording");
  fs::create_directory(path_);
  EXPECT_FALSE(Found(mark));
  fs::remove(path_);
  EXPECT_FALSE(Found(mark));
}

// LIVE-3.41: a run whose end is durable has its recording whatever the machine did behind it; the
// end of another run is not its own.
TEST_F(CutOffRecordingTest, ARunThatIsOverStaysAsItWas) {
  Live();
  BeginJob();
  ASSERT_TRUE(RunFor(120s).clean());
  const std::string whole = FileNow();
  RunFor(60s);
  EXPECT_EQ(FileNow(), whole);  // nothing of what comes behind its end
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(Start()).has_refusal());
  const v1::MachineMark later = RunFor(3s);
  ASSERT_FALSE(later.clean());
  ASSERT_EQ(later.job(), "");
  EXPECT_EQ(FileNow(), whole);
  DiesAt(later);
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  const Recording read = *recording::ReadFile(Served("jobs/17"));
  EXPECT_EQ(read.entries.back().run_over().outcome().kind(), v1::Outcome::KIND_COMPLETED);
  int times = 0;
  recording::ReplayOptions options;
  options.over = [&](const machine::RunOver& over) {
    ++times;
    EXPECT_EQ(over.outcome.kind, machine::OutcomeKind::kCompleted);
  };
  const auto played = recording::Replay(read, options);
  ASSERT_TRUE(played);
  EXPECT_FALSE(played->difference);
  EXPECT_EQ(times, 1);  // though nothing is recorded behind it
  WriteMark();
  EXPECT_EQ(recording::ReadFile(FileNow())->entries.size(), read.entries.size());
}

// LIVE-3.41: a run that an input ends has its report: who plays it stops there.
TEST_F(CutOffRecordingTest, ARunThatAnInputEndsIsPlayedToItsEnd) {
  Live();
  BeginJob();
  RunFor(3s);
  v1::HostOrder stop;
  stop.mutable_emergency_stop();
  Do(stop);
  RunFor(1s);
  int times = 0;
  recording::ReplayOptions options;
  options.over = [&](const machine::RunOver&) { ++times; };
  options.goes_on = [&](SimTime) { return times == 0; };
  const auto played = recording::Replay(*recording::ReadFile(Served("jobs/17")), options);
  ASSERT_TRUE(played);
  EXPECT_EQ(times, 1);
  EXPECT_FALSE(played->difference) << played->difference->field << played->difference->played;
}

}  // namespace
}  // namespace rmlcell::server
