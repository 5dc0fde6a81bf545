// The ends of what a live machine takes over its line, keeps and tells (live.md
// 3, 6, 7).
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <utility>

#include "server/base/this_computer.h"
#include "server/host/background.h"
#include "server/host/host_name.h"
#include "server/host/key_desk.h"
#include "server/host/machine_recorder.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class HostMachineBounds : public HostMachineTest {
 protected:
  std::int64_t BytesRecorded() {
    static_cast<void>(host_->TakeEntries(now_, true));
    v1::HostOrder order;
    order.mutable_recording();
    return Do(order).recording().total();
  }
  std::string WhyNo(const v1::HostOrder& order) { return Do(order).refusal().message(); }
  // As the process of a host does it, but on this thread.
  std::string WhyNoPreview(const v1::PreviewStartRequest& request) {
    v1::HostOrder order;
    *order.mutable_preview_start() = request;
    const auto task = host_->PreparePreview(order, now_);
    return task ? "" : task.error().detail;
  }
  v1::HostOrder BeatOf(std::int64_t sent_s, std::optional<std::int64_t> round_trip_s = {}) {
    v1::HostOrder order;
    v1::HeartbeatPanelRequest& beat = *order.mutable_panel_heartbeat();
    beat.set_control_token(token_);
    beat.set_number(++beats_);
    beat.mutable_sent()->set_seconds(sent_s);
    if (round_trip_s) beat.mutable_round_trip()->set_seconds(*round_trip_s);
    return order;
  }
  std::int64_t beats_ = 0;
};

// LIVE-3.27: an id has up to 64 characters; what halts acts, however long it
// is.
TEST_F(HostMachineBounds, OfTheIdOfARequest) {
  MakeAndTake();
  EXPECT_EQ(WhyNo(Start(std::string(65, 'i'))), "request_id is longer than 64 characters");
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(Do(Start(std::string(64, 'i'))).has_refusal());
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  v1::HostOrder stop = Stop();
  stop.mutable_stop()->set_request_id(std::string(65, 'i'));
  EXPECT_TRUE(Do(stop).has_halt());
  Pass(2s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
}

// LIVE-7.05: clocks may be any, from their first second on; their differences
// must fit.
TEST_F(HostMachineBounds, OfTheClockOfABeat) {
  MakeAndTake();
  const auto taken = [this](const v1::HostOrder& beat) { return Do(beat).has_heartbeat(); };
  EXPECT_TRUE(taken(BeatOf(0)));
  EXPECT_TRUE(taken(BeatOf(4'000'000'000)));
  EXPECT_THAT(WhyNo(BeatOf(4'000'000'001)), HasSubstr("sent"));
  EXPECT_THAT(WhyNo(BeatOf(-1)), HasSubstr("sent"));
  EXPECT_TRUE(taken(BeatOf(5, 0)));
  EXPECT_TRUE(taken(BeatOf(5, 4'000'000'000)));
  EXPECT_THAT(WhyNo(BeatOf(5, 4'000'000'001)), HasSubstr("round_trip"));
  EXPECT_THAT(WhyNo(BeatOf(5, -1)), HasSubstr("round_trip"));
}

// LIVE-5.01: whoever asks for one of the newest 16 jobs is told that it was
// begun here.
TEST_F(HostMachineBounds, OfTheJobsThatItKnows) {
  Make();
  host_->Begin({}, now_);
  const auto knows = [this](int job) {
    v1::HostOrder ask;
    ask.mutable_run_state();
    ask.set_for_job("jobs/" + std::to_string(job));
    return !Do(ask).has_refusal();
  };
  const auto run = [this](int job) {
    v1::HostOrder order = JobOf("PA;PA;", "nothing.rml");
    order.mutable_run_job()->mutable_job()->set_name("jobs/" + std::to_string(job));
    EXPECT_FALSE(Do(order).has_refusal());
    Pass(2s, 50ms);
    EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  };
  for (int job = 1; job <= 16; ++job) run(job);
  EXPECT_TRUE(knows(1));
  run(17);
  EXPECT_FALSE(knows(1));
  EXPECT_TRUE(knows(2));
  EXPECT_TRUE(knows(17));
}

// LIVE-3.40: a recording begins anew where the programs of a machine change,
// and not where it is told again what it has.
TEST_F(HostMachineBounds, OfARecordingThatGoesOn) {
  MakeAndTake();
  v1::HostMemory memory;
  v1::AssignedProgram& stored = *memory.add_programs();
  stored.set_slot(6);
  stored.set_content("PU0,0;");
  host_->Change(memory, now_);
  v1::HostOrder door;
  door.mutable_inputs()->set_control_token(token_);
  v1::MachineInput& input = *door.mutable_inputs()->add_inputs();
  for (int turn = 0; turn < 20; ++turn) {
    input.set_door_open(turn % 2 == 0);
    Do(door);
  }
  const std::int64_t before = BytesRecorded();
  host_->Change(memory, now_);
  EXPECT_GE(BytesRecorded(), before);
  stored.set_content("PU9,0;");
  host_->Change(memory, now_);
  EXPECT_LT(BytesRecorded(), before);
}

// LIVE-3.40: nor while a run is open, which is recorded as it began.
TEST_F(HostMachineBounds, OfARecordingWhoseRunIsOpen) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  v1::HostOrder order;
  order.mutable_override()->set_control_token(token_);
  for (int turn = 0; turn < 100; ++turn) {
    order.mutable_override()->set_override_percent(turn % 2 == 0 ? 90.0 : 80.0);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  const std::int64_t before = BytesRecorded();
  v1::HostMemory memory;
  memory.add_programs()->set_slot(6);
  memory.mutable_programs(0)->set_content("PU0,0;");
  host_->Change(memory, now_);
  EXPECT_GT(BytesRecorded(), before);
}

// LIVE-5.04: a run that was over before the store had its begin holds up no other one.
TEST_F(HostMachineBounds, OfABeginThatIsNotStored) {
  Make();
  host_->Begin({}, now_);
  stores_ = false;
  ASSERT_FALSE(Do(JobOf(kSquare, "square.rml")).has_refusal());
  ASSERT_TRUE(host_->waits_for_store());
  v1::HostOrder abort;
  abort.mutable_abort();
  ASSERT_FALSE(Do(abort).has_refusal());
  Pass(3s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(host_->waits_for_store());
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(2s, 50ms);
  EXPECT_GT(host_->StatusAt(now_).run().run_time_ns(), 0);
}

// LIVE-3.11: time may go slower than the clock, also behind a crash.
TEST_F(HostMachineBounds, OfTheFactorOfTime) {
  auto made = HostMachine::Make({.name = "machines/mill-1",
                                 .host = "workshop/2",
                                 .fence = 8,
                                 .family = families::FindFamily("rml1"),
                                 .profile = "srm-20",
                                 .factor = 0.5},
                                now_, [] { return std::string("token"); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  EXPECT_EQ(host_->StatusAt(now_).factor(), 0.5);
  Pass(2s);
  EXPECT_EQ(host_->StatusAt(now_).virtual_time_ns(), 1'000'000'000);
}

// LIVE-6.01: steps count from 1, and so do passes.
TEST_F(HostMachineBounds, OfTheStepOfAPreview) {
  MakeAndTake();
  v1::PreviewStartRequest request;
  EXPECT_THAT(WhyNoPreview(request), HasSubstr("none was started yet"));
  request.set_program(5);
  EXPECT_EQ(WhyNoPreview(request), "step: steps count from 1");
  request.mutable_step()->set_step(1);
  EXPECT_EQ(WhyNoPreview(request), "");
  request.set_occurrence(-1);
  EXPECT_EQ(WhyNoPreview(request), "occurrence: it counts from 1");
  request.set_occurrence(0);
  EXPECT_EQ(WhyNoPreview(request), "");
}

// LIVE-6.07: a tool of two cells is looked at; a thinner one would meet
// nothing.
TEST_F(HostMachineBounds, OfTheCellsOfAPart) {
  MakeAndTake();
  v1::PreviewStartRequest request;
  request.set_program(5);
  request.mutable_step()->set_step(8);
  v1::Milling& milling = *request.mutable_milling();
  milling.mutable_stock()->set_size_x_mm(20.0);
  milling.mutable_stock()->set_size_y_mm(20.0);
  milling.mutable_stock()->set_size_z_mm(5.0);
  milling.mutable_tool()->set_shape(v1::MillTool::SHAPE_FLAT);
  milling.mutable_tool()->set_diameter_mm(1.0);
  milling.set_cell_mm(0.5);
  EXPECT_EQ(WhyNoPreview(request), "");
  milling.set_cell_mm(0.625);
  EXPECT_THAT(WhyNoPreview(request), HasSubstr("or cells of 0.5 mm"));
}

// LIVE-3.24: of what one run says, a thousand are told; the next run says its
// own.
TEST_F(HostMachineBounds, OfWhatARunSays) {
  MakeOptimo();
  const auto said = [this] {
    int count = 0;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true))
      count += entry.event().has_message() ? 1 : 0;
    return count;
  };
  const auto run = [&](int times) {
    std::string text = "VI[1] = 0\n";
    text += "10 SETERR 5\nVI[1] = VI[1] + 1\nIF (VI[1] < " + std::to_string(times) + ") THEN 10\n";
    v1::HostOrder order = JobOf(text);
    order.mutable_run_job()->mutable_job()->mutable_run()->set_unzeroed(true);
    const v1::HostOrderAnswer answer = Do(order);
    EXPECT_FALSE(answer.has_refusal()) << answer.refusal().message();
    Pass(60s, 50ms);
    return said();
  };
  EXPECT_EQ(run(1'000), 1'000);
  EXPECT_EQ(run(1'001), 1'000);
  EXPECT_EQ(run(3), 3);
}

// LIVE-9.03: what is selected is what was started last.
TEST_F(HostMachineBounds, OfWhatIsSelected) {
  MakeAndTake();
  v1::HostOrder order = Start();
  order.mutable_start()->set_selected(true);
  EXPECT_EQ(WhyNo(order), "selected: no program was started yet; name one");
  v1::HostMemory memory;
  memory.add_programs()->set_slot(1);
  memory.mutable_programs(0)->set_content("PA;PA;VS10;PU100,0;");
  host_->Change(memory, now_);
  for (const int program : {5, 1}) {
    Do(Start("", program));
    Pass(3min, 50ms);
    ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    order.mutable_start()->set_control_token(token_);
    EXPECT_EQ(Do(order).status().run().program(), program);
    Pass(3min, 50ms);
    ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  }
}

// LIVE-7.02: where no session is open nobody presses.
TEST_F(HostMachineBounds, OfASessionThatIsClosed) {
  MakeOptimo();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const std::string session = Do(open).session().name();
  EXPECT_EQ(host_->Handbox()->holder(), "anna");
  v1::HostOrder close;
  close.mutable_delete_session()->set_name(session);
  EXPECT_TRUE(Do(close).has_status());
  EXPECT_EQ(host_->Handbox()->holder(), "");
  v1::HostOrder key;
  key.mutable_key()->set_session("machines/optimo-1/handboxSessions/0");
  key.mutable_key()->set_control_token(token_);
  key.mutable_key()->set_key("MODE_LEFT");
  key.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  key.mutable_key()->set_sequence(1);
  EXPECT_EQ(Do(key).refusal().code(), "CELL-E9004");
}

v1::HostOrderAnswer KeyAnswer(std::int64_t number) {
  v1::HostOrderAnswer answer;
  answer.set_number(number);
  return answer;
}

// LIVE-7.04: a key that has acted waits for nothing, also when its answer is
// not kept any more; and one that is taken twice holds up none behind it.
TEST(KeyDeskBounds, OfTheNewestThatHasActed) {
  KeyDesk desk;
  desk.Take(1, KeyAnswer(1));
  desk.Take(1, KeyAnswer(1));
  desk.Take(2, KeyAnswer(2));
  EXPECT_EQ(desk.Look(3, false), KeyDesk::Turn::kActs);
  for (std::int64_t number = 4; number < 4 + 64; ++number) desk.Take(number, KeyAnswer(number));
  EXPECT_EQ(desk.Look(2, false), KeyDesk::Turn::kTooLate);
  EXPECT_EQ(desk.Look(3, false), KeyDesk::Turn::kActs);
}

// LIVE-7.05: what was released is let go once.
TEST(KeyDeskBounds, OfWhatIsLetGo) {
  const HostTime now{.steady = 1h, .wall = WallTime(24h)};
  DeadMan dead_man;
  dead_man.Press("X+", now);
  dead_man.Press("Y-", now);
  EXPECT_TRUE(dead_man.Hear(1, {}, now.wall.time_since_epoch(), now));
  dead_man.Release("X+");
  EXPECT_THAT(dead_man.LetGo(now), testing::ElementsAre("Y-"));
}

// LIVE-7.06: what a slow line has stopped must be released before it moves
// again.
TEST(KeyDeskBounds, OfWhatIsLost) {
  const HostTime now{.steady = 1h, .wall = WallTime(24h)};
  DeadMan dead_man;
  for (const char* key : {"X+", "Y-"}) dead_man.Press(key, now);
  dead_man.Lose();
  EXPECT_TRUE(dead_man.IsStopped("X+"));
  EXPECT_TRUE(dead_man.IsStopped("Y-"));
  EXPECT_THAT(dead_man.LetGo(now), testing::ElementsAre("X+", "Y-"));
  dead_man.Release("X+");
  EXPECT_FALSE(dead_man.IsStopped("X+"));
  EXPECT_TRUE(dead_man.IsStopped("Y-"));
}

// The pid of a process comes again in one boot: no two hosts have the same
// name.
TEST(NamesOfHosts, DifferEachTime) {
  const std::string name = NameOfHost();
  EXPECT_NE(NameOfHost(), name);
  EXPECT_THAT(name, HasSubstr("/" + std::to_string(::getpid()) + "/"));
  // Computer, process, boot and eight digits more, as "workshop/4711/5f3a09c1b06e77d2".
  const std::string begin =
      NameOfComputer() + "/" + std::to_string(::getpid()) + "/" + NameOfBoot();
  EXPECT_EQ(name.substr(0, begin.size()), begin);
  EXPECT_EQ(name.size(), begin.size() + 8);
}

// LIVE-6.01: what takes a while gives way to the machine.
TEST(BackgroundOfAHost, GivesWay) {
  const int before = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
  int nice = -100;
  {
    Background background;
    EXPECT_TRUE(background.Do([&nice](const std::stop_token&) {
      nice = ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()));
    }));
    EXPECT_FALSE(background.Do([](const std::stop_token&) {}));
  }
  EXPECT_EQ(nice, std::max(before, 10));
  EXPECT_EQ(::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())), before);
}

class RecorderBounds : public testing::Test {
 protected:
  static constexpr auto kMost = static_cast<std::int64_t>(MachineRecorder::kBytesMax);

  static machine::MachineMemory MemoryOf(std::size_t object, std::size_t executable) {
    machine::MachineMemory memory;
    machine::StoredProgram program{.name = "a",
                                   .object = machine::Bytes::Of(std::string(object, 'o'))};
    if (executable > 0) program.executable = machine::Bytes::Of(std::string(executable, 'e'));
    memory.programs[5] = std::move(program);
    return memory;
  }
  void Begin(const std::string& job, std::size_t brought = 0,
             const machine::MachineMemory& memory = {}) {
    v1::MachineRecording head;
    head.set_job(job);
    if (brought > 0) head.mutable_brought()->set_content(std::string(brought, 'b'));
    v1::JournalEntry mark;
    mark.set_sequence(1);
    mark.mutable_mark()->set_state("state");
    recorder_.Begin(std::move(head), memory, mark);
  }
  Result<v1::HostRecordingPart> Part(const std::string& job, std::int64_t offset = 0) {
    v1::HostRecordingRequest request;
    request.set_job(job);
    request.set_offset(offset);
    return recorder_.Part(request);
  }
  // Of the newest.
  std::int64_t Total() { return Part("")->total(); }
  void Tell(std::size_t bytes) {
    v1::JournalEntry entry;
    entry.mutable_event()->mutable_message()->set_text(std::string(bytes, 't'));
    recorder_.Add(entry);
  }
  MachineRecorder recorder_;
};

// LIVE-3.40: the newest eight.
TEST_F(RecorderBounds, OfSoManyRecordings) {
  for (int job = 1; job <= 8; ++job) Begin("jobs/" + std::to_string(job));
  EXPECT_TRUE(Part("jobs/1"));
  Begin("jobs/9");
  EXPECT_EQ(Part("jobs/1").error().code, ErrorCode::kCellNotFound);
  EXPECT_TRUE(Part("jobs/2"));
  EXPECT_TRUE(Part("jobs/9"));
}

// Programs, their executables and what a job brings: 64 MiB together, to the
// byte.
TEST_F(RecorderBounds, OfThePrograms) {
  constexpr std::size_t kBytes = MachineRecorder::kBytesMax;
  Begin("jobs/1", 500, MemoryOf(kBytes - 800, 301));
  const auto none = Part("jobs/1");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().detail, "the programs were too large to be recorded");
  EXPECT_FALSE(recorder_.TakeFresh().begins);
  Begin("jobs/2", 500, MemoryOf(kBytes - 800, 300));
  EXPECT_TRUE(Part("jobs/2"));
  EXPECT_TRUE(recorder_.TakeFresh().begins);
}

// What comes behind 64 MiB is not recorded.
TEST_F(RecorderBounds, OfWhatHappened) {
  Begin("jobs/1");
  const std::int64_t empty = Total();
  Tell(10);
  const std::int64_t around = Total() - empty - 10;  // a text that is short
  Tell(static_cast<std::size_t>(kMost - Total() - 120));
  Tell(static_cast<std::size_t>(kMost - Total() - around));
  ASSERT_EQ(Total(), kMost);
  Tell(5);
  const std::int64_t beyond = Total();
  EXPECT_GT(beyond, kMost);
  Tell(5);
  EXPECT_EQ(Total(), beyond);
}

}  // namespace
}  // namespace rmlcell::server
