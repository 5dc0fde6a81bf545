#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/machine/shape.h"
#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/material/parallel_for.h"
#include "engine/simulation/run/rehearsal.h"

namespace CLI {
class App;
}

// Block and tool of `simulate` and `submit`, and the files that show what is left.
namespace rmlcell::cli {

struct BlockOptions {
  std::string stock;                // "100x80x10"; empty: material is not modelled
  std::string tool;                 // "flat:3"
  std::optional<double> cell_mm{};  // nothing: simulation::StandardCell
  std::string material;             // "wax"; empty: chip loads are not judged
  double rpm = 0.0;                 // of a spindle that is set by hand; 0: as the program says
  std::string target;               // file: what should be left; empty: nothing is compared
  std::optional<double> target_tolerance_mm{};  // nothing: 0.1
};

struct MillingOptions {
  BlockOptions block;
  std::string stl;  // file; empty: none
  double stl_tolerance_mm = 0.01;
  std::string relief;      // file; empty: none
  std::string height_map;  // file; empty: none
  std::string target_png;  // file; empty: none
};

// What a job leaves of its block: names that `submit` takes.
struct JobMillingOptions {
  BlockOptions block;
  int target_slot = 0;                             // of a stored program; 0: none
  std::vector<std::string> products = {"relief"};  // "relief", "height-map", "stl", "target"
  double stl_tolerance_mm = 0.01;
};

// On the command line of a verb. `options` must outlive it.
void AddJobMillingOptions(CLI::App& verb, JobMillingOptions& options);
void AddMillingOptions(CLI::App& verb, MillingOptions& options);

// `machine`: on whose table the block is; a target that is a program runs on it, too. Errors:
// CellInvalidArgument for a machine that mills nothing, a block or a tool that cannot be; those of
// simulation::ReadTarget, of the target's file and, where that is a program, of its run.
Result<simulation::Milling> MillingOf(const MillingOptions& options,
                                      const machine::MachineShape& shape,
                                      const simulation::ProgramMemory& machine);

// The files that were asked for, with the help of `parallel`. Errors: CellFileUnwritable.
Status WriteMaterial(const simulation::HeightField& material,
                     const std::optional<simulation::Target>& target, const MillingOptions& options,
                     simulation::ParallelFor& parallel);

}  // namespace rmlcell::cli
