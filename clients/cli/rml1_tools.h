#pragma once

#include <string>
#include <vector>

#include "clients/cli/machine_choice.h"
#include "engine/rml1/board/board_stream.h"

namespace rmlcell::cli {

// The tools for streams of mills. They need no server. An `output` of "-" is standard output;
// files are written whole or not at all. What a machine would do a part of only is not written
// (engine/rml1/offline/work_check.h) unless it is forced.

// What all of them take. Machine: a profile or a machine file; neither: the defaults.
struct MillToolOptions {
  std::string file;
  std::string output;
  MachineChoice machine;
  bool json = false;
  bool force = false;
};

// To standard output as it comes: long streams need no memory of their length.
int ExplainStream(const MillToolOptions& options);

// What the mill does with a stream as G-code, and a stream of G-code (docs/gcode.md). Output by
// default: FILE with .nc, FILE with .rml.
int StreamToGcode(const MillToolOptions& options);
struct FromGcodeToolOptions : MillToolOptions {
  double tolerance_mm = 0.01;
};
int StreamFromGcode(const FromGcodeToolOptions& options);

// A stream at another place, for a machine with other steps, or many times. Output by default:
// standard output.
struct MoveToolOptions : MillToolOptions {
  std::vector<double> by_mm;  // X, Y and perhaps Z
};
int MoveMillStream(const MoveToolOptions& options);
struct StepsToolOptions : MillToolOptions {
  double from = 0.0;  // units in a mm
  double to = 0.0;
};
int ScaleMillStream(const StepsToolOptions& options);
struct TileToolOptions : MillToolOptions {
  int columns = 1;
  int rows = 1;
  std::string within;  // "150x100": a field in place of columns and rows; empty: none
  double gap_mm = 1.0;
};
int TileMillStream(const TileToolOptions& options);

// A stream that mills a circuit board, of its picture. Output by default: FILE with .rml.
struct PngToolOptions : MillToolOptions {
  rml1::BoardOptions board;
  double dpi = 0.0;  // 0: as the file says
  bool invert = false;
  std::vector<double> at_mm;  // X and Y; empty: 0, 0
};
int StreamFromPng(const PngToolOptions& options);

}  // namespace rmlcell::cli
