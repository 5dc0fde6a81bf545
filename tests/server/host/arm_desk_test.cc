// Jobs that a person starts, or arms their machine for (live.md 5.04, devices.md 1.41).
#include "server/host/arm_desk.h"

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ArmTest : public HostMachineTest {
 protected:
  void MakeWith(v1::MachineOptions::Start start) {
    options_.set_start(start);
    Make();
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  }
  v1::HostOrder Arm(const std::string& job = "", int seconds = 0) {
    v1::HostOrder order;
    v1::ArmMachineRequest& arm = *order.mutable_arm();
    arm.set_control_token(token_);
    arm.set_request_id("arm " + std::to_string(++arms_));
    arm.set_job(job);
    for (const auto one : {v1::CONFIRMATION_TOOL, v1::CONFIRMATION_ORIGIN_VALID,
                           v1::CONFIRMATION_CLAMPS, v1::CONFIRMATION_COVER})
      arm.add_confirmations(one);
    if (seconds > 0) arm.mutable_armed_for()->set_seconds(seconds);
    return order;
  }
  static v1::HostOrder Job(const std::string& name = "jobs/17") {
    v1::HostOrder order;
    order.set_caller("anna");
    v1::WorkerAssignment& assignment = *order.mutable_run_job();
    assignment.mutable_job()->set_name(name);
    assignment.set_main_program(5);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(5);
    program.set_file_name("a.rml");
    program.set_is_source(true);
    program.set_content(kSquare);
    return order;
  }
  v1::HostOrder ByPerson(const std::string& arm_token, const std::string& name = "jobs/17") {
    v1::HostOrder order = Job(name);
    order.mutable_by_person()->set_control_token(token_);
    order.mutable_by_person()->set_request_id("start " + std::to_string(++arms_));
    order.mutable_by_person()->set_arm_token(arm_token);
    return order;
  }
  std::string Code(const v1::HostOrder& order) { return Do(order).refusal().code(); }
  bool IsArmed() { return host_->StatusAt(now_).has_armed_until(); }
  std::vector<std::string> Blockers() {
    std::vector<std::string> codes;
    const v1::MachineStatus status = host_->StatusAt(now_);
    for (const v1::StartBlocker& one : status.start_blockers()) {
      if (one.code() != "CELL-E9408") codes.push_back(one.code());
    }
    return codes;
  }
  int arms_ = 0;
};

// LIVE-5.04: where a person starts jobs, the queue does not.
TEST_F(ArmTest, APersonStartsTheJob) {
  MakeWith(v1::MachineOptions::START_PERSON);
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9423"));
  EXPECT_EQ(Code(Job()), "CELL-E9423");
  EXPECT_EQ(Code(Arm()), "CELL-E9424");
  v1::HostOrder stranger = ByPerson("");
  stranger.mutable_by_person()->set_control_token("none");
  EXPECT_EQ(Code(stranger), "CELL-E9420");
  EXPECT_EQ(Do(ByPerson("")).status().run().job(), "jobs/17");
}

// LIVE-5.02 (a): whoever is refused is told all that is in his way: that the queue starts nothing
// here is in the way of its jobs alone.
TEST_F(ArmTest, WhatKeepsTheQueueAloneKeepsNoPerson) {
  MakeWith(v1::MachineOptions::START_PERSON);
  v1::HostOrder mode;
  mode.mutable_mode()->set_mode(v1::OPERATING_MODE_MANUAL);
  mode.mutable_mode()->set_control_token(token_);
  ASSERT_FALSE(Do(mode).has_refusal());
  const auto in_the_way = [this](const v1::HostOrder& order) {
    const v1::HostOrderAnswer answer = Do(order);
    EXPECT_EQ(answer.refusal().code(), "CELL-E9423");
    std::vector<std::string> why;
    for (const v1::StartBlocker& one : answer.start_blockers()) why.push_back(one.message());
    return why;
  };
  const auto no_remote = HasSubstr("jobs run in REMOTE alone");
  EXPECT_THAT(in_the_way(ByPerson("")), ElementsAre(no_remote));
  EXPECT_THAT(in_the_way(Start("a start")), ElementsAre(no_remote));
  EXPECT_THAT(in_the_way(Job()),
              ElementsAre(no_remote, HasSubstr("a person starts each job here")));
}

// LIVE-5.04, LIVE-9.13: armed for one job, it starts; then it is armed for none.
TEST_F(ArmTest, TheQueueStartsWhatItIsArmedFor) {
  MakeWith(v1::MachineOptions::START_ARMED);
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9406"));
  EXPECT_EQ(Code(Job()), "CELL-E9406");
  v1::HostOrder careless = Arm("jobs/17");
  careless.mutable_arm()->clear_confirmations();
  EXPECT_THAT(Do(careless).refusal().message(), HasSubstr("CONFIRMATION_TOOL"));
  ASSERT_NE(Do(Arm("jobs/17")).armed().arm_token(), "");
  EXPECT_THAT(Blockers(), IsEmpty());
  EXPECT_EQ(host_->StatusAt(now_).armed_by(), "anna");
  EXPECT_EQ(host_->StatusAt(now_).armed_for(), "jobs/17");
  EXPECT_EQ(Code(Job("jobs/18")), "CELL-E9406");
  EXPECT_EQ(Do(Job()).status().run().job(), "jobs/17");
  EXPECT_FALSE(IsArmed());
}

// LIVE-9.13: a person who starts it shows the token that it was armed with.
TEST_F(ArmTest, APersonStartsWithTheTokenOfTheArming) {
  MakeWith(v1::MachineOptions::START_ARMED);
  const std::string token = Do(Arm()).armed().arm_token();
  EXPECT_EQ(Code(ByPerson("none")), "CELL-E9406");
  EXPECT_EQ(Do(ByPerson(token)).status().run().job(), "jobs/17");
}

// LIVE-5.04: nothing is armed that could not take the job now.
TEST_F(ArmTest, AMachineWithAnOpenRunIsNotArmed) {
  MakeWith(v1::MachineOptions::START_ARMED);
  ASSERT_FALSE(Do(Start("begin")).has_refusal());
  const v1::HostOrderAnswer answer = Do(Arm());
  EXPECT_EQ(answer.refusal().code(), "CELL-E9421");
  EXPECT_THAT(answer.refusal().message(), HasSubstr("a run is open"));
  ASSERT_GT(answer.start_blockers_size(), 0);
  EXPECT_EQ(answer.start_blockers(0).code(), "CELL-E9421");
  EXPECT_FALSE(IsArmed());
  // Of what starts nothing it is not said what would be in the way of a start.
  v1::HostOrder abort;
  abort.mutable_abort()->set_run(99);
  const v1::HostOrderAnswer of_another = Do(abort);
  EXPECT_EQ(of_another.refusal().code(), "CELL-E9421");
  EXPECT_EQ(of_another.start_blockers_size(), 0);
}

// What becomes of the run is never guessed.
TEST_F(ArmTest, WhatIsWantedOnLossIsOneThatThereIs) {
  MakeWith(v1::MachineOptions::START_ARMED);
  v1::HostOrder arm = Arm();
  arm.mutable_arm()->set_on_loss(static_cast<v1::ControlLease::OnLoss>(3));
  EXPECT_EQ(Do(arm).refusal().code(), "CELL-E9003");
  EXPECT_FALSE(IsArmed());
}

// LIVE-4.02, LIVE-9.13: for the case that control is lost it counts what the job says, then with
// what the machine was armed, then what the lease says; and behind the run the lease is as it was
// taken.
TEST_F(ArmTest, WhatItIsArmedWithCountsForItsRun) {
  using OnLoss = v1::ControlLease::OnLoss;
  constexpr OnLoss kNothing = v1::ControlLease::ON_LOSS_UNSPECIFIED;
  constexpr OnLoss kHold = v1::ControlLease::ON_LOSS_HOLD;
  constexpr OnLoss kGoOn = v1::ControlLease::ON_LOSS_GO_ON;
  struct Case {
    OnLoss job, armed, counts;
  };
  const auto begin = [this](const Case& one) {
    MakeWith(v1::MachineOptions::START_ARMED);  // the lease says: go on
    v1::HostOrder arm = Arm();
    arm.mutable_arm()->set_on_loss(one.armed);
    Do(arm);
    v1::HostOrder job = Job();
    job.mutable_run_job()->mutable_job()->mutable_run()->set_on_loss(one.job);
    EXPECT_FALSE(Do(job).has_refusal());
    EXPECT_EQ(host_->StatusAt(now_).control().holder(), "anna");
    EXPECT_EQ(host_->StatusAt(now_).control().on_loss(), one.counts);
  };
  for (const Case& one : {Case{kNothing, kNothing, kGoOn}, Case{kNothing, kHold, kHold},
                          Case{kGoOn, kHold, kGoOn}, Case{kHold, kGoOn, kHold}}) {
    begin(one);
    v1::HostOrder release;
    release.mutable_release_control()->set_control_token(token_);
    Do(release);
    Pass(2s, 50ms);
    EXPECT_EQ(State(), one.counts == kHold ? v1::MACHINE_STATE_HELD : v1::MACHINE_STATE_RUNNING);
    begin(one);
    v1::HostOrder abort;
    abort.mutable_abort();
    Do(abort);
    Pass(2s, 50ms);
    ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
    EXPECT_EQ(host_->StatusAt(now_).control().on_loss(), kGoOn);
  }
}

// DEV-1.41: it ends by time, with control, with another program, and when somebody says so.
TEST_F(ArmTest, ItEndsByItself) {
  MakeWith(v1::MachineOptions::START_ARMED);
  Do(Arm());
  Pass(50s, 1s);
  EXPECT_TRUE(IsArmed());
  v1::HostOrder renew;
  renew.mutable_renew_control()->set_control_token(token_);
  Do(renew);
  Pass(50s, 1s);
  Do(renew);
  Pass(19s, 1s);
  EXPECT_TRUE(IsArmed());
  Pass(2s, 1s);
  EXPECT_FALSE(IsArmed());

  Do(Arm("", 5));
  Pass(5s, 1s);
  EXPECT_FALSE(IsArmed());
  EXPECT_EQ(Code(Arm("", 601)), "CELL-E9003");

  Do(Arm());
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(token_);
  Do(release);
  Pass(1s);
  EXPECT_FALSE(IsArmed());

  Control();
  v1::HostMemory memory;
  memory.add_programs()->set_slot(6);
  memory.mutable_programs(0)->set_content("PU0,0;");
  for (const bool with_schedules : {false, true}) {  // neither hides the other
    Do(Arm());
    if (with_schedules) memory.add_schedules()->set_number(1);
    memory.set_schedules_changed(with_schedules);
    host_->Change(memory, now_);
    Pass(1s);
    EXPECT_FALSE(IsArmed()) << with_schedules;
  }

  Do(Arm());
  v1::HostOrder disarm;
  disarm.mutable_disarm();
  Do(disarm);
  EXPECT_FALSE(IsArmed());
  EXPECT_EQ(Code(Job()), "CELL-E9406");
}

// LIVE-3.14: late by more than the machine allows, a run is held; by less it goes on.
TEST_F(ArmTest, ALateHostHoldsItsRun) {
  MakeWith(v1::MachineOptions::START_QUEUE);
  Do(Start("begin"));
  Pass(5s, 50ms);
  Pass(1000ms, 1000ms);
  Pass(500ms, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  Pass(1001ms, 1001ms);
  Pass(5s, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_LATE);
  options_.mutable_late_hold()->set_seconds(30);
  MakeWith(v1::MachineOptions::START_QUEUE);
  Do(Start("begin"));
  Pass(5s, 50ms);
  Pass(20s, 20s);
  Pass(5s, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
}

// DEV-1.41: for 1 s to 600 s, the ends among them.
TEST(ArmDeskBounds, OfTheTime) {
  using std::chrono::milliseconds;
  ArmDesk desk{[] { return "t"; }};
  const HostTime now{.steady = 1h, .wall = WallTime(24h)};
  v1::ArmMachineRequest request;
  for (const auto one : {v1::CONFIRMATION_TOOL, v1::CONFIRMATION_ORIGIN_VALID,
                         v1::CONFIRMATION_CLAMPS, v1::CONFIRMATION_COVER})
    request.add_confirmations(one);
  const auto arm_for = [&](milliseconds time) {
    desk.Disarm();
    request.mutable_armed_for()->set_seconds(time / 1s);
    request.mutable_armed_for()->set_nanos(static_cast<int>((time % 1s) / 1ns));
    return bool(desk.Arm(request, "anna", 1, 2, now));
  };
  EXPECT_FALSE(arm_for(999ms));
  EXPECT_FALSE(arm_for(600'001ms));
  EXPECT_FALSE(desk.is_armed());
  EXPECT_TRUE(arm_for(600s));
  EXPECT_TRUE(arm_for(1s));
  // Until then, and no longer; by the lease and for the memory that it was armed with.
  HostTime then = now;
  then.steady += 999ms;
  desk.Expire(1, 2, then);
  EXPECT_TRUE(desk.is_armed());
  then.steady += 1ms;
  desk.Expire(1, 2, then);
  EXPECT_FALSE(desk.is_armed());
  ASSERT_TRUE(arm_for(1s));
  desk.Expire(3, 2, now);
  EXPECT_FALSE(desk.is_armed());
  ASSERT_TRUE(arm_for(1s));
  desk.Expire(1, 3, now);
  EXPECT_FALSE(desk.is_armed());
}

}  // namespace
}  // namespace rmlcell::server
