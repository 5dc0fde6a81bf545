#include "engine/rml1/command_facts.h"

#include <algorithm>
#include <array>

#include "engine/rml1/command_table.h"

namespace rmlcell::rml1 {
namespace {

struct Fact {
  std::string_view form;
  std::string_view text;
};

constexpr std::string_view kSkipped =
    "A command of another machine: read and left out where the profile says so, else an error.";

// clang-format off
// One for each command, in the order of Op.
constexpr auto kFacts = std::to_array<Fact>({
    {"D x,y,...", "Cuts: down to Z1, then a straight line to each point. Coordinates are absolute from here on."},
    {"F speed", "Speed across while cutting, mm/s: as VS."},
    {"H", "Up to the top, then to X 0, Y 0, then the spindle stops."},
    {"I dx,dy,...", "Cuts at Z1 by each way from where the tool is. Coordinates are relative from here on."},
    {"M x,y,...", "Moves: up to Z2, then to each point. Coordinates are absolute from here on."},
    {"R dx,dy,...", "Moves at Z2 by each way. Coordinates are relative from here on."},
    {"V speed", "Speed of the Z axis and of motion of all axes together, mm/s: as !VZ."},
    {"W time", "Dwell at the places where the tool goes down or up, ms, 0 to 32767: as !DW."},
    {"Z x,y,z,...", "A straight line in all three axes to each point, at the speed of V."},
    {"@ z1,z2", "Heights of the tool down (Z1) and up (Z2): as !PZ."},
    {"^ command", "One command of mode 2 within mode 1."},
    {"DF", "Back to the defaults: absolute, speeds, no dwell, spindle permitted, Z1 and Z2."},
    {"IN", "As DF; then the tool goes up, the error is forgotten and the spindle stops."},
    {"PA x,y,...", "Absolute coordinates; moves to each point with the tool as it is, up or down."},
    {"PD x,y,...", "Tool down to Z1, then a straight line to each point."},
    {"PR dx,dy,...", "Relative coordinates; moves by each way with the tool as it is."},
    {"PU x,y,...", "Tool up to Z2, then to each point."},
    {"VS speed", "Speed across while cutting, mm/s; without a number the default."},
    {"!DW time", "Dwell at the places where the tool goes down or up, ms, 0 to 32767: as W."},
    {"!MC switch", "0: the spindle stops and is not permitted to turn; another number, or none: it is."},
    {"!NR", "Pauses: what comes behind waits until somebody goes on at the panel."},
    {"!PZ z1,z2", "Heights of the tool down (Z1) and up (Z2): as @."},
    {"!RC stage", "Spindle speed in 16 stages, 0 the lowest to 15 the highest of the model."},
    {"!VZ speed", "Speed of the Z axis and of motion of all axes together, mm/s: as V."},
    {"!ZM z", "Z alone moves to a coordinate of the machine, wherever Z 0 is; relative, by a way."},
    {"!ZO z", "Sets Z 0 to a coordinate of the machine; nothing moves."},
    {"!ZZ x,y,z,...", "A straight line in all three axes to each point: as Z."},
    {"!ZE axis number ...", "Axes by their letters, A among them: those of one group move together."},
    {"", kSkipped},
    {"", kSkipped},
    {"", kSkipped},
    {"", kSkipped},
    {"", kSkipped},
    {"", kSkipped},
    {"", kSkipped},
});
// clang-format on
static_assert(kFacts.size() == kOpCount);

}  // namespace

std::vector<machine::LanguageWord> CommandFacts() {
  std::vector<machine::LanguageWord> words;
  for (const CommandRow& row : CommandTable()) {
    const Fact& fact = kFacts[static_cast<std::size_t>(row.op)];
    words.push_back({.name = row.name, .form = fact.form, .text = fact.text, .rule = row.rule});
  }
  std::ranges::sort(words, {}, &machine::LanguageWord::name);
  return words;
}

}  // namespace rmlcell::rml1
