#include "engine/core/near_words.h"

#include <algorithm>
#include <array>

#include "engine/core/letters.h"

namespace rmlcell {
namespace {

// Optimal string alignment distance.
int Distance(std::string_view a, std::string_view b) {
  std::array<std::array<int, kNearWordLongest + 1>, kNearWordLongest + 1> cost{};
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = static_cast<int>(i);
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = UpperCase(a[i - 1]) == UpperCase(b[j - 1]);
      int best =
          std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && UpperCase(a[i - 1]) == UpperCase(b[j - 2]) &&
          UpperCase(a[i - 2]) == UpperCase(b[j - 1])) {
        best = std::min(best, cost[i - 2][j - 2] + 1);
      }
      cost[i][j] = best;
    }
  }
  return cost[a.size()][b.size()];
}

}  // namespace

NearestOf NearestTo(std::string_view word, std::span<const std::string_view> candidates) {
  NearestOf near;
  if (word.size() > kNearWordLongest) return near;
  near.distance = static_cast<int>(word.size() / 3) + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > kNearWordLongest || candidate.empty()) continue;
    const int distance = Distance(word, candidate);
    if (distance > near.distance || (distance == near.distance && near.words.empty())) continue;
    if (distance < near.distance) near.words.clear();
    near.distance = distance;
    if (near.words.size() < kNearWordsMax &&
        std::ranges::find(near.words, candidate) == near.words.end())
      near.words.emplace_back(candidate);
  }
  return near;
}

Detail DidYouMean(std::span<const std::string> words) {
  if (words.empty()) return {};
  Detail text = "; did you mean " + Told("near", words.front());
  for (std::size_t w = 1; w < words.size(); ++w)
    text += (w + 1 < words.size() ? ", " : " or ") + Told("near", words[w]);
  return text + "?";
}

}  // namespace rmlcell
