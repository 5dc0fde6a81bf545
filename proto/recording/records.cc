#include "proto/recording/records.h"

#include <boost/crc.hpp>

namespace rmlcell::recording {
namespace {

constexpr std::uint32_t kRecordMax = 256U << 20;  // none is as large: what says so is no length

std::uint32_t Checksum(std::string_view bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;  // CRC-32C
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

void AddNumber(std::uint32_t number, std::string& bytes) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xFFU);
}

std::uint32_t NumberAt(std::string_view bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return number;
}

}  // namespace

void AddRecord(std::string_view record, std::string& bytes) {
  AddNumber(static_cast<std::uint32_t>(record.size()), bytes);
  AddNumber(Checksum(record), bytes);
  bytes += record;
}

Records ReadRecords(std::string_view bytes) {
  Records read;
  constexpr auto kHead = static_cast<std::size_t>(kRecordHeadBytes);
  while (bytes.size() >= kHead) {
    const std::uint32_t length = NumberAt(bytes);
    // A record has bytes: zeros, which a file may end with, are none.
    if (length == 0 || length > kRecordMax || bytes.size() - kHead < length) break;
    const std::string_view record = bytes.substr(kHead, length);
    if (Checksum(record) != NumberAt(bytes.substr(4))) break;
    read.end += kRecordHeadBytes + length;
    bytes.remove_prefix(kHead + length);
    read.records.push_back(record);
  }
  return read;
}

}  // namespace rmlcell::recording
