#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <utility>
#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/host/order_class.h"

namespace rmlcell::server {

// What a line has brought and the thread of the machine has not taken yet; bounded, whatever comes.
// LIVE-3.10
class WaitingMessages {
 public:
  // Orders; those that halt are counted apart, so that none of them finds it full.
  static constexpr std::size_t kOrdersMax = 256;

  struct Taken {
    std::deque<v1::HostResponse> messages{};
    std::vector<std::int64_t> stops{};    // beyond the bound one STOP stands for all that halt
    std::vector<std::int64_t> refused{};  // there was no room for the others

    void Append(Taken more) {
      std::ranges::move(more.messages, std::back_inserter(messages));
      stops.insert(stops.end(), more.stops.begin(), more.stops.end());
      refused.insert(refused.end(), more.refused.begin(), more.refused.end());
    }
  };

  void Add(v1::HostResponse message) {
    if (message.has_order()) {
      const bool halts = Halts(message);
      if ((halts ? halts_ : orders_)++ >= kOrdersMax) {
        (halts ? taken_.stops : taken_.refused).push_back(message.order().number());
        return;
      }
    }
    taken_.messages.push_back(std::move(message));
  }
  Taken Take() {
    orders_ = halts_ = 0;
    return std::exchange(taken_, {});
  }
  bool empty() const { return taken_.messages.empty(); }

 private:
  std::size_t orders_ = 0;
  std::size_t halts_ = 0;
  Taken taken_;
};

}  // namespace rmlcell::server
