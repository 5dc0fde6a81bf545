#include "engine/optimo/handbox/keys.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace rmlcell::optimo {
namespace {

using machine::JogReference;

struct NamedKey {
  std::string_view name;
  Key key;
};
constexpr std::array kKeys = {
    NamedKey{"START", Key::kStart},
    NamedKey{"STOP", Key::kStop},
    NamedKey{"HOLD", Key::kHold},
    NamedKey{"SHIFT", Key::kShift},
    NamedKey{"STEP", Key::kStep},
    NamedKey{"HOME", Key::kHome},
    NamedKey{"ZERO", Key::kZero},
    NamedKey{"EMERGENCY_STOP", Key::kEmergencyStop},
    NamedKey{"NOTE", Key::kNote},
    NamedKey{"MODE_LEFT", Key::kModeLeft},
    NamedKey{"MODE_RIGHT", Key::kModeRight},
    NamedKey{"OVERRIDE_PLUS", Key::kOverridePlus},
    NamedKey{"OVERRIDE_MINUS", Key::kOverrideMinus},
    NamedKey{"DEL", Key::kDel},
    NamedKey{"MOD", Key::kMod},
    NamedKey{"REC", Key::kRec},
    NamedKey{"ERR", Key::kErr},
    NamedKey{"PREV", Key::kPrev},
    NamedKey{"NEXT", Key::kNext},
    NamedKey{"ENT", Key::kEnt},
    NamedKey{"JOB", Key::kJob},
    NamedKey{"TCP", Key::kTcp},
    NamedKey{"DYN", Key::kDyn},
    NamedKey{"PATH", Key::kPath},
    NamedKey{"WORK", Key::kWork},
    NamedKey{"DLY", Key::kDly},
    NamedKey{"MOV", Key::kMov},
    NamedKey{"OUT", Key::kOut},
    NamedKey{"DEB", Key::kDeb},
    NamedKey{"CAL", Key::kCal},
    NamedKey{"PAR", Key::kUnused},
    NamedKey{"DISP", Key::kUnused},
    NamedKey{"F1", Key::kUnused},
    NamedKey{"F2", Key::kOversh},
    NamedKey{"F3", Key::kFunction},
    NamedKey{"F4", Key::kUnused},
    NamedKey{"F5", Key::kUnused},
    NamedKey{"F6", Key::kSimul},
    NamedKey{"F7", Key::kUnused},
    NamedKey{"F8", Key::kGosub},
};

constexpr std::array kReferences = {std::pair{std::string_view("JOG_ROB"), JogReference::kRobot},
                                    std::pair{std::string_view("JOG_ABS"), JogReference::kAbsolute},
                                    std::pair{std::string_view("JOG_TCP"), JogReference::kTool}};

std::optional<machine::JogKey> JogKeyNamed(std::string_view name) {
  constexpr std::string_view kAxes = "XYZABC";
  if (name.size() != 2 || (name[1] != '+' && name[1] != '-')) return std::nullopt;
  const std::size_t axis = kAxes.find(name[0]);
  if (axis == std::string_view::npos) return std::nullopt;
  return machine::JogKey{.axis = static_cast<machine::JogAxis>(axis), .plus = name[1] == '+'};
}

}  // namespace

std::optional<KnownKey> FindKey(std::string_view name) {
  const auto found = std::ranges::find(kKeys, name, &NamedKey::name);
  if (found != kKeys.end()) return KnownKey{.key = found->key};
  for (const auto& [of, reference] : kReferences) {
    if (of == name) return KnownKey{.key = Key::kJogReference, .reference = reference};
  }
  if (const auto jog = JogKeyNamed(name)) return KnownKey{.key = Key::kJog, .jog = *jog};
  if (name == "POINT") return KnownKey{.key = Key::kCharacter, .character = '.'};
  if (name == "MINUS") return KnownKey{.key = Key::kCharacter, .character = '-'};
  if (name.size() == 1 && name[0] >= '0' && name[0] <= '9')
    return KnownKey{.key = Key::kCharacter, .character = name[0]};
  return std::nullopt;
}

}  // namespace rmlcell::optimo
