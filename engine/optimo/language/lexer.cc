#include "engine/optimo/language/lexer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "engine/optimo/language/evaluate.h"

namespace rmlcell::optimo {
namespace {

enum class Class : std::uint8_t {
  kBad,
  kBlank,
  kLineEnd,
  kComment,
  kDigit,
  kLetter,
  kPoint,
  kMark
};

constexpr std::array<Class, 256> MakeClasses() {
  std::array<Class, 256> classes{};
  for (int c = '0'; c <= '9'; ++c) classes[static_cast<std::size_t>(c)] = Class::kDigit;
  for (int c = 'A'; c <= 'Z'; ++c) classes[static_cast<std::size_t>(c)] = Class::kLetter;
  for (int c = 'a'; c <= 'z'; ++c) classes[static_cast<std::size_t>(c)] = Class::kLetter;
  for (const char c : {'(', ')', '[', ']', ',', '/', '+', '-', '*', '^', '<', '=', '>'}) {
    classes[static_cast<std::size_t>(c)] = Class::kMark;
  }
  classes[' '] = classes['\t'] = Class::kBlank;
  classes['\n'] = Class::kLineEnd;
  classes[';'] = Class::kComment;
  classes['.'] = Class::kPoint;
  return classes;
}
constexpr std::array<Class, 256> kClasses = MakeClasses();

// Marks of one character; '<' and '>' may have a second one.
constexpr std::array<TokenKind, 256> MakeMarks() {
  std::array<TokenKind, 256> marks{};
  marks['('] = TokenKind::kOpen;
  marks[')'] = TokenKind::kClose;
  marks['['] = TokenKind::kOpenIndex;
  marks[']'] = TokenKind::kCloseIndex;
  marks[','] = TokenKind::kComma;
  marks['/'] = TokenKind::kSlash;
  marks['+'] = TokenKind::kPlus;
  marks['-'] = TokenKind::kMinus;
  marks['*'] = TokenKind::kTimes;
  marks['^'] = TokenKind::kPower;
  marks['='] = TokenKind::kEqual;
  marks['<'] = TokenKind::kLess;
  marks['>'] = TokenKind::kGreater;
  return marks;
}
constexpr std::array<TokenKind, 256> kMarks = MakeMarks();

Class ClassOf(char c) { return kClasses[static_cast<unsigned char>(c)]; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsNamePart(char c) { return ClassOf(c) == Class::kDigit || ClassOf(c) == Class::kLetter; }
bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// `value` with the digits behind it that begin at `end`; it wraps around when they are too many.
struct DigitRun {
  std::uint64_t value = 0;
  std::size_t end = 0;
};
DigitRun TakeDigits(std::string_view text, std::size_t at, std::uint64_t value) {
  for (; at < text.size(); ++at) {
    const auto digit = static_cast<unsigned char>(text[at] - '0');
    if (digit > 9) break;
    value = value * 10 + digit;
  }
  return {value, at};
}

// exponent := blanks "E" blanks [sign] blanks digits                                       OPT-7.55
// Ends where it began when there is none: E without digits begins a word (OPT-B.41).
struct Exponent {
  int value = 0;
  std::size_t end = 0;
};
Exponent TakeExponent(std::string_view text, std::size_t begin) {
  constexpr int kFar = 1000;  // larger ones count as this, out of every range
  std::size_t at = begin;
  const auto next = [&] { return at < text.size() ? text[at] : '\0'; };
  const auto skip_blanks = [&] {
    while (IsBlank(next())) ++at;
  };
  skip_blanks();
  if (next() != 'E' && next() != 'e') return {0, begin};
  ++at;
  skip_blanks();
  const bool negative = next() == '-';
  if (negative || next() == '+') ++at;
  skip_blanks();
  if (!IsDigit(next())) return {0, begin};
  int value = 0;
  for (; IsDigit(next()); ++at) value = std::min(kFar, value * 10 + (text[at] - '0'));
  return {negative ? -value : value, at};
}

// The powers of ten that a double holds exactly.
constexpr std::array kTens = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr std::uint64_t kExactMantissa = std::uint64_t{1} << 53;

// mantissa * 10^exponent, rounded once to 24 bits. The quotient of two exact doubles is rounded
// right; rounding it again is wrong only when it lies half way between two floats: then from_chars
// decides.
std::optional<float> FastFloat(std::uint64_t mantissa, int exponent) {
  const auto power = static_cast<std::size_t>(std::abs(exponent));
  if (mantissa > kExactMantissa || power >= kTens.size()) return std::nullopt;
  auto value = static_cast<double>(mantissa);
  if (exponent < 0) {
    value /= kTens[power];
  } else {
    value *= kTens[power];
  }
  constexpr std::uint64_t kBelowFloat = (1ULL << 29) - 1;
  if ((std::bit_cast<std::uint64_t>(value) & kBelowFloat) == 1ULL << 28) return std::nullopt;
  return static_cast<float>(value);
}

// The mantissa has no zeros ahead; so of 0 itself nothing is left, or a point.
float SlowFloat(std::string_view mantissa, int exponent) {
  constexpr std::size_t kRoom = 400;
  std::array<char, kRoom + 8> room;
  std::size_t length = std::min(mantissa.size(), kRoom);
  std::memcpy(room.data(), mantissa.data(), length);
  // Of the digits behind those it only counts whether there are any: they decide what lies half way
  // between two floats.
  if (mantissa.find_first_not_of("0.", length) != std::string_view::npos) room[length++] = '1';
  room[length++] = 'e';
  length = static_cast<std::size_t>(
      std::to_chars(room.data() + length, room.data() + room.size(), exponent).ptr - room.data());
  float value = 0.0F;
  const auto result = std::from_chars(room.data(), room.data() + length, value);
  if (result.ec != std::errc::result_out_of_range) return value;
  // Far too large or far too small, as the power of ten of its first digit is.
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t digit = mantissa.find_first_not_of("0.");
  const int power = exponent + static_cast<int>(point) - static_cast<int>(digit);
  return std::pow(10.0F, static_cast<float>(power));
}

}  // namespace

Lexer::Lexer(std::string_view text, std::vector<Comment>& comments)
    : text_(text), comments_(&comments) {}

// Skips blanks, comments and line ends; false at the end of the text.
bool Lexer::SkipToContent() {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == '\n') {
      ++line_;
      ++at_;
    } else if (IsBlank(c)) {
      ++at_;
    } else if (c == '\r' &&
               (at_ + 1 == text_.size() || text_[at_ + 1] == '\n' || text_[at_ + 1] == '\r')) {
      ++at_;
    } else if (c == ';') {
      const void* found = std::memchr(text_.data() + at_, '\n', text_.size() - at_);
      std::size_t end =
          found == nullptr
              ? text_.size()
              : static_cast<std::size_t>(static_cast<const char*>(found) - text_.data());
      const std::size_t next = end;
      while (text_[end - 1] == '\r') --end;  // the ';' is none
      comments_->push_back({static_cast<std::uint32_t>(at_), static_cast<std::uint32_t>(end)});
      at_ = next;
    } else {
      return true;
    }
  }
  return false;
}

bool Lexer::NextStatement() {
  skipping_ = true;
  while (!done_) ReadLine();
  skipping_ = false;
  tokens_.clear();
  depth_ = 0;
  unfinished_ = false;
  if (!SkipToContent()) return false;
  done_ = false;
  statement_line_ = line_;
  ReadLine();
  return true;
}

const Token& Lexer::More(std::size_t position) {
  while (!done_ && position >= tokens_.size()) ReadLine();
  if (position < tokens_.size()) return tokens_[position];
  end_ = Token{};
  end_.offset = static_cast<std::uint32_t>(last_end_);
  return end_;
}

void Lexer::GoBackTo(std::size_t offset) {
  line_ -= static_cast<std::uint32_t>(std::count(text_.data() + offset, text_.data() + at_, '\n'));
  at_ = offset;
  while (!comments_->empty() && comments_->back().begin >= at_) comments_->pop_back();
}

void Lexer::ResumeAt(const Token& token) {
  GoBackTo(token.offset);
  done_ = true;
}

std::string_view Lexer::RestOfLine(const Token& token) {
  GoBackTo(token.offset + token.length);
  std::size_t end = at_;
  while (end < text_.size() && text_[end] != '\n' && text_[end] != ';') ++end;
  std::size_t begin = at_;
  at_ = end;
  while (end > begin && (IsBlank(text_[end - 1]) || text_[end - 1] == '\r')) --end;
  while (begin < end && IsBlank(text_[begin])) ++begin;
  last_end_ = std::max(end, static_cast<std::size_t>(token.offset) + token.length);
  done_ = true;
  return text_.substr(begin, end - begin);
}

// Reads the tokens of the present line, then decides whether the statement goes on. Called at
// content.
void Lexer::ReadLine() {
  line_start_ = true;
  const bool first = tokens_.empty();
  if (skipping_) tokens_.resize(1);  // only whether it goes on matters
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (IsBlank(c)) {
      ++at_;
      continue;
    }
    if (c == '\n' || c == ';') break;
    if (c == '\r' &&
        (at_ + 1 == text_.size() || text_[at_ + 1] == '\n' || text_[at_ + 1] == '\r')) {
      ++at_;
      continue;
    }
    if (tokens_.size() >= kStatementTokensMax) {
      Push(TokenKind::kTooLong, 1);
      at_ = std::min(text_.find('\n', at_), text_.size());
      break;
    }
    if (first && tokens_.empty() && IsDigit(c)) {
      ReadLabel();
    } else {
      ReadToken(c);
    }
    line_start_ = false;
  }
  done_ = !Continues();
}

// OPT-1.30. Goes over blank and comment lines; they do not end a statement.
bool Lexer::Continues() {
  const Token& last = tokens_.back();
  if (tokens_.size() == 1 && last.kind == TokenKind::kNumber) return false;  // lone sequence number
  bool wanting = depth_ > 0;
  switch (last.kind) {
    case TokenKind::kSlash:
    case TokenKind::kComma:
    case TokenKind::kOpen:
    case TokenKind::kEqual:
    case TokenKind::kPlus:
    case TokenKind::kMinus:
    case TokenKind::kTimes:
    case TokenKind::kPower:
    case TokenKind::kLess:
    case TokenKind::kLessEqual:
    case TokenKind::kGreater:
    case TokenKind::kGreaterEqual:
    case TokenKind::kNotEqual:
      wanting = true;
      break;
    case TokenKind::kWord:
      wanting = wanting ||
                (last.word != Word::kNone && Describe(last.word).group == WordGroup::kOperator);
      break;
    default:
      break;
  }
  if (!SkipToContent()) {
    unfinished_ = wanting;
    return false;
  }
  const char next = text_[at_];
  if (next == '(' || next == ')' || next == ',' || next == '/') return true;
  if (!wanting || BeginsInstruction(at_)) return false;
  return !(skipping_ && BeginsAssignment(at_));
}

// No continuation line can begin with an instruction word, whatever is still open: so one forgotten
// parenthesis costs one statement and not the rest of the text.
bool Lexer::BeginsInstruction(std::size_t offset) const {
  std::size_t at = offset;
  while (at < text_.size() && IsDigit(text_[at])) ++at;
  while (at < text_.size() && IsBlank(text_[at])) ++at;
  std::size_t end = at;
  while (end < text_.size() && end - at <= kNameLength && IsNamePart(text_[end])) ++end;
  if (end == at || end - at > kNameLength) return false;
  const Word word = FindWord(PackName(text_.substr(at, end - at)));
  if (word == Word::kNone) return false;
  const WordGroup group = Describe(word).group;
  return group == WordGroup::kInstruction || group == WordGroup::kIgnored;
}

// NAME = or VR[5] =, after an error only: inside parentheses this may be a comparison.
bool Lexer::BeginsAssignment(std::size_t offset) const {
  constexpr std::size_t kFar = 40;  // "VARIABLE [ INDEXNAM ] =" with a few blanks
  std::size_t at = offset;
  const std::size_t end = std::min(text_.size(), offset + kFar);
  if (at == end || ClassOf(text_[at]) != Class::kLetter) return false;
  while (at < end && IsNamePart(text_[at])) ++at;
  while (at < end && IsBlank(text_[at])) ++at;
  if (at < end && text_[at] == '[') {
    while (at < end && text_[at] != ']' && text_[at] != '\n') ++at;
    if (at < end && text_[at] == ']') ++at;
    while (at < end && IsBlank(text_[at])) ++at;
  }
  return at < end && text_[at] == '=';
}

void Lexer::ReadToken(char first) {
  switch (ClassOf(first)) {
    case Class::kLetter:
      return ReadWord();
    case Class::kDigit:
    case Class::kPoint:
      return ReadNumber();
    case Class::kMark:
      return ReadMark(first);
    default: {
      // A run of bad bytes is one token: a character of several bytes, or a binary file.
      std::size_t end = at_ + 1;
      while (end < text_.size() && ClassOf(text_[end]) == Class::kBad && text_[end] != '\r') ++end;
      return Push(TokenKind::kBadCharacter, end - at_);
    }
  }
}

// OPT-B.87: a mark of two characters has no blank inside.
void Lexer::ReadMark(char first) {
  const TokenKind kind = kMarks[static_cast<unsigned char>(first)];
  if (kind == TokenKind::kOpen) ++depth_;
  if (kind == TokenKind::kClose && depth_ > 0) --depth_;
  if (kind != TokenKind::kLess && kind != TokenKind::kGreater) return Push(kind, 1);
  const char second = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
  const bool less = kind == TokenKind::kLess;
  if (second == '=') return Push(less ? TokenKind::kLessEqual : TokenKind::kGreaterEqual, 2);
  if (second == (less ? '>' : '<')) return Push(TokenKind::kNotEqual, 2);
  Push(kind, 1);
}

void Lexer::ReadWord() {
  std::size_t end = at_ + 1;
  NameKey key = static_cast<unsigned char>(text_[at_] & ~0x20);
  int shift = 56;
  for (; end < text_.size() && IsNamePart(text_[end]); ++end) {
    if (end - at_ >= kNameLength) continue;
    const auto c = static_cast<unsigned char>(text_[end]);
    key = key << 8 | (c >= 'a' ? c - 0x20U : c);
    shift -= 8;
  }
  key <<= shift;
  const std::size_t length = end - at_;
  Push(TokenKind::kWord, length);
  tokens_.back().key = key;
  tokens_.back().word = length <= kNameLength ? FindWord(key) : Word::kNone;
}

// A run of digits at the start of a statement is its sequence number, never a part of more.
// OPT-1.28
void Lexer::ReadLabel() {
  std::uint32_t value = 0;
  std::size_t end = at_;
  for (; end < text_.size() && IsDigit(text_[end]); ++end) {
    value = std::min(kDigitsMax, value * 10 + static_cast<std::uint32_t>(text_[end] - '0'));
  }
  Push(TokenKind::kNumber, end - at_);
  tokens_.back().whole = true;
  tokens_.back().digits = value;
}

// number := (digits ["." [digits]] | "." digits) [exponent]             OPT-7.53 to 7.55, OPT-B.42
void Lexer::ReadNumber() {
  constexpr std::size_t kExactDigits =
      19;  // a mantissa of 64 bits holds as many, whatever they are
  constexpr int kExponentMax = 99;
  std::size_t first = at_;
  while (first < text_.size() && text_[first] == '0') ++first;
  const DigitRun before = TakeDigits(text_, first, 0);
  const bool point = before.end < text_.size() && text_[before.end] == '.';
  const DigitRun behind = point ? TakeDigits(text_, before.end + 1, before.value) : before;
  const std::size_t decimals = point ? behind.end - before.end - 1 : 0;
  std::size_t mantissa_end = behind.end;
  bool bad = before.end + decimals == at_;  // not one digit
  for (;
       mantissa_end < text_.size() && (text_[mantissa_end] == '.' || IsDigit(text_[mantissa_end]));
       ++mantissa_end)
    bad = true;
  const Exponent exponent = TakeExponent(text_, mantissa_end);
  bad = bad || std::abs(exponent.value) > kExponentMax;
  const std::string_view mantissa = text_.substr(first, mantissa_end - first);
  const bool whole = !point && exponent.end == mantissa_end;
  Push(bad ? TokenKind::kBadNumber : TokenKind::kNumber, exponent.end - at_);
  if (bad) return;
  Token& token = tokens_.back();
  token.whole = whole;
  const bool exact = before.end - first + decimals <= kExactDigits;
  token.digits = exact
                     ? static_cast<std::uint32_t>(std::min<std::uint64_t>(behind.value, kDigitsMax))
                     : kDigitsMax;
  const std::optional<float> fast =
      exact ? FastFloat(behind.value, exponent.value - static_cast<int>(decimals)) : std::nullopt;
  token.number = fast ? *fast : SlowFloat(mantissa, exponent.value);
  token.too_large = !(static_cast<double>(token.number) <= kRealMax);
  if (static_cast<double>(token.number) < kRealMin) token.number = 0.0F;
}

}  // namespace rmlcell::optimo
