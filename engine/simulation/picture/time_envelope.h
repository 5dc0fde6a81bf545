#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/units.h"

namespace rmlcell::simulation {

// What a few values did over virtual time, in memory of fixed size however long that is: time is
// cut into buckets, and each keeps where its values came in, their least and greatest, and where
// they went out. No peak is lost; what is finer than a bucket is not told apart. When the buckets
// are used up, neighbours are joined in pairs.
class TimeEnvelope {
 public:
  static constexpr std::size_t kSeriesMax = 8;
  static constexpr std::size_t kBucketsMax = 4096;  // twice the pixels across a wide picture
  using Values = std::array<double, kSeriesMax>;

  // Precondition: `at` is not below 0 and not before the time of an earlier call.
  void Add(SimTime at, const Values& values);

  // What a series was all the time so far.
  void Amend(std::size_t series, double value);

  struct Range {
    double first = 0.0;
    double low = 0.0;
    double high = 0.0;
    double last = 0.0;
    bool low_first = true;  // the least came before the greatest
  };
  struct Bucket {
    std::uint64_t number = 0;  // it begins at number x width()
    std::array<Range, kSeriesMax> ranges{};
  };

  // In order of time; stretches in which nothing was added have none.
  const std::vector<Bucket>& buckets() const { return buckets_; }
  SimTime width() const { return SimTime(width_ns_); }

 private:
  void Halve();

  std::int64_t width_ns_ = 1 << 16;  // 4096 of them are 0.27 s: shorter runs need no finer look
  std::vector<Bucket> buckets_;
};

}  // namespace rmlcell::simulation
