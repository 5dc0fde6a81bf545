#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "clients/cli/machine_call.h"
#include "rmlcell/v1/handbox.grpc.pb.h"
#include "rmlcell/v1/machine.grpc.pb.h"

namespace rmlcell::cli {

// What is to be seen of a machine with a handbox, as it was told last.
struct HandboxSeen {
  v1::HandboxPanel panel;
  v1::MachineStatus status;
  std::optional<grpc::Status> lost;  // why nothing more is told, or control is not kept any more
};

// Follows handbox and machine, and keeps control, on threads of its own, until it is deleted. A
// line that ends is not taken up again: whoever held a key must press it anew.
class HandboxWatch {
 public:
  // `changed` is called on those threads. What it is given must outlive it.
  HandboxWatch(const std::shared_ptr<grpc::Channel>& channel, const std::string& machine,
               const Control& control, std::chrono::seconds control_time,
               std::function<void()> changed);
  ~HandboxWatch();
  HandboxWatch(const HandboxWatch&) = delete;
  HandboxWatch& operator=(const HandboxWatch&) = delete;

  HandboxSeen seen() const;

 private:
  void FollowHandbox(const std::string& machine);
  void FollowMachine(const std::string& machine);
  void KeepControl(const Control& control, std::chrono::seconds control_time);
  void Lose(grpc::Status why);

  std::unique_ptr<v1::HandboxService::Stub> handbox_;
  std::unique_ptr<Service::Stub> machine_;
  const std::function<void()> changed_;
  grpc::ClientContext handbox_context_{};
  grpc::ClientContext machine_context_{};

  mutable std::mutex mutex_{};
  std::condition_variable ending_{};
  bool ends_ = false;
  HandboxSeen seen_{};

  std::jthread handbox_thread_{};
  std::jthread machine_thread_{};
  std::jthread control_thread_{};
};

}  // namespace rmlcell::cli
