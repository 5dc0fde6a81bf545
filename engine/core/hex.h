#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rmlcell {

// The least four bits as a digit, 0 to 9 and a to f.
constexpr char HexDigit(unsigned value) { return "0123456789abcdef"[value & 0xFU]; }

// What a digit stands for, of either case; nothing for another character.
std::optional<unsigned> HexValue(char digit);

// A number without leading zeros, a to f small.
std::string HexNumber(std::uint64_t value);

// Two digits a byte, a to f small: digests, identifiers.
std::string HexOf(std::string_view bytes);
// The bytes again; nothing for what is no such text.
std::optional<std::string> BytesOfHex(std::string_view lower_case);

// The two digits of one byte, A to F: escapes in texts.
std::string HexByte(char byte);

}  // namespace rmlcell
