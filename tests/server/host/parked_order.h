// Orders as they wait in ParkedOrders.
#pragma once

#include <cstdint>
#include <string>

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

inline v1::HostOrder ParkedStart(std::int64_t number) {
  v1::HostOrder order;
  order.set_number(number);
  order.mutable_start();
  return order;
}

inline v1::HostOrder ParkedRun(std::int64_t number, const std::string& job) {
  v1::HostOrder order;
  order.set_number(number);
  order.mutable_run_job()->mutable_job()->set_name(job);
  return order;
}

}  // namespace rmlcell::server
