#include "engine/simulation/toolpath/toolpath.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>
#include <string_view>

namespace rmlcell::simulation {
namespace {

ToolpathBlock SmallBlock() {
  ToolpathBlock block;
  block.points = {{1000, 0, -500, 7, -8},
                  {2000, 0, -500, 7, -8},
                  {2000, 300, -500, 7, -8},
                  {-7, 8, 9, 7, -8},
                  {-7, 8, 10, 400, 1'570'796}};
  block.reached_us = {1'000'000, 1'200'000, 1'250'000, 1'300'000, 1'300'001};
  block.runs = {{.program = 45,
                 .step = 12,
                 .use = machine::MotionUse::kCut,
                 .beam_on = true,
                 .speed_class = 3,
                 .power_class = 15,
                 .reached_class = 2,
                 .start_us = 1'000'000,
                 .end_us = 1'250'000,
                 .first_point = 0,
                 .point_count = 3},
                {.program = 45,
                 .step = 13,
                 .use = machine::MotionUse::kPlunge,
                 .beam_on = false,
                 .speed_class = 0,
                 .start_us = 1'300'000,  // after a pause, and after a jump
                 .end_us = 1'300'001,
                 .first_point = 3,
                 .point_count = 2}};
  return block;
}

void ExpectEqual(const ToolpathBlock& a, const ToolpathBlock& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.reached_us, b.reached_us);
  EXPECT_EQ(a.runs, b.runs);
}

// docs/toolpath.md, byte by byte.
TEST(ToolpathBlock, BytesAreAsDocumented) {
  ToolpathBlock block;
  block.points = {{1, -1, 0, 0, -2}, {3, -1, 0, 1, -2}};
  block.reached_us = {300, 310};
  block.runs = {{.program = 2,
                 .step = 5,
                 .use = machine::MotionUse::kCut,
                 .beam_on = true,
                 .speed_class = 4,
                 .power_class = 15,
                 .start_us = 300,
                 .end_us = 310,
                 .first_point = 0,
                 .point_count = 2}};
  const std::string expected(
      "T\x02"         // magic, version
      "\x01\x02"      // one run, two points
      "\xAC\x02"      // start 300
      "\x02\x01\x00"  // (1, -1, 0)
      "\x00\x03"      // A 0, B -2
      "\x6D"          // 1 cut + 4 beam + 8 joined + 32 no pause + 64 one point
      "\x06"          // 2 same reached class + 4 turns
      "\x04\x0A\x04"  // program +2, step +5, class 4
      "\x0F"          // power class 15
      "\x0A"          // 10 us
      "\x04\x00\x00"  // (+2, 0, 0)
      "\x02\x00",     // A +1, B as before
      23);
  EXPECT_EQ(EncodeToolpathBlock(block), expected);
}

TEST(ToolpathBlock, ReadsBackWhatWasWritten) {
  const ToolpathBlock block = SmallBlock();
  const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
  ASSERT_TRUE(back);
  ExpectEqual(*back, block);
}

TEST(ToolpathBlock, ReadsBackTheFullestBlockAndTheFarthestPoints) {
  ToolpathBlock block;
  constexpr std::int32_t kFar = 2'000'000'000;
  for (std::size_t k = 0; k < kToolpathBlockPoints; ++k) {
    block.points.push_back(k % 2 == 0 ? ToolpathPoint{kFar, -kFar, 0, -kFar, 0}
                                      : ToolpathPoint{-kFar, kFar, 1, 0, kFar});
    block.reached_us.push_back(k + 1 < kToolpathBlockPoints ? static_cast<std::int64_t>(k * k)
                                                            : std::int64_t{1} << 50);
  }
  block.runs = {{.program = 99,
                 .step = std::numeric_limits<std::int32_t>::max(),
                 .speed_class = kSpeedClasses,
                 .power_class = kPowerClasses,
                 .reached_class = kSpeedClasses,
                 .start_us = 0,
                 .end_us = std::int64_t{1} << 50,
                 .first_point = 0,
                 .point_count = kToolpathBlockPoints}};
  const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
  ASSERT_TRUE(back);
  ExpectEqual(*back, block);
}

// Times that the way tells well enough are left out, and come back as the way tells them.
TEST(ToolpathBlock, TimesAreKeptWhereTheWayDoesNotTellThem) {
  ToolpathBlock block;
  block.points = {{0, 0, 0}, {1000, 0, 0}, {1000, 3000, 0}};
  block.runs = {{.start_us = 10'000, .end_us = 50'000, .first_point = 0, .point_count = 3}};
  const auto bytes = [&](std::int64_t middle_us) {
    block.reached_us = {10'000, middle_us, 50'000};
    return EncodeToolpathBlock(block);
  };
  // A quarter of the way: 20 ms, and a millisecond more or less.
  const std::string even = bytes(20'000);
  EXPECT_EQ(bytes(19'000), even);
  EXPECT_EQ(bytes(21'000), even);
  EXPECT_EQ(DecodeToolpathBlock(even)->reached_us,
            (std::vector<std::int64_t>{10'000, 20'000, 50'000}));
  for (const std::int64_t off : {18'999, 21'001, 50'000, 10'000}) {
    const std::string timed = bytes(off);
    EXPECT_GT(timed.size(), even.size()) << off;
    EXPECT_EQ(DecodeToolpathBlock(timed)->reached_us,
              (std::vector<std::int64_t>{10'000, off, 50'000}));
  }
}

// A head that stands costs nothing, and one that turns on the spot has its time by the points.
TEST(ToolpathBlock, AHeadMayTurnOnTheSpot) {
  ToolpathBlock block;
  block.points = {{0, 0, 0, 0, 5}, {0, 0, 0, 10, 5}, {0, 0, 0, 20, 5}};
  block.reached_us = {0, 50'000, 100'000};
  block.runs = {{.start_us = 0, .end_us = 100'000, .first_point = 0, .point_count = 3}};
  const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
  ASSERT_TRUE(back);
  ExpectEqual(*back, block);
  const std::size_t turning = EncodeToolpathBlock(block).size();
  for (ToolpathPoint& point : block.points) point.a_urad = 0;
  EXPECT_EQ(EncodeToolpathBlock(block).size(), turning - 4);
}

// A flag of a later version is no guess for this one.
TEST(ToolpathBlock, UnknownFlagsAndTimesBeyondTheEndAreRefused) {
  std::string bytes = EncodeToolpathBlock(SmallBlock());
  // Header: magic, version, counts, start of three bytes, the first point: 2, 1, 2, 1, 1 bytes.
  constexpr std::size_t kMore = 2 + 2 + 3 + 2 + 1 + 2 + 1 + 1 + 1;
  ASSERT_TRUE(DecodeToolpathBlock(bytes));
  bytes[kMore] = static_cast<char>(bytes[kMore] | 0x10);
  EXPECT_FALSE(DecodeToolpathBlock(bytes));
}

// Times that are told belong to the points behind the first, also of a run that begins elsewhere.
TEST(ToolpathBlock, TimesOfARunThatBeginsElsewhere) {
  ToolpathBlock block;
  block.points = {{0, 0, 0}, {1000, 0, 0}, {5000, 0, 0}, {6000, 0, 0}, {6000, 3000, 0}};
  block.reached_us = {0, 10'000, 30'000, 65'000, 70'000};
  block.runs = {
      {.step = 1, .start_us = 0, .end_us = 10'000, .first_point = 0, .point_count = 2},
      {.step = 2, .start_us = 30'000, .end_us = 70'000, .first_point = 2, .point_count = 3}};
  const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
  ASSERT_TRUE(back);
  ExpectEqual(*back, block);
}

// A block by hand: one run, with what a case changes. Each part in the order of docs/toolpath.md.
struct ByHand {
  std::string counts{"\x01\x02", 2};
  std::string start{"\0", 1};
  std::string first{"\0\0\0\0\0", 5};
  std::string flags{"\x6C\0", 2};   // beam, joined, no pause, one point
  std::string step{"\x02\x02", 2};  // program 1, step 1
  std::string classes{"\x01\x01\x01", 3};
  std::string duration{"\x0A", 1};
  std::string points{"\x02\0\0", 3};  // (+1, 0, 0)

  std::string bytes() const {
    return std::string("T\x02", 2) + counts + start + first + flags + step + classes + duration +
           points;
  }
};

std::string WhyNot(const ByHand& hand) {
  const Result<ToolpathBlock> read = DecodeToolpathBlock(hand.bytes());
  return read ? std::string() : std::string(read.error().detail);
}

std::string VarintOf(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}
std::string SignedOf(std::int64_t value) {
  return VarintOf(value < 0 ? ~(static_cast<std::uint64_t>(value) << 1)
                            : static_cast<std::uint64_t>(value) << 1);
}

// Both sides of each limit, and what is said beyond it.
TEST(ToolpathBlock, LimitsOfABlock) {
  EXPECT_EQ(WhyNot({}), "");
  EXPECT_EQ(WhyNot({.counts = {"\x02\x01", 2}}), "more points than a block has");
  EXPECT_EQ(WhyNot({.counts = {"\x01\x01", 2}}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.counts = {"\x01\x03", 2}}), "points missing");
  EXPECT_EQ(WhyNot({.counts = {"\x01\x80\x20", 3}}), "points missing");  // 4096
  EXPECT_EQ(WhyNot({.counts = {"\x01\x81\x20", 3}}), "more points than a block has");
  // Classes up to 20.
  for (const std::size_t which : {0u, 1u, 2u}) {
    ByHand hand;
    hand.classes[which] = 20;
    EXPECT_EQ(WhyNot(hand), "");
    hand.classes[which] = 21;
    EXPECT_EQ(WhyNot(hand), "run 1 cannot be read");
  }
  // Places of 32 bits.
  const std::int64_t low = std::numeric_limits<std::int32_t>::min();
  const std::int64_t high = std::numeric_limits<std::int32_t>::max();
  const std::string rest(4, '\0');
  EXPECT_EQ(WhyNot({.first = SignedOf(low) + rest}), "");
  EXPECT_EQ(WhyNot({.first = SignedOf(low - 1) + rest}), "no first point");
  EXPECT_EQ(WhyNot({.first = SignedOf(high - 1) + rest}), "");  // and a micrometre more
  EXPECT_EQ(WhyNot({.first = SignedOf(high) + rest}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.first = SignedOf(high + 1) + rest}), "no first point");
  // From 1 by as much as 64 bits hold, and from -1 by as much below 0.
  const std::int64_t farthest = std::numeric_limits<std::int64_t>::max();
  const std::string level(2, '\0');
  EXPECT_EQ(WhyNot({.first = SignedOf(1) + rest, .points = SignedOf(farthest) + level}),
            "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.first = SignedOf(-1) + rest, .points = SignedOf(-farthest - 1) + level}),
            "run 1 cannot be read");
  // Times up to what nanoseconds of 64 bits hold, rounded up to microseconds.
  const std::uint64_t latest = std::numeric_limits<std::int64_t>::max() / 1000 + 1;
  EXPECT_EQ(WhyNot({.start = VarintOf(latest), .duration = {"\0", 1}}), "");
  EXPECT_EQ(WhyNot({.start = VarintOf(latest + 1), .duration = {"\0", 1}}), "no first point");
  EXPECT_EQ(WhyNot({.duration = VarintOf(latest)}), "");
  EXPECT_EQ(WhyNot({.duration = VarintOf(latest + 1)}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.start = VarintOf(latest - 10)}), "");
  EXPECT_EQ(WhyNot({.start = VarintOf(latest - 9)}), "run 1 cannot be read");
}

// Programs and steps are numbers of 32 bits, as places are.
TEST(ToolpathBlock, NumbersOfARunHaveTheirLimits) {
  const std::int64_t high = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(WhyNot({.step = SignedOf(high) + SignedOf(high)}), "");
  EXPECT_EQ(WhyNot({.step = SignedOf(high + 1) + SignedOf(1)}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.step = SignedOf(1) + SignedOf(high + 1)}), "run 1 cannot be read");
}

// A block without runs is its head alone; what is missing of that is said.
TEST(ToolpathBlock, AHeadThatIsCutOff) {
  const std::string head = std::string("T\x02", 2) + std::string(2 + 1 + 5, '\0');
  const auto why_not = [&](std::size_t length) {
    const Result<ToolpathBlock> read =
        DecodeToolpathBlock(std::string_view(head).substr(0, length));
    return read ? std::string() : std::string(read.error().detail);
  };
  for (const std::size_t length : {2U, 3U})  // how many runs and points there are
    EXPECT_EQ(why_not(length), "more points than a block has") << length;
  for (std::size_t length = 4; length < head.size(); ++length)  // when, where, at which angles
    EXPECT_EQ(why_not(length), "no first point") << length;
  EXPECT_EQ(why_not(head.size()), "");
}

// Why bytes are no block: they are other ones, of another version, or go on behind its end.
TEST(ToolpathBlock, WhatIsNoBlockIsSaid) {
  const auto why_not = [](const std::string& bytes) {
    const Result<ToolpathBlock> read = DecodeToolpathBlock(bytes);
    return read ? std::string() : std::string(read.error().detail);
  };
  const std::string good = ByHand{}.bytes();
  EXPECT_EQ(why_not(good), "");
  EXPECT_EQ(why_not(""), "not a block");
  EXPECT_EQ(why_not("U" + good.substr(1)), "not a block");
  EXPECT_EQ(why_not("T"), "another version");
  for (const char version : {'\x01', '\x03'}) {
    std::string other = good;
    other[1] = version;
    EXPECT_EQ(why_not(other), "another version");
  }
  EXPECT_EQ(why_not(good + "x"), "bytes after the last run");
}

// A head that stands otherwise at the beginning of a run alone has turned, too.
TEST(ToolpathBlock, AHeadMayHaveTurnedBeforeARun) {
  for (const bool of_b : {false, true}) {
    ToolpathBlock block;
    block.points = {{0, 0, 0}, {1000, 0, 0}, {5000, 0, 0}, {6000, 0, 0}};
    (of_b ? block.points[2].b_urad : block.points[2].a_urad) = 50;
    block.reached_us = {0, 10'000, 20'000, 30'000};
    block.runs = {
        {.step = 1, .start_us = 0, .end_us = 10'000, .first_point = 0, .point_count = 2},
        {.step = 2, .start_us = 20'000, .end_us = 30'000, .first_point = 2, .point_count = 2}};
    const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
    ASSERT_TRUE(back);
    ExpectEqual(*back, block);
  }
}

// A run that is not joined has two points of its own at least, a joined one has one.
TEST(ToolpathBlock, PointsOfARun) {
  const std::string two("\x02\0\0\x04\0\0", 6);
  EXPECT_EQ(WhyNot({.flags = {"\x24\0", 2}, .duration = {"\x0A\x02", 2}, .points = two}), "");
  EXPECT_EQ(WhyNot({.flags = {"\x24\0", 2}, .duration = {"\x0A\x01", 2}}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.flags = {"\x64\0", 2}}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.flags = {"\x2C\0", 2}, .duration = {"\x0A\x01", 2}}), "");
  EXPECT_EQ(WhyNot({.flags = {"\x2C\0", 2}, .duration = {"\x0A\0", 2}}), "run 1 cannot be read");
  EXPECT_EQ(WhyNot({.flags = {"\x2C\0", 2}, .duration = {"\x0A\x02", 2}, .points = two}),
            "run 1 cannot be read");
  const Result<ToolpathBlock> apart = DecodeToolpathBlock(
      ByHand{.flags = {"\x24\0", 2}, .duration = {"\x0A\x02", 2}, .points = two}.bytes());
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->points, (std::vector<ToolpathPoint>{{1, 0, 0}, {3, 0, 0}}));
  EXPECT_EQ(apart->reached_us, (std::vector<std::int64_t>{0, 10}));
}

// Hostile bytes: every cut of a good block is refused with CELL-E9027.
TEST(ToolpathBlock, TruncatedBytesAreRefused) {
  const std::string bytes = EncodeToolpathBlock(SmallBlock());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Result<ToolpathBlock> back =
        DecodeToolpathBlock(std::string_view(bytes).substr(0, length));
    ASSERT_FALSE(back) << length;
    EXPECT_EQ(back.error().code, ErrorCode::kCellToolpathCorrupt);
  }
  EXPECT_FALSE(DecodeToolpathBlock(bytes + '\0'));
}

// Any change of bytes gives an error or a block within its bounds, and what is a block encodes to a
// block that is the same, its times within their tolerance.
TEST(ToolpathBlock, ChangedBytesNeverBreakTheBounds) {
  const std::string good = EncodeToolpathBlock(SmallBlock());
  std::mt19937 random(20240601);  // NOLINT: fixed seed, so that a failure can be repeated
  int read = 0;
  for (int round = 0; round < 50'000; ++round) {
    std::string bytes = good;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      bytes[random() % bytes.size()] = static_cast<char>(random() & 0xFFu);
    }
    const Result<ToolpathBlock> block = DecodeToolpathBlock(bytes);
    if (!block) continue;
    ++read;
    ASSERT_LE(block->points.size(), kToolpathBlockPoints);
    for (const ToolpathRun& run : block->runs) {
      ASSERT_GE(run.point_count, 2u);
      ASSERT_LE(run.first_point + run.point_count, block->points.size());
      ASSERT_LE(run.start_us, run.end_us);
      ASSERT_LE(run.speed_class, kSpeedClasses);
      ASSERT_LE(run.power_class, kPowerClasses);
      ASSERT_LE(run.reached_class, kSpeedClasses);
      std::int64_t before_us = run.start_us;
      for (std::uint32_t k = 0; k < run.point_count; ++k) {
        ASSERT_GE(TimeOf(*block, run, k), before_us);
        before_us = TimeOf(*block, run, k);
      }
      ASSERT_EQ(before_us, run.end_us);
    }
    if (block->runs.empty()) continue;
    const Result<ToolpathBlock> again = DecodeToolpathBlock(EncodeToolpathBlock(*block));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->points, block->points);
    EXPECT_EQ(again->runs, block->runs);
    ASSERT_EQ(again->reached_us.size(), block->reached_us.size());
    for (std::size_t k = 0; k < block->reached_us.size(); ++k) {  // times that were not needed
      ASSERT_NEAR(static_cast<double>(again->reached_us[k]),
                  static_cast<double>(block->reached_us[k]), kToolpathTimeTolerance_us);
    }
  }
  EXPECT_GT(read, 100);
}

// Counts that promise more than a block holds are refused before anything is reserved.
TEST(ToolpathBlock, HugeCountsAreRefused) {
  const std::string runs = std::string("T\x02", 2) + std::string(9, '\xFF') + '\x01';
  EXPECT_FALSE(DecodeToolpathBlock(runs));
  const std::string points("T\x02\x01\x81\x20\x00\x00\x00\x00", 9);  // 4097 points
  EXPECT_FALSE(DecodeToolpathBlock(points));
}

}  // namespace
}  // namespace rmlcell::simulation
