#include "engine/core/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

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

}  // namespace

std::string FixedText(double value, int decimals) {
  std::array<char, kLongestWhole + kDecimalsMax> room{};
  const auto end = std::to_chars(room.data(), room.data() + room.size(), value,
                                 std::chars_format::fixed, std::clamp(decimals, 0, kDecimalsMax));
  std::string text(room.data(), end.ptr);
  if (!text.empty() && text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) {
    text.erase(0, 1);
  }
  return text;
}

std::string TrimmedText(double value, int decimals) {
  std::string text = FixedText(value, decimals);
  const std::size_t point = text.find('.');
  if (point == std::string::npos) return text;
  const std::size_t last = text.find_last_not_of('0');
  text.erase(std::max(last, point + 1) + 1);
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
