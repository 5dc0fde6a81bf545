#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Integers of variable length: seven bits a byte, least significant first, the high bit set on all
// but the last byte. Signed ones are folded first (0, -1, 1, -2 ...), so that small means short.
namespace rmlcell::simulation {

inline void PutVarint(std::string& bytes, std::uint64_t value) {
  while (value >= 0x80) {
    bytes += static_cast<char>(static_cast<unsigned char>(value | 0x80));
    value >>= 7;
  }
  bytes += static_cast<char>(static_cast<unsigned char>(value));
}

inline void PutSigned(std::string& bytes, std::int64_t value) {
  const auto folded =
      (static_cast<std::uint64_t>(value) << 1) ^ (value < 0 ? ~std::uint64_t{0} : std::uint64_t{0});
  PutVarint(bytes, folded);
}

// Reads from the front of foreign bytes. After a failure everything read is nothing.
class VarintReader {
 public:
  explicit VarintReader(std::string_view bytes) : bytes_(bytes) {}

  std::optional<std::uint8_t> Byte() {
    if (bytes_.empty()) return Fail();
    const auto byte = static_cast<std::uint8_t>(bytes_.front());
    bytes_.remove_prefix(1);
    return byte;
  }

  // Nothing when the bytes end early or the value has more than 64 bits.
  std::optional<std::uint64_t> Varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::optional<std::uint8_t> byte = Byte();
      if (!byte) return std::nullopt;
      const std::uint64_t bits = *byte & 0x7Fu;
      if (shift == 63 && bits > 1) return FailWide();
      value |= bits << shift;
      if ((*byte & 0x80u) == 0) return value;
    }
    return FailWide();
  }

  std::optional<std::int64_t> Signed() {
    const std::optional<std::uint64_t> folded = Varint();
    if (!folded) return std::nullopt;
    const std::uint64_t half = *folded >> 1;
    return static_cast<std::int64_t>((*folded & 1) != 0 ? ~half : half);
  }

  bool at_end() const { return bytes_.empty(); }

 private:
  std::optional<std::uint8_t> Fail() {
    bytes_ = {};
    return std::nullopt;
  }
  std::optional<std::uint64_t> FailWide() {
    bytes_ = {};
    return std::nullopt;
  }

  std::string_view bytes_;
};

}  // namespace rmlcell::simulation
