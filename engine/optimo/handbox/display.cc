#include "engine/optimo/handbox/display.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kDisplayWidth = 20;  // OPT-4.01
constexpr std::size_t kNameWidth = 8;      // OPT-4.02

std::string Padded(std::string text, std::size_t width) {
  text.resize(width, ' ');
  return text;
}

std::string Digits(int number, std::size_t width) {
  const std::string digits = std::to_string(number);
  return digits.size() < width ? std::string(width - digits.size(), '0') + digits : digits;
}

// OPT-4.02 to 4.04
std::string DefaultText(const machine::ShownStep& shown) {
  const std::string name = shown.step > 0 ? shown.instruction : std::string(kNameWidth, '*');
  return "P=" + Digits(shown.program, 2) + "S=" + Digits(shown.step, 4) +
         "I=" + Padded(name, kNameWidth);
}

}  // namespace

machine::Panel ShowHandbox(const machine::MachineStatus& status) {
  machine::Panel panel{.display = std::string(kDisplayWidth, ' ')};
  if (status.state == machine::MachineState::kOff) return panel;
  panel.lamps = {machine::Name(status.mode),
                 "ROB"};  // OPT-4.21: the reference of jog keys as it comes
  panel.display = DefaultText(status.shown);
  // The control knows its own numbers only.
  if (status.message && Lookup(*status.message).family == ErrorFamily::kOptimo) {
    panel.message = status.message;
    panel.display =
        Padded("ERROR " + std::to_string(Lookup(*status.message).number), kDisplayWidth);
  }
  return panel;
}

}  // namespace rmlcell::optimo
