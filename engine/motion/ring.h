#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/core/check.h"

namespace rmlcell::motion {

// A queue whose elements keep their number while they live: the first one ever pushed is 0. Grows
// by doubling and never shrinks, so a steady stream allocates nothing.
template <class T>
class Ring {
 public:
  using Number = std::uint64_t;

  Number first() const { return first_; }
  Number end() const { return end_; }  // one past the newest
  std::size_t size() const { return static_cast<std::size_t>(end_ - first_); }
  bool empty() const { return first_ == end_; }

  T& operator[](Number number) {
    RMLCELL_CHECK(number >= first_ && number < end_);
    return slots_[Slot(number)];
  }
  T& front() { return (*this)[first_]; }
  T& back() { return (*this)[end_ - 1]; }

  // A slot for a new element, holding what some older one left there.
  T& PushSlot() {
    if (size() == slots_.size()) Grow();
    return slots_[Slot(end_++)];
  }
  void Push(T value) { PushSlot() = std::move(value); }
  // Precondition: empty. Numbers begin at 0 again, and so do the slots: few of them stay in the cache.
  void Rewind() {
    RMLCELL_CHECK(empty());
    first_ = end_ = 0;
  }
  void PopFront() {
    RMLCELL_CHECK(!empty());
    ++first_;
  }
  void PopBack() {
    RMLCELL_CHECK(!empty());
    --end_;
  }

 private:
  std::size_t Slot(Number number) const {
    return static_cast<std::size_t>(number) & (slots_.size() - 1);
  }
  void Grow() {
    std::vector<T> larger(slots_.empty() ? 16 : 2 * slots_.size());
    for (Number n = first_; n < end_; ++n) {
      larger[static_cast<std::size_t>(n) & (larger.size() - 1)] = std::move(slots_[Slot(n)]);
    }
    slots_ = std::move(larger);
  }

  std::vector<T> slots_;  // a power of two
  Number first_ = 0;
  Number end_ = 0;
};

}  // namespace rmlcell::motion
