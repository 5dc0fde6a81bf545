#pragma once

#include <chrono>
#include <optional>
#include <utility>

namespace rmlcell::server {

// The lease that a host has of its machine, by a clock that goes on while its computer sleeps: when
// the lease ends another host may take the machine, which rests before. LIVE-3.04
class LeaseClock {
 public:
  static constexpr std::chrono::seconds kRestsBefore{5};  // its end
  static constexpr std::chrono::seconds kStops{2};        // longer than any machine takes to stop

  // Given by the answer to what was asked for at `asked`.
  void Given(std::chrono::nanoseconds duration, std::chrono::nanoseconds asked) {
    duration_ = duration;
    since_ = asked;
    next_ = asked + duration_ / 3;
    sent_.reset();
  }
  bool RenewalDue(std::chrono::nanoseconds now) const { return now >= next_; }
  std::chrono::nanoseconds next_renewal() const { return next_; }
  void Renews(std::chrono::nanoseconds now) {
    sent_ = now;
    next_ = now + duration_ / 3;
  }
  // It holds from when the newest was sent: an answer to one before it, which the store did not
  // take at once, is of a moment ago, since a line that is silent for longer is cut off.
  void Renewed() {
    if (sent_) since_ = *std::exchange(sent_, std::nullopt);
  }
  bool MustStop(std::chrono::nanoseconds now) const {
    return now - since_ >= duration_ - kRestsBefore - kStops;
  }

 private:
  std::chrono::nanoseconds duration_{0};
  std::chrono::nanoseconds since_{0};  // when what was confirmed last was sent
  std::chrono::nanoseconds next_{0};
  std::optional<std::chrono::nanoseconds> sent_{};  // the newest renewal, while nothing confirms it
};

}  // namespace rmlcell::server
