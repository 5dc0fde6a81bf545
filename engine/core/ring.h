#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/core/check.h"

namespace rmlcell {

// A queue whose elements keep their number while they live: the first one ever pushed is 0. Grows
// fourfold and never shrinks, so a steady stream allocates nothing; room that is not used is not
// touched.
template <class T>
class Ring {
 public:
  using Number = std::uint64_t;

  Number first() const { return first_; }
  Number end() const { return end_; }  // one past the newest
  std::size_t size() const { return static_cast<std::size_t>(end_ - first_); }
  bool empty() const { return first_ == end_; }

  [[gnu::always_inline]] T& operator[](Number number) {
    RMLCELL_CHECK(number >= first_ && number < end_);
    return slots_[Slot(number)];
  }
  [[gnu::always_inline]] const T& operator[](Number number) const {
    RMLCELL_CHECK(number >= first_ && number < end_);
    return slots_[Slot(number)];
  }
  T& front() { return (*this)[first_]; }
  T& back() { return (*this)[end_ - 1]; }
  const T& front() const { return (*this)[first_]; }
  const T& back() const { return (*this)[end_ - 1]; }

  // A slot for a new element, holding what some older one left there.
  [[gnu::always_inline]] T& PushSlot() {
    if (size() == room_) Grow();
    const std::size_t slot = Slot(end_++);
    if (slot == slots_.size()) slots_.emplace_back();
    return slots_[slot];
  }
  void Push(T value) { PushSlot() = std::move(value); }
  // Precondition: empty. Numbers begin at 0 again, and so do the slots: few of them stay in the
  // cache.
  void Rewind() {
    RMLCELL_CHECK(empty());
    first_ = end_ = base_ = 0;
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
    return static_cast<std::size_t>(number - base_) & (room_ - 1);
  }
  // Only the elements there are move; the slots behind them are made when they are first used.
  [[gnu::noinline]] void Grow() {
    std::vector<T> larger;
    const std::size_t room = room_ == 0 ? 16 : 4 * room_;
    larger.reserve(room);
    for (Number n = first_; n < end_; ++n) larger.push_back(std::move(slots_[Slot(n)]));
    slots_ = std::move(larger);
    room_ = room;
    base_ = first_;
  }

  std::vector<T> slots_;  // up to room_
  std::size_t room_ = 0;  // a power of two
  Number base_ = 0;       // the number of the element in slot 0 after the last growth
  Number first_ = 0;
  Number end_ = 0;
};

}  // namespace rmlcell
