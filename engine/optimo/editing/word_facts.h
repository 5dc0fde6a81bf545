#pragma once

#include <span>
#include <string_view>

#include "engine/optimo/language/words.h"

// What a programmer wants to know of a reserved word, in a line.
namespace rmlcell::optimo::editing {

struct WordFact {
  Word word = Word::kNone;
  std::string_view form{};  // how it is written; empty: as the word itself
  std::string_view text{};  // what it does
};

// One row for every reserved word, in the order of words.def.
std::span<const WordFact> WordFacts();
// Precondition: word is not kNone.
const WordFact& FactOf(Word word);

}  // namespace rmlcell::optimo::editing
