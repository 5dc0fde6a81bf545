#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rmlcell::rml1 {

// The range of a coordinate or angle, RML1-2.32; a value is compared as it is written, before it is
// rounded (RML1-9.50).
inline constexpr std::int64_t kFloatMin = -8388608;
inline constexpr std::int64_t kFloatMax = 8388607;
inline constexpr std::int64_t kIntMin = -32768;
inline constexpr std::int64_t kIntMax = 32767;

// A parameter as it was read.
struct Number {
  double single = 0.0;   // the nearest 4-byte IEEE value (RML1-9.21): coordinates
  double decimal = 0.0;  // the double nearest to its first 15 digits, which tell apart any two
                         // decimals: speeds, so that 0.7 is seven steps of 0.1
  std::int64_t magnitude = 0;  // whole part without sign, at most kMagnitudeMax
  bool negative = false;
  bool fraction = false;  // a digit other than 0 behind the period, however far behind

  // Beyond every range of the language; larger numbers saturate here.
  static constexpr std::int64_t kMagnitudeMax = 1'000'000'000;

  // The fraction cut off, towards zero (RML1-2.63, RML1-9.13).
  std::int64_t truncated() const { return negative ? -magnitude : magnitude; }

  // low <= value <= high, of the decimal value as written (RML1-9.50).
  bool Within(std::int64_t low, std::int64_t high) const {
    const std::int64_t away = magnitude + (fraction ? 1 : 0);  // next whole number from zero
    return negative ? -away >= low && -magnitude <= high : magnitude >= low && away <= high;
  }
};

// Reads one number byte by byte in constant memory, however many digits come (RML1-7.07).
// Form: optional sign, digits with at most one period among them (RML1-2.25).
class NumberReader {
 public:
  static bool IsDigit(int byte) { return byte >= '0' && byte <= '9'; }
  static bool CanBegin(unsigned char byte) {
    return IsDigit(byte) || byte == '+' || byte == '-' || byte == '.';
  }

  // Precondition: CanBegin(first).
  void Begin(unsigned char first);

  // Takes a digit or the first period; false: the number ended before this byte.
  bool Take(unsigned char byte) {
    if (IsDigit(byte)) {
      TakeDigit(byte);
      return true;
    }
    if (byte != '.' || period_) return false;
    period_ = true;
    return true;
  }

  bool has_digit() const { return has_digit_; }
  bool has_period() const { return period_; }

  // The value read; 0 when no digit came, as a lone period counts (RML1-2.31).
  Number value() const;

  // The same of a number that stands whole in the bytes, with the byte behind it, and is of
  // ordinary length: what nearly every number of a program is. Returns where it ends; nullptr: it
  // must be taken byte by byte. Precondition: `at` is not `end`, and CanBegin(*at).
  static const char* ReadWhole(const char* at, const char* end, Number& number) {
    const bool negative = *at == '-';
    const char* const first = at + (negative || *at == '+' ? 1 : 0);
    std::uint64_t read = 0;  // of longer ones what is left of it: they are read anew
    for (at = first; at != end && IsDigit(*at); ++at)
      read = read * 10 + static_cast<unsigned char>(*at - '0');
    const bool ordinary = at != end && at != first && at - first <= kOrdinaryDigits;
    if (!ordinary || *at == '.') return ReadDecimal(first, end, negative, number);
    const auto digits = static_cast<std::int64_t>(read);
    const double value = static_cast<double>(negative ? -digits : digits);  // never -0
    number = {.single = value, .decimal = value, .magnitude = digits, .negative = negative};
    return at;
  }

 private:
  static const char* ReadDecimal(const char* first, const char* end, bool negative, Number& number);
  void TakeDigit(unsigned char byte);
  void ConvertExactly(Number& number) const;

  // Whole numbers of so many digits are 4-byte values as they are.
  static constexpr std::ptrdiff_t kOrdinaryDigits = 7;

  // A decimal halfway between two 4-byte values has at most 113 significant digits: with that many
  // kept, and one bit for the rest, every number is rounded right.
  static constexpr int kDirectDigits = 18;  // fit into 64 bits
  static constexpr int kMoreDigits = 96;
  static constexpr int kScaleMax = 1'000'000;  // such a value is 0 in every format

  std::uint64_t digits_ = 0;  // the first significant ones
  int direct_ = 0;            // how many these are
  int more_ = 0;              // how many follow in more_digits_
  int scale_ = 0;             // how many of all these stand behind the period, zeros in front too
  std::int64_t magnitude_ = 0;
  bool negative_ = false;
  bool period_ = false;
  bool has_digit_ = false;
  bool fraction_ = false;
  bool rest_ = false;  // a digit other than 0 was not kept
  std::array<char, kMoreDigits> more_digits_{};
};

}  // namespace rmlcell::rml1
