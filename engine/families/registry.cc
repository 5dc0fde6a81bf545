// The registration of the machine families: one line each, and one for a table of error codes of
// its own. A file by itself, so that a program can be linked with another list.
#include <array>

#include "engine/core/catalogue.h"
#include "engine/families/families.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/rml1/offline/stream_diff.h"
#include "engine/rml1/rml1_family.h"

namespace rmlcell {

// The codes of these families stand in engine/core/catalogue.def, as their manuals print them.
std::span<const ErrorTable> OwnErrorTables() { return {}; }

namespace families {

std::span<const machine::MachineFamily* const> Families() {
  static const std::array<const machine::MachineFamily*, 2> families = {
      &optimo::OptimoFamily(),
      &rml1::Rml1Family(),
  };
  return families;
}

std::span<const StreamComparison> StreamComparisons() {
  static const std::array<StreamComparison, 1> comparisons = {
      {{&rml1::Rml1Family(), rml1::CompareStreams}}};
  return comparisons;
}

}  // namespace families
}  // namespace rmlcell
