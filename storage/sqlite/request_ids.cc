#include "storage/sqlite/request_ids.h"

#include <random>

#include "engine/core/hex.h"

namespace rmlcell::storage::sqlite {
namespace {

std::uint64_t RandomSeed() {
  std::random_device device;  // that of the system
  return std::uint64_t{device()} << 32 | device();
}

}  // namespace

RequestIds::RequestIds() : seed_(RandomSeed()) {}

std::string RequestIds::Make(WallTime now) {
  const auto milliseconds = static_cast<std::uint64_t>(
      std::chrono::floor<std::chrono::milliseconds>(now).time_since_epoch().count());
  const std::uint64_t number = seed_ + count_++;
  // RFC 9562: 48 bits of time, the version, 12 bits, the variant, 62 bits. Those of our own are the
  // number, all of it, and ten bits of the seed.
  const std::uint64_t high = milliseconds << 16 | 0x7000U | (number >> 52);
  const std::uint64_t low = std::uint64_t{1} << 63 | (number << 12 >> 2) | (seed_ & 0x3FFU);
  std::string text = "________-____-____-____-____________";
  int digit = 0;
  for (char& c : text) {
    if (c == '-') continue;
    const std::uint64_t half = digit < 16 ? high : low;
    c = HexDigit(static_cast<unsigned>(half >> (60 - 4 * (digit % 16))));
    ++digit;
  }
  return text;
}

}  // namespace rmlcell::storage::sqlite
