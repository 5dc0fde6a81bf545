#pragma once

#include <algorithm>
#include <chrono>

namespace rmlcell::server {

// How long a worker that ended stays away before another takes its place: not at all after a
// healthy life, else longer and longer, so that one that cannot start keeps no processor busy.
class RestartDelay {
 public:
  static constexpr std::chrono::seconds kHealthyLife{5};  // a shorter life counts as a failed start
  static constexpr std::chrono::milliseconds kMax{10'000};

  std::chrono::milliseconds AfterLife(std::chrono::steady_clock::duration life) {
    delay_ = life >= kHealthyLife ? std::chrono::milliseconds(0)
                                  : std::min(kMax, delay_ * 2 + std::chrono::milliseconds(100));
    return delay_;
  }

 private:
  std::chrono::milliseconds delay_{0};
};

}  // namespace rmlcell::server
