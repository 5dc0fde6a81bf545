#include "engine/optimo/handbox/display.h"

#include <algorithm>
#include <cstddef>

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kDisplayWidth = 20;  // OPT-4.01
constexpr std::size_t kNameWidth = 8;      // OPT-4.02

std::string Digits(int number, std::size_t width) {
  const std::string digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), '0') + digits;
}

}  // namespace

std::string OnDisplay(std::string text) {
  text.resize(kDisplayWidth, ' ');
  return text;
}

std::string DefaultText(const machine::ShownStep& shown) {
  std::string name = shown.instruction.empty() ? std::string(kNameWidth, '*') : shown.instruction;
  name.resize(kNameWidth, ' ');
  return "P=" + Digits(shown.program, 2) + "S=" + Digits(shown.step, 4) + "I=" + name;
}

std::string PlacedText(const machine::ShownStep& at, std::string_view name) {
  return "P=" + Digits(at.program, 2) + " S=" + Digits(at.step, 4) + " " + std::string(name);
}

}  // namespace rmlcell::optimo
