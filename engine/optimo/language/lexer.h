#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/optimo/language/program.h"
#include "engine/optimo/language/words.h"

// Text to tokens, one statement at a time, its continuation lines included (OPT-1.18, 1.27
// to 1.32).
namespace rmlcell::optimo {

enum class TokenKind : std::uint8_t {
  kEnd,  // of the statement
  kNumber,
  kWord,  // reserved word or name
  kOpen,
  kClose,
  kOpenIndex,
  kCloseIndex,
  kComma,
  kSlash,
  kPlus,
  kMinus,
  kTimes,
  kPower,
  kLess,
  kLessEqual,
  kEqual,
  kGreaterEqual,
  kGreater,
  kNotEqual,
  kBadCharacter,  // a byte that no token can contain
  kBadNumber,     // "5..", ".", an exponent over 99
  kTooLong,       // the statement has more than kStatementTokensMax tokens; the line is cut here
};

// No object of 34,000 bytes (OPT-1.08) can hold a statement of more; bounds memory on hostile text.
inline constexpr std::size_t kStatementTokensMax = 100'000;

struct Token {
  TokenKind kind = TokenKind::kEnd;
  Word word = Word::kNone;  // kWord: the reserved word, or kNone for a name
  bool first_on_line = false;
  bool joined = false;     // no blank between it and the token before
  bool whole = false;      // kNumber without point and exponent
  bool too_large = false;  // kNumber: beyond 2^63
  std::uint32_t offset = 0;
  std::uint32_t length = 0;
  std::uint32_t digits = 0;  // kNumber, whole: its value, at most kDigitsMax
  float number = 0.0F;       // kNumber: rounded to 24 bits
  NameKey key = 0;           // kWord: first eight characters
};
inline constexpr std::uint32_t kDigitsMax = 1'000'000'000;  // larger whole numbers saturate

// Reads lines only when their tokens are asked for, so that work stays linear whatever the errors
// are.
class Lexer {
 public:
  Lexer(std::string_view text, std::vector<Comment>& comments);

  // Goes to the next statement (or lone sequence number); false at the end of the text. What was
  // left of the statement before is skipped, its continuation lines included.
  bool NextStatement();

  // The tokens of the statement: position 0 is the first. Behind the last there is kEnd for ever.
  const Token& At(std::size_t position) {
    return position < tokens_.size() ? tokens_[position] : More(position);
  }

  // Line of the statement's first token, from 1.
  std::uint32_t line() const { return statement_line_; }

  // Since the beginning, those read again behind ResumeAt among them.
  std::uint64_t tokens_read() const { return tokens_read_; }

  // The line at `offset` begins like an assignment: NAME = or VR[5] =.
  bool BeginsAssignment(std::size_t offset) const;

  // The statement stopped at the end of the text where it should have gone on: 7002.
  bool unfinished() const { return unfinished_; }

  // The next statement begins at this token, the first of its line, instead of behind the present
  // one.
  void ResumeAt(const Token& token);

  // The rest of the line, from the end of `token` to a comment or the line end, belongs to the
  // statement without being looked at. Returns it without blanks at both ends.
  std::string_view RestOfLine(const Token& token);

  std::string_view TextOf(const Token& token) const {
    return text_.substr(token.offset, token.length);
  }

 private:
  const Token& More(std::size_t position);
  void ReadLine();
  bool SkipToContent();
  bool Continues();
  bool BeginsInstruction(std::size_t offset) const;
  void GoBackTo(std::size_t offset);
  void ReadToken(char first);
  void ReadMark(char first);
  void ReadNumber();
  void ReadLabel();
  void ReadWord();
  void Push(TokenKind kind, std::size_t length) {
    tokens_.push_back({.kind = kind,
                       .first_on_line = line_start_,
                       .joined = !line_start_ && last_end_ == at_,
                       .offset = static_cast<std::uint32_t>(at_),
                       .length = static_cast<std::uint32_t>(length)});
    at_ += length;
    last_end_ = at_;
    ++tokens_read_;
  }

  std::string_view text_;
  std::vector<Comment>* comments_;
  std::vector<Token> tokens_;
  Token end_;
  std::uint64_t tokens_read_ = 0;
  std::size_t at_ = 0;
  std::size_t last_end_ = 0;  // behind the last token
  std::uint32_t line_ = 1;    // of at_
  std::uint32_t statement_line_ = 1;
  int depth_ = 0;  // open parentheses
  bool line_start_ = true;
  bool done_ = true;  // all tokens of the statement are read
  bool skipping_ = false;
  bool unfinished_ = false;
};

}  // namespace rmlcell::optimo
