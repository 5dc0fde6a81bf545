#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/machine_control.pb.h"
#include "rmlcell/v1/machine_status.pb.h"
#include "server/host/host_time.h"

namespace rmlcell::server {

// A machine whose jobs start when a person has armed it: for one job, or for whichever is next; for
// a while, and until anything of what he has seen to is another. LIVE-5.04, DEV-1.41
class ArmDesk {
 public:
  static constexpr std::chrono::seconds kLasts{120};
  static constexpr std::chrono::seconds kLongest{600};

  explicit ArmDesk(std::function<std::string()> make_token) : make_token_(std::move(make_token)) {}

  // Replaces what it was armed for before. Errors: CellInvalidArgument; CellNotArmed: what a person
  // must have seen to is not all named.
  Result<v1::ArmMachineResponse> Arm(const v1::ArmMachineRequest& request,
                                     const std::string& caller, std::int64_t control_lease,
                                     std::uint64_t memory, const HostTime& now);
  void Disarm() { armed_.reset(); }
  bool is_armed() const { return armed_.has_value(); }
  // It is over by time, with another control lease, with another memory.
  void Expire(std::int64_t control_lease, std::uint64_t memory, const HostTime& now);

  // Error: CellNotArmed. `token`: of the person who starts it; none: the queue does.
  Status MayStart(const std::string& job, const std::optional<std::string>& token) const;
  // Of the run that it was armed for, which begins.
  v1::ControlLease::OnLoss on_loss() const;
  void AddTo(v1::MachineStatus& status) const;

 private:
  struct Armed {
    std::string token{};
    std::string job{};  // empty: whichever is next
    std::string by{};
    std::int64_t control_lease = 0;
    std::uint64_t memory = 0;
    v1::ControlLease::OnLoss on_loss = v1::ControlLease::ON_LOSS_HOLD;
    std::chrono::nanoseconds until{0};
    WallTime until_wall{};
  };

  std::function<std::string()> make_token_;
  std::optional<Armed> armed_{};
};

}  // namespace rmlcell::server
