#include "engine/optimo/language/nearest_word.h"

#include <algorithm>
#include <array>

#include "engine/core/letters.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kLongest = 16;  // longer words are no mistyped words of eight letters

// Optimal string alignment distance of two short words, without case.
int Distance(std::string_view a, std::string_view b) {
  std::array<std::array<int, kLongest + 1>, kLongest + 1> cost{};
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

bool IsDigitOfName(char c) { return c >= '0' && c <= '9'; }
// Letters by which the names of coordinates differ.
bool IsAxis(char c) {
  return std::string_view("XYZABC").find(UpperCase(c)) != std::string_view::npos;
}

// Of two words at a distance of 1: without what is equal at both ends.
struct Difference {
  std::string_view from, to;
};
Difference DifferenceOf(std::string_view from, std::string_view to) {
  while (!from.empty() && !to.empty() && UpperCase(from.front()) == UpperCase(to.front())) {
    from.remove_prefix(1);
    to.remove_prefix(1);
  }
  while (!from.empty() && !to.empty() && UpperCase(from.back()) == UpperCase(to.back())) {
    from.remove_suffix(1);
    to.remove_suffix(1);
  }
  return {from, to};
}

Slip SlipOf(std::string_view word, std::string_view meant) {
  const Difference difference = DifferenceOf(word, meant);
  for (const std::string_view part : {difference.from, difference.to}) {
    if (std::ranges::any_of(part, IsDigitOfName)) return Slip::kOther;
  }
  return difference.from.size() == 2 && difference.to.size() == 2 ? Slip::kSwap : Slip::kOneLetter;
}

}  // namespace

NearWords NearestWords(std::string_view word, std::span<const std::string_view> candidates) {
  NearWords near;
  if (word.size() > kLongest) return near;
  int best = static_cast<int>(word.size() / 3) + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() > kLongest || candidate.empty()) continue;
    const int distance = Distance(word, candidate);
    if (distance > best || (distance == best && near.words.empty())) continue;
    if (distance < best) near.words.clear();
    best = distance;
    if (near.words.size() < kNearWordsMax &&
        std::ranges::find(near.words, candidate) == near.words.end())
      near.words.emplace_back(candidate);
  }
  if (best == 1 && near.words.size() == 1) near.slip = SlipOf(word, near.words.front());
  return near;
}

std::string QuestionFor(const NearWords& near) {
  if (near.words.empty()) return {};
  std::string text = "; did you mean " + near.words.front();
  for (std::size_t w = 1; w < near.words.size(); ++w)
    text += (w + 1 < near.words.size() ? ", " : " or ") + near.words[w];
  return text + "?";
}

bool IsSurelyName(std::string_view word, const NearWords& near) {
  if (!near.IsSingle(Slip::kSwap)) return false;
  return !std::ranges::all_of(DifferenceOf(word, near.words.front()).from, IsAxis);
}

NameCandidates::NameCandidates(const Module& module, std::span<const std::uint16_t> declared) {
  constexpr std::size_t kNamesMax = 500;  // compared with one mistyped word
  for (const std::uint16_t name : declared.first(std::min(declared.size(), kNamesMax))) {
    char room[kNameLength];
    names_.emplace_back(UnpackName(module.names[name].key, room));
  }
}

void NameCandidates::AppendTo(std::vector<std::string_view>& candidates) const {
  candidates.insert(candidates.end(), names_.begin(), names_.end());
}

}  // namespace rmlcell::optimo
