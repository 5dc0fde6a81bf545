#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rmlcell::rml1 {

// One error register of the device with the log of everything that went into it: the command errors
// 1..3, or the communication errors 10..18 (RML1-6.04 to 6.10, RML1-4.21, RML1-4.22).
class ErrorLog {
 public:
  // Entries kept with their place; later ones are counted per number (RML1-6.10).
  static constexpr std::size_t kEntriesMax = 100'000;
  static constexpr int kNumberMax = 18;

  struct Entry {
    std::int64_t offset = 0;  // of the first byte concerned
    int number = 0;

    bool operator==(const Entry&) const = default;
  };

  // Returns true when the entry was kept. Precondition: 0 < number <= kNumberMax.
  bool Add(int number, std::int64_t offset) {
    if (register_ == 0) register_ = number;
    ++counts_[static_cast<std::size_t>(number)];
    ++total_;
    if (entries_.size() >= kEntriesMax) return false;
    entries_.push_back({offset, number});
    return true;
  }

  // The first error since the last clear; 0: none (RML1-9.03).
  int value() const { return register_; }
  void ClearRegister() { register_ = 0; }  // the log stays (RML1-6.07)

  std::span<const Entry> entries() const { return entries_; }
  std::uint64_t total() const { return total_; }
  std::uint64_t count(int number) const { return counts_[static_cast<std::size_t>(number)]; }
  bool cut() const { return total_ > entries_.size(); }

 private:
  int register_ = 0;
  std::uint64_t total_ = 0;
  std::array<std::uint64_t, kNumberMax + 1> counts_{};
  std::vector<Entry> entries_;
};

}  // namespace rmlcell::rml1
