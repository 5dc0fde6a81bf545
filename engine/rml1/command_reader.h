#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/rml1/byte_span.h"
#include "engine/rml1/command_table.h"
#include "engine/rml1/digit_word.h"
#include "engine/rml1/number.h"
#include "engine/rml1/receive_path.h"

namespace rmlcell::rml1 {

// Which family is in force without a switch-over command (RML1-1.04, RML1-9.01).
enum class CommandSetting : std::uint8_t { kAuto, kMode1, kMode2 };

// The command set of one machine.
struct CommandSet {
  CommandSetting setting = CommandSetting::kAuto;
  std::uint8_t skipped = kSkipNothing;  // names that are read and ignored (RML1-9.48)
  bool axis_command = true;             // has !ZE; a PNC-3200 does not
};

// Why bytes were discarded or a list was given up; the numbers are those of section 6.
enum class ReadError : std::uint8_t {
  kForeignCharacter,  // 1: begins no command (RML1-2.05)
  kUnknownName,       // 1: letters that are no command (RML1-2.09)
  kStrayNumber,       // 2: digit, sign or period between commands (RML1-2.02)
  kUnknownCall,       // 2: a name after ^ that is no mode-2 command (RML1-3A.31)
  kAxisTwice,         // 2: !ZE names an axis twice in a group (RML1-3D.15)
  kAxisValue,         // 3: !ZE has an axis letter without a number (RML1-3D.16)
  kAxisLetter,        // 3: !ZE has something else where a letter belongs (RML1-3D.17, 3D.20)
};

// What one byte brought about.
struct Reading {
  enum class Kind : std::uint8_t {
    kNothing,
    kCommand,       // a name is complete: row() tells which
    kCall,          // ^ opened a call
    kParameter,     // number() is the next parameter
    kAxisValue,     // !ZE: axis() goes to number()
    kGroup,         // !ZE: a group is complete
    kEnd,           // the parameter list is over: the command runs now, if it has not yet
    kError,         // error() tells what was discarded
    kStatementEnd,  // a semicolon or line end between commands
  };
  Kind kind = Kind::kNothing;
  bool taken = true;  // false: offer the same byte again, after acting on this reading
};

// The command search and the parameter reader: a machine of a few states that stops after every
// byte and after everything a byte brings about, so that a stream may be cut anywhere and a command
// acts before the byte that ended it is looked at again. Constant memory whatever comes
// (RML1-9.05, 9.06). Grammar: rml1.md sections 0.4, 2 and 3D.
class CommandReader {
 public:
  explicit CommandReader(const CommandSet& set) : set_(set) {}

  // `offset` is the place of the byte in the stream; it is only handed back by the accessors.
  Reading Put(unsigned char byte, std::int64_t offset);

  // Whether a parameter may begin with this byte, or separators before one.
  bool ParameterMayBegin(char byte) const {
    const bool separates = byte == ',' || byte == ' ' || byte == '\t';
    return state_ == State::kBetween || (state_ == State::kAfterNumber && separates);
  }
  // Reads the parameter that comes next, when all of it stands in the bytes, with the byte behind
  // it, and none of these is one that the receive path may take or change: what Put would make of
  // them one by one, up to the reading kParameter, whose byte is left. False: what comes next is
  // for Put; separators were taken. Precondition, here and below: ParameterMayBegin.
  bool ReadParameter(ByteSpan& bytes);
  // The same of a whole set, as nearly all are written: of whole numbers with six digits at most.
  // False: nothing was taken. Preconditions: a command with sets, and the next parameter is the
  // first of one.
  bool ReadSet(ByteSpan& bytes, std::array<double, 3>& set) {
    const char* const behind = ReadNumbers(bytes.at(), bytes.end(), set);
    if (behind == nullptr) return false;
    bytes.SkipTo(behind);
    state_ = State::kAfterNumber;
    comma_ = false;
    count_ = 2;
    return true;
  }

  // Whether a parameter list ends right before this byte: what Put would say with kEnd.
  bool ListEndsBefore(char byte) const {
    return state_ == State::kAfterNumber && !ParameterMayBegin(byte);
  }
  void EndListHere() { state_ = State::kSearch; }

  bool searches() const { return state_ == State::kSearch; }
  // Takes blanks, line ends and semicolons between commands. True: a statement ended.
  // Precondition, here and below: searches().
  static bool SkipStatementEnds(ByteSpan& bytes) {
    const char* at = bytes.at();
    bool ended = bytes.end() - at > 2 && at[0] == ';' && at[1] == '\n';  // nearly always
    if (ended) at += 2;
    for (; at != bytes.end() && *at <= ';'; ++at) {
      if (EndsStatement(*at)) {
        ended = true;
      } else if (!IsBlank(*at)) {
        break;
      }
    }
    bytes.SkipTo(at);
    return ended;
  }
  // Reads the name of a command that stands whole in the bytes, as Put does up to the reading
  // kCommand: none has axes. False: nothing was taken, and it is for Put. Precondition: not empty.
  bool ReadName(ByteSpan& bytes) {
    const char* const at = bytes.at();
    const bool again =
        at[0] == name_[0] && (name_bytes_ == 1 || (at + 1 != bytes.end() && at[1] == name_[1]));
    if (!again) return FindName(bytes);
    command_offset_ = bytes.offset();
    bytes.SkipTo(at + name_bytes_);
    BeginList();
    return true;
  }

  // Valid after the readings that name them.
  const CommandRow& row() const { return *row_; }
  const Number& number() const { return number_; }
  std::int64_t number_offset() const { return number_offset_; }  // of its first byte
  char axis() const { return axis_; }
  ReadError error() const { return error_; }
  std::int64_t error_offset() const { return error_offset_; }      // of the first discarded byte
  int error_length() const { return error_length_; }               // discarded bytes
  std::int64_t command_offset() const { return command_offset_; }  // of the name's first byte

  // The device found a fault in !ZE: the rest up to the terminator is skipped (RML1-3D.12).
  void SkipGroups();

  // Drops what is half read (ESC.K, RML1-4.08, 4.11). An open call goes too.
  void Drop();

  // A command, a name or a call is unfinished.
  bool pending() const { return state_ != State::kSearch || in_call_; }
  std::int64_t pending_offset() const { return in_call_ ? call_offset_ : command_offset_; }

 private:
  enum class State : std::uint8_t {
    kSearch,
    kLetter,       // first letter of a name is held
    kMark,         // after !
    kMarkLetter,   // after ! and a letter
    kBetween,      // before a parameter
    kNumber,       // inside a number
    kAfterNumber,  // right behind a number
    kListOver,     // the list ended with the last parameter
    kAxis,         // !ZE: an axis letter is expected
    kAxisGap,      // !ZE: a number is expected
    kAxisNumber,
    kAxisEnd,   // !ZE: the terminator is there, the last group has run
    kAxisSkip,  // !ZE: after an error
  };

  static bool IsBlank(int byte) { return byte == ' ' || byte == '\t'; }
  static bool EndsStatement(int byte) { return byte == ';' || byte == '\r' || byte == '\n'; }
  // The numbers of a set. Returns where they end; nullptr: it is no such set.
  const char* ReadNumbers(const char* at, const char* end, std::array<double, 3>& set) const;
  const char* ReadApart(const char* at, const char* end, std::array<double, 3>& set) const;

  bool FindName(ByteSpan& bytes);
  void BeginList() {
    comma_ = false;
    count_ = 0;
    state_ = State::kBetween;
  }

  Reading Search(unsigned char byte, std::int64_t offset);
  Reading SecondLetter(unsigned char byte, std::int64_t offset);
  Reading AfterMark(unsigned char byte, std::int64_t offset);
  Reading AfterMarkLetter(unsigned char byte, std::int64_t offset);
  Reading Between(unsigned char byte, std::int64_t offset);
  Reading InNumber(unsigned char byte);
  Reading AfterNumber(unsigned char byte, std::int64_t offset);
  Reading Axis(unsigned char byte, std::int64_t offset);
  Reading AxisGap(unsigned char byte, std::int64_t offset);
  Reading InAxisNumber(unsigned char byte, std::int64_t offset);

  Reading Found(const CommandRow& row, bool taken);
  Reading EndList();
  Reading Refuse(ReadError error, std::int64_t offset, int length, bool taken);
  Reading RefuseAxis(ReadError error, std::int64_t offset, unsigned char byte);
  void CountParameter() {
    comma_ = false;
    count_ = std::min(count_ + 1, 2);
  }
  bool HasAll() const { return row_->shape == Shape::kFixed && count_ >= row_->values; }

  CommandSet set_;
  State state_ = State::kSearch;
  bool in_call_ = false;
  bool comma_ = false;  // the one comma that may stand between two parameters was there
  char letter_ = 0;     // first letter of the name in progress
  // The name of row() as it was written, where it stood whole and no call is open: found again
  // without a search, for most commands are what the one before them was. Else what begins none.
  static constexpr char kNoName = ';';
  std::array<char, 2> name_ = {kNoName};
  std::uint8_t name_bytes_ = 1;
  char axis_ = 0;
  ReadError error_ = ReadError::kForeignCharacter;
  int error_length_ = 0;
  int count_ = 0;                 // parameters of the list so far; stops at 2
  std::uint32_t axes_named_ = 0;  // letters of the group, as bits
  const CommandRow* row_ = nullptr;
  NumberReader reader_;
  Number number_;
  std::int64_t command_offset_ = 0;
  std::int64_t call_offset_ = 0;
  std::int64_t error_offset_ = 0;
  std::int64_t number_offset_ = 0;
};

}  // namespace rmlcell::rml1
