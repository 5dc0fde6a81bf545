#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// What a line has brought and the thread of the machine has not taken yet; bounded, whatever comes.
// LIVE-3.10
class WaitingMessages {
 public:
  // Orders; those that halt, let go or slow down are counted apart.
  static constexpr std::size_t kOrdersMax = 256;

  struct Taken {
    std::deque<v1::HostResponse> messages{};
    // Beyond the bound a STOP stands for all that would halt or let go; who asks for more than one
    // (EMERGENCY STOP, ABORT) gets it, and keys are what they are, by their numbers.
    std::vector<v1::HostOrder> stops{};
    // There was no room for these; of keys with their numbers.
    std::vector<v1::HostOrder> refused{};

    void Append(Taken more);
    // What came before the stops and would begin a motion behind them. LIVE-2.05
    std::vector<v1::HostOrder> TakeMotions();
  };

  void Add(v1::HostResponse message);
  Taken Take();
  bool empty() const { return taken_.messages.empty(); }

 private:
  std::size_t orders_ = 0;
  std::size_t halts_ = 0;
  Taken taken_;
};

}  // namespace rmlcell::server
