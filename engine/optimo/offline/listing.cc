#include "engine/optimo/offline/listing.h"

#include <algorithm>

#include "engine/optimo/language/printer.h"

namespace rmlcell::optimo {
namespace {

constexpr std::size_t kColumns = 5;

void PrintRight(std::size_t number, std::string& out) {
  const std::string text = std::to_string(number);
  out.append(kColumns - std::min(kColumns, text.size()), ' ');
  out += text;
}

}  // namespace

std::string List(const Module& module) {
  std::string out;
  std::size_t line = 0;
  const auto begin = [&](std::size_t step) {
    PrintRight(++line, out);
    out += ' ';
    PrintRight(step, out);
    out += "  ";
  };
  const auto lone = [&](std::uint16_t label) {
    begin(0);
    out += std::to_string(label) + '\n';
  };
  for (const Instruction& instruction : module.instructions) {
    const auto labels = module.Labels(instruction);
    for (std::size_t l = 0; l + 1 < labels.size(); ++l) lone(labels[l]);
    begin(instruction.step);
    PrintLabelColumns(labels.empty() ? kNoLabel : labels.back(), out);
    PrintStatement(module, instruction, out);
    out += '\n';
  }
  for (const std::uint16_t label : module.end_labels) lone(label);
  return out;
}

}  // namespace rmlcell::optimo
