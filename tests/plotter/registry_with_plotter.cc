// The registry of the test build: engine/families/registry.cc with a third family.
#include <array>

#include "engine/families/families.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/rml1/rml1_family.h"
#include "tests/plotter/plotter.h"

namespace rmlcell {

std::span<const ErrorTable> OwnErrorTables() {
  static const std::array tables = {plotter::Errors()};
  return tables;
}

namespace families {

std::span<const machine::MachineFamily* const> Families() {
  static const std::array<const machine::MachineFamily*, 3> families = {
      &optimo::OptimoFamily(), &rml1::Rml1Family(), &plotter::PlotterFamily()};
  return families;
}

// Streams of the plotter cannot be compared.
std::span<const StreamComparison> StreamComparisons() { return {}; }

}  // namespace families
}  // namespace rmlcell
