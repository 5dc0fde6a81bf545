#include "server/web/base64.h"

#include <array>
#include <cstdint>

namespace rmlcell::web {
namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<std::int8_t, 256> MakeValues() {
  std::array<std::int8_t, 256> values{};
  for (std::int8_t& value : values) value = -1;
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  values['-'] = 62;
  values['_'] = 63;
  return values;
}

constexpr std::array<std::int8_t, 256> kValues = MakeValues();

std::uint32_t Byte(std::string_view bytes, std::size_t i) {
  return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U;
}

// The bytes of a group of two or three characters, which ends a piece. Bits beyond the last byte
// must be zero, so that each text stands for one sequence of bytes only.
bool AppendTail(std::uint32_t group, int digits, std::string& out) {
  if (digits == 0) return true;
  if (digits == 1) return false;
  if (digits == 2) {
    if ((group & 0xFU) != 0) return false;
    out += static_cast<char>(group >> 4U);
    return true;
  }
  if ((group & 0x3U) != 0) return false;
  out += static_cast<char>(group >> 10U);
  out += static_cast<char>((group >> 2U) & 0xFFU);
  return true;
}

}  // namespace

std::string Base64(std::string_view bytes, bool padded) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t group =
        Byte(bytes, i) << 16U | Byte(bytes, i + 1) << 8U | Byte(bytes, i + 2);
    const std::size_t left = bytes.size() - i;
    out += kAlphabet[group >> 18U];
    out += kAlphabet[(group >> 12U) & 63U];
    if (left > 1) out += kAlphabet[(group >> 6U) & 63U];
    if (left > 2) out += kAlphabet[group & 63U];
    if (padded && left < 3) out.append(3 - left, '=');
  }
  return out;
}

std::optional<std::string> Base64Decode(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t group = 0;
  int digits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '=') {
      const std::size_t padding = digits == 2 ? 2 : digits == 3 ? 1 : 0;
      if (padding == 0 || text.substr(i, padding) != std::string_view("==", padding))
        return std::nullopt;
      if (!AppendTail(group, digits, out)) return std::nullopt;
      group = 0;
      digits = 0;
      i += padding - 1;
      continue;
    }
    const std::int8_t value = kValues[static_cast<unsigned char>(text[i])];
    if (value < 0) return std::nullopt;
    group = group << 6U | static_cast<std::uint32_t>(value);
    if (++digits == 4) {
      out += static_cast<char>(group >> 16U);
      out += static_cast<char>((group >> 8U) & 0xFFU);
      out += static_cast<char>(group & 0xFFU);
      group = 0;
      digits = 0;
    }
  }
  if (!AppendTail(group, digits, out)) return std::nullopt;
  return out;
}

}  // namespace rmlcell::web
