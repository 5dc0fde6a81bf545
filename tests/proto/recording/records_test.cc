// Records with their length and CRC-32C (live.md 3).
#include "proto/recording/records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rmlcell::recording {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::string Hex(const std::string& bytes) {
  std::string text;
  for (const unsigned char c : bytes) {
    text += "0123456789abcdef"[c >> 4U];
    text += "0123456789abcdef"[c & 15U];
  }
  return text;
}

// The check value of CRC-32C is that of "123456789": 0xE3069283.
TEST(Records, HaveLengthAndChecksumInFront) {
  std::string bytes;
  AddRecord("123456789", bytes);
  EXPECT_EQ(Hex(bytes.substr(0, 8)), "09000000839206e3");
  EXPECT_EQ(bytes.substr(8), "123456789");
  const std::string long_one(0x01020304, 'x');
  std::string other;
  AddRecord(long_one, other);
  EXPECT_EQ(Hex(other.substr(0, 4)), "04030201");
  EXPECT_THAT(ReadRecords(other).records, ElementsAre(std::string_view(long_one)));
}

TEST(Records, AreReadUpToWhereTheyAreWhole) {
  std::string bytes;
  AddRecord("one", bytes);
  AddRecord(std::string("\0\xFF", 2), bytes);
  const auto whole = static_cast<std::int64_t>(bytes.size());
  EXPECT_EQ(whole, 8 + 3 + 8 + 2);
  EXPECT_THAT(ReadRecords(bytes).records, ElementsAre("one", std::string_view("\0\xFF", 2)));
  EXPECT_EQ(ReadRecords(bytes).end, whole);
  // Cut off anywhere: those in front.
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Records read = ReadRecords(bytes.substr(0, size));
    EXPECT_EQ(read.records.size(), size < 11 ? 0U : 1U) << size;
    EXPECT_EQ(read.end, size < 11 ? 0 : 11) << size;
  }
  // One byte that is another one, anywhere.
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_EQ(ReadRecords(damaged).end, at < 11 ? 0 : 11) << at;
  }
  // A file may end with zeros.
  EXPECT_EQ(ReadRecords(bytes + std::string(100, '\0')).end, whole);
  EXPECT_THAT(ReadRecords(std::string(100, '\0')).records, IsEmpty());
}

// One that says to be longer than what is there is none, also where the checksum fits that.
TEST(Records, AreNotLongerThanWhatIsThere) {
  std::string bytes;
  AddRecord("abc", bytes);
  ASSERT_EQ(bytes[0], 3);
  for (const char length : {'\x04', '\x0A', '\x20'}) {
    bytes[0] = length;
    EXPECT_THAT(ReadRecords(bytes).records, IsEmpty());
    EXPECT_EQ(ReadRecords(bytes).end, 0);
  }
}

}  // namespace
}  // namespace rmlcell::recording
