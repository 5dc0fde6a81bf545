#pragma once

#include <array>
#include <string>
#include <vector>

namespace rmlcell::cli {

// The tools of the programming office: they read and write files of Optimo programs and need no server.
// An `output` of "-" is standard output; empty: the name that the tool gives it. Files are written whole
// or not at all.

// `map`: a source map is written beside the object, .MAP for its extension, from which Decompile gives the
// programmer's own text back as long as the object is the one that was made of it.
int Compile(const std::string& file, const std::string& output, bool map);
int Decompile(const std::string& file, const std::string& output);

// The executable of a main program with the FUNCTIONs that it needs, from files and folders as simulate
// takes them.
int Link(const std::vector<std::string>& files, const std::vector<std::string>& slots, int main_slot,
         const std::string& output);

// In place. `check_only`: says which files are not in canonical layout, and changes none.
int Format(const std::vector<std::string>& files, bool check_only);

// The arguments of CONVERT: file, optional output, /i or /m (OPT-8.54 to 8.67).
int Convert(const std::vector<std::string>& arguments);

int Compensate(const std::string& file, const std::string& output);

// Numbers as they were given; a vector is empty when its option was not. `shift` goes alone.
struct TransformOptions {
  std::string file;
  std::string output;
  std::vector<double> move;   // X, Y, Z in mm
  std::vector<double> turn;   // about Z, Y, X in rad
  std::vector<double> shift;  // X, Y, Z, rz, ry, rx: added to VR[86] to VR[91]
};
int Transform(const TransformOptions& options);

int List(const std::string& file, const std::string& output);

// What two programs do differently. Exit code 1 when they differ.
struct DiffOptions {
  std::string before;
  std::string after;
  std::string svg;  // file of a picture of both paths; -: standard output, in place of the text
  bool json = false;
};
int Diff(const DiffOptions& options);

}  // namespace rmlcell::cli
