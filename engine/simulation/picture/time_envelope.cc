#include "engine/simulation/picture/time_envelope.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

// `after` follows `range` in time.
void Join(TimeEnvelope::Range& range, const TimeEnvelope::Range& after) {
  const bool lower = after.low < range.low;
  const bool higher = after.high > range.high;
  if (lower && higher) {
    range.low_first = after.low_first;
  } else if (lower) {
    range.low_first = false;
  } else if (higher) {
    range.low_first = true;
  }
  range.low = std::min(range.low, after.low);
  range.high = std::max(range.high, after.high);
  range.last = after.last;
}

}  // namespace

void TimeEnvelope::Add(SimTime at, const Values& values) {
  while (static_cast<std::uint64_t>(at.count() / width_ns_) >= kBucketsMax) Halve();
  const auto number = static_cast<std::uint64_t>(at.count() / width_ns_);
  const bool opens = buckets_.empty() || buckets_.back().number != number;
  if (opens) buckets_.push_back({.number = number, .ranges = {}});
  Bucket& bucket = buckets_.back();
  for (std::size_t k = 0; k < kSeriesMax; ++k) {
    const Range point{values[k], values[k], values[k], values[k], true};
    if (opens) {
      bucket.ranges[k] = point;
    } else {
      Join(bucket.ranges[k], point);
    }
  }
}

void TimeEnvelope::Amend(std::size_t series, double value) {
  for (Bucket& bucket : buckets_) bucket.ranges[series] = {value, value, value, value, true};
}

void TimeEnvelope::Halve() {
  width_ns_ *= 2;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < buckets_.size(); ++k) {
    buckets_[k].number /= 2;
    if (kept > 0 && buckets_[kept - 1].number == buckets_[k].number) {
      for (std::size_t n = 0; n < kSeriesMax; ++n) {
        Join(buckets_[kept - 1].ranges[n], buckets_[k].ranges[n]);
      }
    } else {
      buckets_[kept++] = buckets_[k];
    }
  }
  buckets_.resize(kept);
}

}  // namespace rmlcell::simulation
