#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/untold_findings.h"
#include "engine/optimo/language/program.h"
#include "engine/optimo/language/start_modes.h"

// Source to object and back (optimo.md 1.1, B.6).
namespace rmlcell::optimo {

inline constexpr std::uint32_t kObjectLimitStandard = 34'000;  // OPT-1.08

struct CompileOptions {
  std::uint32_t object_limit =
      kObjectLimitStandard;  // bytes; machine parameter OBJECT_LIMIT; 0: none
  StartModes start{};        // advice is for a machine that starts programs so
  bool advice = true;        // static warnings and advice
  bool inch = false;         // the text is an inch source: 7030 (OPT-2.04)
  bool source = false;       // fill in Compilation::step_lines and allowed
  std::size_t diagnostics_max = 1000;
  // What others have to say about a program without errors: asked when `advice` is.
  std::function<void(const ParsedProgram&, Findings&)> further_advice{};
};

struct Compilation {
  bool ok = false;
  std::string object;                   // empty when not ok
  Module module;                        // checked; complete only when ok
  std::vector<Diagnostic> diagnostics;  // in order of place
  UntoldFindings diagnostics_dropped{};
  std::vector<int> step_lines;          // as LinesOfSteps; only when asked for and ok
  std::vector<AllowedFinding> allowed;  // alike: what comments allow
};

// Never fails: bad programs are diagnostics. `file` is only a name for them.
Compilation Compile(std::string_view text, std::string_view file, const CompileOptions& options);

// Object bytes of a checked module without errors. Identical on every platform (OPT-B.69).
std::string EncodeObject(const Module& module);

// Reads an object. Safe on hostile bytes. The module is checked: every index, type and range is
// valid. Errors: ObjectCorrupt (7034); ObjectTooLong is not tested here.
Result<Module> DecodeObject(std::string_view bytes);

// Canonical source of a module, lines ended by LF (OPT-B.40); never empty. Compiles to the same
// object.
std::string Decompile(const Module& module);

// Decodes and decompiles. Errors: ObjectCorrupt.
Result<std::string> ObjectToSource(std::string_view object);

}  // namespace rmlcell::optimo
