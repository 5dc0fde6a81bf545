#include "engine/machine/run.h"

namespace rmlcell::machine {

std::vector<NamedVariable> ReadVariables(const Run& run, std::span<const std::string> names) {
  std::vector<NamedVariable> read;
  for (const std::string& name : names) {
    if (std::optional<VariableValue> value = run.ReadVariable(name))
      read.push_back({name, *std::move(value)});
  }
  return read;
}

}  // namespace rmlcell::machine
