#include "engine/core/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace rmlcell {
namespace {

// 1e308 needs 309 digits, a sign and a point; the decimals come on top.
constexpr std::size_t kLongestWhole = 311;
// No double has more decimals that are not zero, and nobody reads so many.
constexpr int kDecimalsMax = 100;

template <class Number>
std::optional<Number> ParseWhole(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Fixed decimals of numbers as programs have them, in an eighth of the time of std::to_chars, which
// sees the whole value: the value times 10^decimals is known to 2^-14, and where that leaves open
// which way it is rounded, or for other numbers, nothing is written. False: nothing was.
bool AppendSmall(std::string& text, double value, int decimals) {
  constexpr std::array kPowers = {1u, 10u, 100u, 1'000u, 10'000u, 100'000u, 1'000'000u};
  constexpr double kScaledMax = 1e12;
  constexpr double kUnsure = 1e-3;
  if (decimals < 1 || decimals >= static_cast<int>(kPowers.size())) return false;
  const std::uint64_t power = kPowers[static_cast<std::size_t>(decimals)];
  const double scaled = std::abs(value) * static_cast<double>(power);
  if (!(scaled < kScaledMax)) return false;  // nor is NaN
  const auto rounded = static_cast<std::uint64_t>(scaled + 0.5);
  if (std::abs(scaled - static_cast<double>(rounded)) > 0.5 - kUnsure) return false;
  std::array<char, 24> room;
  char* at = room.data() + room.size();
  std::uint64_t part = rounded % power;
  for (int k = 0; k < decimals; ++k, part /= 10) *--at = static_cast<char>('0' + part % 10);
  *--at = '.';
  for (std::uint64_t whole = rounded / power;; whole /= 10) {
    *--at = static_cast<char>('0' + whole % 10);
    if (whole < 10) break;
  }
  if (value < 0.0 && rounded != 0) *--at = '-';
  text.append(at, room.data() + room.size());
  return true;
}

}  // namespace

void AppendFixed(std::string& text, double value, int decimals) {
  if (AppendSmall(text, value, decimals)) return;
  const std::size_t begin = text.size();
  std::array<char, kLongestWhole + kDecimalsMax> room;
  const auto end = std::to_chars(room.data(), room.data() + room.size(), value,
                                 std::chars_format::fixed, std::clamp(decimals, 0, kDecimalsMax));
  text.append(room.data(), end.ptr);
  if (text[begin] == '-' && text.find_first_not_of("-0.", begin) == std::string::npos) {
    text.erase(begin, 1);
  }
}

void AppendTrimmed(std::string& text, double value, int decimals) {
  const std::size_t begin = text.size();
  AppendFixed(text, value, decimals);
  const std::size_t point = text.find('.', begin);
  if (point == std::string::npos) return;
  const std::size_t last = text.find_last_not_of('0');
  text.resize(std::max(last, point + 1) + 1);
}

std::string FixedText(double value, int decimals) {
  std::string text;
  AppendFixed(text, value, decimals);
  return text;
}

std::string TrimmedText(double value, int decimals) {
  std::string text;
  AppendTrimmed(text, value, decimals);
  return text;
}

std::string ShortestText(double value) {
  std::array<char, 64> room{};
  const auto end = std::to_chars(room.data(), room.data() + room.size(), value);
  return {room.data(), end.ptr};
}

std::optional<double> ParseDouble(std::string_view text) {
  const std::optional<double> value = ParseWhole<double>(text);
  if (value && !std::isfinite(*value)) return std::nullopt;  // "inf" and "nan" are read as well
  return value;
}

std::optional<long long> ParseInteger(std::string_view text) { return ParseWhole<long long>(text); }

}  // namespace rmlcell
