#pragma once

#include "engine/rml1/command_reader.h"

namespace rmlcell::rml1 {

// How a machine of each command-set setting is told what every setting can be told; rml1.md 1.
struct CommandNames {
  const char* defaults;
  const char* xy_speed;
  const char* up;
  const char* down;
  const char* three_axis;
  const char* absolute;  // without a motion
  const char* relative;
};

constexpr CommandNames NamesFor(CommandSetting setting) {
  if (setting == CommandSetting::kMode1) return {"^DF", "F", "M", "D", "Z", "^PA", "^PR"};
  if (setting == CommandSetting::kMode2) return {"DF", "VS", "PU", "PD", "!ZZ", "PA", "PR"};
  return {"DF", "VS", "PU", "PD", "Z", "PA", "PR"};
}

}  // namespace rmlcell::rml1
