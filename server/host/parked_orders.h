#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Of an order that somebody stopped first.
inline Error StoppedBefore() {
  return {ErrorCode::kCellMachineState, "it was stopped before it began", {}};
}

// Orders that have not begun: that they are about to is on its way to the disk. LIVE-3.21
class ParkedOrders {
 public:
  struct Parked {
    v1::HostOrder order{};
    std::chrono::nanoseconds until{0};
    bool over = false;  // it begins no more, or has begun
  };
  using Pointer = std::shared_ptr<Parked>;

  Pointer Add(const v1::HostOrder& order, std::chrono::nanoseconds until);
  bool HasJob(const std::string& job) const;
  bool HasKey() const;

  // Those that would begin a motion, of a job (empty: of all) what begins it: over, and returned.
  std::vector<v1::HostOrder> TakeMotions(const std::string& job);
  // The disk was too slow for them.
  std::vector<v1::HostOrder> TakeLate(std::chrono::nanoseconds now);
  // The line that has brought them is gone; of other lines the numbers are below 0.
  void ForgetLine();
  void ForgetAll();

 private:
  std::vector<Pointer> parked_;
};

}  // namespace rmlcell::server
