#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rmlcell::rml1 {

// The digits that eight bytes begin with, looked at all at once: nothing branches on how many there
// are, which no processor could foresee in a list of coordinates.
class DigitWord {
 public:
  static constexpr std::ptrdiff_t kBytes = 8;

  // Precondition: so many bytes can be read.
  explicit DigitWord(const char* at) {
    std::memcpy(&digits_, at, sizeof digits_);
    if constexpr (std::endian::native == std::endian::big) digits_ = __builtin_bswap64(digits_);
    digits_ ^= 0x3030303030303030U;  // of a digit its value, of all else more than 9
  }

  // How many digits there are before the first byte that is none; more than six are seven.
  unsigned count() const {
    constexpr std::uint64_t kTops = 0x8080808080808080U;
    constexpr std::uint64_t kLast = std::uint64_t{1} << 63U;
    // A byte above 9 sets its top bit, and may carry into the ones behind it, which do not matter.
    const std::uint64_t others = (((digits_ + 0x7676767676767676U) | digits_) & kTops) | kLast;
    return static_cast<unsigned>(std::countr_zero(others)) / kBits;
  }

  // The number that the first `count` of them are. Preconditions: 0 < count <= count().
  std::int64_t value(unsigned count) const {
    // Zeros in front of them make eight; then neighbours are joined to pairs, pairs to fours, and
    // these: of each two the one in front counts ten, a hundred, ten thousand times.
    std::uint64_t v = digits_ << (-(kBits * count) & 63U);
    v = (v * (1 + (10U << 8U)) >> 8U) & 0x00FF00FF00FF00FFU;
    v = (v * (1 + (100U << 16U)) >> 16U) & 0x0000FFFF0000FFFFU;
    return static_cast<std::int64_t>(v * (1 + (std::uint64_t{10'000} << 32U)) >> 32U);
  }

 private:
  static constexpr unsigned kBits = 8;  // of a byte

  std::uint64_t digits_ = 0;
};

}  // namespace rmlcell::rml1
