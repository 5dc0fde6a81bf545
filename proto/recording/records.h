#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Records, one behind the other: each the length of its bytes and their CRC-32C, both four bytes,
// least significant first, and the bytes.
namespace rmlcell::recording {

inline constexpr std::int64_t kRecordHeadBytes = 8;

// Precondition: it is not empty.
void AddRecord(std::string_view record, std::string& bytes);

// Those in front that are whole.
struct Records {
  std::vector<std::string_view> records{};  // of the bytes that were read
  std::int64_t end = 0;                     // behind the last
};
Records ReadRecords(std::string_view bytes);

}  // namespace rmlcell::recording
