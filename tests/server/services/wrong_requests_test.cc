// Requests that name nothing, or say what cannot be: refused with what is wrong, and nothing done.
#include <google/protobuf/text_format.h>

#include <filesystem>

#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

class WrongRequests : public LiveMachines {
 protected:
  template <class Stub, class Request, class Response>
  void ExpectWrong(const std::unique_ptr<Stub>& stub,
                   grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                   const std::string& text, const std::string& said = "CELL-E9003",
                   grpc::StatusCode code = grpc::StatusCode::INVALID_ARGUMENT) {
    SCOPED_TRACE(Request::descriptor()->name() + ": " + text);
    Request request;
    ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request));
    Call(stub, method, request);
    ExpectRefused(code, said);
  }
};

TEST_F(WrongRequests, WhatIsNoNameIsRefused) {
  using Machines = v1::MachineService::Stub;
  ExpectWrong(machines, &Machines::GetMachine, "name: 'x'");
  ExpectWrong(machines, &Machines::UpdateMachine, "machine { name: 'x' }");
  ExpectWrong(machines, &Machines::DeleteMachine, "name: 'x'");
  ExpectWrong(machines, &Machines::GetLaserSchedule, "name: 'x'");
  ExpectWrong(machines, &Machines::ListLaserSchedules, "parent: 'x'");
  ExpectWrong(machines, &Machines::PutLaserSchedule, "laser_schedule { name: 'x' }");
  ExpectWrong(machines, &Machines::DeleteLaserSchedule, "name: 'x'");
  using Jobs = v1::JobService::Stub;
  ExpectWrong(jobs, &Jobs::CancelJob, "name: 'x'");
  ExpectWrong(jobs, &Jobs::HoldJob, "name: 'x'");
  ExpectWrong(jobs, &Jobs::StopJob, "name: 'x'");
  ExpectWrong(jobs, &Jobs::ResumeJob, "name: 'x'");
  ExpectWrong(jobs, &Jobs::SetJobOverride, "name: 'x' override_percent: 70");
  ExpectWrong(jobs, &Jobs::MoveJob, "name: 'x'");
  ExpectWrong(jobs, &Jobs::DeleteJob, "name: 'x'");
  ExpectWrong(jobs, &Jobs::GetJobPicture, "name: 'x'");
  ExpectWrong(jobs, &Jobs::GetJobArtifact, "name: 'x' artifact: 'report'");
}

// common.proto: an etag that cannot be one of ours is that of something else.
TEST_F(WrongRequests, WhatIsNoEtagIsRefused) {
  using Stub = v1::MachineService::Stub;
  const auto code = grpc::StatusCode::ABORTED;
  ExpectWrong(machines, &Stub::UpdateMachine,
              "machine { name: 'machines/mill-1' etag: 'x' title: 'T' } update_mask { paths: "
              "'title' }",
              "CELL-E9006", code);
  ExpectWrong(machines, &Stub::DeleteMachine, "name: 'machines/mill-1' etag: 'x'", "CELL-E9006",
              code);
  ExpectWrong(machines, &Stub::PutLaserSchedule,
              "laser_schedule { name: 'machines/optimo-1/laserSchedules/5' etag: 'x' mode: "
              "LASER_MODE_CW }",
              "CELL-E9006", code);
}

TEST_F(WrongRequests, WhatNoMachineCanBeIsRefused) {
  using Stub = v1::MachineService::Stub;
  ExpectWrong(machines, &Stub::CreateMachine, "machine_id: '9' machine { family: 'optimo' }",
              "machine_id");
  ExpectWrong(machines, &Stub::CreateMachine, "machine_id: 'lathe' machine { family: 'lathe' }",
              "CELL-E9008");
  ExpectWrong(machines, &Stub::ListMachines, "page_size: -1");
  const std::string of_mill = "name: 'machines/mill-1/laserSchedules/5'";
  const auto code = grpc::StatusCode::FAILED_PRECONDITION;
  ExpectWrong(machines, &Stub::PutLaserSchedule,
              "laser_schedule { " + of_mill + " mode: LASER_MODE_CW }",
              "this machine has no laser schedules", code);
  ExpectWrong(machines, &Stub::DeleteLaserSchedule, of_mill, "this machine has no laser schedules",
              code);
  const std::string of_laser = "name: 'machines/optimo-1/laserSchedules/5'";
  ExpectWrong(machines, &Stub::PutLaserSchedule,
              "laser_schedule { " + of_laser + " title: '" + std::string(201, 'x') + "' }",
              "title");
  ExpectWrong(machines, &Stub::GetLaserSchedule, of_laser, "CELL-E9004",
              grpc::StatusCode::NOT_FOUND);
}

// LIVE-3: a machine that is made enabled lives; where it is only checked nothing is made.
TEST_F(WrongRequests, AMachineThatIsOnlyCheckedIsNotMade) {
  v1::CreateMachineRequest request;
  request.set_machine_id("laser-2");
  request.mutable_machine()->set_family("optimo");
  request.mutable_machine()->mutable_options()->set_enabled(true);
  request.set_validate_only(true);
  const auto create = [&] {
    const auto made = Call(machines, &v1::MachineService::Stub::CreateMachine, request);
    EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(made.name(), "machines/laser-2");
    return made.etag();
  };
  EXPECT_EQ(create(), "");
  EXPECT_EQ(CodeOf(store().GetMachine("laser-2")), ErrorCode::kCellUnknownMachine);
  EXPECT_FALSE(processes.IsEnabled("laser-2"));
  request.set_validate_only(false);
  EXPECT_EQ(create(), "1");
  EXPECT_TRUE(processes.IsEnabled("laser-2"));
}

TEST_F(WrongRequests, AChangeThatIsOnlyCheckedChangesNothing) {
  const auto before = Must(store().GetMachine("mill-1"));
  v1::UpdateMachineRequest request;
  request.mutable_machine()->set_name("machines/mill-1");
  request.mutable_machine()->set_title("Another");
  request.mutable_update_mask()->add_paths("title");
  request.set_validate_only(true);
  EXPECT_EQ(Call(machines, &v1::MachineService::Stub::UpdateMachine, request).title(), "Another");
  EXPECT_TRUE(status.ok()) << status.error_message();
  const auto after = Must(store().GetMachine("mill-1"));
  EXPECT_EQ(after.title, before.title);
  EXPECT_EQ(after.revision, before.revision);
}

// LIVE-3: whoever enables what lives already changes nothing of it.
TEST_F(WrongRequests, WhatLivesAlreadyIsEnabledAsItStands) {
  const auto before = Must(store().GetMachine("optimo-1"));
  v1::EnableMachineRequest request;
  request.set_machine(kLaser);
  request.set_request_id("r");
  Call(machines, &v1::MachineService::Stub::EnableMachine, request);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(processes.IsEnabled("optimo-1"));
  EXPECT_EQ(Must(store().GetMachine("optimo-1")).revision, before.revision);
}

// Of a machine that is gone no host is started, and what its hosts kept goes with it.
TEST_F(WrongRequests, ADeletedMachineLeavesNothingBehind) {
  ASSERT_TRUE(processes.Enable("mill-1"));
  const std::string journal = folder.File("journals/mill-1.journal");
  storage::WriteFile(journal, "entries");
  v1::DeleteMachineRequest request;
  request.set_name("machines/mill-1");
  Call(machines, &v1::MachineService::Stub::DeleteMachine, request);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_FALSE(processes.IsEnabled("mill-1"));
  EXPECT_FALSE(std::filesystem::exists(journal));
}

// One that cannot be deleted lives on with another host.
TEST_F(WrongRequests, AMachineThatIsKeptLivesOn) {
  storage::MachineRecord record = Must(store().GetMachine("optimo-1"));
  v1::MachineOptions options;
  options.set_enabled(true);
  record.options = BytesOf(options);
  Must(store().PutMachine(record, record.revision));
  Must(store().SubmitAndWait({.machine = "optimo-1", .kind = "CHECK"}));
  v1::DeleteMachineRequest request;
  request.set_name(kLaser);
  Call(machines, &v1::MachineService::Stub::DeleteMachine, request);
  ExpectRefused(grpc::StatusCode::FAILED_PRECONDITION, "jobs wait for machine optimo-1");
  EXPECT_EQ(host->stopped(), "it was deleted");
  EXPECT_TRUE(processes.IsEnabled("optimo-1"));
}

}  // namespace
}  // namespace rmlcell::server
