#pragma once

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// Before or behind what is written. LIVE-3.20
enum class OrderClass { kActsFirst, kWrittenFirst, kWrittenBehind, kAsks };

OrderClass ClassOf(const v1::HostOrder& order);

// What a STOP that comes behind it takes back, as long as it has not acted.
inline bool BeginsMotion(const v1::HostOrder& order) {
  return order.has_start() || order.has_resume() || order.has_run_job() || order.has_zero();
}

}  // namespace rmlcell::server
