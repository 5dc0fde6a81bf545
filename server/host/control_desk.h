#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "rmlcell/v1/machine_control.pb.h"
#include "rmlcell/v1/run_event.pb.h"
#include "server/host/host_time.h"

namespace rmlcell::server {

// Who has control of a machine: one client at a time, by a token that is shown once. The host has
// it, so all servers agree. LIVE-4.01 to 4.03
class ControlDesk {
 public:
  static constexpr std::chrono::milliseconds kTtlMin{1'000};
  static constexpr std::chrono::milliseconds kTtlMax{60'000};
  static constexpr std::chrono::milliseconds kTtl{5'000};
  static constexpr std::size_t kReasonMax = 200;
  static constexpr std::size_t kClientMax = 100;

  // `make_token`: 128 bits that nobody can guess, as text.
  explicit ControlDesk(std::function<std::string()> make_token)
      : make_token_(std::move(make_token)) {}

  // Errors: CellLeaseHeld with who has it, since when; CellInvalidArgument.
  Result<v1::AcquireControlResponse> Acquire(const v1::AcquireControlRequest& request,
                                             const std::string& caller, const HostTime& now);
  // Errors: CellControlNeeded; one that is over comes back by Acquire alone.
  Result<v1::ControlLease> Renew(std::string_view token, const HostTime& now);
  Result<v1::ControlLease::OnLoss> Release(std::string_view token, const HostTime& now);
  // CellControlNeeded: no token, or that of a lease that is over, with who has control now.
  Status Check(std::string_view token, const HostTime& now) const;

  // For the run of a job when nobody has it: nobody has the token, and it does not run out.
  // LIVE-4.05
  void GiveToQueue(const std::string& job, v1::ControlLease::OnLoss on_loss, const HostTime& now);
  // What is wanted of a run that begins counts before what the lease of a person says, and stands
  // in it until the run is over; unspecified: nothing else is wanted. LIVE-4.02
  void RunBegins(v1::ControlLease::OnLoss wanted);
  void RunIsOver();  // with it ends the lease of the queue
  bool IsOfQueue() const { return of_queue_; }

  // A lease that has run out by now: it is over, and this says how a run is to be kept.
  std::optional<v1::ControlLease::OnLoss> Expire(const HostTime& now);

  // Number of the newest lease; whoever comes behind a crash goes on with it.
  std::int64_t number() const { return number_; }
  void CountFrom(std::int64_t number) { number_ = number; }
  // Of now; nothing: nobody has control.
  const std::optional<v1::ControlLease>& lease() const { return lease_; }
  std::optional<std::chrono::nanoseconds> runs_out() const;
  // How it changed hands last, for all to read; once.
  std::optional<v1::ControlChanged> TakeChange() { return std::exchange(change_, std::nullopt); }

 private:
  bool IsToken(std::string_view token) const;
  void Give(const std::string& holder, v1::ControlLease::OnLoss on_loss, const HostTime& now);
  void Prolong(const HostTime& now);
  void End(v1::ControlChanged::Kind kind);

  std::function<std::string()> make_token_;
  std::int64_t number_ = 0;
  std::optional<v1::ControlLease> lease_;
  std::string token_sha256_;  // whoever reads the memory of this has no token
  bool of_queue_ = false;
  std::optional<v1::ControlLease::OnLoss> behind_run_;  // as the person wanted who took it
  std::chrono::nanoseconds ttl_{0};
  std::chrono::nanoseconds runs_out_{0};
  std::optional<v1::ControlChanged> change_;
};

}  // namespace rmlcell::server
