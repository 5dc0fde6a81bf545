#include "server/host/waiting_messages.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/host/order_class.h"

namespace rmlcell::server {
namespace {

// Heartbeats and overrides are what a machine slows down by, and are never too many: each client
// has one under way.
bool IsCounted(const v1::HostOrder& order) {
  return order.request_case() != v1::HostOrder::kOverride && !order.has_panel_heartbeat() &&
         !order.has_handbox_heartbeat();
}

v1::HostOrder StopFor(const v1::HostOrder& order) {
  const bool key = order.has_key() || order.has_panel_key();
  if (key || order.has_emergency_stop() || order.has_abort() || order.has_disarm()) return order;
  v1::HostOrder stop;
  stop.set_number(order.number());
  stop.set_caller(order.caller());
  stop.mutable_stop();
  return stop;
}

v1::HostOrder NumberOf(const v1::HostOrder& order) {
  if (order.has_key() || order.has_panel_key()) return order;
  v1::HostOrder number;
  number.set_number(order.number());
  return number;
}

}  // namespace

void WaitingMessages::Taken::Append(Taken more) {
  std::ranges::move(more.messages, std::back_inserter(messages));
  std::ranges::move(more.stops, std::back_inserter(stops));
  std::ranges::move(more.refused, std::back_inserter(refused));
}

std::vector<v1::HostOrder> WaitingMessages::Taken::TakeMotions() {
  std::vector<v1::HostOrder> taken;
  std::erase_if(messages, [&](const v1::HostResponse& message) {
    if (!message.has_order() || !BeginsMotion(message.order())) return false;
    taken.push_back(message.order());
    return true;
  });
  return taken;
}

void WaitingMessages::Add(v1::HostResponse message) {
  if (message.has_order() && IsCounted(message.order())) {
    const OrderClass kind = ClassOf(message.order());
    const bool halts = kind == OrderClass::kActsFirst || kind == OrderClass::kLetsGo;
    if ((halts ? halts_ : orders_)++ >= kOrdersMax) {
      if (halts) taken_.stops.push_back(StopFor(message.order()));
      if (!halts) taken_.refused.push_back(NumberOf(message.order()));
      return;
    }
  }
  taken_.messages.push_back(std::move(message));
}

WaitingMessages::Taken WaitingMessages::Take() {
  orders_ = halts_ = 0;
  return std::exchange(taken_, {});
}

}  // namespace rmlcell::server
