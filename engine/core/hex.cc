#include "engine/core/hex.h"

#include "engine/core/letters.h"

namespace rmlcell {

std::optional<unsigned> HexValue(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<unsigned>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<unsigned>(digit - 'a' + 10);
  if (digit >= 'A' && digit <= 'F') return static_cast<unsigned>(digit - 'A' + 10);
  return std::nullopt;
}

std::string HexNumber(std::uint64_t value) {
  std::string text;
  do {
    text.insert(text.begin(), HexDigit(static_cast<unsigned>(value)));
    value >>= 4U;
  } while (value != 0);
  return text;
}

std::string HexOf(std::string_view bytes) {
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += HexDigit(byte >> 4U);
    text += HexDigit(byte);
  }
  return text;
}

std::string HexByte(char byte) { return UpperCase(HexOf({&byte, 1})); }

std::optional<std::string> BytesOfHex(std::string_view lower_case) {
  if (lower_case.size() % 2 != 0) return std::nullopt;
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  std::string bytes;
  bytes.reserve(lower_case.size() / 2);
  for (std::size_t i = 0; i < lower_case.size(); i += 2) {
    const std::size_t high = kHexDigits.find(lower_case[i]);
    const std::size_t low = kHexDigits.find(lower_case[i + 1]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    bytes += static_cast<char>(high << 4 | low);
  }
  return bytes;
}

}  // namespace rmlcell
