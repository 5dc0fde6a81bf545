#include "engine/rml1/offline/gcode_reader.h"

#include <string>

#include "engine/core/hex.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }
bool IsLetter(char c) { return c >= 'A' && c <= 'Z'; }
bool IsOfNumber(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-'; }

Detail CharacterText(char c) {
  if (c > 0x20 && c < 0x7F) return "'" + Told("character", {&c, 1}) + "'";
  return "byte " + Told("byte", static_cast<unsigned char>(c), {}, "0x" + HexByte(c));
}

}  // namespace

// Editors of Windows put a mark in front that belongs to no line.
GcodeReader::GcodeReader(std::string_view text) : text_(text) {
  constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
  if (text_.starts_with(kUtf8Mark)) next_ = kUtf8Mark.size();
}

std::optional<Result<GcodeBlock>> GcodeReader::Next() {
  if (next_ >= text_.size()) return std::nullopt;
  start_ = next_;
  ++line_;
  const std::size_t end = std::min(text_.find_first_of("\r\n", start_), text_.size());
  next_ = end + 1;
  if (end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n') ++next_;
  return ReadBlock(text_.substr(start_, end - start_));
}

Result<GcodeBlock> GcodeReader::ReadBlock(std::string_view line) const {
  GcodeBlock block;
  const std::string_view trimmed = Trimmed(line);
  block.percent = trimmed.starts_with('%');
  std::size_t at = block.percent ? line.find('%') + 1 : 0;
  while (at < line.size()) {
    const char c = line[at];
    if (IsBlank(c)) {
      ++at;
    } else if (block.percent && c != '(' && c != ';') {
      return Error{ErrorCode::kRml1GcodeForm, "% stands alone on its line", Place(at, 1)};
    } else if (c == ';') {
      break;
    } else if (c == '(') {
      const std::size_t close = line.find(')', at);
      if (close == std::string_view::npos)
        return Error{ErrorCode::kRml1GcodeForm, "a comment without its )", Place(at, 1)};
      at = close + 1;
    } else if (IsLetter(UpperCase(c))) {
      if (const auto error = TakeWord(line, at, block)) return *error;
    } else if (c == '/') {
      return Error{ErrorCode::kRml1GcodeForm,
                   "a line that may be skipped by a switch: take out the / or the line",
                   Place(at, 1)};
    } else {
      return Error{ErrorCode::kRml1GcodeForm, CharacterText(c) + " begins no word", Place(at, 1)};
    }
  }
  return block;
}

// Letter and number with blanks anywhere; `at` goes behind it.
std::optional<Error> GcodeReader::TakeWord(std::string_view line, std::size_t& at,
                                           GcodeBlock& block) const {
  const std::size_t begin = at;
  const char letter = UpperCase(line[at++]);
  std::string number;
  std::size_t end = at;  // behind the last digit
  for (; at < line.size() && (IsBlank(line[at]) || IsOfNumber(line[at])); ++at) {
    if (IsBlank(line[at])) continue;
    if (number.size() <= kDigitsMax) number += line[at];
    end = at + 1;
  }
  std::string_view digits = number;
  const SourceSpan where = Place(begin, end - begin);
  const bool plus = digits.starts_with('+');
  if (plus) digits.remove_prefix(1);
  const bool signs = plus && (digits.starts_with('+') || digits.starts_with('-'));
  const auto value = number.size() <= kDigitsMax && !signs ? ParseDouble(digits) : std::nullopt;
  if (!value) {
    return Error{
        ErrorCode::kRml1GcodeForm,
        Told("word", {&letter, 1}) + (digits.empty() ? " has no number" : " has no such number"),
        where};
  }
  if (letter == 'N') return std::nullopt;
  if (block.words.size() == kWordsMax)
    return Error{ErrorCode::kRml1GcodeForm, "more words than a line may have", where};
  block.words.push_back({letter, *value, where});
  return std::nullopt;
}

SourceSpan GcodeReader::Place(std::size_t column, std::size_t length) const {
  return {.line = line_,
          .column = static_cast<int>(std::min<std::size_t>(column, 1'000'000)) + 1,
          .length = static_cast<int>(std::min<std::size_t>(length, 1'000)),
          .byte_offset = static_cast<std::int64_t>(start_ + column)};
}

}  // namespace rmlcell::rml1
