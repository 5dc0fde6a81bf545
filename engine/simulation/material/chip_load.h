#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"

namespace rmlcell::simulation {

// What one edge of a mill usually takes off at one turn, and how fast it usually goes, for a tool
// of one diameter in one material.
struct ChipRange {
  double least_mm = 0.0;
  double most_mm = 0.0;
  double speed_most_m_min = 0.0;  // of the edge along the cut
  double plunge_most_mm = 0.0;    // straight down; 0: not told

  bool operator==(const ChipRange&) const = default;
};

// How a material is milled: figures for some diameters, rising.
struct ChipTable {
  struct Row {
    double diameter_mm = 0.0;
    double least_mm = 0.0;
    double most_mm = 0.0;
  };
  std::string material;  // "wax"
  std::string source;    // where the figures are from; "estimate: ..."
  double speed_most_m_min = 0.0;
  double plunge_share = 0.0;  // of the most across that an edge takes straight down
  std::vector<Row> rows;

  // Between two rows in proportion; beyond them in proportion to the diameter.
  ChipRange For(double diameter_mm) const;
};

// Of a file like chip_loads.toml. Error: CellBadText with its line: no TOML, a table without
// source, lists that do not rise or are not as long as each other, a least above the most, a plunge
// that takes nothing or more than a pass.
Result<std::vector<ChipTable>> ReadChipTables(std::string_view toml);

// The file of that name in this folder.
const std::vector<ChipTable>& ChipTables();

// Error: CellInvalidArgument for a material that is not in the table, with those that are.
Result<ChipRange> ChipsOf(std::string_view material, double diameter_mm);

}  // namespace rmlcell::simulation
