#include "engine/rml1/number.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <limits>
#include <string>

namespace rmlcell::rml1 {
namespace {

// 10^n is exact in a double up to here, and so is a mantissa of fifteen digits: their quotient is
// the nearest double to the decimal.
constexpr int kExactDigits = 15;
constexpr std::uint64_t kExactLimit = 1'000'000'000'000'000;  // such a mantissa has one digit more
constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// Lies exactly halfway between two 4-byte values: rounding a rounded value could then go wrong.
bool IsHalfwayBetweenSingles(double value) {
  constexpr std::uint64_t kDroppedBits = (std::uint64_t{1} << 29) - 1;
  return (std::bit_cast<std::uint64_t>(value) & kDroppedBits) == (kDroppedBits + 1) / 2;
}

}  // namespace

void NumberReader::Begin(unsigned char first) {
  digits_ = 0;
  direct_ = more_ = scale_ = 0;
  magnitude_ = 0;
  period_ = has_digit_ = fraction_ = rest_ = false;
  negative_ = first == '-';
  if (first != '+' && first != '-') Take(first);
}

void NumberReader::TakeDigit(unsigned char byte) {
  has_digit_ = true;
  const int digit = byte - '0';
  if (period_) {
    fraction_ = fraction_ || digit != 0;
  } else {
    magnitude_ = std::min(magnitude_ * 10 + digit, Number::kMagnitudeMax);
  }
  if (direct_ < kDirectDigits) {
    digits_ = digits_ * 10 + static_cast<std::uint64_t>(digit);
    if (digits_ != 0) ++direct_;
    if (period_ && scale_ < kScaleMax) ++scale_;
  } else if (more_ < kMoreDigits) {
    more_digits_[static_cast<std::size_t>(more_++)] = static_cast<char>(byte);
    if (period_) ++scale_;
  } else {
    rest_ = rest_ || digit != 0;
  }
}

Number NumberReader::value() const {
  Number number{.magnitude = magnitude_, .negative = negative_, .fraction = fraction_};
  const bool short_number =
      direct_ <= kExactDigits && scale_ < static_cast<int>(kPowersOfTen.size());
  if (digits_ == 0) return number;  // not even a minus sign: there is no -0 on these machines
  if (magnitude_ >= Number::kMagnitudeMax) {
    number.single = number.decimal = static_cast<double>(Number::kMagnitudeMax);
  } else if (short_number) {
    number.decimal = static_cast<double>(digits_) / kPowersOfTen[static_cast<std::size_t>(scale_)];
    number.single = static_cast<double>(static_cast<float>(number.decimal));
    if (IsHalfwayBetweenSingles(number.decimal)) ConvertExactly(number);
  } else {
    ConvertExactly(number);
  }
  if (negative_) {
    number.single = -number.single;
    number.decimal = -number.decimal;
  }
  return number;
}

// Of digits from `first` on, with a period among or behind them.
const char* NumberReader::ReadDecimal(const char* first, const char* end, bool negative,
                                      Number& number) {
  const char* at = first;
  std::int64_t whole = 0;
  for (; at != end && IsDigit(*at) && at - first < kExactDigits; ++at) {
    whole = whole * 10 + (*at - '0');
  }
  if (at == end || *at != '.' || whole >= Number::kMagnitudeMax) return nullptr;
  const char* const behind = at + 1;
  std::int64_t digits = whole;
  for (++at; at != end && IsDigit(*at) && at - first <= kExactDigits; ++at) {
    digits = digits * 10 + (*at - '0');
  }
  const bool ordinary = at != end && !IsDigit(*at) && at - first > 1;
  if (!ordinary) return nullptr;
  const double power = kPowersOfTen[static_cast<std::size_t>(at - behind)];
  number.magnitude = whole;
  number.negative = negative;
  number.fraction = digits != whole * static_cast<std::int64_t>(power);
  number.decimal = static_cast<double>(negative ? -digits : digits) / power;
  number.single = static_cast<double>(static_cast<float>(number.decimal));
  return IsHalfwayBetweenSingles(number.decimal) ? nullptr : at;
}

void NumberReader::ConvertExactly(Number& number) const {
  std::array<char, 160> room{};  // 18 + 96 digits, one for the rest, an exponent
  char* end = std::to_chars(room.data(), room.data() + room.size(), digits_).ptr;
  end = std::copy_n(more_digits_.data(), more_, end);
  if (rest_) *end++ = '1';
  *end++ = 'e';
  const int scale = scale_ + (rest_ ? 1 : 0);
  end = std::to_chars(end, room.data() + room.size(), -scale).ptr;
  // Too small for the format leaves the 0 in place; too large was handled by the caller.
  float single = 0.0F;
  std::from_chars(room.data(), end, single);
  number.single = static_cast<double>(single);

  // All the digits that are cut off here stand behind the period: the whole part has at most nine.
  std::uint64_t first_digits = digits_;
  int first_scale = scale_ - more_;
  for (; first_digits >= kExactLimit; first_digits /= 10) --first_scale;
  const std::string first = std::to_string(first_digits) + 'e' + std::to_string(-first_scale);
  double decimal = 0.0;
  std::from_chars(first.data(), first.data() + first.size(), decimal);
  number.decimal = decimal;
}

}  // namespace rmlcell::rml1
