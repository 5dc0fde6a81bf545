#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rmlcell::rml1 {

// The receive buffer of the device: bytes that were received and not yet interpreted, first in,
// first out, each with its place in the stream. It takes at most `capacity` bytes; a sender that
// heeds flow control asks room() first (RML1-3C.08, RML1-9.35). Memory grows with what is in it, up
// to eight times the capacity, and is given back by Clear.
class DataBuffer {
 public:
  explicit DataBuffer(std::size_t capacity) : capacity_(capacity) {}

  struct Entry {
    unsigned char byte = 0;
    std::int64_t offset = 0;
  };

  bool empty() const { return head_ == entries_.size(); }
  std::size_t size() const { return entries_.size() - head_; }
  std::size_t room() const { return capacity_ - size(); }

  // False: full, and the byte is lost (RML1-4.23).
  bool Push(unsigned char byte, std::int64_t offset) {
    if (empty()) {
      entries_.clear();
      head_ = 0;
    } else if (size() >= capacity_) {
      return false;
    } else if (head_ >= kCompactFrom && head_ * 2 >= entries_.size()) {
      Compact();
    }
    entries_.push_back(static_cast<std::uint64_t>(offset) << 8U | byte);
    return true;
  }

  // Precondition: not empty.
  Entry front() const {
    const std::uint64_t entry = entries_[head_];
    return {static_cast<unsigned char>(entry & 0xFFU), static_cast<std::int64_t>(entry >> 8U)};
  }
  void Pop() { ++head_; }

  void Clear() {
    entries_ = {};
    head_ = 0;
  }

 private:
  static constexpr std::size_t kCompactFrom = 4096;
  void Compact() {
    entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(head_));
    head_ = 0;
  }

  std::size_t capacity_;
  std::size_t head_ = 0;
  std::vector<std::uint64_t> entries_;  // offset and byte
};

}  // namespace rmlcell::rml1
