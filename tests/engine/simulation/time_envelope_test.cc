#include "engine/simulation/picture/time_envelope.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

namespace rmlcell::simulation {
namespace {

TimeEnvelope::Values Of(double value) {
  TimeEnvelope::Values values{};
  values[0] = value;
  return values;
}

TEST(TimeEnvelope, KeepsFirstLeastGreatestAndLastOfABucket) {
  TimeEnvelope envelope;
  for (const double value : {3.0, 7.0, -2.0, 4.0}) envelope.Add(SimTime(10), Of(value));
  ASSERT_EQ(envelope.buckets().size(), 1u);
  const TimeEnvelope::Range& range = envelope.buckets()[0].ranges[0];
  EXPECT_EQ(range.first, 3.0);
  EXPECT_EQ(range.low, -2.0);
  EXPECT_EQ(range.high, 7.0);
  EXPECT_EQ(range.last, 4.0);
  EXPECT_FALSE(range.low_first);
}

// Which extreme came first, by its first time; both at once have the order of what they came in.
TEST(TimeEnvelope, KnowsWhichExtremeCameFirst) {
  const auto low_first = [](std::initializer_list<double> values) {
    TimeEnvelope envelope;
    for (const double value : values) envelope.Add(SimTime(10), Of(value));
    return envelope.buckets()[0].ranges[0].low_first;
  };
  EXPECT_TRUE(low_first({3.0, 7.0}));
  EXPECT_TRUE(low_first({3.0, 7.0, 3.0}));
  EXPECT_TRUE(low_first({3.0, 7.0, 5.0, 7.0}));
  EXPECT_FALSE(low_first({7.0, 3.0}));
  EXPECT_FALSE(low_first({7.0, 3.0, 7.0}));
  EXPECT_FALSE(low_first({5.0, 7.0, 3.0, 6.0}));
  EXPECT_TRUE(low_first({5.0, 3.0, 7.0}));
}

TEST(TimeEnvelope, WhatASeriesWasCanBeToldLater) {
  TimeEnvelope envelope;
  const std::int64_t width = envelope.width().count();
  for (const std::int64_t at : {std::int64_t{0}, width}) envelope.Add(SimTime(at), {1.0, 2.0, 3.0});
  envelope.Amend(1, 7.0);
  envelope.Add(SimTime(width), {1.0, 6.0, 3.0});
  ASSERT_EQ(envelope.buckets().size(), 2u);
  for (const TimeEnvelope::Bucket& bucket : envelope.buckets()) {
    EXPECT_EQ(bucket.ranges[0].first, 1.0);
    EXPECT_EQ(bucket.ranges[1].first, 7.0);
    EXPECT_EQ(bucket.ranges[1].high, 7.0);
    EXPECT_EQ(bucket.ranges[2].last, 3.0);
  }
  EXPECT_EQ(envelope.buckets()[0].ranges[1].low, 7.0);
  EXPECT_EQ(envelope.buckets()[1].ranges[1].low, 6.0);
  EXPECT_FALSE(envelope.buckets()[1].ranges[1].low_first);
}

// An hour with one peak of a microsecond: it is there, and memory did not grow.
TEST(TimeEnvelope, NeverLosesAPeakHoweverLongTheRun) {
  TimeEnvelope envelope;
  for (int second = 0; second <= 3600; ++second) {
    envelope.Add(std::chrono::seconds(second), Of(1.0));
    if (second == 1234) {
      envelope.Add(std::chrono::seconds(second) + SimTime(1000), Of(99.0));
      envelope.Add(std::chrono::seconds(second) + SimTime(2000), Of(1.0));
    }
  }
  EXPECT_LE(envelope.buckets().size(), TimeEnvelope::kBucketsMax);
  double high = 0.0;
  double when = 0.0;
  for (const TimeEnvelope::Bucket& bucket : envelope.buckets()) {
    if (bucket.ranges[0].high <= high) continue;
    high = bucket.ranges[0].high;
    when = static_cast<double>(bucket.number) * ToSeconds(envelope.width());
  }
  EXPECT_EQ(high, 99.0);
  EXPECT_LE(when, 1234.0);
  EXPECT_GT(when + ToSeconds(envelope.width()), 1234.0);
}

// Joining neighbours gives what one coarse bucket would have kept: 1 2 | 5 0 | in order of time.
TEST(TimeEnvelope, JoinedBucketsKeepTheOrderOfTheirExtremes) {
  TimeEnvelope envelope;
  const std::int64_t width = envelope.width().count();
  envelope.Add(SimTime(0), Of(1.0));
  envelope.Add(SimTime(1), Of(2.0));
  envelope.Add(SimTime(width), Of(5.0));
  envelope.Add(SimTime(width + 1), Of(0.0));
  ASSERT_EQ(envelope.buckets().size(), 2u);
  envelope.Add(SimTime(width * static_cast<std::int64_t>(TimeEnvelope::kBucketsMax)), Of(3.0));
  EXPECT_EQ(envelope.width().count(), 2 * width);
  const TimeEnvelope::Range& range = envelope.buckets()[0].ranges[0];
  EXPECT_EQ(range.first, 1.0);
  EXPECT_EQ(range.high, 5.0);
  EXPECT_EQ(range.low, 0.0);
  EXPECT_EQ(range.last, 0.0);
  EXPECT_FALSE(range.low_first);
}

}  // namespace
}  // namespace rmlcell::simulation
