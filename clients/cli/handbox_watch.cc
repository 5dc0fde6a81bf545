#include "clients/cli/handbox_watch.h"

#include <utility>

namespace rmlcell::cli {

HandboxWatch::HandboxWatch(const std::shared_ptr<grpc::Channel>& channel,
                           const std::string& machine, const Control& control,
                           std::chrono::seconds control_time, std::function<void()> changed)
    : handbox_(v1::HandboxService::NewStub(channel)),
      machine_(Service::NewStub(channel)),
      changed_(std::move(changed)),
      handbox_thread_([this, machine] { FollowHandbox(machine); }),
      machine_thread_([this, machine] { FollowMachine(machine); }),
      control_thread_([this, &control, control_time] { KeepControl(control, control_time); }) {}

HandboxWatch::~HandboxWatch() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  ending_.notify_all();
  handbox_context_.TryCancel();
  machine_context_.TryCancel();
}

HandboxSeen HandboxWatch::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

void HandboxWatch::FollowHandbox(const std::string& machine) {
  v1::WatchHandboxRequest request;
  request.set_machine(machine);
  const auto stream = handbox_->WatchHandbox(&handbox_context_, request);
  for (v1::WatchHandboxResponse message; stream->Read(&message);) {
    {
      const std::lock_guard lock(mutex_);
      seen_.panel = std::move(*message.mutable_panel());
    }
    changed_();
  }
  Lose(stream->Finish());
}

void HandboxWatch::FollowMachine(const std::string& machine) {
  constexpr double kRate_hz = 10.0;  // what an eye can read of a number
  v1::WatchMachineRequest request;
  request.set_name(machine);
  request.set_max_rate_hz(kRate_hz);
  const auto stream = machine_->WatchMachine(&machine_context_, request);
  for (v1::WatchMachineResponse message; stream->Read(&message);) {
    if (!message.has_status()) continue;
    {
      const std::lock_guard lock(mutex_);
      seen_.status = std::move(*message.mutable_status());
    }
    changed_();
  }
  Lose(stream->Finish());
}

void HandboxWatch::KeepControl(const Control& control, std::chrono::seconds control_time) {
  const auto between = std::chrono::milliseconds(control_time) / 3;
  for (std::unique_lock lock(mutex_); !ending_.wait_for(lock, between, [this] { return ends_; });) {
    lock.unlock();
    if (grpc::Status renewed = control.Renew(control_time); !renewed.ok()) Lose(std::move(renewed));
    lock.lock();
  }
}

// The first reason is the one: others follow from it. A stream that ended well did so without a
// reason, and the server with it.
void HandboxWatch::Lose(grpc::Status why) {
  {
    const std::lock_guard lock(mutex_);
    if (ends_ || seen_.lost) return;
    seen_.lost = why.ok() ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server has ended")
                          : std::move(why);
  }
  changed_();
}

}  // namespace rmlcell::cli
