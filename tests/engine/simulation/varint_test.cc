#include "engine/simulation/toolpath/varint.h"

#include <gtest/gtest.h>

#include <limits>

namespace rmlcell::simulation {
namespace {

TEST(Varint, SevenBitsAByteLeastFirst) {
  std::string bytes;
  PutVarint(bytes, 300);  // 0b10_0101100
  EXPECT_EQ(bytes, std::string("\xAC\x02", 2));
  bytes.clear();
  PutSigned(bytes, -1);
  PutSigned(bytes, 1);
  PutSigned(bytes, -64);
  EXPECT_EQ(bytes, std::string("\x01\x02\x7F", 3));
}

TEST(Varint, ReadsBackTheExtremes) {
  std::string bytes;
  const std::int64_t values[] = {0, -1, 1, std::numeric_limits<std::int64_t>::min(),
                                 std::numeric_limits<std::int64_t>::max()};
  for (const std::int64_t value : values) PutSigned(bytes, value);
  PutVarint(bytes, std::numeric_limits<std::uint64_t>::max());
  VarintReader reader(bytes);
  for (const std::int64_t value : values) EXPECT_EQ(reader.Signed(), value);
  EXPECT_EQ(reader.Varint(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_TRUE(reader.at_end());
}

TEST(Varint, RefusesWhatEndsEarlyOrIsTooWide) {
  EXPECT_FALSE(VarintReader("").Varint());
  EXPECT_FALSE(VarintReader("\x80").Varint());
  EXPECT_FALSE(VarintReader(std::string(10, '\xFF')).Varint());
  std::string wide(9, '\x80');
  wide += '\x02';  // bit 64
  EXPECT_FALSE(VarintReader(wide).Varint());
  wide.back() = '\x01';  // bit 63
  EXPECT_EQ(VarintReader(wide).Varint(), std::uint64_t{1} << 63);
}

}  // namespace
}  // namespace rmlcell::simulation
