// Each letter has its own width, and the curves of a long run have each bucket once.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "engine/simulation/picture/text_width.h"
#include "engine/simulation/picture/time_envelope.h"

namespace rmlcell::simulation {
namespace {

// The widths of Helvetica as Adobe published them, in thousandths of the size.
constexpr std::pair<int, std::string_view> kLettersOfWidth[] = {{191, "'"},
                                                                {222, "ijl"},
                                                                {260, "|"},
                                                                {278, " !,./:;I[\\]ft"},
                                                                {333, "()-`r"},
                                                                {334, "{}"},
                                                                {355, "\""},
                                                                {389, "*"},
                                                                {469, "^"},
                                                                {500, "Jcksvxyz"},
                                                                {556, "#$0123456789?L_abdeghnopqu"},
                                                                {584, "+<=>~"},
                                                                {611, "FTZ"},
                                                                {667, "&ABEKPSVXY"},
                                                                {722, "CDHNRUw"},
                                                                {778, "GOQ"},
                                                                {833, "Mm"},
                                                                {889, "%"},
                                                                {944, "W"},
                                                                {1015, "@"}};

TEST(LetterWidths, EachLetterHasItsOwn) {
  std::string seen;
  for (const auto& [width, letters] : kLettersOfWidth) {
    for (const char letter : letters) {
      EXPECT_NEAR(TextWidth({&letter, 1}, {.size = 1000.0}), 1.12 * width, 1e-6) << letter;
      EXPECT_NEAR(TextWidth({&letter, 1}, {.size = 500.0, .bold = true}), 0.5 * 1.12 * 1.1 * width,
                  1e-6)
          << letter;
      seen += letter;
    }
  }
  std::ranges::sort(seen);
  std::string all;
  for (char letter = ' '; letter <= '~'; ++letter) all += letter;
  EXPECT_EQ(seen, all);
  // What is no letter of these, and what is left of a text of which nothing fits.
  for (const char other : {'\x1F', '\x7F'})
    EXPECT_NEAR(TextWidth({&other, 1}, {.size = 1000.0}), 1120.0, 1e-6);
  EXPECT_EQ(Fitted("", -1.0, {.size = 10.0}), "…");
}

// Three times as many instants as there are buckets: each bucket is there once, in the order of
// time, and has all that lies in it.
TEST(LetterWidths, ALongRunHasEachBucketOnce) {
  TimeEnvelope envelope;
  constexpr std::uint64_t kInstants = 3 * TimeEnvelope::kBucketsMax;
  const SimTime step = envelope.width();
  const auto value_at = [](std::uint64_t k) { return static_cast<double>(k * 7919 % 10'007); };
  for (std::uint64_t k = 0; k < kInstants; ++k) {
    TimeEnvelope::Values values{};
    values[1] = value_at(k);
    envelope.Add(step * static_cast<SimTime::rep>(k), values);
    EXPECT_LE(envelope.buckets().size(), TimeEnvelope::kBucketsMax);
  }
  EXPECT_EQ(envelope.width(), 4 * step);
  ASSERT_EQ(envelope.buckets().size(), kInstants / 4);
  for (std::size_t bucket = 0; bucket < envelope.buckets().size(); ++bucket) {
    const TimeEnvelope::Bucket& here = envelope.buckets()[bucket];
    EXPECT_EQ(here.number, bucket);
    double low = value_at(4 * bucket), high = low;
    std::uint64_t low_at = 0, high_at = 0;
    for (std::uint64_t k = 1; k < 4; ++k) {
      const double value = value_at(4 * bucket + k);
      if (value < low) low_at = k;
      if (value > high) high_at = k;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    EXPECT_EQ(here.ranges[1].low, low);
    EXPECT_EQ(here.ranges[1].high, high);
    EXPECT_EQ(here.ranges[1].low_first, low_at <= high_at);
    EXPECT_EQ(here.ranges[1].last, value_at(4 * bucket + 3));
  }
}

}  // namespace
}  // namespace rmlcell::simulation
