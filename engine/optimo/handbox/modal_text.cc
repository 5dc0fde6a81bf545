#include "engine/optimo/handbox/modal_text.h"

#include <algorithm>

#include "engine/core/number_text.h"
#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {

std::string ModalText(const machine::MachineView& view, std::string_view name) {
  const auto found = std::ranges::find(view.modal_values, name, &machine::ModalValue::name);
  return found == view.modal_values.end() ? std::string() : found->value;
}

std::vector<double> ModalNumbers(const machine::MachineView& view, std::string_view name) {
  const std::string text = ModalText(view, name);
  std::vector<double> numbers;
  if (!text.starts_with('(')) return numbers;
  for (std::size_t at = 1; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(",)", at), text.size());
    numbers.push_back(ParseDouble(text.substr(at, end - at)).value_or(0.0));
    at = end + 2;  // the blank behind a comma
  }
  return numbers;
}

std::string WithReal(std::string name, double value) {
  name += ' ';
  PrintReal(static_cast<float>(value), name);
  return name;
}

std::string WithList(std::string name, const std::vector<double>& values) {
  name += " (";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) name += ", ";
    PrintReal(static_cast<float>(values[i]), name);
  }
  return name + ")";
}

}  // namespace rmlcell::optimo
