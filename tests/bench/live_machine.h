#pragma once

#include <google/protobuf/util/time_util.h>
#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/program.grpc.pb.h"
#include "tests/bench/cell_server.h"

namespace rmlcell::bench {

namespace v1 = rmlcell::v1;

inline std::string Lines(int count, int longest) {
  std::string text = "PA;PA;VS1;!VZ1;!PZ0,200;!MC1;PU0,0;";
  for (int i = 0; i < count; ++i)
    text += "PD" + std::to_string(i * 37 % longest) + "," + std::to_string(i * 53 % longest) + ";";
  return text + "PU0,0;H;";
}

inline std::string NewId() {
  static std::atomic<int> made = 0;
  char text[40];
  std::snprintf(text, sizeof text, "00000000-0000-4000-8000-%012d", ++made);
  return text;
}

inline double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

inline double SecondsOf(const google::protobuf::Timestamp& time) {
  return static_cast<double>(time.seconds()) + time.nanos() * 1e-9;
}

// A machine that lives, with a program in slot 5 and control of it.
class LiveMachine {
 public:
  LiveMachine(const CellServer& server, std::string name, const std::string& file = "lines.rml",
              const std::string& content = Lines(2'000, 5'000))
      : name_(std::move(name)), calls_(v1::MachineService::NewStub(server.Connect())) {
    v1::EnableMachineRequest enable;
    enable.set_machine(name_);
    enable.set_request_id(NewId());
    Status(&v1::MachineService::Stub::EnableMachine, enable);
    v1::PutProgramRequest put;
    put.set_name(name_ + "/programs/5");
    put.mutable_program()->set_file_name(file);
    put.mutable_program()->set_content(content);
    grpc::ClientContext context;
    v1::Program stored;
    Must(v1::ProgramService::NewStub(server.Connect())->PutProgram(&context, put, &stored));
    TakeControl();
  }
  ~LiveMachine() {
    watching_.TryCancel();
    if (watcher_.joinable()) watcher_.join();
  }

  void Start() {
    v1::StartMachineRequest start;
    start.set_machine(name_);
    start.set_control_token(token_);
    start.set_request_id(NewId());
    start.set_program(5);
    Status(&v1::MachineService::Stub::StartMachine, start);
  }
  // How fast its time goes, as many times as the clock.
  void SetFactor(double factor) {
    v1::SetFactorRequest set;
    set.set_machine(name_);
    set.set_control_token(token_);
    set.set_request_id(NewId());
    set.set_factor(factor);
    Status(&v1::MachineService::Stub::SetFactor, set);
  }
  double SecondsToStop() {
    v1::StopMachineRequest stop;
    stop.set_machine(name_);
    const auto begin = Clock::now();
    grpc::ClientContext context;
    v1::HaltResponse answer;
    Must(calls_->StopMachine(&context, stop, &answer));
    return SecondsSince(begin);
  }
  double SecondsToResume() {
    v1::ResumeMachineRequest resume;
    resume.set_machine(name_);
    resume.set_control_token(token_);
    resume.set_request_id(NewId());
    const auto begin = Clock::now();
    Status(&v1::MachineService::Stub::ResumeMachine, resume);
    return SecondsSince(begin);
  }
  v1::MachineStatus Now() {
    v1::GetMachineRequest request;
    request.set_name(name_);
    grpc::ClientContext context;
    v1::Machine machine;
    Must(calls_->GetMachine(&context, request, &machine));
    return machine.status();
  }
  void Await(v1::MachineState state) {
    while (Now().state() != state) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  // From the last heartbeat of a jog key that is down until the machine brakes, by the clock that
  // both processes have. It stands then.
  double SecondsToBrake() {
    v1::PressPanelKeyRequest press;
    press.set_machine(name_);
    press.set_control_token(token_);
    press.set_key(++keys_ % 4 < 2 ? "X+" : "X-");
    press.set_action(v1::KEY_ACTION_PRESS);
    press.set_sequence(keys_);
    Status(&v1::MachineService::Stub::PressPanelKey, press);
    double sent = 0.0;
    for (int beat = 0; beat < 6; ++beat) {
      v1::HeartbeatPanelRequest heartbeat;
      heartbeat.set_machine(name_);
      heartbeat.set_control_token(token_);
      heartbeat.set_number(++beats_);
      heartbeat.add_keys_down(press.key());
      sent = WallSeconds();
      *heartbeat.mutable_sent() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
          static_cast<std::int64_t>(sent * 1e6));
      grpc::ClientContext context;
      v1::HeartbeatResponse heard;
      Must(calls_->HeartbeatPanel(&context, heartbeat, &heard));
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    double braked = 0.0;
    for (;;) {
      const v1::MachineStatus now = Now();
      if (now.state() == v1::MACHINE_STATE_JOGGING) continue;
      braked = SecondsOf(now.send_time());
      break;
    }
    Await(v1::MACHINE_STATE_IDLE);
    press.set_action(v1::KEY_ACTION_RELEASE);
    press.set_sequence(++keys_);
    Status(&v1::MachineService::Stub::PressPanelKey, press);
    return braked - sent;
  }
  pid_t host() {
    const std::string host = Now().host();
    return std::atoi(host.substr(host.find('/') + 1).c_str());
  }
  // Collects how old each status is that arrives, by the clock that both processes have.
  void Watch() {
    v1::WatchMachineRequest request;
    request.set_name(name_);
    events_ = calls_->WatchMachine(&watching_, request);
    watcher_ = std::thread([this] {
      v1::WatchMachineResponse message;
      while (events_->Read(&message)) {
        if (message.status().state() != v1::MACHINE_STATE_RUNNING) continue;
        const double age = WallSeconds() - SecondsOf(message.status().send_time());
        const std::lock_guard lock(mutex_);
        ages_.push_back(age);
      }
    });
  }
  std::vector<double> TakeAges() {
    const std::lock_guard lock(mutex_);
    return std::exchange(ages_, {});
  }
  void TakeControl() {
    v1::AcquireControlRequest acquire;
    acquire.set_machine(name_);
    acquire.mutable_ttl()->set_seconds(60);
    acquire.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
    acquire.set_take_over(true);
    acquire.set_reason("a bench");
    acquire.set_request_id(NewId());
    grpc::ClientContext context;
    v1::AcquireControlResponse answer;
    Must(calls_->AcquireControl(&context, acquire, &answer));
    token_ = answer.control_token();
    keys_ = beats_ = 0;  // they are counted by whoever has control
  }

 private:
  template <class Method, class Request>
  void Status(Method method, const Request& request) {
    grpc::ClientContext context;
    v1::MachineStatus status;
    Must((calls_.get()->*method)(&context, request, &status));
  }

  const std::string name_;
  std::unique_ptr<v1::MachineService::Stub> calls_;
  std::string token_;
  std::int64_t keys_ = 0;
  std::int64_t beats_ = 0;
  grpc::ClientContext watching_;
  std::unique_ptr<grpc::ClientReader<v1::WatchMachineResponse>> events_;
  std::thread watcher_;
  std::mutex mutex_;
  std::vector<double> ages_;  // guarded by mutex_
};

}  // namespace rmlcell::bench
