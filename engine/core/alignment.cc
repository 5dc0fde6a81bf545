#include "engine/core/alignment.h"

#include <algorithm>
#include <optional>

namespace rmlcell {
namespace {

using Keys = std::span<const std::uint64_t>;

// Furthest x on each diagonal k = x - y after d differences; rows of all d, to walk back.
std::optional<std::vector<AlignedPair>> LongestCommon(Keys a, Keys b) {
  const auto n = static_cast<std::ptrdiff_t>(a.size()), m = static_cast<std::ptrdiff_t>(b.size());
  std::vector<std::vector<std::ptrdiff_t>> rows;  // row d holds diagonals -d .. d
  const auto at = [](const std::vector<std::ptrdiff_t>& row, std::ptrdiff_t k) -> std::ptrdiff_t {
    const auto d = static_cast<std::ptrdiff_t>(row.size() / 2);
    return row[static_cast<std::size_t>(k + d)];
  };
  // Where a path with d differences on diagonal k comes from: down (b grows) or right (a grows).
  const auto from_above = [&](const std::vector<std::ptrdiff_t>& before, std::ptrdiff_t d,
                              std::ptrdiff_t k) {
    return k == -d || (k != d && at(before, k - 1) < at(before, k + 1));
  };
  for (std::ptrdiff_t d = 0; d <= n + m; ++d) {
    if (static_cast<std::size_t>(d) > kDifferencesMax) return std::nullopt;
    std::vector<std::ptrdiff_t> row(static_cast<std::size_t>(2 * d + 1), -1);
    for (std::ptrdiff_t k = -d; k <= d; k += 2) {
      std::ptrdiff_t x = 0;
      if (d > 0) {
        const auto& before = rows.back();
        // Diagonals beyond the last row were not reached.
        const auto reach = [&](std::ptrdiff_t diagonal) {
          return diagonal < -(d - 1) || diagonal > d - 1 ? -1 : at(before, diagonal);
        };
        const bool above = k == -d || (k != d && reach(k - 1) < reach(k + 1));
        x = above ? reach(k + 1) : reach(k - 1) + 1;
      }
      std::ptrdiff_t y = x - k;
      while (x < n && y < m && a[static_cast<std::size_t>(x)] == b[static_cast<std::size_t>(y)])
        ++x, ++y;
      row[static_cast<std::size_t>(k + d)] = x;
      if (k == n - m && x >= n) {
        rows.push_back(std::move(row));
        std::vector<AlignedPair> pairs;
        for (std::ptrdiff_t step = d; step >= 0; --step) {
          const std::ptrdiff_t diagonal = x - y;
          std::ptrdiff_t start = 0;  // x after the difference of this step
          std::ptrdiff_t back = 0;   // the diagonal it came from
          if (step > 0) {
            const auto& before = rows[static_cast<std::size_t>(step - 1)];
            const bool above = from_above(before, step, diagonal);
            back = above ? diagonal + 1 : diagonal - 1;
            start = above ? at(before, back) : at(before, back) + 1;
          }
          while (x > start) {
            --x, --y;
            pairs.push_back({static_cast<std::size_t>(x), static_cast<std::size_t>(y)});
          }
          if (step > 0) {
            x = at(rows[static_cast<std::size_t>(step - 1)], back);
            y = x - back;
          }
        }
        std::ranges::reverse(pairs);
        return pairs;
      }
    }
    rows.push_back(std::move(row));
  }
  return std::vector<AlignedPair>{};
}

}  // namespace

std::vector<AlignedPair> Align(Keys a, Keys b) {
  std::vector<AlignedPair> pairs;
  std::size_t first = 0;
  while (first < a.size() && first < b.size() && a[first] == b[first]) {
    pairs.push_back({first, first});
    ++first;
  }
  std::size_t tail = 0;
  while (tail < a.size() - first && tail < b.size() - first &&
         a[a.size() - 1 - tail] == b[b.size() - 1 - tail]) {
    ++tail;
  }
  const Keys middle_a = a.subspan(first, a.size() - first - tail),
             middle_b = b.subspan(first, b.size() - first - tail);
  if (const auto common = LongestCommon(middle_a, middle_b)) {
    for (const AlignedPair& pair : *common) pairs.push_back({pair.a + first, pair.b + first});
  } else {
    for (std::size_t i = 0; i < middle_a.size() && i < middle_b.size(); ++i) {
      if (middle_a[i] == middle_b[i]) pairs.push_back({first + i, first + i});
    }
  }
  for (std::size_t i = tail; i-- > 0;) pairs.push_back({a.size() - 1 - i, b.size() - 1 - i});
  return pairs;
}

}  // namespace rmlcell
