#pragma once

#include <deque>
#include <string>
#include <vector>

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Before or behind what is written. LIVE-3.20
enum class OrderClass {
  kActsFirst,  // it halts, and goes before all that waits
  kLetsGo,     // a key: it acts at once, in its place
  kWrittenFirst,
  kWrittenBehind,
  kAsks,
};

OrderClass ClassOf(const v1::HostOrder& order);

inline bool IsHalt(const v1::HostOrder& order) {
  return order.has_stop() || order.has_hold() || order.has_emergency_stop();
}

// What a STOP that comes behind it takes back, as long as it has not acted.
inline bool BeginsMotion(const v1::HostOrder& order) {
  return order.has_start() || order.has_resume() || order.has_run_job() || order.has_zero() ||
         order.has_continue_job() || order.has_start_at_step() ||
         ((order.has_panel_key() || order.has_key() || order.has_inputs()) &&
          ClassOf(order) == OrderClass::kWrittenFirst);
}

// Of an order that begins the run of a job; null: it does not.
inline const v1::WorkerAssignment* AssignmentOf(const v1::HostOrder& order) {
  if (order.has_run_job()) return &order.run_job();
  return order.has_continue_job() ? &order.continue_job().assignment() : nullptr;
}

inline std::string JobOf(const v1::HostOrder& order) {
  const v1::WorkerAssignment* assignment = AssignmentOf(order);
  return assignment != nullptr ? assignment->job().name() : std::string();
}

bool Halts(const v1::HostResponse& message);
// What halts goes before all else, and takes out what stood before it and would begin a motion
// behind it.
std::vector<v1::HostOrder> StopFirst(std::deque<v1::HostResponse>& messages);

}  // namespace rmlcell::server
