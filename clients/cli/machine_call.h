#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "clients/cli/remote_call.h"
#include "clients/cli/remote_machines.h"
#include "clients/cli/request_id.h"
#include "rmlcell/v1/machine.grpc.pb.h"

// Calls about machines that live: one answer each, and control for as long as one takes.
namespace rmlcell::cli {

using Service = v1::MachineService;

// Whoever holds a key says so that often. LIVE-7.05
inline constexpr std::chrono::milliseconds kBetweenBeats{50};

// "RUNNING" of "MACHINE_STATE_RUNNING".
std::string Short(std::string_view name, std::string_view prefix);

std::string ValueText(const v1::VariableValue& value);

int Show(const Remote& remote, const v1::MachineStatus& status);
// When the control that was taken for it has been given back.
int ShowOwn(const Remote& remote, v1::MachineStatus status);

// Until the axes stand, 3 s at most: whoever gives control back before is stopped by that.
void AwaitRest(const Remote& remote, const std::string& machine);

// How a machine stands, where it can be told.
std::optional<v1::MachineStatus> StatusNow(const Remote& remote, const std::string& machine);

// A call with one answer; the stub is made for it.
template <class Request, class Response>
grpc::Status Call(const Remote& remote,
                  grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                        Response*),
                  const Request& request, Response& response,
                  std::chrono::seconds patience = kUnaryDeadline) {
  const auto stub = Service::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context, patience);
  return (stub.get()->*method)(&context, request, &response);
}

template <class Request>
Request For(const MachineAct& act) {
  Request request;
  request.set_machine(FullName("machines", act.machine));
  request.set_request_id(NewRequestId());
  return request;
}

// Control of a machine for as long as one request takes.
class Control {
 public:
  // For so long at most; 0: for a moment.
  Control(const Remote& remote, const MachineAct& act, int seconds = 0,
          const std::string& client = "rmlcell")
      : remote_(remote), act_(act) {
    auto request = For<v1::AcquireControlRequest>(act);
    request.set_client(client);
    if (seconds > 0) request.mutable_ttl()->set_seconds(seconds);
    request.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
    request.set_take_over(!act.take_over.empty());
    request.set_reason(act.take_over);
    v1::AcquireControlResponse response;
    status_ = Call(remote, &Service::Stub::AcquireControl, request, response);
    token_ = response.control_token();
  }
  ~Control() {
    if (token_.empty()) return;
    v1::ReleaseControlRequest request;
    request.set_machine(FullName("machines", act_.machine));
    request.set_control_token(token_);
    google::protobuf::Empty none;
    // Whoever ends is not kept by a server that has gone: control runs out by itself.
    static_cast<void>(
        Call(remote_, &Service::Stub::ReleaseControl, request, none, remote_.short_patience));
  }
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  const grpc::Status& status() const { return status_; }
  const std::string& token() const { return token_; }

  // At a third of its time; so that it does not run out.
  grpc::Status Renew(std::chrono::seconds patience) const {
    v1::RenewControlRequest request;
    request.set_machine(FullName("machines", act_.machine));
    request.set_control_token(token_);
    v1::RenewControlResponse renewed;
    return Call(remote_, &Service::Stub::RenewControl, request, renewed, patience);
  }

 private:
  const Remote& remote_;
  const MachineAct& act_;
  grpc::Status status_;
  std::string token_;
};

template <class Request, class Response>
int WithControl(const Remote& remote, const MachineAct& act,
                grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                      Response*),
                Request request,
                const std::function<int(const Response&, const std::string& token)>& show) {
  const Control control(remote, act);
  if (!control.status().ok()) return Refused(control.status(), remote);
  request.set_control_token(control.token());
  Response response;
  const grpc::Status status = Call(remote, method, request, response);
  return status.ok() ? show(response, control.token()) : Refused(status, remote);
}

template <class Request>
int ShowWithControl(const Remote& remote, const MachineAct& act,
                    grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                          v1::MachineStatus*),
                    Request request) {
  return WithControl<Request, v1::MachineStatus>(
      remote, act, method, std::move(request),
      [&remote](const v1::MachineStatus& status, const std::string&) {
        return ShowOwn(remote, status);
      });
}

}  // namespace rmlcell::cli
