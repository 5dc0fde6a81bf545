#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/near_words.h"
#include "engine/optimo/language/ast.h"

// What a mistyped word may mean. Private to the folder.
namespace rmlcell::optimo {

// How the nearest words differ from the one that was written.
enum class Slip : std::uint8_t {
  kOther,
  kOneLetter,  // one letter exchanged, missing or too many; no digit
  kSwap,       // two neighbouring letters swapped
};

struct NearWords {
  std::vector<std::string> words;  // all that are equally near, at most kNearWordsMax
  Slip slip = Slip::kOther;        // of a single one

  bool IsSingle(Slip of) const { return words.size() == 1 && slip == of; }
};

// The candidates with the fewest exchanged, missing, surplus or swapped characters, at most a third
// of the word; none when none is so near. Each once, in the order of the candidates.
NearWords NearestWords(std::string_view word, std::span<const std::string_view> candidates);

// "; did you mean GO or GOTO?"; empty when there is no word.
Detail QuestionFor(const NearWords& near);

// One name for another changes the program, and it stays valid: ZONE3 is no slip for ZONE1, nor
// YPOS for XPOS or POS for POSX. Only two swapped letters that name no axes are taken for a slip.
bool IsSurelyName(std::string_view word, const NearWords& near);

// Names that were declared, as candidates. Comparing them with a mistyped word is bounded.
class NameCandidates {
 public:
  NameCandidates(const Module& module, std::span<const std::uint16_t> declared);

  void AppendTo(std::vector<std::string_view>& candidates) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace rmlcell::optimo
