// What clients ask of machines that live, over a channel of this process: their hosts get it as it
// was asked, and what they answer comes back.
#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>

#include <future>

#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(LiveMachines, OrdersGoToTheHost) {
  using Stub = v1::MachineService::Stub;
  ExpectHandedOn(machines, &Stub::StartMachine, "start", "status");
  ExpectHandedOn(machines, &Stub::ZeroMachine, "zero", "status");
  ExpectHandedOn(machines, &Stub::ResumeMachine, "resume", "status");
  ExpectHandedOn(machines, &Stub::AbortRun, "abort", "status");
  ExpectHandedOn(machines, &Stub::SetMode, "mode", "status");
  ExpectHandedOn(machines, &Stub::SetOverride, "override", "status");
  ExpectHandedOn(machines, &Stub::AcknowledgeAlarm, "acknowledge_alarm", "status");
  ExpectHandedOn(machines, &Stub::SetFactor, "factor", "status");
  ExpectHandedOn(machines, &Stub::SetInputs, "inputs", "status");
  ExpectHandedOn(machines, &Stub::SetGates, "gates", "status");
  ExpectHandedOn(machines, &Stub::ArmMachine, "arm", "armed");
  ExpectHandedOn(machines, &Stub::DisarmMachine, "disarm", "status");
  ExpectHandedOn(machines, &Stub::PreviewStart, "preview_start", "preview");
  ExpectHandedOn(machines, &Stub::StartAtStep, "start_at_step", "status");
  ExpectHandedOn(machines, &Stub::PressPanelKey, "panel_key", "status");
  ExpectHandedOn(machines, &Stub::HeartbeatPanel, "panel_heartbeat", "heartbeat");
  ExpectHandedOn(machines, &Stub::ConfirmMachine, "confirm", "status");
  ExpectHandedOn(machines, &Stub::StopMachine, "stop", "halt");
  ExpectHandedOn(machines, &Stub::HoldMachine, "hold", "halt");
  ExpectHandedOn(machines, &Stub::EmergencyStopMachine, "emergency_stop", "halt");
  ExpectHandedOn(machines, &Stub::AcquireControl, "acquire_control", "control");
  ExpectHandedOn(machines, &Stub::RenewControl, "renew_control", "control_kept");
  ExpectHandedOn(machines, &Stub::ReleaseControl, "release_control", "");
  ExpectHandedOn(machines, &Stub::ReadVariables, "read_variables", "variables");
  ExpectHandedOn(machines, &Stub::WriteVariables, "write_variables", "written");
  ExpectHandedOn(machines, &Stub::SetBreakpoints, "breakpoints", "run_state");
  ExpectHandedOn(machines, &Stub::SetSimulation, "simulation", "run_state");
  ExpectHandedOn(machines, &Stub::GetRunState, "run_state", "run_state");
}

TEST_F(LiveMachines, KeysOfTheHandboxGoToTheHost) {
  using Stub = v1::HandboxService::Stub;
  ExpectHandedOn(handbox, &Stub::CreateHandboxSession, "create_session", "session");
  ExpectHandedOn(handbox, &Stub::PressKey, "key", "key");
  ExpectHandedOn(handbox, &Stub::HeartbeatHandbox, "handbox_heartbeat", "heartbeat");
  ExpectHandedOn(handbox, &Stub::DeleteHandboxSession, "delete_session", "");
}

// A stream of keys: each is answered in its turn, and a refusal does not end it.
TEST_F(LiveMachines, KeysStreamToTheHost) {
  const auto context = Context();
  const auto stream = handbox->HandboxStream(context.get());
  const auto answered = [&](const v1::HandboxStreamRequest& request,
                            const v1::HostOrderAnswer& answer) {
    host->Answer(answer);
    v1::HandboxStreamResponse response;
    EXPECT_TRUE(stream->Write(request) && stream->Read(&response));
    return response;
  };
  v1::HandboxStreamRequest key;
  Fill(*key.mutable_key());
  v1::HostOrderAnswer pressed;
  pressed.mutable_key()->set_sequence(6);
  EXPECT_EQ(answered(key, pressed).key().sequence(), 6);
  v1::HandboxStreamRequest beat;
  Fill(*beat.mutable_heartbeat());
  v1::HostOrderAnswer heard;
  heard.mutable_heartbeat()->mutable_sent()->set_seconds(4);
  EXPECT_EQ(answered(beat, heard).heartbeat().sent().seconds(), 4);
  const std::vector<v1::HostOrder> orders = host->TakeOrders();
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(orders[0].caller(), "local");
  EXPECT_EQ(orders[0].key().SerializeAsString(), key.key().SerializeAsString());
  EXPECT_EQ(orders[1].handbox_heartbeat().SerializeAsString(),
            beat.heartbeat().SerializeAsString());
  v1::HostOrderAnswer refused;
  refused.mutable_refusal()->set_code("CELL-E9434");
  EXPECT_EQ(answered(key, refused).refusal().code(), "CELL-E9434");
  host->TakeOrders();
  EXPECT_EQ(answered({}, pressed).refusal().code(), "CELL-E9003");
  key.mutable_key()->set_session("optimo-1");
  EXPECT_EQ(answered(key, pressed).refusal().code(), "CELL-E9003");
  key.mutable_key()->set_session("machines/mill-1/handboxSessions/1");
  const v1::ErrorDetail hostless = answered(key, pressed).refusal();
  EXPECT_EQ(hostless.code(), "CELL-E9424");
  EXPECT_THAT(hostless.message(), HasSubstr("the machine has no host: enable it"));
  EXPECT_THAT(host->TakeOrders(), IsEmpty());
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());
}

// LIVE-7.02: what is to be seen now, and after each change; numbered.
TEST_F(LiveMachines, TheHandboxIsWatched) {
  v1::WatchHandboxRequest request;
  request.set_machine(kLaser);
  const auto opened = [&] {
    const auto context = Context();
    const auto reader = handbox->WatchHandbox(context.get(), request);
    v1::WatchHandboxResponse nothing;
    EXPECT_FALSE(reader->Read(&nothing));
    status = reader->Finish();
  };
  opened();
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "it has no handbox, or does not live: enable it");
  const auto show = [&](const std::string& display) {
    v1::HostRequest told;
    told.mutable_panel()->set_display(display);
    hosts.Receive(*host, std::move(told));
  };
  show("READY");
  const auto context = Context();
  const auto reader = handbox->WatchHandbox(context.get(), request);
  v1::WatchHandboxResponse seen;
  ASSERT_TRUE(reader->Read(&seen));
  EXPECT_EQ(seen.panel().display(), "READY");
  EXPECT_EQ(seen.sequence(), 1);
  show("TEACH");
  ASSERT_TRUE(reader->Read(&seen));
  EXPECT_EQ(seen.panel().display(), "TEACH");
  EXPECT_EQ(seen.sequence(), 2);
  context->TryCancel();
  EXPECT_FALSE(reader->Read(&seen));
  reader->Finish();
  request.set_machine("machines/none");
  opened();
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  request.set_machine("none");
  opened();
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// The host says first who has control; what was taught is in the store.
TEST_F(LiveMachines, TakingBackAsksTheHostFirst) {
  v1::UndoTeachEntriesRequest request;
  request.set_program("machines/optimo-1/programs/45");
  request.set_down_to(1);
  request.set_control_token("t");
  const auto undo = [&] { Call(handbox, &v1::HandboxService::Stub::UndoTeachEntries, request); };
  undo();
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "request_id: a UUID");
  request.set_request_id("u");
  v1::HostOrderAnswer answer;
  answer.mutable_refusal()->set_code("CELL-E9409");
  answer.mutable_refusal()->set_message("no control");
  host->Answer(answer);
  undo();
  EXPECT_THAT(status.error_message(), HasSubstr("no control"));
  const auto orders = host->TakeOrders();
  ASSERT_EQ(orders.size(), 1U);
  EXPECT_EQ(orders[0].caller(), "local");
  EXPECT_EQ(orders[0].undo_teaching().SerializeAsString(), request.SerializeAsString());
  host->Answer({});
  undo();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND) << status.error_message();
  request.set_program("machines/mill-1/programs/45");
  undo();
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "the machine has no host: enable it");
  request.set_program("45");
  undo();
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

TEST_F(LiveMachines, WithoutAHostNothingIsHandedOn) {
  v1::ZeroMachineRequest request;
  request.set_request_id("r");
  const auto zero = [&](const std::string& machine) {
    request.set_machine(machine);
    Call(machines, &v1::MachineService::Stub::ZeroMachine, request);
  };
  zero("machines/mill-1");
  ExpectRefused(grpc::StatusCode::UNAVAILABLE, "the machine has no host: enable it");
  zero("machines/none");
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  zero("none");
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  request.clear_request_id();
  zero(kLaser);
  ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "request_id: a UUID");
  EXPECT_THAT(host->TakeOrders(), IsEmpty());
}

// All that keeps a start from beginning, and the machine's own account of it.
TEST_F(LiveMachines, ARefusalSaysAll) {
  v1::HostOrderAnswer answer;
  answer.mutable_refusal()->set_code("OPT-E348");
  answer.mutable_refusal()->set_message("no object");
  answer.mutable_machine_refusal()->set_machine(kLaser);
  for (const char* code : {"OPT-E348", "CELL-E9408"}) {
    v1::StartBlocker& blocker = *answer.add_start_blockers();
    blocker.set_code(code);
    blocker.set_message(std::string("why ") + code);
  }
  host->Answer(answer);
  v1::StartMachineRequest request;
  request.set_machine(kLaser);
  request.set_request_id("r");
  Call(machines, &v1::MachineService::Stub::StartMachine, request);
  google::rpc::Status rich;
  ASSERT_TRUE(rich.ParseFromString(status.error_details()));
  EXPECT_EQ(rich.code(), static_cast<int>(status.error_code()));
  EXPECT_EQ(rich.message(), status.error_message());
  google::rpc::PreconditionFailure all;
  v1::MachineRefusal own;
  for (const auto& detail : rich.details()) {
    detail.UnpackTo(&all);
    detail.UnpackTo(&own);
  }
  ASSERT_EQ(all.violations_size(), 2);
  EXPECT_EQ(all.violations(1).type(), "CELL-E9408");
  EXPECT_EQ(all.violations(1).subject(), kLaser);
  EXPECT_EQ(all.violations(1).description(), "why CELL-E9408");
  EXPECT_EQ(own.machine(), kLaser);
}

// Disabling ends the host and stands; so does enabling. A run that is open keeps it.
TEST_F(LiveMachines, AMachineIsDisabledAndEnabled) {
  v1::DisableMachineRequest disable;
  disable.set_machine(kLaser);
  disable.set_request_id("first");
  const auto disabled = [&] {
    return Call(machines, &v1::MachineService::Stub::DisableMachine, disable);
  };
  Tell(*host, v1::MACHINE_STATE_HELD, "jobs/7");
  disabled();
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "a run is open; abort it first");
  EXPECT_EQ(host->stopped(), "");
  Tell(*host, v1::MACHINE_STATE_IDLE);
  ASSERT_TRUE(processes.Enable("optimo-1"));
  EXPECT_EQ(disabled().state(), v1::MACHINE_STATE_OFF);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(host->stopped(), "it was disabled");
  EXPECT_FALSE(hosts.IsHosted("optimo-1"));
  EXPECT_FALSE(processes.IsEnabled("optimo-1"));
  EXPECT_TRUE(Options().disabled());
  EXPECT_FALSE(Options().enabled());
  // A repeat acts never again, and what has the same name is the same.
  host = Joined();
  EXPECT_EQ(disabled().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(host->stopped(), "");
  v1::EnableMachineRequest enable;
  enable.set_machine(kLaser);
  enable.set_request_id("first");
  Call(machines, &v1::MachineService::Stub::EnableMachine, enable);
  ExpectRefused(grpc::StatusCode::ALREADY_EXISTS, "CELL-E9");
  enable.set_request_id("second");
  EXPECT_EQ(Call(machines, &v1::MachineService::Stub::EnableMachine, enable).state(),
            v1::MACHINE_STATE_IDLE);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(processes.IsEnabled("optimo-1"));
  EXPECT_TRUE(Options().enabled());
  EXPECT_FALSE(Options().disabled());
}

// Its host has it as it was when it began: another one follows.
TEST_F(LiveMachines, AMachineThatIsChangedLivesAnew) {
  v1::UpdateMachineRequest request;
  request.mutable_machine()->set_name(kLaser);
  request.mutable_machine()->set_title("Laser");
  request.mutable_update_mask()->add_paths("title");
  const auto update = [&] {
    return Call(machines, &v1::MachineService::Stub::UpdateMachine, request);
  };
  EXPECT_EQ(update().title(), "Laser");
  EXPECT_EQ(host->stopped(), "");
  request.mutable_update_mask()->set_paths(0, "options");
  request.mutable_machine()->mutable_options()->set_enabled(true);
  Tell(*host, v1::MACHINE_STATE_HELD, "jobs/7");
  update();
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION,
                "a run is open: change it when that is over");
  Tell(*host, v1::MACHINE_STATE_IDLE);
  // One that comes before the call has seen that the machine has none is not told from the old one.
  const auto next = std::async(std::launch::async, [&] {
    EXPECT_TRUE(Eventually([&] { return processes.IsEnabled("optimo-1"); }));
    return Joined();
  });
  EXPECT_TRUE(update().options().enabled());
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(host->stopped(), "the machine was changed");
  EXPECT_TRUE(hosts.IsHosted("optimo-1"));  // the call is answered when it lives again
  EXPECT_TRUE(processes.IsEnabled("optimo-1"));
  next.wait();
}

TEST_F(LiveMachines, AMachineThatIsDeletedLivesNoMore) {
  v1::DeleteMachineRequest request;
  request.set_name(kLaser);
  const auto remove = [&] { Call(machines, &v1::MachineService::Stub::DeleteMachine, request); };
  request.set_etag("99");
  remove();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::ABORTED) << status.error_message();
  request.clear_etag();
  Tell(*host, v1::MACHINE_STATE_HELD, "jobs/7");
  remove();
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "a run is open; abort it first");
  EXPECT_EQ(host->stopped(), "");
  Tell(*host, v1::MACHINE_STATE_IDLE);
  remove();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(host->stopped(), "it was deleted");
  EXPECT_FALSE(hosts.IsHosted("optimo-1"));
}

// A machine that lives says what it can; one that does not says nothing.
TEST_F(LiveMachines, CapabilitiesAreThoseOfAMachineThatLives) {
  v1::GetMachineRequest request;
  request.set_name(kLaser);
  const auto machine = Call(machines, &v1::MachineService::Stub::GetMachine, request);
  EXPECT_TRUE(machine.has_capabilities());
  EXPECT_EQ(machine.status().host(), "hall/1");
  request.set_name("machines/mill-1");
  EXPECT_FALSE(Call(machines, &v1::MachineService::Stub::GetMachine, request).has_capabilities());
}

// LIVE-3.03: until a host of that computer has it.
TEST_F(LiveMachines, AMachineIsGivenToAnotherComputer) {
  v1::TakeMachineRequest request;
  request.set_machine(kLaser);
  request.set_reason("the hall is without power");
  request.set_request_id("r");
  const auto take = [&](const std::string& computer) {
    request.set_computer(computer);
    return Call(machines, &v1::MachineService::Stub::TakeMachine, request);
  };
  EXPECT_EQ(take("hall").host(), "hall/1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  request.set_request_id("s");
  const auto next = std::async(std::launch::async, [&] { return Joined("office"); });
  EXPECT_EQ(take("office").host(), "office/1");
  EXPECT_TRUE(status.ok()) << status.error_message();
  next.wait();
}

// Only what there is is enabled or disabled.
TEST_F(LiveMachines, AMachineThatIsNotThereIsNeitherEnabledNorDisabled) {
  v1::EnableMachineRequest enable;
  enable.set_machine("machines/none");
  enable.set_request_id("a");
  Call(machines, &v1::MachineService::Stub::EnableMachine, enable);
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
  EXPECT_FALSE(processes.IsEnabled("none"));
  v1::DisableMachineRequest disable;
  disable.set_machine("machines/none");
  disable.set_request_id("b");
  Call(machines, &v1::MachineService::Stub::DisableMachine, disable);
  ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9009");
}

}  // namespace
}  // namespace rmlcell::server
