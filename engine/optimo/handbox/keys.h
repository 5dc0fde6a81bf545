#pragma once

#include <optional>
#include <string_view>

#include "engine/machine/machine_input.h"

// The keys of the handbox by the names of LIVE-7.03.
namespace rmlcell::optimo {

enum class Key {
  kStart,
  kStop,
  kHold,
  kShift,
  kStep,
  kHome,
  kZero,
  kEmergencyStop,
  kNote,
  kModeLeft,
  kModeRight,
  kOverridePlus,
  kOverrideMinus,
  kJogReference,  // ROB, ABS, TCP
  kJog,           // X+ to C-
  kDel,
  kMod,
  kRec,
  kErr,
  kPrev,
  kNext,
  kEnt,
  kJob,
  kTcp,
  kDyn,
  kPath,
  kWork,
  kDly,
  kMov,
  kOut,
  kDeb,
  kCal,
  kUnused,  // PAR, DISP, F1, F4, F5, F7: OPT-4.45
  kOversh,
  kFunction,
  kSimul,
  kGosub,
  kCharacter,  // 0 to 9, point, minus
};

struct KnownKey {
  Key key = Key::kUnused;
  machine::JogReference reference{};  // kJogReference
  machine::JogKey jog{};              // kJog
  char character = 0;                 // kCharacter
};

// Nothing: there is no such key.
std::optional<KnownKey> FindKey(std::string_view name);

}  // namespace rmlcell::optimo
