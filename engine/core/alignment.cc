#include "engine/core/alignment.h"

#include <algorithm>
#include <optional>

namespace rmlcell {
namespace {

using Keys = std::span<const std::uint64_t>;

// Furthest x on each diagonal k = x - y after d differences; rows of all d, to walk back.
std::optional<std::vector<AlignedPair>> LongestCommon(Keys a, Keys b) {
  using Row = std::vector<std::ptrdiff_t>;  // of d: the diagonals -d .. d, every other one
  const auto n = static_cast<std::ptrdiff_t>(a.size()), m = static_cast<std::ptrdiff_t>(b.size());
  std::vector<Row> rows;
  // Where a path is right after its d-th difference on diagonal k, and the diagonal before that:
  // it came from above (b grows) or from the left (a grows).
  struct Step {
    std::ptrdiff_t from, x;
  };
  const auto reached = [&](std::ptrdiff_t d, std::ptrdiff_t k) {
    return rows[static_cast<std::size_t>(d)][static_cast<std::size_t>(k + d)];
  };
  const auto last_step = [&](std::ptrdiff_t d, std::ptrdiff_t k) -> Step {
    if (d == 0) return {0, 0};
    if (k == -d || (k != d && reached(d - 1, k - 1) < reached(d - 1, k + 1)))
      return {k + 1, reached(d - 1, k + 1)};
    return {k - 1, reached(d - 1, k - 1) + 1};
  };
  // After n + m differences at the latest both ends are reached.
  for (std::ptrdiff_t d = 0; d <= static_cast<std::ptrdiff_t>(kDifferencesMax); ++d) {
    Row row(static_cast<std::size_t>(2 * d + 1));
    for (std::ptrdiff_t k = -d; k <= d; k += 2) {
      std::ptrdiff_t x = last_step(d, k).x;
      while (x < n && x - k < m &&
             a[static_cast<std::size_t>(x)] == b[static_cast<std::size_t>(x - k)])
        ++x;
      row[static_cast<std::size_t>(k + d)] = x;
      if (k != n - m || x < n) continue;
      std::vector<AlignedPair> pairs;
      for (std::ptrdiff_t step = d, diagonal = k;; --step) {
        const Step back = last_step(step, diagonal);
        for (; x > back.x; --x)
          pairs.push_back(
              {static_cast<std::size_t>(x - 1), static_cast<std::size_t>(x - 1 - diagonal)});
        if (step == 0) break;
        diagonal = back.from;
        x = reached(step - 1, diagonal);
      }
      std::ranges::reverse(pairs);
      return pairs;
    }
    rows.push_back(std::move(row));
  }
  return std::nullopt;
}

}  // namespace

std::vector<AlignedPair> Align(Keys a, Keys b) {
  std::vector<AlignedPair> pairs;
  const auto first = static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
  for (std::size_t i = 0; i < first; ++i) pairs.push_back({i, i});
  const Keys rest_a = a.subspan(first), rest_b = b.subspan(first);
  const auto tail = static_cast<std::size_t>(
      std::mismatch(rest_a.rbegin(), rest_a.rend(), rest_b.rbegin(), rest_b.rend()).first -
      rest_a.rbegin());
  const Keys middle_a = rest_a.first(rest_a.size() - tail),
             middle_b = rest_b.first(rest_b.size() - tail);
  if (const auto common = LongestCommon(middle_a, middle_b)) {
    for (const AlignedPair& pair : *common) pairs.push_back({pair.a + first, pair.b + first});
  } else {
    for (std::size_t i = 0; i < std::min(middle_a.size(), middle_b.size()); ++i) {
      if (middle_a[i] == middle_b[i]) pairs.push_back({first + i, first + i});
    }
  }
  for (std::size_t i = tail; i > 0; --i) pairs.push_back({a.size() - i, b.size() - i});
  return pairs;
}

}  // namespace rmlcell
