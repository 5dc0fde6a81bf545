#include "engine/optimo/language/nearest_word.h"

#include <algorithm>
#include <utility>

#include "engine/core/letters.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kLongest = 16;  // longer words are no mistyped words of eight letters

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
  NearestOf nearest = NearestTo(word, candidates);
  near.words = std::move(nearest.words);
  if (nearest.distance == 1 && near.words.size() == 1) near.slip = SlipOf(word, near.words.front());
  return near;
}

Detail QuestionFor(const NearWords& near) { return DidYouMean(near.words); }

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
