#include "engine/simulation/material/height_grid.h"

#include <gtest/gtest.h>

#include <bit>
#include <string>

namespace rmlcell::simulation {
namespace {

// 15 x 10 cells; (2.5535 + 4) / 65535 is 0.0001 mm a number.
constexpr Stock kGridBlock{.x_min = -3.3,
                           .x_max = 2.7,
                           .y_min = 5.0,
                           .y_max = 9.0,
                           .bottom = -4.0,
                           .top = 2.5535,
                           .cell = 0.4};

template <class Number>
Number At(const std::string& bytes, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t byte = sizeof(Number); byte-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes.at(offset + byte));
  return static_cast<Number>(value);
}

// docs/material.md: a heading of 64 bytes and two a cell, from the least Y on.
TEST(HeightGrid, IsWhatTheDocumentSays) {
  HeightField field = HeightField::Of(kGridBlock).value();
  field.Cut({.radius_mm = 0.3}, {-3.1, 5.2, -1}, {-3.1, 5.2, -1});  // the cell of least X and Y
  field.Cut({.radius_mm = 0.3}, {2.5, 5.2, -9}, {2.5, 5.2, -9});    // through, that of greatest X
  std::string bytes;
  ASSERT_TRUE(WriteHeightGrid(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  ASSERT_EQ(bytes.size(), 64U + 2 * 15 * 10);
  EXPECT_EQ(bytes.substr(0, 8), "RMLCELLH");
  EXPECT_EQ(At<std::uint32_t>(bytes, 8), 1U);
  EXPECT_EQ(At<std::uint32_t>(bytes, 12), 15U);
  EXPECT_EQ(At<std::uint32_t>(bytes, 16), 10U);
  EXPECT_EQ(At<std::uint32_t>(bytes, 20), 0U);
  const double numbers[] = {-3.3, 5.0, 0.4, -4.0, 2.5535};
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(std::bit_cast<double>(At<std::uint64_t>(bytes, 24 + 8 * i)), numbers[i]) << i;
  EXPECT_EQ(At<std::uint16_t>(bytes, 64), 30'000);  // (-1 + 4) / 0.0001
  EXPECT_EQ(At<std::uint16_t>(bytes, 66), 65'535);
  EXPECT_EQ(At<std::uint16_t>(bytes, 64 + 2 * 14), 0);
  for (std::size_t cell = 15; cell < 150; ++cell)
    EXPECT_EQ(At<std::uint16_t>(bytes, 64 + 2 * cell), 65'535) << cell;
}

TEST(HeightGrid, EndsWhereNobodyWantsMore) {
  const HeightField field = HeightField::Of(kGridBlock).value();
  int rows = 0;
  EXPECT_FALSE(WriteHeightGrid(field, [&](std::string_view) { return ++rows < 3; }));
  EXPECT_EQ(rows, 3);
}

// Half a number is rounded; what lies beyond the block is at its ends.
TEST(HeightGrid, Numbers) {
  const Stock stock{.bottom = 0.0, .top = 65535.0};
  EXPECT_EQ(HeightNumber(stock, 1.49F), 1);
  EXPECT_EQ(HeightNumber(stock, 1.5F), 2);
  EXPECT_EQ(HeightNumber(stock, -3.0F), 0);
  EXPECT_EQ(HeightNumber(stock, 70'000.0F), 65'535);
}

}  // namespace
}  // namespace rmlcell::simulation
