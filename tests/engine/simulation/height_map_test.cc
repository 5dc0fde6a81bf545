#include "engine/simulation/material/height_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/simulation/material/png.h"
#include "tests/engine/simulation/png_chunks.h"

namespace rmlcell::simulation {
namespace {

constexpr Stock kBlock{
    .x_min = -3.3,
    .x_max = 2.7,
    .y_min = 5.0,
    .y_max = 9.0,
    .bottom = -4.0,
    .top = 2.5535,
    .cell = 0.4};  // 15 x 10 cells; (2.5535 + 4) / 65535 is 0.0001 mm a grey value

HeightField BlockWithAHole() {
  HeightField field = HeightField::Of(kBlock).value();
  field.Cut({.radius_mm = 0.5}, {-3.1, 5.2, -1}, {-3.1, 5.2, -1});  // the cell of least X and Y
  field.Cut({.radius_mm = 0.5}, {1.0, 8.0, -9}, {1.0, 8.0, -9});    // through
  return field;
}

std::string MapOf(const HeightField& field) {
  std::string bytes;
  EXPECT_TRUE(WriteHeightMap(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  return bytes;
}

std::string Png(const PngHeading& heading) {
  std::string bytes;
  EXPECT_TRUE(WritePng(
      heading,
      [](std::size_t, std::span<std::uint8_t> row) { std::ranges::fill(row, std::uint8_t{0}); },
      [&](std::string_view part) {
        bytes += part;
        return true;
      }));
  return bytes;
}

const std::vector<std::pair<std::string, std::string>> kTexts = {
    {"Left mm", "0"}, {"Front mm", "0"}, {"Cell mm", "1"}, {"Bottom mm", "-1"}, {"Top mm", "0"}};

// A picture whose heading was changed: its checksum is that of type and data.
std::string SealedHeading(std::string png) {
  std::uint32_t sum = 0xFFFFFFFF;
  for (std::size_t at = 12; at < 29; ++at) {
    sum ^= static_cast<unsigned char>(png[at]);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (0xEDB88320 & (0 - (sum & 1)));
  }
  for (std::size_t k = 0; k < 4; ++k)
    png[29 + k] = static_cast<char>(static_cast<unsigned char>(~sum >> (24 - 8 * k)));
  return png;
}

void ExpectRefused(std::string_view bytes, const std::string& detail) {
  const Result<HeightMap> map = ReadHeightMap(bytes);
  ASSERT_FALSE(map) << detail;
  EXPECT_EQ(map.error().code, ErrorCode::kCellBadText);
  EXPECT_NE(map.error().detail.find(detail), std::string::npos) << map.error().detail;
}

// What comes back is the block with its place, and each height within half a grey value; below its
// bottom is nothing.
TEST(HeightMap, BringsTheHeightsBack) {
  const HeightField field = BlockWithAHole();
  const Result<HeightMap> map = ReadHeightMap(MapOf(field));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->columns, 15u);
  EXPECT_EQ(map->rows, 10u);
  EXPECT_EQ(map->stock.x_min, kBlock.x_min);
  EXPECT_EQ(map->stock.y_min, kBlock.y_min);
  EXPECT_EQ(map->stock.cell, kBlock.cell);
  EXPECT_EQ(map->stock.bottom, kBlock.bottom);
  EXPECT_EQ(map->stock.top, kBlock.top);
  for (std::size_t k = 0; k < map->heights.size(); ++k)
    EXPECT_NEAR(map->heights[k], std::max(field.heights()[k], -4.0f), 0.5e-4 + 1e-6) << k;
}

// The format's own words: 15 x 10 pixels, grey of 16 bits; 2500 pixels a metre; the last row of the
// picture is the one of least Y; and nothing says when it was made.
TEST(HeightMap, SaysItsScale) {
  const std::string bytes = MapOf(BlockWithAHole());
  EXPECT_EQ(bytes, MapOf(BlockWithAHole()));
  std::string types;
  std::vector<std::string> texts;
  for (const PngChunk& chunk : ChunksOf(bytes)) {
    types += chunk.type + ' ';
    if (chunk.type == "IHDR") {
      EXPECT_EQ(BigEndian(chunk.data), 15u);
      EXPECT_EQ(BigEndian(chunk.data.substr(4)), 10u);
      EXPECT_EQ(chunk.data.substr(8), std::string("\x10\0\0\0\0", 5));
    } else if (chunk.type == "pHYs") {
      EXPECT_EQ(BigEndian(chunk.data), 2500u);
      EXPECT_EQ(BigEndian(chunk.data.substr(4)), 2500u);
      EXPECT_EQ(chunk.data.substr(8), "\x01");
    } else if (chunk.type == "tEXt") {
      texts.push_back(chunk.data);
      std::ranges::replace(texts.back(), '\0', '=');
    }
  }
  EXPECT_EQ(types, "IHDR pHYs tEXt tEXt tEXt tEXt tEXt tEXt tEXt IDAT IEND ");
  EXPECT_EQ(texts, (std::vector<std::string>{"Software=rmlcell", "Left mm=-3.3", "Front mm=5",
                                             "Cell mm=0.4", "Bottom mm=-4", "Top mm=2.5535",
                                             "Step mm=0.0001"}));
  const Result<GreyPicture> picture = ReadGreyPng(bytes);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->grey[0], 65535);           // untouched
  EXPECT_EQ(picture->grey[9 * 15 + 0], 30000);  // 3 mm above the bottom
  EXPECT_EQ(picture->grey[2 * 15 + 10], 0);     // through, at X 0.9, Y 8.0
}

TEST(HeightMap, EndsWhenNobodyWantsMore) {
  EXPECT_FALSE(WriteHeightMap(BlockWithAHole(), [](std::string_view) { return false; }));
}

TEST(HeightMap, RefusesWhatIsNone) {
  ExpectRefused("", "it ends too early");
  ExpectRefused("GIF89a, and more than eight bytes", "PNG");
  PngHeading heading{.width = 3, .height = 2, .texts = kTexts};
  EXPECT_TRUE(ReadHeightMap(Png(heading)));
  heading.form = PngHeading::Form::kColour8;
  ExpectRefused(Png(heading), "it is not grey of 16 bits");
}

// Each text must be there and be a number, and together they must make a block.
TEST(HeightMap, RefusesAPictureWithoutItsScale) {
  for (std::size_t k = 0; k < kTexts.size(); ++k) {
    PngHeading heading{.width = 3, .height = 2, .texts = kTexts};
    heading.texts[k].second = "wide";
    ExpectRefused(Png(heading), "does not say '" + kTexts[k].first + "'");
    heading.texts.erase(heading.texts.begin() + static_cast<std::ptrdiff_t>(k));
    ExpectRefused(Png(heading), "does not say '" + kTexts[k].first + "'");
  }
  PngHeading heading{.width = 3, .height = 2, .texts = kTexts};
  heading.texts[2].second = "-1";
  ExpectRefused(Png(heading), "no height map");
  heading.texts[2].second = "1";
  heading.texts[4].second = "-1";
  ExpectRefused(Png(heading), "ends before it begins");
  heading.texts[4].second = "1e39";
  ExpectRefused(Png(heading), "its heights are out of reach");
}

// Cut short anywhere, or with any byte changed, it is refused: checksums cover all of it.
TEST(HeightMap, RefusesDamage) {
  const std::string whole = MapOf(BlockWithAHole());
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_FALSE(ReadHeightMap(whole.substr(0, length))) << length;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    std::string damaged = whole;
    damaged[k] = static_cast<char>(damaged[k] ^ 0x55);
    EXPECT_FALSE(ReadHeightMap(damaged)) << k;
  }
}

// A heading may say what it likes: memory is not given for it. 30000 x 30000 are too many; 8000 x
// 8000 in 200 bytes cannot be.
TEST(HeightMap, GivesNoMemoryForAHeadingAlone) {
  std::string bytes = Png({.width = 3, .height = 2, .texts = kTexts});
  const auto with_size = [&](std::uint32_t size) {
    std::string changed = bytes;
    for (const std::size_t at : {16u, 20u}) {
      for (std::size_t k = 0; k < 4; ++k)
        changed[at + k] = static_cast<char>(static_cast<unsigned char>(size >> (24 - 8 * k)));
    }
    return SealedHeading(changed);
  };
  EXPECT_EQ(with_size(3).substr(0, 20), bytes.substr(0, 20));
  ExpectRefused(with_size(30000), "it has too many pixels");
  ExpectRefused(with_size(8000), "it ends too early");
  // 1 << 26 cells are as many as a block may have.
  ExpectRefused(with_size(8192), "it ends too early");
  ExpectRefused(with_size(8193), "it has too many pixels");
}

// PNG 11.2.2: the bits of a pixel, its colours, and the order of the rows.
TEST(HeightMap, IsGreyOfSixteenBitsInOrder) {
  const std::string bytes = Png({.width = 3, .height = 2, .texts = kTexts});
  const auto with = [&](std::size_t at, char value) {
    std::string changed = bytes;
    changed[at] = value;
    return SealedHeading(changed);
  };
  EXPECT_EQ(with(24, 16), bytes);
  ExpectRefused(with(24, 8), "it is not grey of 16 bits");
  ExpectRefused(with(25, 2), "it is not grey of 16 bits");
  ExpectRefused(with(28, 1), "it is interlaced");
}

// A map has eight short texts: dozens of them are taken, and long ones, but not without end.
TEST(HeightMap, HasTextsOfSomeNumberAndLength) {
  const auto with = [](std::size_t count, std::size_t length) {
    PngHeading heading{.width = 3, .height = 2, .texts = kTexts};
    for (std::size_t k = 0; k < count; ++k)
      heading.texts.emplace_back("More", std::string(length, 'x'));
    return Png(heading);
  };
  EXPECT_TRUE(ReadHeightMap(with(40, 1)));
  ExpectRefused(with(100, 1), "no height map");
  EXPECT_TRUE(ReadHeightMap(with(1, 60'000)));
  ExpectRefused(with(1, 70'000), "no height map");
}

// A picture of one grey packs into nothing, however long it is in the making: asked before each
// row.
TEST(Png, WhoeverWaitsIsAskedBeforeEachRow) {
  for (const int most : {7, 3}) {
    int asked = 0;
    int rows = 0;
    const bool written = WritePng(
        {.width = 5, .height = 7}, [&](std::size_t, std::span<std::uint8_t>) { ++rows; },
        [&](std::string_view part) {
          if (part.empty()) ++asked;
          return asked <= most;
        });
    EXPECT_EQ(written, most == 7);
    EXPECT_EQ(rows, most);
  }
}

}  // namespace
}  // namespace rmlcell::simulation
