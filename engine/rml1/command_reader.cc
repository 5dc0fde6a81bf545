#include "engine/rml1/command_reader.h"

#include <algorithm>

namespace rmlcell::rml1 {
namespace {

// The letter in upper case, or 0. Bytes of 0x80 or more are no letters (RML1-1.09, RML1-1.10).
char LetterOf(unsigned char byte) {
  const auto upper = static_cast<char>(byte >= 'a' && byte <= 'z' ? byte - 'a' + 'A' : byte);
  return upper >= 'A' && upper <= 'Z' ? upper : char{0};
}

// Blanks between the letters count; a stream of nothing else must not overflow the figure.
int LengthFrom(std::int64_t first, std::int64_t last) {
  constexpr std::int64_t kLengthMax = 1'000'000'000;
  return static_cast<int>(std::min(last - first + 1, kLengthMax));
}

// Blanks, and one comma unless there was one, or none may come (rml1.md 0.4 rule 1).
const char* SkipSeparators(const char* at, const char* end, bool& comma) {
  for (; at != end; ++at) {
    if (*at == ',' && !comma) {
      comma = true;
    } else if (*at != ' ' && *at != '\t') {
      break;
    }
  }
  return at;
}

// A whole number of six digits at most. Returns where it ends; nullptr: it is none. Precondition: a
// sign and eight bytes can be read. Always inline: a set has three.
[[gnu::always_inline]] inline const char* ReadNumber(const char* at, double& number) {
  constexpr unsigned kDigitsMax = 6;
  const std::ptrdiff_t negative = *at == '-' ? 1 : 0;
  const DigitWord word(at + negative);
  const unsigned count = word.count();
  if (count - 1U >= kDigitsMax) return nullptr;
  number = static_cast<double>((word.value(count) ^ -negative) + negative);  // never -0
  return at + negative + count;
}

Reading Nothing() { return {}; }
Reading Again(Reading::Kind kind) { return {kind, false}; }

}  // namespace

Reading CommandReader::Put(unsigned char byte, std::int64_t offset) {
  switch (state_) {
    case State::kSearch:
      return Search(byte, offset);
    case State::kLetter:
      return SecondLetter(byte, offset);
    case State::kMark:
      return AfterMark(byte, offset);
    case State::kMarkLetter:
      return AfterMarkLetter(byte, offset);
    case State::kBetween:
      return Between(byte, offset);
    case State::kNumber:
      return InNumber(byte);
    case State::kAfterNumber:
      return AfterNumber(byte, offset);
    case State::kListOver:
    case State::kAxisEnd:
      return EndList();
    case State::kAxis:
      return Axis(byte, offset);
    case State::kAxisGap:
      return AxisGap(byte, offset);
    case State::kAxisNumber:
      return InAxisNumber(byte, offset);
    case State::kAxisSkip:
      return EndsStatement(byte) ? EndList() : Nothing();
  }
  return Nothing();
}

bool CommandReader::ReadParameter(ByteSpan& bytes) {
  if (HasAll()) return false;
  bool comma = comma_ || count_ == 0;
  const char* const at = SkipSeparators(bytes.at(), bytes.end(), comma);
  if (at != bytes.at()) {
    state_ = State::kBetween;
    comma_ = comma;
    bytes.SkipTo(at);
  }
  const bool begins = state_ == State::kBetween && at != bytes.end() &&
                      NumberReader::CanBegin(static_cast<unsigned char>(*at));
  if (!begins) return false;
  const char* const behind = NumberReader::ReadWhole(at, bytes.end(), number_);
  if (behind == nullptr || !ReceivePath::AlwaysPasses(*behind)) return false;
  number_offset_ = bytes.offset();
  bytes.SkipTo(behind);
  state_ = State::kAfterNumber;
  CountParameter();
  return true;
}

// Parted by one comma or blank each, as by nearly all who write them; else with any separators. By
// itself: what it needs in registers the reading around it does not.
[[gnu::noinline]] const char* CommandReader::ReadNumbers(const char* at, const char* end,
                                                         std::array<double, 3>& set) const {
  constexpr std::ptrdiff_t kRoom = 3 * (2 + DigitWord::kBytes);  // separator, sign and digits
  if (end - at < kRoom) return nullptr;
  const auto separates = [](char byte) { return byte == ',' || byte == ' '; };
  const char* behind = at;
  if (state_ == State::kBetween) {
    behind += *at == ' ' ? 1 : 0;
  } else if (separates(*at)) {
    ++behind;
  } else {
    return ReadApart(at, end, set);
  }
  behind = ReadNumber(behind, set[0]);
  if (behind == nullptr || !separates(*behind)) return ReadApart(at, end, set);
  behind = ReadNumber(behind + 1, set[1]);
  if (behind == nullptr) return ReadApart(at, end, set);
  if (row_->values == 3) {
    if (!separates(*behind)) return ReadApart(at, end, set);
    behind = ReadNumber(behind + 1, set[2]);
    if (behind == nullptr) return ReadApart(at, end, set);
  }
  const bool ends = *behind == ';' || (*behind != '.' && ReceivePath::AlwaysPasses(*behind));
  return ends ? behind : nullptr;
}

const char* CommandReader::ReadApart(const char* at, const char* end,
                                     std::array<double, 3>& set) const {
  constexpr std::ptrdiff_t kRoom = 1 + DigitWord::kBytes;  // a sign, and the digits
  bool separated = state_ == State::kBetween;
  bool comma = comma_ || count_ == 0;
  for (std::size_t i = 0; i < row_->values; ++i) {
    const char* const first = SkipSeparators(at, end, comma);
    if (end - first < kRoom || (first == at && !separated)) return nullptr;
    separated = comma = false;
    at = ReadNumber(first, set[i]);
    if (at == nullptr) return nullptr;
  }
  return *at != '.' && ReceivePath::AlwaysPasses(*at) ? at : nullptr;
}

bool CommandReader::FindName(ByteSpan& bytes) {
  const char* const at = bytes.at();
  const char first = LetterOf(static_cast<unsigned char>(*at));
  if (first == 0) return false;
  const bool mode1 = set_.setting != CommandSetting::kMode2 && !in_call_;
  const bool may_be_pair = !mode1 || (set_.setting != CommandSetting::kMode1 && BeginsMode2(first));
  const CommandRow* row = nullptr;
  if (!may_be_pair) {
    row = FindMode1(first, set_.skipped);
  } else if (at + 1 != bytes.end()) {
    const char second = LetterOf(static_cast<unsigned char>(at[1]));
    row = second != 0 ? FindMode2(first, second) : nullptr;
  }
  if (row == nullptr) return false;
  command_offset_ = bytes.offset();
  const bool in_call = in_call_;
  const std::uint8_t length = may_be_pair ? 2 : 1;
  Found(*row, true);
  if (!in_call) {
    name_bytes_ = length;
    std::copy_n(at, length, name_.begin());
  }
  bytes.SkipTo(at + length);
  return true;
}

void CommandReader::SkipGroups() { state_ = State::kAxisSkip; }

void CommandReader::Drop() {
  state_ = State::kSearch;
  in_call_ = false;
}

// The command search (RML1-2.01 to 2.06, 3A.29 to 3A.36).
Reading CommandReader::Search(unsigned char byte, std::int64_t offset) {
  if (byte <= 0x20 || byte == ';') {
    return {EndsStatement(byte) ? Reading::Kind::kStatementEnd : Reading::Kind::kNothing, true};
  }
  const bool mode1 = set_.setting != CommandSetting::kMode2 && !in_call_;
  if (const char letter = LetterOf(byte); letter != 0) {
    letter_ = letter;
    command_offset_ = offset;
    const bool only_mode1 = mode1 && set_.setting == CommandSetting::kMode1;
    const CommandRow* row = mode1 ? FindMode1(letter, set_.skipped) : nullptr;
    if (row != nullptr && (only_mode1 || !BeginsMode2(letter))) return Found(*row, true);
    if (only_mode1) return Refuse(ReadError::kUnknownName, offset, 1, true);
    state_ = State::kLetter;
    return Nothing();
  }
  if (byte == '!') {  // ends an open call, whatever name follows (RML1-3A.34)
    in_call_ = false;
    command_offset_ = offset;
    state_ = State::kMark;
    return Nothing();
  }
  if (NumberReader::CanBegin(byte)) return Refuse(ReadError::kStrayNumber, offset, 1, true);
  if (mode1 && byte == '@') {
    command_offset_ = offset;
    return Found(RowOf(Op::kAt), true);
  }
  if (mode1 && byte == '^') {
    in_call_ = true;
    name_[0] = kNoName;
    call_offset_ = offset;
    return {Reading::Kind::kCall, true};
  }
  return Refuse(ReadError::kForeignCharacter, offset, 1, true);
}

// A held letter meets the next byte (RML1-2.07 to 2.16, 3A.35). Both readings of auto: the pair
// wins.
Reading CommandReader::SecondLetter(unsigned char byte, std::int64_t offset) {
  if (IsBlank(byte)) return Nothing();
  const char second = LetterOf(byte);
  const CommandRow* pair = second != 0 ? FindMode2(letter_, second) : nullptr;
  if (pair != nullptr) return Found(*pair, true);
  const int length = LengthFrom(command_offset_, offset);
  if (in_call_) return Refuse(ReadError::kUnknownCall, command_offset_, length, true);
  if (set_.setting == CommandSetting::kMode2) {
    return Refuse(ReadError::kUnknownName, command_offset_, length, true);
  }
  const CommandRow* alone = FindMode1(letter_, set_.skipped);
  if (second == 0) {
    if (alone != nullptr) return Found(*alone, false);
    return Refuse(ReadError::kUnknownName, command_offset_, 1, false);
  }
  if (alone != nullptr && FindMode1(second, set_.skipped) != nullptr) return Found(*alone, false);
  return Refuse(ReadError::kUnknownName, command_offset_, length, true);
}

// RML1-2.17, RML1-2.18.
Reading CommandReader::AfterMark(unsigned char byte, std::int64_t offset) {
  if (IsBlank(byte)) return Nothing();
  const CommandRow* vendor = FindCommonDigit(static_cast<char>(byte), set_.skipped);
  if (vendor != nullptr) return Found(*vendor, true);
  letter_ = LetterOf(byte);
  if (letter_ != 0) {
    state_ = State::kMarkLetter;
    return Nothing();
  }
  const int length = LengthFrom(command_offset_, offset);
  return Refuse(ReadError::kUnknownName, command_offset_, length, true);
}

// RML1-2.17, RML1-2.19.
Reading CommandReader::AfterMarkLetter(unsigned char byte, std::int64_t offset) {
  if (IsBlank(byte)) return Nothing();
  const char second = LetterOf(byte);
  const CommandRow* row = second != 0 ? FindCommon(letter_, second, set_.skipped) : nullptr;
  if (row != nullptr && (row->op != Op::kZE || set_.axis_command)) return Found(*row, true);
  const int length = LengthFrom(command_offset_, offset);
  return Refuse(ReadError::kUnknownName, command_offset_, length, true);
}

Reading CommandReader::Found(const CommandRow& row, bool taken) {
  row_ = &row;
  name_[0] = kNoName;
  in_call_ = false;
  axes_named_ = 0;
  BeginList();
  if (row.shape == Shape::kAxes) state_ = State::kAxis;
  return {Reading::Kind::kCommand, taken};
}

// rml1.md 0.4 rule 1.
Reading CommandReader::Between(unsigned char byte, std::int64_t offset) {
  if (IsBlank(byte)) return Nothing();
  if (HasAll()) return EndList();
  if (byte == ',' && count_ > 0 && !comma_) {
    comma_ = true;
    return Nothing();
  }
  if (!NumberReader::CanBegin(byte)) return EndList();
  reader_.Begin(byte);
  number_offset_ = offset;
  state_ = State::kNumber;
  return Nothing();
}

// rml1.md 0.4 rule 2.
Reading CommandReader::InNumber(unsigned char byte) {
  if (reader_.Take(byte)) return Nothing();
  if (!reader_.has_digit() && !reader_.has_period()) return EndList();  // a lone sign (RML1-2.28)
  number_ = reader_.value();
  state_ =
      reader_.has_digit() ? State::kAfterNumber : State::kListOver;  // a lone period: RML1-2.31
  CountParameter();
  return Again(Reading::Kind::kParameter);
}

// A number must be followed by a separator before the next one (RML1-2.29, RML1-2.30).
Reading CommandReader::AfterNumber(unsigned char byte, std::int64_t offset) {
  if (!IsBlank(byte) && byte != ',') return EndList();
  state_ = State::kBetween;
  return Between(byte, offset);
}

// !ZE: axis letter expected (RML1-3D.08, 3D.15 to 3D.22).
Reading CommandReader::Axis(unsigned char byte, std::int64_t offset) {
  if (IsBlank(byte)) return Nothing();
  if (byte == ':') {
    axes_named_ = 0;
    return {Reading::Kind::kGroup, true};
  }
  if (EndsStatement(byte)) {
    state_ = State::kAxisEnd;
    return Again(Reading::Kind::kGroup);
  }
  const char letter = LetterOf(byte);
  if (letter == 0) return RefuseAxis(ReadError::kAxisLetter, offset, byte);
  const std::uint32_t bit = std::uint32_t{1} << (letter - 'A');
  if ((axes_named_ & bit) != 0) return RefuseAxis(ReadError::kAxisTwice, offset, byte);
  axes_named_ |= bit;
  axis_ = letter;
  state_ = State::kAxisGap;
  return Nothing();
}

// !ZE: the number of an axis expected (RML1-3D.16, RML1-3D.18).
Reading CommandReader::AxisGap(unsigned char byte, std::int64_t offset) {
  if (IsBlank(byte)) return Nothing();
  if (!NumberReader::CanBegin(byte)) return RefuseAxis(ReadError::kAxisValue, offset, byte);
  reader_.Begin(byte);
  number_offset_ = offset;
  state_ = State::kAxisNumber;
  return Nothing();
}

// RML1-3D.24: here a lone sign or period is a missing value.
Reading CommandReader::InAxisNumber(unsigned char byte, std::int64_t offset) {
  if (reader_.Take(byte)) return Nothing();
  if (!reader_.has_digit()) return RefuseAxis(ReadError::kAxisValue, offset, byte);
  number_ = reader_.value();
  state_ = State::kAxis;
  return Again(Reading::Kind::kAxisValue);
}

Reading CommandReader::EndList() {
  state_ = State::kSearch;
  return Again(Reading::Kind::kEnd);
}

Reading CommandReader::Refuse(ReadError error, std::int64_t offset, int length, bool taken) {
  error_ = error;
  error_offset_ = offset;
  error_length_ = length;
  state_ = State::kSearch;
  in_call_ = false;
  return {Reading::Kind::kError, taken};
}

// The rest up to the terminator is skipped without further errors (RML1-3D.25); a terminator in the
// place of the fault is left to end the command.
Reading CommandReader::RefuseAxis(ReadError error, std::int64_t offset, unsigned char byte) {
  error_ = error;
  error_offset_ = offset;
  error_length_ = 1;
  state_ = State::kAxisSkip;
  return {Reading::Kind::kError, !EndsStatement(byte)};
}

}  // namespace rmlcell::rml1
