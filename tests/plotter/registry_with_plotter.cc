// The registry of the test build: engine/families/registry.cc with a third family.
#include <array>

#include "engine/families/families.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/rml1/offline/stream_diff.h"
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

std::span<const StreamComparison> StreamComparisons() {
  static const std::array<StreamComparison, 1> comparisons = {
      {{&rml1::Rml1Family(), rml1::CompareStreams}}};
  return comparisons;
}

}  // namespace families
}  // namespace rmlcell
