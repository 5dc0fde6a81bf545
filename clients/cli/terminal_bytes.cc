#include "clients/cli/terminal_bytes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::cli {
namespace {

using Kind = TerminalEvent::Kind;
using Named = std::pair<std::string_view, std::string_view>;

constexpr char kEscape = '\x1b';
constexpr char kCtrlC = '\x03';
constexpr char kBell = '\x07';
constexpr std::size_t kNumbersMax = 32;  // ESC [ < 65 ; 9999 ; 9999 M is 13
constexpr std::size_t kOldMouseBytes = 3;
constexpr std::string_view kPasteBegins = "200~";
constexpr std::string_view kPasteEnds = "\x1b[201~";

// Behind ESC [ and ESC O, without what tells of Shift, Ctrl and the like: with these they are
// other keys.
constexpr std::array kSequences = {
    Named{"A", "Up"},   Named{"B", "Down"}, Named{"C", "Right"}, Named{"D", "Left"},
    Named{"H", "Hom"},  Named{"1~", "Hom"}, Named{"7~", "Hom"},  Named{"3~", "Del"},
    Named{"5~", "PgU"}, Named{"6~", "PgD"}, Named{"P", "F1"},    Named{"Q", "F2"},
    Named{"R", "F3"},   Named{"S", "F4"},   Named{"11~", "F1"},  Named{"12~", "F2"},
    Named{"13~", "F3"}, Named{"14~", "F4"}, Named{"15~", "F5"},  Named{"17~", "F6"},
    Named{"18~", "F7"}, Named{"19~", "F8"},
};
constexpr std::array kCharacters = {Named{"\r", "Ent"}, Named{"\n", "Ent"},   Named{"\t", "Tab"},
                                    Named{" ", "Spc"},  Named{"\x7f", "Bsp"}, Named{"\b", "Bsp"}};

template <std::size_t kSize>
std::string_view NameIn(const std::array<Named, kSize>& table, std::string_view bytes) {
  const auto found = std::ranges::find(table, bytes, &Named::first);
  return found == table.end() ? std::string_view() : found->second;
}

void AddTyped(std::string_view typed, std::vector<TerminalEvent>& events) {
  if (const HandboxKey* key = HandboxKeyTyped(typed)) events.push_back({Kind::kTyped, key});
}

// "<BUTTON;COLUMN;ROW", counted from 1; `last` is M where it goes down, m where it goes up.
void AddMouse(std::string_view numbers, char last, std::vector<TerminalEvent>& events) {
  constexpr long long kLeftButton = 0;
  constexpr long long kFarthest = 10'000;
  std::array<long long, 3> values{};
  for (long long& value : values) {
    const std::size_t end = std::min(numbers.find(';'), numbers.size());
    const std::optional<long long> number = ParseInteger(numbers.substr(0, end));
    if (!number || *number < 0 || *number > kFarthest) return;
    value = *number;
    numbers.remove_prefix(std::min(end + 1, numbers.size()));
  }
  if (!numbers.empty()) return;
  if (last == 'm') return events.push_back({Kind::kMouseUp});
  if (values[0] != kLeftButton) return;
  const HandboxKey* key =
      HandboxKeyAt(static_cast<int>(values[2]) - 1, static_cast<int>(values[1]) - 1);
  if (key != nullptr) events.push_back({Kind::kMouseDown, key});
}

}  // namespace

std::vector<TerminalEvent> TerminalBytes::Read(std::string_view bytes) {
  std::vector<TerminalEvent> events;
  for (const char byte : bytes) Take(byte, events);
  return events;
}

void TerminalBytes::Take(char byte, std::vector<TerminalEvent>& events) {
  if (byte == kCtrlC) {  // within whatever: this must always help
    state_ = State::kPlain;
    return events.push_back({Kind::kQuit});
  }
  if (byte == kEscape && state_ != State::kPasted && state_ != State::kOldMouse) {
    state_ = State::kEscape;
    return;
  }
  switch (state_) {
    case State::kPlain:
      return TakePlain(byte, events);
    case State::kEscape:
      return TakeEscape(byte);
    case State::kSequence:
      return TakeSequence(byte, events);
    case State::kFunctionKey:
      AddTyped(NameIn(kSequences, std::string_view(&byte, 1)), events);
      state_ = State::kPlain;
      return;
    case State::kConsoleKey: {
      constexpr std::string_view kFunctionKeys = "ABCDE";
      const std::size_t number = kFunctionKeys.find(byte);
      if (number != std::string_view::npos) AddTyped("F" + std::to_string(number + 1), events);
      state_ = State::kPlain;
      return;
    }
    case State::kOldMouse:
      if (--missing_ == 0) state_ = State::kPlain;
      return;
    case State::kText:
      if (byte == kBell) state_ = State::kPlain;
      return;
    case State::kPasted:
      return TakePasted(byte);
  }
}

void TerminalBytes::TakePlain(char byte, std::vector<TerminalEvent>& events) {
  if (byte == 'q') return events.push_back({Kind::kQuit});
  const std::string_view character(&byte, 1);
  const std::string_view name = NameIn(kCharacters, character);
  AddTyped(name.empty() ? character : name, events);
}

// A character behind ESC is one with Alt, which means nothing here.
void TerminalBytes::TakeEscape(char byte) {
  constexpr std::string_view kTexts = "]P_^X";
  numbers_.clear();
  state_ = byte == '['                                   ? State::kSequence
           : byte == 'O'                                 ? State::kFunctionKey
           : kTexts.find(byte) != std::string_view::npos ? State::kText
                                                         : State::kPlain;
}

void TerminalBytes::TakeSequence(char byte, std::vector<TerminalEvent>& events) {
  const auto code = static_cast<unsigned char>(byte);
  if (byte == '[' && numbers_.empty()) {
    state_ = State::kConsoleKey;
  } else if (code < 0x20 || code > 0x7E) {
    state_ = State::kPlain;  // it was cut off
  } else if (code < 0x40) {
    if (numbers_.size() < kNumbersMax) numbers_ += byte;  // a longer one is none of those known
  } else {
    state_ = State::kPlain;
    End(byte, events);
  }
}

void TerminalBytes::End(char last, std::vector<TerminalEvent>& events) {
  if (numbers_.starts_with('<') && (last == 'M' || last == 'm'))
    return AddMouse(std::string_view(numbers_).substr(1), last, events);
  if (last == 'M' && numbers_.empty()) {
    state_ = State::kOldMouse;
    missing_ = kOldMouseBytes;
    return;
  }
  const std::string sequence = numbers_ + last;
  if (sequence == kPasteBegins) {
    state_ = State::kPasted;
    numbers_.clear();
  } else if (sequence == "0n") {
    events.push_back({Kind::kAnswers});
  } else if (sequence == "O") {
    events.push_back({Kind::kLeft});
  } else {
    AddTyped(NameIn(kSequences, sequence), events);
  }
}

void TerminalBytes::TakePasted(char byte) {
  numbers_ += byte;
  if (numbers_.size() > kPasteEnds.size()) numbers_.erase(0, 1);
  if (numbers_ == kPasteEnds) state_ = State::kPlain;
}

}  // namespace rmlcell::cli
