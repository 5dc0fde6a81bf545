#pragma once

#include <string>

namespace rmlcell::cli {

// The tools for streams of mills. They need no server. An `output` of "-" is standard output;
// files are written whole or not at all.

// What all of them take. Machine: a profile or a machine file; neither: the defaults.
struct MillToolOptions {
  std::string file;
  std::string output;
  std::string profile;
  std::string machine_file;
  bool json = false;
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

}  // namespace rmlcell::cli
