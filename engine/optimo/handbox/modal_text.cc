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
  std::string_view rest = std::string_view(text).substr(1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of(",)"), rest.size());
    numbers.push_back(ParseDouble(rest.substr(0, end)).value_or(0.0));
    rest.remove_prefix(std::min(end + 2, rest.size()));  // the blank behind a comma
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
  std::string_view between;
  for (const double value : values) {
    name += between;
    PrintReal(static_cast<float>(value), name);
    between = ", ";
  }
  return name + ")";
}

}  // namespace rmlcell::optimo
