// A machine as its host has it: orders, answers, journal and marks, by a clock of the test.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// LIVE-4.04: what moves the machine asks for control, what stops it does not.
TEST_F(HostMachineTest, ControlIsNeededToMoveAndNotToStop) {
  Make();
  EXPECT_EQ(Do(Start()).refusal().code(), "CELL-E9420");
  token_ = "guessed";
  EXPECT_EQ(Do(Start()).refusal().code(), "CELL-E9420");
  Control();
  EXPECT_EQ(Do(Start()).status().state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Do(Stop()).halt().status().state(), v1::MACHINE_STATE_STOPPING);
  const v1::HostOrderAnswer refused = Do(Start());
  EXPECT_EQ(refused.refusal().code(), "CELL-E9421");
  EXPECT_EQ(refused.machine_refusal().state(), v1::MACHINE_STATE_STOPPING);
  EXPECT_EQ(refused.machine_refusal().control_holder(), "anna");
}

// LIVE-2.01, LIVE-3.16, LIVE-2.14: each thing in a field of its own, with units; a mill in the
// middle of a cut of 1 mm/s.
TEST_F(HostMachineTest, TheStatusTellsAllOfIt) {
  Make();
  v1::MachineStatus status = host_->StatusAt(now_);
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(status.has_run());
  EXPECT_EQ(status.words().execution(), "READY");
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  Do(Start());
  Pass(30s, 50ms);
  status = host_->StatusAt(now_);
  EXPECT_EQ(status.machine(), "machines/mill-1");
  EXPECT_EQ(status.fence(), 7);
  EXPECT_EQ(status.virtual_time_ns(), 30'000'000'000);
  EXPECT_EQ(status.send_time().seconds(), now_.wall.time_since_epoch() / 1s);
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(status.mode(), v1::OPERATING_MODE_REMOTE);
  EXPECT_TRUE(status.zeroed());
  EXPECT_FALSE(status.door_open());
  EXPECT_EQ(status.alarms_size(), 0);
  EXPECT_EQ(status.run().run(), 1);
  EXPECT_EQ(status.run().program(), 5);
  EXPECT_EQ(status.run().place().step(), 8);
  EXPECT_EQ(status.run().phase(), v1::RUN_PHASE_PROGRAM);
  EXPECT_EQ(status.run().run_time_ns(), 30'000'000'000);
  EXPECT_EQ(status.run().source(), v1::START_SOURCE_CONSOLE);
  EXPECT_NE(status.run().instruction(), "");
  EXPECT_FALSE(status.run().waits());
  EXPECT_EQ(status.hold_reason(), v1::HOLD_REASON_UNSPECIFIED);
  EXPECT_EQ(status.control().holder(), "anna");
  ASSERT_EQ(status.axes_size(), 4);
  EXPECT_EQ(status.axes(0).axis(), "X");
  EXPECT_EQ(status.axes(0).unit(), v1::UNIT_MILLIMETRE);
  EXPECT_EQ(status.axes(3).unit(), v1::UNIT_RADIAN);
  EXPECT_NEAR(status.speed_mm_s(), 1.0, 1e-9);
  EXPECT_EQ(status.position_source(), v1::POSITION_SOURCE_PLANNED);
  EXPECT_EQ(status.override_percent(), 100.0);
  EXPECT_EQ(status.factor(), 1.0);
  EXPECT_EQ(status.host(), "workshop/1");
  EXPECT_EQ(status.words().execution(), "ACTIVE");
  EXPECT_EQ(status.words().item_state(), "Executing");
  // A second later it is a millimetre further, along one axis.
  Pass(1s, 50ms);
  const v1::MachineStatus later = host_->StatusAt(now_);
  const double x = later.axes(0).value() - status.axes(0).value();
  const double y = later.axes(1).value() - status.axes(1).value();
  EXPECT_NEAR(std::abs(x) + std::abs(y), 1.0, 1e-6);
}

// LIVE-2.02, LIVE-3.23: a run from its start to its end, held and resumed, with what is told of it;
// a mark where it stands.
TEST_F(HostMachineTest, ARunIsToldFromItsStartToItsEnd) {
  Make();
  EXPECT_THAT(Told(), ElementsAre("clean mark"));
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  Do(Start());
  EXPECT_THAT(Told(), ElementsAre(Input(v1::AppliedInput::kControl),
                                  Input(v1::AppliedInput::kStart), "begun", "mark"));
  Pass(500ms);
  EXPECT_THAT(Told(), ElementsAre());
  Do(Stop());
  Pass(2s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_STOP);
  EXPECT_THAT(Told(), ElementsAre(Input(v1::AppliedInput::kStop), "halted", "mark"));
  Pass(1s);
  EXPECT_THAT(Told(), ElementsAre());
  Do(Resume());
  EXPECT_EQ(Told().front(), Input(v1::AppliedInput::kResume));
  EXPECT_FALSE(host_->StatusAt(now_).has_last_run());
  Pass(3min, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const v1::LastRun last = host_->StatusAt(now_).last_run();
  EXPECT_EQ(last.run(), 1);
  EXPECT_EQ(last.program(), 5);
  EXPECT_EQ(last.outcome().kind(), v1::Outcome::KIND_COMPLETED);
  const std::vector<std::string> told = Told();
  EXPECT_THAT(told, testing::Contains("over KIND_COMPLETED"));
  EXPECT_EQ(told.back(), "clean mark");
}

// LIVE-5.10, LIVE-2.10 a1: who takes its power away cuts a run off; a person looks before the next.
TEST_F(HostMachineTest, PowerThatGoesCutsARunOff) {
  Make();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  Do(Start());
  Pass(7s, 50ms);
  const auto power = [this](bool on) {
    v1::HostOrder order;
    order.mutable_inputs()->set_control_token(token_);
    order.mutable_inputs()->add_inputs()->set_power(on);
    return Do(order);
  };
  power(false);
  EXPECT_EQ(State(), v1::MACHINE_STATE_OFF);
  EXPECT_THAT(Told(), testing::Contains("over KIND_INTERRUPTED"));
  EXPECT_FALSE(mark_.clean());
  power(true);
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_GT(host_->StatusAt(now_).cut_off_at().step(), 0);
  EXPECT_EQ(Do(Start()).refusal().code(), "CELL-E9409");
  v1::HostOrder confirm;
  confirm.mutable_confirm()->set_control_token(token_);
  confirm.mutable_confirm()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  EXPECT_FALSE(Do(confirm).has_refusal());
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  power(false);  // no run is open
  power(true);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-3.16: what is on, and that it waits; a mill has no outputs, but a spindle.
TEST_F(HostMachineTest, TheStatusHasOutputsAndWaits) {
  auto made = HostMachine::Make({.name = "machines/optimo-1",
                                 .host = "workshop/1",
                                 .fence = 7,
                                 .family = families::FindFamily("optimo")},
                                now_, [this] { return "token " + std::to_string(++tokens_); });
  ASSERT_TRUE(made);
  host_ = *std::move(made);
  v1::HostOrder job;
  v1::WorkerAssignment& assignment = *job.mutable_run_job();
  assignment.mutable_job()->set_name("jobs/17");
  assignment.set_main_program(5);
  v1::AssignedProgram& program = *assignment.add_programs();
  program.set_slot(5);
  program.set_file_name("a.S");
  program.set_is_source(true);
  program.set_content("DELAY 5\nOL[3] = ON\nOA[1] = 2.5\nWAIT IL[20]\n");
  // LIVE-5.02, OPT-6.14: SIMUL that is armed would have the job count without a cut.
  const auto simulation = [this](int step) {
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    v1::HostOrder order;
    order.mutable_simulation()->set_control_token(token_);
    if (step > 0) order.mutable_simulation()->mutable_until()->set_program(5);
    if (step > 0) order.mutable_simulation()->mutable_until()->set_step(step);
    EXPECT_FALSE(Do(order).has_refusal());
    v1::HostOrder release;
    release.mutable_release_control()->set_control_token(token_);
    Do(release);
  };
  simulation(3);
  EXPECT_EQ(Do(job).refusal().code(), "CELL-E9421");
  simulation(0);
  ASSERT_FALSE(Do(job).has_refusal());
  Pass(1s);
  EXPECT_TRUE(host_->StatusAt(now_).run().waits());
  EXPECT_EQ(host_->StatusAt(now_).outputs_size(), 0);
  Pass(5s);
  const v1::MachineStatus status = host_->StatusAt(now_);
  EXPECT_TRUE(status.run().waits());
  ASSERT_EQ(status.outputs_size(), 2);
  EXPECT_EQ(status.outputs(0).name(), "OL[3]");
  EXPECT_EQ(status.outputs(0).value(), 1.0);
  EXPECT_EQ(status.outputs(1).name(), "OA[1]");
  EXPECT_EQ(status.outputs(1).value(), 2.5);
}

// LIVE-3.22: one order. What fails as soon as it begins was begun before; so with a job.
TEST_F(HostMachineTest, ARunBeginsBeforeAnythingIsToldOfIt) {
  machine::MachineMemory memory;
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  memory.programs[5] = {.name = "a", .object = machine::Bytes::Of("no object")};
  auto made = HostMachine::Make({.name = "machines/optimo-1",
                                 .host = "workshop/1",
                                 .fence = 7,
                                 .family = &family,
                                 .memory = std::move(memory)},
                                now_, [this] { return "token " + std::to_string(++tokens_); });
  ASSERT_TRUE(made);
  host_ = *std::move(made);
  Control();
  Told();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(100ms);
  EXPECT_THAT(Told(), ElementsAre(Input(v1::AppliedInput::kStart), "begun", "event",
                                  "over KIND_FAILED", "clean mark"));
}

// LIVE-3.16: since when there is an alarm, by the clock on the wall.
TEST_F(HostMachineTest, AnAlarmSaysSinceWhen) {
  Make();
  Pass(1s);
  const WallTime pressed = now_.wall;
  v1::HostOrder order;
  order.mutable_emergency_stop();
  Do(order);
  Pass(3s);
  const v1::MachineStatus status = host_->StatusAt(now_);
  ASSERT_EQ(status.alarms_size(), 1);
  EXPECT_EQ(status.alarms(0).time().seconds(), Stamp(pressed).seconds());
}

// LIVE-4.01: control leases are counted on by the next host.
TEST_F(HostMachineTest, ControlLeasesAreCountedOn) {
  Make();
  Control();
  Told();
  EXPECT_EQ(mark_.control_lease(), 1);
  control_lease_ = 41;
  Make();
  Control();
  EXPECT_EQ(host_->StatusAt(now_).control().number(), 42);
}

// LIVE-3.23: moving, it says every second where it is.
TEST_F(HostMachineTest, MovingItMarksEverySecond) {
  Make();
  Control();
  Do(Start());
  static_cast<void>(Told());
  int marks = 0;
  for (int i = 0; i < 100; ++i) {
    Pass(50ms);
    for (const std::string& one : Told()) marks += one == "mark" ? 1 : 0;
  }
  EXPECT_EQ(marks, 5);
  EXPECT_TRUE(mark_.has_run_time_ns());
  EXPECT_EQ(mark_.place().program(), 5);
  EXPECT_EQ(mark_.state_sha256().size(), 32U);
  EXPECT_EQ(mark_.fence(), 7);
  EXPECT_EQ(mark_.sequence(), sequence_);
  EXPECT_EQ(mark_.virtual_time_ns(), host_->StatusAt(now_).virtual_time_ns());
}

// LIVE-3.26: whatever happens while it moves, what was told goes to the disk ten times a second,
// one write for all of it; what asks for an answer goes at once.
TEST_F(HostMachineTest, MovingItWritesTenTimesASecond) {
  Make();
  Control();
  Do(Start());
  Pass(5s);
  static_cast<void>(host_->TakeEntries(now_, true));
  int writes = 0;
  int told = 0;
  v1::HostOrder stop;
  stop.mutable_stop();
  for (int i = 0; i < 400; ++i) {
    // STOP and its taking back act first, and are written behind.
    if (i % 4 == 0) Do(stop);
    if (i % 4 == 1) Do(Resume());
    Pass(5ms, 5ms);
    const auto entries = host_->TakeEntries(now_, false);
    if (!entries.empty()) ++writes;
    told += static_cast<int>(entries.size());
  }
  EXPECT_GE(told, 200);
  EXPECT_LE(writes, 21);  // of 2 s
  EXPECT_GE(writes, 18);
  Do(Resume());
  EXPECT_FALSE(host_->TakeEntries(now_, true).empty());
}

// LIVE-3.27: a repeated request gets the first answer and acts no more.
TEST_F(HostMachineTest, ARepeatedRequestActsOnce) {
  Make();
  Control();
  const v1::HostOrderAnswer first = Do(Start("one"));
  Do(Stop());
  Pass(2s);
  static_cast<void>(Told());
  v1::HostOrderAnswer again = Do(Start("one"));
  again.set_number(first.number());
  EXPECT_EQ(again.SerializeAsString(), first.SerializeAsString());
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_THAT(Told(), ElementsAre());
  // A refusal is an answer, too.
  EXPECT_TRUE(Do(Start("two")).has_refusal());
  v1::HostOrder abort;
  abort.mutable_abort()->set_request_id("three");
  EXPECT_EQ(Do(abort).status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_TRUE(Do(Start("two")).has_refusal());
  EXPECT_FALSE(Do(Start("four")).has_refusal());
}

// LIVE-3.30, LIVE-5.10: a run that was cut off is not gone on with; a person decides.
TEST_F(HostMachineTest, WhatWasCutOffWaitsForAPerson) {
  Make();
  Control();
  Do(Start());
  Pass(10s);
  static_cast<void>(Told());
  EXPECT_FALSE(mark_.clean());
  const v1::MachineMark cut_off = mark_;
  const v1::Point tip = host_->StatusAt(now_).tip();
  Make(cut_off.state(), true, cut_off);
  sequence_ = 0;
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_THAT(host_->StatusAt(now_).confirmations_due(), ElementsAre(v1::CONFIRMATION_INSPECTED));
  EXPECT_FALSE(host_->StatusAt(now_).has_run());
  EXPECT_NEAR(host_->StatusAt(now_).tip().x(), tip.x(), 0.011);  // 1 mm/s, a mark within 10 ms
  // How the run ended is told once: the next mark, again one that is not clean, is in no run.
  EXPECT_THAT(Told(), ElementsAre("over KIND_INTERRUPTED", "mark"));
  EXPECT_FALSE(mark_.has_run_time_ns());
  Control();
  EXPECT_EQ(Do(Start()).refusal().code(), "CELL-E9409");
  EXPECT_EQ(Do(Resume()).refusal().code(), "CELL-E9409");
  v1::HostOrder confirm;
  confirm.mutable_confirm()->set_control_token(token_);
  EXPECT_EQ(Do(confirm).refusal().code(), "CELL-E9409");
  confirm.mutable_confirm()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  EXPECT_EQ(Do(confirm).status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Told().back(), "clean mark");
  EXPECT_EQ(Do(Start()).status().state(), v1::MACHINE_STATE_RUNNING);
}

// LIVE-4.02: control that runs out holds the run, or lets it go on, as the lease says. A mill comes
// to rest where its HOLD does, at the end of a side of the square.
TEST_F(HostMachineTest, ControlThatIsLostHoldsTheRunOrNot) {
  for (const v1::ControlLease::OnLoss on_loss :
       {v1::ControlLease::ON_LOSS_HOLD, v1::ControlLease::ON_LOSS_GO_ON}) {
    Make();
    Control(on_loss);
    v1::HostOrder factor;
    factor.mutable_factor()->set_control_token(token_);
    factor.mutable_factor()->set_factor(0.1);
    Do(factor);
    Do(Start());
    Pass(59s, 50ms);
    EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
    Pass(10s, 50ms);
    const v1::MachineStatus status = host_->StatusAt(now_);
    EXPECT_FALSE(status.has_control());
    if (on_loss == v1::ControlLease::ON_LOSS_HOLD) {
      EXPECT_EQ(status.state(), v1::MACHINE_STATE_STOPPING);
      EXPECT_EQ(status.hold_reason(), v1::HOLD_REASON_CONTROL);
      Pass(250s, 50ms);
      const v1::MachineStatus held = host_->StatusAt(now_);
      EXPECT_EQ(held.state(), v1::MACHINE_STATE_HELD);
      EXPECT_EQ(held.hold_reason(), v1::HOLD_REASON_CONTROL);
      EXPECT_NEAR(std::abs(held.tip().x() - 20.0), 10.0, 1e-6);
      EXPECT_NEAR(std::abs(held.tip().y() - 20.0), 10.0, 1e-6);
    } else {
      EXPECT_EQ(status.state(), v1::MACHINE_STATE_RUNNING);
    }
  }
}

// LIVE-3.11: twice as fast is the same way in half the time.
TEST_F(HostMachineTest, TimeGoesByItsFactor) {
  Make();
  Control();
  const std::int64_t begin = host_->StatusAt(now_).virtual_time_ns();
  Pass(1s);
  EXPECT_EQ(host_->StatusAt(now_).virtual_time_ns() - begin, 1'000'000'000);
  v1::HostOrder factor;
  factor.mutable_factor()->set_control_token(token_);
  factor.mutable_factor()->set_factor(10.0);
  EXPECT_EQ(Do(factor).status().factor(), 10.0);
  Pass(1s);
  EXPECT_EQ(host_->StatusAt(now_).virtual_time_ns() - begin, 11'000'000'000);
  factor.mutable_factor()->set_factor(100.1);
  EXPECT_EQ(Do(factor).refusal().code(), "CELL-E9003");
}

// LIVE-9.07: all of them or none, each with what is wrong with it.
TEST_F(HostMachineTest, VariablesAreReadAndNotWrittenOnAMill) {
  Make();
  v1::HostOrder read;
  read.mutable_read_variables()->add_variables("Z1");
  read.mutable_read_variables()->add_variables("NONE");
  const v1::ReadVariablesResponse values = Do(read).variables();
  ASSERT_EQ(values.variables_size(), 2);
  EXPECT_TRUE(values.variables(0).has_value());
  EXPECT_EQ(values.variables(1).error().code(), "CELL-E9003");
  EXPECT_EQ(values.fence(), 7);
  Control();
  v1::HostOrder write;
  write.mutable_write_variables()->set_control_token(token_);
  write.mutable_write_variables()->add_variables()->set_name("Z1");
  write.mutable_write_variables()->mutable_variables(0)->mutable_value()->set_real(3.0);
  EXPECT_FALSE(Do(write).written().variables(0).error().code().empty());
}

// LIVE-3.15, LIVE-3.11: how a host divides time changes nothing that is told of a run.
TEST_F(HostMachineTest, HowTimeIsDividedChangesNothing) {
  std::vector<std::string> first;
  std::string state;
  for (const std::chrono::milliseconds step : {5ms, 10ms, 20ms, 50ms}) {
    now_.steady = 1h;
    Make();
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    Do(Start());
    std::vector<std::string> told;
    Pass(3min, step);
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_)) {
      if (entry.has_run_over()) told.push_back(entry.run_over().SerializeAsString());
    }
    ASSERT_EQ(told.size(), 1U);
    const v1::MachineStatus status = host_->StatusAt(now_);
    const std::string stands = status.tip().SerializeAsString();
    if (first.empty()) {
      first = told;
      state = stands;
    }
    EXPECT_EQ(told, first) << step.count();
    EXPECT_EQ(stands, state) << step.count();
  }
}

// LIVE-10.01, LIVE-2.04: whatever comes, only a machine that runs or stops moves, and time never
// falls.
TEST_F(HostMachineTest, RandomOrdersKeepTheInvariants) {
  std::mt19937 random(1);
  for (int round = 0; round < 30; ++round) {
    Make();
    Control();
    std::int64_t before = 0;
    for (int i = 0; i < 200; ++i) {
      const v1::MachineStatus was = host_->StatusAt(now_);
      v1::HostOrder order;
      switch (random() % 9) {
        case 0:
          order = Start();
          break;
        case 1:
          order = Resume();
          break;
        case 2:
          order = Stop();
          break;
        case 3:
          order.mutable_hold();
          break;
        case 4:
          order.mutable_abort();
          break;
        case 5:
          order.mutable_emergency_stop();
          break;
        case 6:
          order.mutable_acknowledge_alarm()->set_control_token(token_);
          order.mutable_acknowledge_alarm()->set_alarm_id(
              was.alarms().empty() ? 1 : was.alarms(0).id());
          break;
        case 7: {
          order.mutable_inputs()->set_control_token(token_);
          v1::MachineInput& input = *order.mutable_inputs()->add_inputs();
          if (random() % 2 == 0) {
            input.set_emergency_stop_released(true);
          } else {
            input.set_door_open(random() % 2 == 0);
          }
          break;
        }
        default:
          order.mutable_mode()->set_control_token(token_);
          order.mutable_mode()->set_mode(random() % 2 == 0 ? v1::OPERATING_MODE_REMOTE
                                                           : v1::OPERATING_MODE_CYCLE);
      }
      Do(order);
      Pass(std::chrono::milliseconds(10 * (random() % 30)));
      const v1::MachineStatus is = host_->StatusAt(now_);
      ASSERT_GE(is.virtual_time_ns(), before);
      before = is.virtual_time_ns();
      const bool moves =
          is.state() == v1::MACHINE_STATE_RUNNING || is.state() == v1::MACHINE_STATE_STOPPING;
      if (!moves) {
        ASSERT_EQ(is.speed_mm_s(), 0.0) << v1::MachineState_Name(is.state());
      }
      ASSERT_EQ(is.has_run(), moves || is.state() == v1::MACHINE_STATE_HELD);
      ASSERT_EQ(is.alarms().empty(), is.state() != v1::MACHINE_STATE_ALARM);
      Control();  // goes on having it
      v1::HostOrder take;
      take.mutable_acquire_control()->set_take_over(true);
      take.mutable_acquire_control()->set_reason("a test");
      take.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
      token_ = Do(take).control().control_token();
    }
  }
}

}  // namespace
}  // namespace rmlcell::server
