#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "engine/rml1/board/nearest_order.h"
#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/board/simplify.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

// The ranges of what is asked of a board, and of what its picture says. docs/boards.md
namespace rmlcell::rml1 {
namespace {

struct OptionRange {
  const char* name;
  double BoardOptions::*option;
  double low;
  double high;
};

// A value in its range comes as far as the picture, which has no copper.
TEST(BoardBounds, RangesOfOptions) {
  const Bitmap none{.width = 1, .height = 1, .copper = {0}};
  const OptionRange ranges[] = {{"the edge of a pixel", &BoardOptions::pixel_mm, 0.0001, 10.0},
                                {"the diameter of the tool", &BoardOptions::tool_mm, 0.01, 50.0},
                                {"the depth", &BoardOptions::depth_mm, 0.001, 1000.0},
                                {"the depth of a step", &BoardOptions::step_mm, 0.0, 1000.0},
                                {"the overlap", &BoardOptions::overlap, 0.0, 0.95},
                                {"the feed rate", &BoardOptions::feed_mm_s, 0.01, 1000.0},
                                {"the plunge rate", &BoardOptions::plunge_mm_s, 0.01, 1000.0},
                                {"the spindle speed", &BoardOptions::rpm, 0.0, 1e6},
                                {"the clearance", &BoardOptions::clearance_mm, 0.001, 1000.0},
                                {"the tolerance", &BoardOptions::tolerance_mm, 0.0, 1.0},
                                {"the place in X", &BoardOptions::at_x_mm, -1000.0, 1000.0},
                                {"the place in Y", &BoardOptions::at_y_mm, -1000.0, 1000.0}};
  for (const OptionRange& range : ranges) {
    const auto told = [&](double value) {
      BoardOptions options{.pixel_mm = 0.1};
      options.*range.option = value;
      const auto made = StreamOfBoard(none, ParametersOf("srm-20"), options);
      return made ? "made" : made.error().detail;
    };
    EXPECT_EQ(told(range.low), "the picture has no copper") << range.name;
    EXPECT_EQ(told(range.high), "the picture has no copper") << range.name;
    const double below = range.low - 1e-3 * std::abs(range.low) - (range.low == 0.0 ? 1e-6 : 0.0);
    for (const double value : {below, range.high * 1.001, double{NAN}}) {
      EXPECT_TRUE(told(value).starts_with(std::string(range.name) + " is ")) << told(value);
    }
  }
}

TEST(BoardBounds, NumberOfPasses) {
  const Bitmap none{.width = 1, .height = 1, .copper = {0}};
  const auto told = [&](int passes) {
    const BoardOptions options{.pixel_mm = 0.1, .passes = passes};
    return StreamOfBoard(none, ParametersOf("srm-20"), options).error().detail;
  };
  EXPECT_EQ(told(1), "the picture has no copper");
  EXPECT_EQ(told(100), "the picture has no copper");
  EXPECT_EQ(told(0), "the number of passes is 0; from 1 to 100 is possible");
  EXPECT_EQ(ArgumentsText(told(0)), "name='the number of passes' value=0 least=1 most=100");
  EXPECT_EQ(told(101), "the number of passes is 101; from 1 to 100 is possible");
}

// A clearance of less than a unit of 0.01 mm is one; where the tool stands higher than that, it
// comes down to it before anything else.
TEST(BoardBounds, TheToolComesDownToTheClearance) {
  const Bitmap pad{.width = 3, .height = 3, .copper = {0, 0, 0, 0, 1, 0, 0, 0, 0}};
  const auto begins = [&](double clearance_mm) {
    const auto made = StreamOfBoard(pad, ParametersOf("srm-20"),
                                    {.pixel_mm = 1.0, .clearance_mm = clearance_mm, .at_x_mm = 20});
    const std::size_t first = made->stream.find("\nZ") + 1;
    return made->stream.substr(first, made->stream.find(';', first) - first);
  };
  EXPECT_EQ(begins(0.001), "Z0,0,1");
  EXPECT_EQ(begins(3.0), "Z0,0,300");
}

// 1 mm in steps of 0.1 mm, whose sum is a little less: ten times down and no more.
TEST(BoardBounds, StepsOfTheDepth) {
  const Bitmap pad{.width = 3, .height = 3, .copper = {0, 0, 0, 0, 1, 0, 0, 0, 0}};
  const auto made = StreamOfBoard(pad, ParametersOf("srm-20"),
                                  {.pixel_mm = 1.0, .depth_mm = 1.0, .step_mm = 0.1});
  ASSERT_TRUE(made);
  ASSERT_EQ(made->loops, 1U);
  const std::string plunge = "!VZ1;\nZ";
  int plunges = 0;
  for (std::size_t at = made->stream.find(plunge); at != std::string::npos;
       at = made->stream.find(plunge, at + 1)) {
    ++plunges;
    const std::size_t end = made->stream.find(';', at + plunge.size());
    const std::string wanted = "," + std::to_string(-10 * plunges);
    EXPECT_TRUE(made->stream.substr(at, end - at).ends_with(wanted)) << plunges;
  }
  EXPECT_EQ(plunges, 10);
}

// A step is a unit of the machine at least, 0.01 mm here, and the stream has at most the bytes that
// it may have.
TEST(BoardBounds, StepsAndTheirStreamAreBounded) {
  const Bitmap pad{.width = 3, .height = 3, .copper = {0, 0, 0, 0, 1, 0, 0, 0, 0}};
  BoardOptions options{.pixel_mm = 1.0, .depth_mm = 1.0, .step_mm = 0.0099};
  const auto made = [&] { return StreamOfBoard(pad, ParametersOf("srm-20"), options); };
  const auto small = made();
  ASSERT_FALSE(small);
  EXPECT_EQ(small.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(small.error().detail,
            "the depth of a step is 0.0099 mm; a unit of this machine is 0.01 mm");
  EXPECT_EQ(ArgumentsText(small.error().detail), "value=0.0099 mm least=0.01 mm");
  options.step_mm = 0.01;
  const auto whole = made();
  ASSERT_TRUE(whole);
  options.bytes_max = whole->stream.size();
  EXPECT_TRUE(made());
  options.bytes_max = whole->stream.size() / 2;
  const auto large = made();
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::kRml1ProductTooLarge);
  EXPECT_EQ(large.error().detail, "more than " + std::to_string(options.bytes_max) + " bytes");
}

// As many bytes as the rounds have may be made, and not one more: the lift behind the last of them,
// which has the speed of a rapid, and the end are not of the rounds.
TEST(BoardBounds, BytesOfTheRounds) {
  const Bitmap pad{.width = 3, .height = 3, .copper = {0, 0, 0, 0, 1, 0, 0, 0, 0}};
  BoardOptions options{.pixel_mm = 1.0, .at_x_mm = 20.0, .at_y_mm = 20.0};
  const auto made = [&] { return StreamOfBoard(pad, ParametersOf("srm-20"), options); };
  const auto whole = made();
  ASSERT_TRUE(whole) << whole.error().detail;
  ASSERT_EQ(whole->loops, 1U);
  options.bytes_max = whole->stream.rfind("!VZ30;\n");
  ASSERT_NE(options.bytes_max, std::string::npos) << whole->stream;
  const auto as_many = made();
  ASSERT_TRUE(as_many) << as_many.error().detail;
  EXPECT_EQ(as_many->stream, whole->stream);
  --options.bytes_max;
  const auto one_less = made();
  ASSERT_FALSE(one_less);
  EXPECT_EQ(one_less.error().code, ErrorCode::kRml1ProductTooLarge);
}

// What lies no further off than the tolerance is left out; the first point and the one furthest
// from it stay.
TEST(SimplifiedBounds, WhatIsLeftOut) {
  const Loop four = {{0, 0}, {5, 1}, {10, 0}, {5, -3}};
  EXPECT_EQ(Simplified(four, 1.0), (Loop{{0, 0}, {10, 0}, {5, -3}}));
  EXPECT_EQ(Simplified(four, 0.999), four);
  EXPECT_EQ(Simplified(four, 3.0), (Loop{{0, 0}, {10, 0}}));
  // A point on the line between two others but behind them is as far off as the nearer one.
  const Loop behind = {{0, 0}, {-2, 0}, {10, 0}, {5, -3}};
  EXPECT_EQ(Simplified(behind, 1.9), behind);
}

// A long line is taken in parts of 4096 points, whose ends stay: out over 5000 points and back.
TEST(SimplifiedBounds, LongLinesAreTakenInParts) {
  Loop loop;
  for (int k = 0; k <= 5000; ++k) loop.push_back({static_cast<double>(k), 0});
  for (int k = 4999; k > 0; --k) loop.push_back({static_cast<double>(k), 0});
  EXPECT_EQ(Simplified(loop, 0.5), (Loop{{0, 0}, {4096, 0}, {5000, 0}, {5000 - 4096, 0}}));
}

// Of places that are as near the first one is taken.
TEST(NearestOrderBounds, TheFirstOfThoseThatAreAsNear) {
  const std::vector<PlanePoint> around = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  EXPECT_EQ(NearestOrder(around, {0, 0}).front(), 0U);
  const std::vector<PlanePoint> same(5, PlanePoint{3, 3});
  EXPECT_EQ(NearestOrder(same, {0, 0}), (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

std::string GrayPng(std::uint32_t width, const std::vector<std::uint8_t>& pixels) {
  png_image image{.version = PNG_IMAGE_VERSION,
                  .width = width,
                  .height = static_cast<std::uint32_t>(pixels.size()) / width,
                  .format = PNG_FORMAT_GRAY};
  png_alloc_size_t size = 0;
  EXPECT_NE(png_image_write_get_memory_size(image, size, 0, pixels.data(), 0, nullptr), 0);
  std::string bytes(size, '\0');
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr),
            0);
  bytes.resize(size);
  return bytes;
}

// From the middle of gray on it is light.
TEST(PngBounds, WhatIsLight) {
  const std::string png = GrayPng(4, {0, 127, 128, 255});
  EXPECT_EQ(ReadPng(png, false)->bitmap.copper, (std::vector<std::uint8_t>{0, 0, 1, 1}));
  EXPECT_EQ(ReadPng(png, true)->bitmap.copper, (std::vector<std::uint8_t>{1, 1, 0, 0}));
}

// Behind IHDR, 8 + 25 bytes: a chunk with a checksum that nobody looks at.
std::string WithChunk(std::string png, std::string_view type, std::string_view data) {
  const std::string length{'\0', '\0', '\0', static_cast<char>(data.size())};
  return png.insert(33, length + std::string(type) + std::string(data) + std::string(4, '\0'));
}

// 10000 pixels a metre are 0.1 mm each.
constexpr std::string_view kTenToAMm("\0\0\x27\x10", 4);
std::string Resolution(std::string_view x, std::string_view y, char unit) {
  return std::string(x) + std::string(y) + unit;
}

TEST(PngBounds, TheSizeOfAPixel) {
  const std::string png = GrayPng(2, {0, 255});
  const auto size = [](const std::string& bytes) { return ReadPng(bytes, false)->pixel_mm; };
  const std::string tenth = WithChunk(png, "pHYs", Resolution(kTenToAMm, kTenToAMm, '\1'));
  EXPECT_EQ(size(tenth), 0.1);
  // Other chunks may stand before it.
  EXPECT_EQ(size(WithChunk(tenth, "tEXt", std::string("a\0b", 3))), 0.1);
  EXPECT_EQ(size(WithChunk(tenth, "tEXt", "")), 0.1);
  // A ratio without a unit, and none at all, are no size.
  EXPECT_FALSE(size(WithChunk(png, "pHYs", Resolution(kTenToAMm, kTenToAMm, '\0'))));
  const std::string_view zero("\0\0\0\0", 4);
  EXPECT_FALSE(size(WithChunk(png, "pHYs", Resolution(zero, zero, '\1'))));
  EXPECT_FALSE(size(png));
  // One of them is enough to make a pixel oblong.
  EXPECT_FALSE(ReadPng(WithChunk(png, "pHYs", Resolution(kTenToAMm, zero, '\1')), false));
}

// What is given counts before what the picture says.
TEST(PngBounds, TheResolutionThatIsGiven) {
  EXPECT_DOUBLE_EQ(PixelSizeOf({.bitmap = {}, .pixel_mm = 0.5}, 254.0).value(), 0.1);
  EXPECT_EQ(PixelSizeOf({.bitmap = {}, .pixel_mm = 0.5}, 0.0).value(), 0.5);
  const auto none = PixelSizeOf({}, 0.0);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kRml1PictureSize);
}

// The size of a picture has two decimals; what is not about the travel is told as it was found.
TEST(BoardBounds, InTermsOfThePicture) {
  BoardLines board;
  board.width_mm = 12.3456;
  board.height_mm = 6.7891;
  const Error told =
      InTermsOfPicture({ErrorCode::kRml1WorkBeyondTravel, "2 mm would not be cut", {}}, board);
  EXPECT_EQ(told.code, ErrorCode::kRml1PictureBeyondTravel);
  EXPECT_EQ(told.detail, "the picture is 12.35 by 6.79 mm: 2 mm would not be cut");
  const Error other = InTermsOfPicture({ErrorCode::kRml1PartRefused, "1 is refused", {}}, board);
  EXPECT_EQ(other.code, ErrorCode::kRml1PartRefused);
  EXPECT_EQ(other.detail, "1 is refused");
}

// A chunk of another type says no size, even if it is as long; nor does one behind the image.
TEST(PngBounds, ChunksThatSayNoSize) {
  const std::string png = GrayPng(2, {0, 255});
  const std::string tenth = WithChunk(png, "pHYs", Resolution(kTenToAMm, kTenToAMm, '\1'));
  const auto text = ReadPng(WithChunk(tenth, "tEXt", std::string("a\0bcdefgh", 9)), false);
  ASSERT_TRUE(text) << text.error().detail;
  EXPECT_EQ(text->pixel_mm, 0.1);
  constexpr std::size_t kChunk = 12 + 9;  // of pHYs, whole
  constexpr std::size_t kEnd = 12;        // IEND, whole
  std::string late = png;
  late.insert(late.size() - kEnd, tenth.substr(33, kChunk));
  const auto behind = ReadPng(late, false);
  ASSERT_TRUE(behind) << behind.error().detail;
  EXPECT_FALSE(behind->pixel_mm);
}

}  // namespace
}  // namespace rmlcell::rml1
