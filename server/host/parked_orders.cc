#include "server/host/parked_orders.h"

#include <algorithm>
#include <utility>

#include "server/host/order_class.h"

namespace rmlcell::server {

ParkedOrders::Pointer ParkedOrders::Add(const v1::HostOrder& order,
                                        std::chrono::nanoseconds until) {
  return parked_.emplace_back(std::make_shared<Parked>(Parked{.order = order, .until = until}));
}

bool ParkedOrders::HasJob(const std::string& job) const {
  return std::ranges::any_of(
      parked_, [&](const Pointer& one) { return !one->over && JobOf(one->order) == job; });
}

bool ParkedOrders::HasKey() const {
  return std::ranges::any_of(parked_, [](const Pointer& one) {
    return !one->over && (one->order.has_key() || one->order.has_panel_key());
  });
}

std::vector<v1::HostOrder> ParkedOrders::TakeMotions(const std::string& job) {
  std::vector<v1::HostOrder> taken;
  for (const Pointer& one : parked_) {
    const bool meant = job.empty() || JobOf(one->order) == job;
    if (meant && BeginsMotion(one->order) && !std::exchange(one->over, true))
      taken.push_back(one->order);
  }
  return taken;
}

std::vector<v1::HostOrder> ParkedOrders::TakeLate(std::chrono::nanoseconds now) {
  std::vector<v1::HostOrder> late;
  std::erase_if(parked_, [&](const Pointer& one) {
    if (one->over) return true;
    if (now < one->until) return false;
    one->over = true;
    late.push_back(one->order);
    return true;
  });
  return late;
}

void ParkedOrders::ForgetLine() {
  for (const Pointer& one : parked_) one->over = one->over || one->order.number() > 0;
}

void ParkedOrders::ForgetAll() {
  for (const Pointer& one : parked_) one->over = true;
}

}  // namespace rmlcell::server
