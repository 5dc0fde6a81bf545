#include "clients/cli/handbox_keys.h"

#include <algorithm>
#include <array>

namespace rmlcell::cli {
namespace {

constexpr Holding kTap = Holding::kTap;
constexpr Holding kOnce = Holding::kOnce;
constexpr Holding kHeld = Holding::kHeld;

// Small letters are what is needed most. A capital letter of an axis is its other direction. STOP
// is the largest key of a keyboard, and what one finds without looking.
constexpr std::array kKeys = {
    HandboxKey{"MODE_LEFT", "MODE<", "(", 9, 0},
    HandboxKey{"MODE_RIGHT", "MODE>", ")", 9, 1},
    HandboxKey{"OVERRIDE_MINUS", "OVER-", "_", 9, 2},
    HandboxKey{"OVERRIDE_PLUS", "OVER+", "+", 9, 3},
    HandboxKey{"START", "START", "s", 9, 5, kOnce},
    HandboxKey{"STOP", "STOP", "Spc", 9, 6},
    HandboxKey{"HOLD", "HOLD", "h", 9, 7},
    HandboxKey{"SHIFT", "SHIFT", "Tab", 10, 0, kOnce},
    HandboxKey{"STEP", "STEP", "S", 10, 1, kOnce},
    HandboxKey{"NOTE", "NOTE", "N", 10, 2, kOnce},
    HandboxKey{"ZERO", "ZERO", "O", 10, 3, kOnce},
    HandboxKey{"HOME", "HOME", "Hom", 10, 4, kHeld},
    HandboxKey{"EMERGENCY_STOP", "EMERGENCY STOP", "!", 10, 6, kOnce, 2},

    HandboxKey{"JOG_ROB", "ROB", "R", 12, 0},
    HandboxKey{"JOG_ABS", "ABS", "W", 12, 1},
    HandboxKey{"JOG_TCP", "TCP", "T", 12, 2},
    HandboxKey{"X+", "X+", "x", 13, 0, kHeld, 1, "Right"},
    HandboxKey{"Y+", "Y+", "y", 13, 1, kHeld, 1, "Up"},
    HandboxKey{"Z+", "Z+", "z", 13, 2, kHeld, 1, "PgU"},
    HandboxKey{"X-", "X-", "X", 14, 0, kHeld, 1, "Left"},
    HandboxKey{"Y-", "Y-", "Y", 14, 1, kHeld, 1, "Down"},
    HandboxKey{"Z-", "Z-", "Z", 14, 2, kHeld, 1, "PgD"},
    HandboxKey{"A+", "A+", "a", 15, 0, kHeld},
    HandboxKey{"B+", "B+", "b", 15, 1, kHeld},
    HandboxKey{"C+", "C+", "c", 15, 2, kHeld},
    HandboxKey{"A-", "A-", "A", 16, 0, kHeld},
    HandboxKey{"B-", "B-", "B", 16, 1, kHeld},
    HandboxKey{"C-", "C-", "C", 16, 2, kHeld},

    HandboxKey{"7", "7", "7", 12, 3},
    HandboxKey{"8", "8", "8", 12, 4},
    HandboxKey{"9", "9", "9", 12, 5},
    HandboxKey{"4", "4", "4", 13, 3},
    HandboxKey{"5", "5", "5", 13, 4},
    HandboxKey{"6", "6", "6", 13, 5},
    HandboxKey{"1", "1", "1", 14, 3},
    HandboxKey{"2", "2", "2", 14, 4},
    HandboxKey{"3", "3", "3", 14, 5},
    HandboxKey{"0", "0", "0", 15, 3},
    HandboxKey{"POINT", "POINT", ".", 15, 4, kTap, 1, ","},
    HandboxKey{"MINUS", "MINUS", "-", 15, 5},

    HandboxKey{"PREV", "PREV", "<", 12, 6},
    HandboxKey{"NEXT", "NEXT", ">", 12, 7},
    HandboxKey{"REC", "REC", "r", 13, 6, kOnce},
    HandboxKey{"MOD", "MOD", "m", 13, 7, kOnce},
    HandboxKey{"DEL", "DEL", "Del", 14, 6, kOnce, 1, "Bsp"},
    HandboxKey{"ERR", "ERR", "e", 14, 7},
    HandboxKey{"ENT", "ENT", "Ent", 15, 6, kTap, 2},

    HandboxKey{"JOB", "JOB", "j", 18, 0, kOnce},
    HandboxKey{"TCP", "TCP", "t", 18, 1, kOnce},
    HandboxKey{"DYN", "DYN", "d", 18, 2, kOnce},
    HandboxKey{"PATH", "PATH", "p", 18, 3, kOnce},
    HandboxKey{"WORK", "WORK", "w", 18, 4, kOnce},
    HandboxKey{"DLY", "DLY", "l", 18, 5, kOnce},
    HandboxKey{"MOV", "MOV", "v", 18, 6, kOnce},
    HandboxKey{"OUT", "OUT", "o", 18, 7, kOnce},
    HandboxKey{"DEB", "DEB", "g", 19, 0, kOnce},
    HandboxKey{"CAL", "CAL", "k", 19, 1, kOnce},
    HandboxKey{"PAR", "PAR", "P", 19, 2, kOnce},
    HandboxKey{"DISP", "DISP", "D", 19, 3, kOnce},
    HandboxKey{"F1", "F1", "F1", 20, 0, kOnce},
    HandboxKey{"F2", "F2", "F2", 20, 1, kOnce},
    HandboxKey{"F3", "F3", "F3", 20, 2, kOnce},
    HandboxKey{"F4", "F4", "F4", 20, 3, kOnce},
    HandboxKey{"F5", "F5", "F5", 20, 4, kOnce},
    HandboxKey{"F6", "F6", "F6", 20, 5, kOnce},
    HandboxKey{"F7", "F7", "F7", 20, 6, kOnce},
    HandboxKey{"F8", "F8", "F8", 20, 7, kOnce},
};

const HandboxKey* FoundIn(decltype(kKeys)::const_iterator found) {
  return found == kKeys.end() ? nullptr : &*found;
}

}  // namespace

std::span<const HandboxKey> AllHandboxKeys() { return kKeys; }

const HandboxKey* HandboxKeyTyped(std::string_view typed) {
  if (typed.empty()) return nullptr;
  return FoundIn(std::ranges::find_if(
      kKeys, [typed](const HandboxKey& key) { return key.typed == typed || key.also == typed; }));
}

const HandboxKey* HandboxKeyAt(int row, int column) {
  return FoundIn(std::ranges::find_if(kKeys, [row, column](const HandboxKey& key) {
    const int begin = key.cell * kHandboxCell;
    return key.row == row && column >= begin && column < begin + key.cells * kHandboxCell;
  }));
}

}  // namespace rmlcell::cli
