#pragma once

#include <cstdint>
#include <span>
#include <string_view>

// The keys of a handbox on a terminal: where each stands on the screen, and what is typed for it.
namespace rmlcell::cli {

enum class Holding : std::uint8_t {
  kTap,   // each time that it is typed counts, also while it repeats
  kOnce,  // not again while it repeats: it would record twice, or switch back
  kHeld,  // moves the machine as long as it is down
};

// A button is kHandboxCell wide: what is typed, in 3 columns, a blank, the label, a blank.
inline constexpr int kHandboxCell = 10;
inline constexpr int kHandboxRows = 24;
inline constexpr int kHandboxColumns = 80;

struct HandboxKey {
  std::string_view name;   // LIVE-7.03
  std::string_view label;  // at most 5 characters, in a wide one 15
  std::string_view typed;  // one character, or the name of a key: "Home", "F1"
  int row;                 // of the screen, from 0
  int cell;                // in that row, from 0
  Holding holding = Holding::kTap;
  int cells = 1;               // it is so wide
  std::string_view also = {};  // typed for it, too; the screen does not tell
};

// All of them, each once.
std::span<const HandboxKey> AllHandboxKeys();

// By what is typed; null: nothing is meant by it.
const HandboxKey* HandboxKeyTyped(std::string_view typed);
// Whose button is there, from 0; null: none.
const HandboxKey* HandboxKeyAt(int row, int column);

}  // namespace rmlcell::cli
