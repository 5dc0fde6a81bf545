#pragma once

#include <string>
#include <vector>

#include "clients/cli/machine_choice.h"

namespace rmlcell::cli {

// The off-line tools: they read and write files of Optimo programs and need no
// server. An `output` of "-" is standard output; empty: the name that the tool gives it. Files are
// written whole or not at all.

// What most of them take. `json`: the answer as one JSON object (tool_answer.h).
struct ToolOptions {
  std::string file;
  std::string output;
  bool json = false;
};

// `map`: a source map is written beside the object, .MAP for its extension, from which Decompile
// gives the programmer's own text back as long as the object is the one that was made of it.
int Compile(const ToolOptions& options, bool map);
int Decompile(const ToolOptions& options);

// The executable of a main program with the FUNCTIONs that it needs, from files and folders as
// simulate takes them.
struct LinkOptions {
  std::vector<std::string> files;
  std::vector<std::string> slots;  // "44=FILE"
  int main_slot = 0;
  std::string output;  // empty: that of the program, with .X
  bool json = false;
};
int Link(const LinkOptions& options);

// In place.
struct FormatOptions {
  std::vector<std::string> files;
  bool check_only = false;  // says which files are not in canonical layout, and changes none
  bool json = false;
};
int Format(const FormatOptions& options);

// The arguments of CONVERT: file, optional output, /i or /m (OPT-8.54 to 8.67). `output` goes
// before the one among them.
struct ConvertOptions {
  std::vector<std::string> arguments;
  std::string output;
  bool json = false;
};
int Convert(const ConvertOptions& options);

int Compensate(const ToolOptions& options);

// Numbers as they were given; a vector is empty when its option was not. `shift` goes alone.
struct TransformOptions : ToolOptions {
  std::vector<double> move;   // X, Y, Z in mm
  std::vector<double> turn;   // about Z, Y, X in rad
  std::vector<double> shift;  // X, Y, Z, rz, ry, rx: added to VR[86] to VR[91]
};
int Transform(const TransformOptions& options);

int List(const ToolOptions& options);

// What two programs do differently. Exit code 1 when they differ.
struct DiffOptions {
  std::string before;
  std::string after;
  std::string svg;  // file of a picture of both paths; -: standard output, in place of the text
  MachineChoice machine;
  bool json = false;
};
int Diff(const DiffOptions& options);

}  // namespace rmlcell::cli
