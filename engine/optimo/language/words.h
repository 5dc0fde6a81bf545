#pragma once

#include <cstdint>
#include <span>
#include <string_view>

// The reserved words of RML, one row each (optimo.md chapter 11, OPT-W.01 to OPT-W.75). Words and
// names are compared by their first eight characters in upper case, packed into one integer
// (OPT-1.02, 7.46).
namespace rmlcell::optimo {

inline constexpr int kNameLength = 8;  // characters that count, OPT-7.46

enum class Word : std::uint8_t {
  kNone,
#define RMLCELL_WORD(symbol, text, group, rule) k##symbol,
#include "engine/optimo/language/words.def"
#undef RMLCELL_WORD
};

// What a word is to the grammar.
enum class WordGroup : std::uint8_t {
  kNone,
  kInstruction,  // begins a statement
  kIgnored,      // begins a statement, accepted without effect: warning 7023
  kUnavailable,  // not on the Optimo: 7022
  kAttribute,    // after '/'
  kChoice,       // a value of COORD, PATH, DEFINE
  kFlow,         // THEN, ELSE
  kConstant,     // ON, OFF, PI ...
  kVariable,     // VR, VI ... PAR
  kFunction,     // SIN ...
  kOperator,     // AND, OR, XOR, NOT, MOD
};

struct WordInfo {
  Word word;
  std::string_view text;  // upper case
  WordGroup group;
  std::string_view rule;
};

// All reserved words, in the order of words.def; row i describes Word(i + 1).
std::span<const WordInfo> ReservedWords();

const WordInfo& Describe(Word word);  // precondition: word is not kNone

// The first eight characters in upper case, first character in the highest byte, blanks as zero
// bytes.
using NameKey = std::uint64_t;
NameKey PackName(std::string_view text);
std::string_view UnpackName(NameKey key, char (&room)[kNameLength]);

// The reserved word with exactly these (at most eight) characters, or kNone.
Word FindWord(NameKey key);

}  // namespace rmlcell::optimo
