#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/detail.h"

// What a mistyped word may mean: of a program, of the command line, a name of a profile.
namespace rmlcell {

inline constexpr std::size_t kNearWordsMax = 3;

// Differences are exchanged, missing, surplus and swapped neighbouring characters, without case.
// Nothing is near a word that is longer than this.
inline constexpr std::size_t kNearWordLongest = 32;

struct NearestOf {
  std::vector<std::string> words;  // all that are equally near, at most kNearWordsMax
  int distance = 0;                // how many differences each has
};
// The candidates with the fewest such differences, at most a third of the characters of the word;
// none when none is so near. Each once, in the order of the candidates.
NearestOf NearestTo(std::string_view word, std::span<const std::string_view> candidates);

// "; did you mean GO or GOTO?"; empty when there is no word.
Detail DidYouMean(std::span<const std::string> words);

}  // namespace rmlcell
