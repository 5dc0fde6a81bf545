// Calls that wait for a host, to come or to go; what the store refuses them, and what they leave as
// it was then.
#include <atomic>
#include <future>

#include "rmlcell/v1/cell.pb.h"
#include "server/records/machine_messages.h"
#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

// A host that goes when the test lets it.
class HesitatingHost final : public HostLink {
 public:
  void Send(v1::HostResponse message) override {
    if (message.has_stop()) stopped_ = true;
  }
  void Close(const Error&) override { closed_ = true; }
  bool stopped() const { return stopped_; }
  bool closed() const { return closed_; }

 private:
  std::atomic<bool> stopped_ = false;
  std::atomic<bool> closed_ = false;
};

// A host that another one follows in the moment in which it is told to go.
class FollowedHost final : public HostLink {
 public:
  FollowedHost(Hosts& hosts, std::shared_ptr<HostLink> next, v1::HostHello hello)
      : hosts_(hosts), next_(std::move(next)), hello_(std::move(hello)) {}
  void Send(v1::HostResponse message) override {
    if (message.has_stop()) {
      EXPECT_TRUE(hosts_.Join(next_, hello_));
    }
  }
  void Close(const Error&) override {}

 private:
  Hosts& hosts_;
  std::shared_ptr<HostLink> next_;
  v1::HostHello hello_;
};

class LivingWaits : public LiveMachines {
 protected:
  using LiveMachines::LiveMachines;
  // So that a call that does not wait has been answered; one that does does not mind.
  static void LetItWait() {
    int looks = 0;
    EXPECT_TRUE(Eventually([&] { return ++looks > 25; }));
  }
  v1::MachineStatus Enabled(const std::string& request_id) {
    v1::EnableMachineRequest request;
    request.set_machine(kLaser);
    request.set_request_id(request_id);
    return Call(machines, &v1::MachineService::Stub::EnableMachine, request);
  }
  v1::MachineStatus Disabled(const std::string& request_id, const std::string& machine = kLaser) {
    v1::DisableMachineRequest request;
    request.set_machine(machine);
    request.set_request_id(request_id);
    return Call(machines, &v1::MachineService::Stub::DisableMachine, request);
  }
  v1::MachineStatus Taken(const std::string& computer) {
    v1::TakeMachineRequest request;
    request.set_machine(kLaser);
    request.set_reason("the hall is without power");
    request.set_request_id("for " + computer);
    request.set_computer(computer);
    return Call(machines, &v1::MachineService::Stub::TakeMachine, request);
  }
  void HandBack(const HostLink& link) {
    v1::HostRequest request;
    request.mutable_hand_back();
    hosts.Receive(link, std::move(request));
    hosts.Leave(link);
  }
  void ExpectDiskFull() { ExpectRefused(grpc::StatusCode::INTERNAL, "the disk is full"); }
};

TEST_F(LivingWaits, EnablingIsAnsweredWhenTheMachineHasBegun) {
  for (const auto state :
       {v1::MACHINE_STATE_STARTING, v1::MACHINE_STATE_RECOVERING, v1::MACHINE_STATE_LOST}) {
    const std::string name = v1::MachineState_Name(state);
    Tell(*host, state);
    const auto begun = std::async(std::launch::async, [&] {
      LetItWait();
      Tell(*host, v1::MACHINE_STATE_IDLE);
    });
    EXPECT_EQ(Enabled(name).state(), v1::MACHINE_STATE_IDLE) << name;
    EXPECT_TRUE(status.ok()) << status.error_message();
    begun.wait();
  }
}

// Also of one whose hosts ended too often: why it was off says nothing any more.
TEST_F(LivingWaits, EnablingIsAnsweredWhenItsHostHasCome) {
  hosts.NoteOff("optimo-1", "its host ended 5 times");
  ASSERT_TRUE(hosts.WhyOff("optimo-1"));
  const auto next = std::async(std::launch::async, [&] {
    EXPECT_TRUE(Eventually([&] { return processes.IsEnabled("optimo-1"); }));
    EXPECT_FALSE(hosts.WhyOff("optimo-1"));
    LetItWait();
    return Joined();
  });
  EXPECT_EQ(Enabled("r").host(), "hall/1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  next.wait();
}

TEST_F(LivingWaits, AMachineThatIsDisabledIsOffForNoOtherReason) {
  hosts.NoteOff("optimo-1", "its host ended 5 times");
  const v1::MachineStatus told = Disabled("r");
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(told.state(), v1::MACHINE_STATE_OFF);
  EXPECT_FALSE(told.has_off_reason());
  EXPECT_FALSE(hosts.WhyOff("optimo-1"));
}

TEST_F(LivingWaits, DisablingIsAnsweredWhenItsHostHasGone) {
  v1::HostHello hello = HelloOf("hall");
  hello.set_machine("machines/mill-1");
  const auto slow = std::make_shared<HesitatingHost>();
  ASSERT_TRUE(hosts.Join(slow, hello));
  const auto left = std::async(std::launch::async, [&] {
    EXPECT_TRUE(Eventually([&] { return slow->stopped(); }));
    LetItWait();
    HandBack(*slow);
  });
  EXPECT_EQ(Disabled("r", "machines/mill-1").state(), v1::MACHINE_STATE_OFF);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  left.wait();
  EXPECT_FALSE(slow->closed());  // it went by itself
}

class ImpatientWaits : public LivingWaits {
 protected:
  ImpatientWaits() : LivingWaits(std::chrono::milliseconds(50)) {}
};

// For neither a host that does not come nor one that does not go is it waited for ever: the one has
// the machine when it comes later, the other has none any more.
TEST_F(ImpatientWaits, NobodyWaitsForEver) {
  v1::HostHello hello = HelloOf("hall");
  hello.set_machine("machines/mill-1");
  const auto stubborn = std::make_shared<HesitatingHost>();
  ASSERT_TRUE(hosts.Join(stubborn, hello));
  auto disabled = std::async(std::launch::async, [&] {
    v1::DisableMachineRequest request;
    request.set_machine("machines/mill-1");
    request.set_request_id("r");
    v1::MachineStatus told;
    const grpc::Status end = machines->DisableMachine(Context().get(), request, &told);
    EXPECT_TRUE(end.ok()) << end.error_message();
    return told.state();
  });
  Taken("office");
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "no host of office has come yet");
  EXPECT_THAT(status.error_message(), testing::HasSubstr("CELL-E9424"));
  EXPECT_NE(Joined("office"), nullptr);
  EXPECT_EQ(disabled.get(), v1::MACHINE_STATE_OFF);
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  EXPECT_TRUE(stubborn->closed());
}

// LIVE-3.03: whoever was told to go has gone; who has the machine by then keeps it.
TEST_F(ImpatientWaits, WhoFollowsTheHostThatGoesStays) {
  v1::HostHello hello = HelloOf("hall");
  hello.set_machine("machines/mill-1");
  v1::HostHello other = HelloOf("office");
  other.set_machine("machines/mill-1");
  const auto next = std::make_shared<HesitatingHost>();
  ASSERT_TRUE(hosts.Join(std::make_shared<FollowedHost>(hosts, next, other), hello));
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  Disabled("r", "machines/mill-1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(hosts.IsHosted("mill-1"));
  EXPECT_FALSE(next->stopped());
  EXPECT_FALSE(next->closed());
}

TEST_F(LivingWaits, ADisableThatIsRefusedLeavesAllAsItWas) {
  Tell(*host, v1::MACHINE_STATE_HELD, "jobs/7");
  Disabled("a");
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "a run is open; abort it first");
  EXPECT_FALSE(Options().disabled());
  Tell(*host, v1::MACHINE_STATE_IDLE);
  refusing.Refuse("PutMachine");
  Disabled("b");
  ExpectDiskFull();
  EXPECT_EQ(host->stopped(), "");
  EXPECT_TRUE(hosts.IsHosted("optimo-1"));
}

TEST_F(LivingWaits, WhatTheStoreRefusesIsWhatTheyEndWith) {
  refusing.Refuse("UnfinishedJobs");
  Enabled("a");
  ExpectDiskFull();
  refusing.Refuse("GetMachine");
  v1::DeleteMachineRequest remove;
  remove.set_name(kLaser);
  Call(machines, &v1::MachineService::Stub::DeleteMachine, remove);
  ExpectDiskFull();
  EXPECT_EQ(host->stopped(), "");
  refusing.Heal();
  refusing.Refuse("UnfinishedJobs");
  Disabled("b");
  ExpectDiskFull();
  EXPECT_EQ(host->stopped(), "it was disabled");
}

// LIVE-3.03: who gave it away and why is told where the machine is taken.
TEST_F(LivingWaits, AMachineIsTakenByAPersonForAReason) {
  const auto next = std::async(std::launch::async, [&] { return Joined("office"); });
  EXPECT_EQ(Taken("office").host(), "office/1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  next.wait();
  std::string told;
  for (const storage::EventRecord& event : Must(store().AllEvents(0, 1000))) {
    v1::MachineEvent said;
    if (event.kind == kMachineEvent && said.ParseFromString(event.payload))
      told += said.run().message().text();
  }
  EXPECT_EQ(told, "taken by local: the hall is without power");
}

// It has nothing to wait for, and takes it from nobody later on.
TEST_F(LivingWaits, AMachineIsNotTakenByTheComputerThatHasIt) {
  EXPECT_EQ(Taken("hall").host(), "hall/1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  HandBack(*host);
  host = Joined("office");
  EXPECT_EQ(TryJoin("hall"), nullptr);
  EXPECT_TRUE(hosts.IsHeard("optimo-1"));
}

// machine.proto: schedules that are stored are with the host before any order that follows. Nobody
// reads the log here: the host has them from the call.
TEST_F(LivingWaits, SchedulesGoToTheHostWithTheCall) {
  refusing.Refuse("AllEvents");
  v1::PutLaserScheduleRequest put;
  v1::LaserSchedule& schedule = *put.mutable_laser_schedule();
  schedule.set_name(std::string(kLaser) + "/laserSchedules/5");
  schedule.set_mode(v1::LASER_MODE_CW);
  schedule.set_power_percent(40.0);
  Call(machines, &v1::MachineService::Stub::PutLaserSchedule, put);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(host->memory().schedules_size(), 1);
  v1::DeleteLaserScheduleRequest remove;
  remove.set_name(schedule.name());
  Call(machines, &v1::MachineService::Stub::DeleteLaserSchedule, remove);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(host->memory().schedules_changed());
  EXPECT_EQ(host->memory().schedules_size(), 0);
}

// Its line breaks before it has answered: who asked is told so.
TEST_F(LivingWaits, AHostThatGoesTakesNothingBack) {
  host->LeaveOnOrder();
  v1::UndoTeachEntriesRequest request;
  request.set_program("machines/optimo-1/programs/45");
  request.set_down_to(1);
  request.set_control_token("t");
  request.set_request_id("u");
  Call(handbox, &v1::HandboxService::Stub::UndoTeachEntries, request);
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "its host is not heard of any more");
  EXPECT_EQ(host->TakeOrders().size(), 1U);
}

// What has been read once is answered from memory, and what is not there likewise.
TEST_F(LivingWaits, WhatIsNoMachineIsRefusedFromMemoryToo) {
  using Stub = v1::MachineService::Stub;
  EXPECT_EQ(Call(machines, &Stub::ListMachines, v1::ListMachinesRequest()).machines_size(), 2);
  v1::GetMachineRequest request;
  request.set_name("machines/mill-1");
  EXPECT_EQ(Call(machines, &Stub::GetMachine, request).name(), "machines/mill-1");
  request.set_name("machines/none");
  Call(machines, &Stub::GetMachine, request);
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  request.set_name("none");
  Call(machines, &Stub::GetMachine, request);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  v1::PreviewStartRequest preview;
  preview.set_machine("none");
  Call(machines, &Stub::PreviewStart, preview);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// A run minds how its machine lives, and not what it is called.
TEST_F(LivingWaits, ATitleMayChangeWhileARunIsOpen) {
  Tell(*host, v1::MACHINE_STATE_HELD, "jobs/7");
  v1::UpdateMachineRequest request;
  request.mutable_machine()->set_name(kLaser);
  request.mutable_machine()->set_title("Laser");
  request.mutable_update_mask()->add_paths("title");
  const auto update = [&] {
    return Call(machines, &v1::MachineService::Stub::UpdateMachine, request);
  };
  const v1::Machine changed = update();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(changed.title(), "Laser");
  request.mutable_machine()->set_title("Cutter");
  request.mutable_machine()->set_etag(changed.etag());
  EXPECT_EQ(update().title(), "Cutter");
  update();  // it has another one now
  EXPECT_EQ(status.error_code(), grpc::StatusCode::ABORTED) << status.error_message();
}

// A code that nobody here knows is a fault of somebody, and not of who asks.
TEST_F(LivingWaits, ARefusalWithoutAKnownCodeIsAnInnerFault) {
  v1::ZeroMachineRequest request;
  request.set_machine(kLaser);
  for (const char* code : {"", "NONE-E1"}) {
    v1::HostOrderAnswer answer;
    answer.mutable_refusal()->set_code(code);
    answer.mutable_refusal()->set_message("not now");
    host->Answer(answer);
    request.set_request_id(std::string("r") + code);
    Call(machines, &v1::MachineService::Stub::ZeroMachine, request);
    ExpectRefused(grpc::StatusCode::INTERNAL, "not now");
  }
}

}  // namespace
}  // namespace rmlcell::server
