#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/handbox.h"

// Modal values of the machine, as it writes them.
namespace rmlcell::optimo {

std::string ModalText(const machine::MachineView& view, std::string_view name);  // "(0.0, 3.0)"
// Of a list; anything else has none.
std::vector<double> ModalNumbers(const machine::MachineView& view, std::string_view name);

// "SPEED 70.0"; a list of several: "TCP (0.0, 0.0, 3.0, 0.0, 0.0, -5.0)".
std::string WithReal(std::string name, double value);
std::string WithList(std::string name, const std::vector<double>& values);

}  // namespace rmlcell::optimo
