#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "clients/cli/terminal.h"
#include "clients/cli/verbs.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "tests/clients/cli/fake_services.h"

// A machine that lives, for the verbs of `rmlcell machine`.
namespace rmlcell::cli {

// What is asked for, in order: name and request of each call on a line, without its id.
class CallNotes {
 public:
  void Add(const std::string& name, const google::protobuf::Message& request) {
    std::unique_ptr<google::protobuf::Message> shown(request.New());
    shown->CopyFrom(request);
    std::string note = name;
    if (const auto* id = shown->GetDescriptor()->FindFieldByName("request_id"); id != nullptr) {
      if (shown->GetReflection()->GetString(*shown, id).size() != 32) note += " WITHOUT AN ID";
      shown->GetReflection()->ClearField(shown.get(), id);
    }
    const std::string text = shown->ShortDebugString();
    const std::lock_guard lock(mutex_);
    notes_.push_back(note + (text.empty() ? "" : " " + text));
  }
  // Since it was asked last.
  std::string Take() {
    const std::lock_guard lock(mutex_);
    std::string all;
    for (const std::string& note : std::exchange(notes_, {})) all += note + "\n";
    return all;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> notes_;
};

// Does nothing, and answers with what it was given.
class FakeMachine : public v1::MachineService::Service {
 public:
  explicit FakeMachine(CallNotes& calls) : calls_(calls) {}

  v1::Machine machine{};                        // the status apart
  std::vector<v1::MachineStatus> statuses{{}};  // one after the other; the last one from then on
  std::map<std::string, grpc::Status> refused{};
  v1::AcquireControlResponse control = [] {
    v1::AcquireControlResponse made;
    made.set_control_token("t");
    return made;
  }();
  v1::ArmMachineResponse armed{};
  v1::ReadVariablesResponse variables{};
  v1::PreviewStartResponse preview{};
  std::vector<v1::WatchMachineResponse> watched{};

  using Context = grpc::ServerContext*;
  grpc::Status GetMachine(Context, const v1::GetMachineRequest* request,
                          v1::Machine* response) override {
    *response = machine;
    *response->mutable_status() = Next();
    return Noted("GetMachine", *request);
  }
  grpc::Status UpdateMachine(Context, const v1::UpdateMachineRequest* request,
                             v1::Machine* response) override {
    *response = request->machine();
    return Noted("UpdateMachine", *request);
  }
  grpc::Status WatchMachine(Context, const v1::WatchMachineRequest* request,
                            grpc::ServerWriter<v1::WatchMachineResponse>* writer) override {
    const grpc::Status end = Noted("WatchMachine", *request);
    for (const v1::WatchMachineResponse& one : watched) writer->Write(one);
    return end;
  }
  grpc::Status AcquireControl(Context, const v1::AcquireControlRequest* request,
                              v1::AcquireControlResponse* response) override {
    *response = control;
    return Noted("AcquireControl", *request);
  }
  grpc::Status RenewControl(Context, const v1::RenewControlRequest* request,
                            v1::RenewControlResponse* /*response*/) override {
    calls_.Add("RenewControl token " + request->control_token(), v1::GetMachineRequest());
    return Refusal("RenewControl");
  }
  grpc::Status ReleaseControl(Context, const v1::ReleaseControlRequest* request,
                              google::protobuf::Empty* /*response*/) override {
    calls_.Add("ReleaseControl token " + request->control_token(), v1::GetMachineRequest());
    return Refusal("ReleaseControl");
  }
  grpc::Status EnableMachine(Context, const v1::EnableMachineRequest* request,
                             v1::MachineStatus* response) override {
    return Answer("EnableMachine", *request, *response);
  }
  grpc::Status DisableMachine(Context, const v1::DisableMachineRequest* request,
                              v1::MachineStatus* response) override {
    return Answer("DisableMachine", *request, *response);
  }
  grpc::Status TakeMachine(Context, const v1::TakeMachineRequest* request,
                           v1::MachineStatus* response) override {
    return Answer("TakeMachine", *request, *response);
  }
  grpc::Status StartMachine(Context, const v1::StartMachineRequest* request,
                            v1::MachineStatus* response) override {
    return Answer("StartMachine", *request, *response);
  }
  grpc::Status ZeroMachine(Context, const v1::ZeroMachineRequest* request,
                           v1::MachineStatus* response) override {
    return Answer("ZeroMachine", *request, *response);
  }
  grpc::Status ResumeMachine(Context, const v1::ResumeMachineRequest* request,
                             v1::MachineStatus* response) override {
    return Answer("ResumeMachine", *request, *response);
  }
  grpc::Status StopMachine(Context, const v1::StopMachineRequest* request,
                           v1::HaltResponse* response) override {
    return Answer("StopMachine", *request, *response->mutable_status());
  }
  grpc::Status HoldMachine(Context, const v1::HoldMachineRequest* request,
                           v1::HaltResponse* response) override {
    return Answer("HoldMachine", *request, *response->mutable_status());
  }
  grpc::Status EmergencyStopMachine(Context, const v1::EmergencyStopMachineRequest* request,
                                    v1::HaltResponse* response) override {
    return Answer("EmergencyStopMachine", *request, *response->mutable_status());
  }
  grpc::Status AbortRun(Context, const v1::AbortRunRequest* request,
                        v1::MachineStatus* response) override {
    return Answer("AbortRun", *request, *response);
  }
  grpc::Status SetMode(Context, const v1::SetModeRequest* request,
                       v1::MachineStatus* response) override {
    return Answer("SetMode", *request, *response);
  }
  grpc::Status SetOverride(Context, const v1::SetOverrideRequest* request,
                           v1::MachineStatus* response) override {
    return Answer("SetOverride", *request, *response);
  }
  grpc::Status SetFactor(Context, const v1::SetFactorRequest* request,
                         v1::MachineStatus* response) override {
    return Answer("SetFactor", *request, *response);
  }
  grpc::Status AcknowledgeAlarm(Context, const v1::AcknowledgeAlarmRequest* request,
                                v1::MachineStatus* response) override {
    return Answer("AcknowledgeAlarm", *request, *response);
  }
  grpc::Status ConfirmMachine(Context, const v1::ConfirmMachineRequest* request,
                              v1::MachineStatus* response) override {
    return Answer("ConfirmMachine", *request, *response);
  }
  grpc::Status SetInputs(Context, const v1::SetInputsRequest* request,
                         v1::MachineStatus* response) override {
    return Answer("SetInputs", *request, *response);
  }
  grpc::Status SetGates(Context, const v1::SetGatesRequest* request,
                        v1::MachineStatus* response) override {
    return Answer("SetGates", *request, *response);
  }
  grpc::Status ReadVariables(Context, const v1::ReadVariablesRequest* request,
                             v1::ReadVariablesResponse* response) override {
    *response = variables;
    return Noted("ReadVariables", *request);
  }
  grpc::Status WriteVariables(Context, const v1::WriteVariablesRequest* request,
                              v1::WriteVariablesResponse* response) override {
    *response->mutable_variables() = variables.variables();
    return Noted("WriteVariables", *request);
  }
  grpc::Status ArmMachine(Context, const v1::ArmMachineRequest* request,
                          v1::ArmMachineResponse* response) override {
    *response = armed;
    return Noted("ArmMachine", *request);
  }
  grpc::Status PreviewStart(Context, const v1::PreviewStartRequest* request,
                            v1::PreviewStartResponse* response) override {
    *response = preview;
    return Noted("PreviewStart", *request);
  }
  grpc::Status StartAtStep(Context, const v1::StartAtStepRequest* request,
                           v1::MachineStatus* response) override {
    return Answer("StartAtStep", *request, *response);
  }
  grpc::Status PressPanelKey(Context, const v1::PressPanelKeyRequest* request,
                             v1::MachineStatus* response) override {
    return Answer("PressPanelKey", *request, *response);
  }
  grpc::Status HeartbeatPanel(Context, const v1::HeartbeatPanelRequest* request,
                              v1::HeartbeatResponse* /*response*/) override {
    beats.push_back(*request);
    return Refusal("HeartbeatPanel");
  }

  std::vector<v1::HeartbeatPanelRequest> beats{};

 private:
  v1::MachineStatus Next() {
    v1::MachineStatus next = statuses.front();
    if (statuses.size() > 1) statuses.erase(statuses.begin());
    return next;
  }
  grpc::Status Refusal(const std::string& name) const {
    const auto found = refused.find(name);
    return found == refused.end() ? grpc::Status() : found->second;
  }
  grpc::Status Noted(const std::string& name, const google::protobuf::Message& request) {
    calls_.Add(name, request);
    return Refusal(name);
  }
  grpc::Status Answer(const std::string& name, const google::protobuf::Message& request,
                      v1::MachineStatus& response) {
    response = Next();
    return Noted(name, request);
  }

  CallNotes& calls_;
};

// Says lines of `rmlcell machine`.
class MachineWords : public testing::Test {
 protected:
  // "mode m cycle"
  Told Say(const std::string& line, bool json = false) {
    std::istringstream text("machine " + line);
    std::vector<std::string> words;
    for (std::string word; text >> word;) words.insert(words.begin(), word);
    Remote remote = server_->remote(json);
    return Hear([&] {
      int exit_code = -1;
      CLI::App app;
      AddMachineVerbs(app, remote, exit_code);
      try {
        app.parse(words);
      } catch (const CLI::ParseError& error) {
        Complain(error.what());
        return int{kUsage};
      }
      return exit_code;
    });
  }
  std::string Calls() { return calls_.Take(); }

  CliFolder folder_;
  CallNotes calls_;
  FakeMachine machine_{calls_};
  std::unique_ptr<FakeServer> server_ =
      std::make_unique<FakeServer>(folder_, std::vector<grpc::Service*>{&machine_});
};

// Of a call that takes control and gives it back.
inline std::string WithControlFor(const std::string& call, const std::string& asked = {}) {
  return "AcquireControl machine: \"machines/m\" on_loss: ON_LOSS_GO_ON client: \"rmlcell\"" +
         asked + "\n" + call + "\nReleaseControl token t\n";
}

}  // namespace rmlcell::cli
