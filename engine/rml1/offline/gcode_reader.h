#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/core/result.h"

namespace rmlcell::rml1 {

// A letter in upper case and its number, with its place.
struct GcodeWord {
  char letter = 0;
  double value = 0.0;
  SourceSpan where{};
};

// One line: its words without N, comments and blanks.
struct GcodeBlock {
  std::vector<GcodeWord> words;
  bool percent = false;  // a line of % alone
};

// Reads G-code line by line, docs/gcode.md: words, comments in ( ) on one line or from ; to its
// end, N and line ends of every kind. Letters may be small, and blanks stand anywhere, inside
// numbers too, as RS-274 has it. Nothing else is passed over: what cannot be read is an error of
// its line. Memory is that of one line, of at most kWordsMax words.
class GcodeReader {
 public:
  static constexpr std::size_t kWordsMax = 64;
  static constexpr std::size_t kDigitsMax = 40;  // of one number

  explicit GcodeReader(std::string_view text);

  // The next line, empty ones too; nothing at the end. Error: Rml1GcodeForm (8101) with its place;
  // the line is passed over, and the next call goes on behind it.
  std::optional<Result<GcodeBlock>> Next();
  std::size_t offset() const { return next_; }  // of the line to come

 private:
  Result<GcodeBlock> ReadBlock(std::string_view line) const;
  std::optional<Error> TakeWord(std::string_view line, std::size_t& at, GcodeBlock& block) const;
  SourceSpan Place(std::size_t column, std::size_t length) const;

  std::string_view text_;
  std::size_t next_ = 0;   // of the line to come
  std::size_t start_ = 0;  // of the present one
  int line_ = 0;
};

}  // namespace rmlcell::rml1
