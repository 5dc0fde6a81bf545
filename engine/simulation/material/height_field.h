#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/result.h"
#include "engine/simulation/material/mill_tool.h"

namespace rmlcell::simulation {

class ToolSweep;

// A tool that is less deep in a block is clear of it: rounding of heights and places.
inline constexpr double kGougeLeast_mm = 1e-3;

// A block of material before it is milled, in the machine frame of the mill: mm.
struct Stock {
  double x_min = 0.0;
  double x_max = 0.0;
  double y_min = 0.0;
  double y_max = 0.0;
  double bottom = 0.0;
  double top = 0.0;
  double cell = 0.1;  // edge of the square cells that it is looked at in

  bool operator==(const Stock&) const = default;
};

// Errors: CellInvalidArgument for a block that cannot be, or of more cells than a HeightField has.
Status CheckStock(const Stock& stock);

// What is left of a block: the height of its surface over each cell of a grid. Cuts only ever lower
// it, so their order does not matter, and rows can be cut each by itself. motion.md section 9.
class HeightField {
 public:
  static constexpr std::uint64_t kCellsMax = 1u << 26;  // 256 MiB of heights

  // Errors: those of CheckStock.
  static Result<HeightField> Of(const Stock& stock);

  struct Size {
    std::size_t columns = 0;
    std::size_t rows = 0;

    bool operator==(const Size&) const = default;
  };
  static Size SizeOf(const Stock& stock);  // precondition: CheckStock is well

  struct Rows {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  Rows all_rows() const { return {0, rows_}; }

  // Takes away what the tool sweeps on a straight move, and tells the most that it took off over a
  // cell, not below the bottom. Rows that nobody else cuts at the same time.
  double Cut(const MillTool& tool, const motion::MachinePoint& from, const motion::MachinePoint& to,
             Rows rows);
  double Cut(const MillTool& tool, const motion::MachinePoint& from,
             const motion::MachinePoint& to) {
    return Cut(tool, from, to, all_rows());
  }

  // How deep the tool would go into what is there on that move; 0 when it stays clear.
  double DepthOf(const MillTool& tool, const motion::MachinePoint& from,
                 const motion::MachinePoint& to) const;

  // How deep shank or holder would go into what is there on that move, where the tool has not cut
  // it away before them; 0 when they stay clear. Before Cut of the same move.
  double ShankDepthOf(const MillTool& tool, const motion::MachinePoint& from,
                      const motion::MachinePoint& to, Rows rows) const;
  double ShankDepthOf(const MillTool& tool, const motion::MachinePoint& from,
                      const motion::MachinePoint& to) const {
    return ShankDepthOf(tool, from, to, all_rows());
  }

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  float height(std::size_t column, std::size_t row) const {
    return heights_[row * columns_ + column];
  }
  const std::vector<float>& heights() const { return heights_; }  // row by row, from y_min on
  const Stock& stock() const { return stock_; }

  // Not below the bottom: what a tool cuts under the block is not its.
  double removed_mm3() const;
  double remaining_mm3() const { return whole_mm3() - removed_mm3(); }
  double whole_mm3() const;       // before anything was removed
  double deepest_cut_mm() const;  // below the top

 private:
  HeightField(const Stock& stock, std::size_t columns, std::size_t rows);
  double CutLevel(ToolSweep& sweep);

  Stock stock_;
  std::size_t columns_;
  std::size_t rows_;
  std::vector<float> heights_;
};

}  // namespace rmlcell::simulation
