#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cli/handbox_keys.h"

namespace rmlcell::cli {

// What a person at a terminal does with a handbox, and what the terminal itself says.
struct TerminalEvent {
  enum class Kind : std::uint8_t {
    kTyped,      // `key`; again and again while it is down, and nothing tells when it goes up
    kMouseDown,  // on the button of `key`
    kMouseUp,    // wherever it is
    kAnswers,    // the terminal is there: it was asked (kAskTerminal)
    kLeft,       // another window is typed into from here on
    kQuit,
  };
  Kind kind{};
  const HandboxKey* key = nullptr;

  bool operator==(const TerminalEvent&) const = default;
};

// What a terminal sends, byte by byte: characters, keys as xterm, VT220, rxvt and the Linux console
// send them, the mouse as in mode 1006. What is not known is passed over as a whole, so that no
// part of it is taken for a key; so is what is pasted. Ctrl-C and a q quit.
// Holds nothing of the bytes but the sequence that has begun, of bounded length.
class TerminalBytes {
 public:
  std::vector<TerminalEvent> Read(std::string_view bytes);
  // Nothing came for so long that what has begun is no sequence, or was cut off.
  void GiveUp() { state_ = State::kPlain; }
  bool begun() const { return state_ != State::kPlain; }

 private:
  enum class State : std::uint8_t {
    kPlain,
    kEscape,       // ESC
    kSequence,     // ESC [
    kConsoleKey,   // ESC [ [, of the Linux console
    kFunctionKey,  // ESC O
    kOldMouse,     // ESC [ M: three bytes follow
    kText,         // ESC ] and the like: up to BEL or ESC
    kPasted,       // up to ESC [ 201 ~
  };

  void Take(char byte, std::vector<TerminalEvent>& events);
  void TakePlain(char byte, std::vector<TerminalEvent>& events);
  void TakeEscape(char byte);
  void TakeSequence(char byte, std::vector<TerminalEvent>& events);
  void TakePasted(char byte);
  void End(char last, std::vector<TerminalEvent>& events);

  State state_ = State::kPlain;
  std::string numbers_;  // of the sequence; of what is pasted its last bytes
  std::size_t missing_ = 0;
};

// The terminal answers this with kAnswers. It is a question after its state (DSR).
inline constexpr std::string_view kAskTerminal = "\x1b[5n";

}  // namespace rmlcell::cli
