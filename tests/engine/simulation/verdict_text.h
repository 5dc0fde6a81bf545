#pragma once

#include <string>

#include "engine/machine/verdict.h"

namespace rmlcell::simulation {

// "BAD; OPT-E7414 10.000 mm of a process ... @7; DOUBTFUL ..."
inline std::string TextOf(const machine::Judgement& judgement) {
  std::string text(machine::VerdictText(judgement.verdict));
  for (const machine::Reason& reason : judgement.reasons) {
    text += "; " + CodeText(reason.code) + ' ' + reason.said;
    if (reason.first.step > 0) text += " @" + std::to_string(reason.first.step);
  }
  return text;
}

}  // namespace rmlcell::simulation
