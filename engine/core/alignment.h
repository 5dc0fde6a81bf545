#pragma once

#include <cstdint>
#include <span>
#include <vector>

// Which elements of two sequences belong together.
namespace rmlcell {

struct AlignedPair {
  std::size_t a = 0;
  std::size_t b = 0;

  bool operator==(const AlignedPair&) const = default;
};

// The longest common subsequence of two sequences of keys, as pairs in ascending order (Myers,
// O((n + m) d) with d the number of differences). Where more than kDifferencesMax elements differ,
// what lies between the first and the last equal stretch is paired where equal keys stand at the
// same distance from the first: still right, no longer the longest.
inline constexpr std::size_t kDifferencesMax = 2000;
std::vector<AlignedPair> Align(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b);

}  // namespace rmlcell
