#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

// Bytes in one order on every platform: whole numbers of variable length, little-endian fixed ones.
// For the object and executable forms. Private to the folder.
namespace rmlcell::optimo {

class ByteWriter {
 public:
  ByteWriter() = default;
  explicit ByteWriter(std::size_t room) { bytes_.reserve(room); }

  void Byte(unsigned value) { bytes_ += static_cast<char>(value); }
  void Fixed16(unsigned value) {
    const char bytes[2] = {static_cast<char>(value), static_cast<char>(value >> 8)};
    bytes_.append(bytes, sizeof bytes);
  }
  void Fixed32(std::uint32_t value) {
    const char bytes[4] = {static_cast<char>(value), static_cast<char>(value >> 8),
                           static_cast<char>(value >> 16), static_cast<char>(value >> 24)};
    bytes_.append(bytes, sizeof bytes);
  }
  void Fixed64(std::uint64_t value) {
    Fixed32(static_cast<std::uint32_t>(value));
    Fixed32(static_cast<std::uint32_t>(value >> 32));
  }
  void Real(float value) { Fixed32(std::bit_cast<std::uint32_t>(value)); }
  // Seven bits a byte, lowest first; one byte below 128.
  void Whole(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) Byte(static_cast<unsigned>(value & 0x7F) | 0x80);
    Byte(static_cast<unsigned>(value));
  }
  void Text(std::string_view text) {
    Whole(text.size());
    bytes_ += text;
  }
  void Raw(std::string_view bytes) { bytes_ += bytes; }

  const std::string& bytes() const { return bytes_; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Reading past the end, or a number in more bytes than it needs, sets bad() and yields zeros from
// then on.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  unsigned Byte() {
    if (at_ >= bytes_.size()) {
      bad_ = true;
      return 0;
    }
    return static_cast<unsigned char>(bytes_[at_++]);
  }
  unsigned Fixed16() {
    const unsigned low = Byte();
    return low | Byte() << 8;
  }
  std::uint32_t Fixed32() {
    const std::uint32_t low = Fixed16();
    return low | static_cast<std::uint32_t>(Fixed16()) << 16;
  }
  std::uint64_t Fixed64() {
    const std::uint64_t low = Fixed32();
    return low | static_cast<std::uint64_t>(Fixed32()) << 32;
  }
  float Real() { return std::bit_cast<float>(Fixed32()); }
  std::uint64_t Whole(std::uint64_t max) {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const unsigned byte = Byte();
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if ((byte & 0x80) != 0) continue;
      if ((byte == 0 && shift > 0) || value > max) break;
      return value;
    }
    bad_ = true;
    return 0;
  }
  std::string_view Text(std::uint64_t max) { return Raw(Whole(max)); }
  std::string_view Raw(std::uint64_t length) {
    if (bad_ || length > bytes_.size() - at_) {
      bad_ = true;
      return {};
    }
    const std::string_view text = bytes_.substr(at_, static_cast<std::size_t>(length));
    at_ += text.size();
    return text;
  }

  bool bad() const { return bad_; }
  bool AtEnd() const { return at_ == bytes_.size(); }
  void Refuse() { bad_ = true; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool bad_ = false;
};

// CRC-32 as in IEEE 802.3.
std::uint32_t Checksum(std::string_view bytes);

}  // namespace rmlcell::optimo
