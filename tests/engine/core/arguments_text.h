#pragma once

#include <cmath>
#include <string>
#include <variant>

#include "engine/core/detail.h"
#include "engine/core/number_text.h"

namespace rmlcell {

// "instruction='MOVE' values=2 speed=12.5 mm/s": what a text knows, words in quotes, numbers to
// 0.0001.
inline std::string ArgumentsText(const Detail& detail) {
  std::string text;
  for (const Argument& argument : detail.arguments()) {
    text += (text.empty() ? "" : " ") + argument.name + "=";
    if (const double* const number = std::get_if<double>(&argument.value))
      text += ShortestText(std::round(*number * 1e4) / 1e4);
    else
      text += "'" + std::get<std::string>(argument.value) + "'";
    if (!argument.unit.empty()) text += " " + argument.unit;
  }
  return text;
}

}  // namespace rmlcell
