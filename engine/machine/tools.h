#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/parameters.h"
#include "engine/machine/program_file.h"

// What can be done with program texts without running them: the tools of a programmer.
// A family whose programs are texts has them (MachineFamily::tools), one with streams has none.
namespace rmlcell::machine {

// Unit and form of a file: by its name, else by its bytes.
enum class FileForm { kMetricSource, kInchSource, kObject };

struct CompileOptions {
  bool advice = true;       // findings of severity warning and advice
  bool inch = false;        // the text is an inch source
  bool source_map = false;  // fill in CompiledProgram::source_map
  bool any_size = false;    // the object is not stored: it may be larger than the machine takes
};
struct CompiledProgram {
  bool ok = false;
  std::string object{};
  std::string source_map{};  // gives the programmer his own text back, Tools::Decompile
  int steps = 0;
  std::vector<Diagnostic> diagnostics{};  // in order of place
  UntoldFindings diagnostics_dropped{};
};

struct RecoveredSource {
  std::string text;
  bool own_text = false;  // as the programmer wrote it, from the map
  bool inch = false;
};

// Object bytes of a slot 1..99; nothing when it is empty. The view must stay valid during Link.
using ObjectLookup = std::function<std::optional<std::string_view>(int slot)>;
struct LinkedProgram {
  std::string executable;
  std::vector<int> functions;  // slots, in order of first use
};

struct FormattedText {
  std::string text;  // as it was where it cannot be read
  bool changed = false;
  bool readable = false;
  std::vector<Diagnostic> diagnostics{};
  UntoldFindings diagnostics_dropped{};
};

// The endings of files that tools make and read.
struct FileExtensions {
  std::string_view object{};       // ".O"
  std::string_view executable{};   // ".X"
  std::string_view listing{};      // ".LST"
  std::string_view compensated{};  // ".CMP"
  std::string_view source_map{};   // ".MAP"
};

// What the tools of a family call what whoever uses them finds.
struct ToolCodes {
  ErrorCode source_is_inch = ErrorCode::kCellBadText;  // where it must be metric
  ErrorCode convert_input = ErrorCode::kCellFileUnreadable;
  ErrorCode convert_output = ErrorCode::kCellFileUnwritable;
};

// For the first line of what is made; the engine reads no clock.
struct FileNames {
  std::string input;
  std::string output;
  std::string date;  // "Tue Apr 20 13:37:33 1993"
};

// A text made of another one.
struct RewrittenText {
  bool ok = false;  // false: the text is empty, nothing may be written
  std::string text{};
  std::vector<Diagnostic> diagnostics{};
  UntoldFindings diagnostics_dropped{};
};

enum class Direction { kToMetric, kToInch };
// What a call of the unit converter asks for.
struct ConvertRequest {
  std::string input;
  std::string output;
  Direction direction = Direction::kToMetric;
};

// By how much a program is moved: mm, and about Z, Y, X in rad, in the order of a frame of the
// machine.
struct Displacement {
  std::array<double, 3> move_mm{};
  std::array<double, 3> turn_rad{};
};

struct RepairedText {
  std::string text;  // layout, comments and line ends as they were
  // What was repaired, in the order in which it was; places are those of the text at that moment.
  std::vector<Diagnostic> fixed;
  Translation left;  // what there is to say about `text`
};
// The check that decides: with the parameters of a machine, with advice or without.
using ProgramCheck = std::function<Translation(const SourceFile& file)>;

// What a change of a program touches; a change may touch several.
enum Aspect : std::uint8_t {
  kAspectPath = 1,     // where the tool goes
  kAspectTime = 2,     // how fast, and how long it waits
  kAspectPower = 4,    // processes, schedules, beam
  kAspectOutputs = 8,  // what the machine is told by outputs
  kAspectData = 16,    // variables
  kAspectFlow = 32,    // jumps, calls, ends, error handling
};

struct StepChange {
  enum class Kind { kAdded, kRemoved, kChanged };
  Kind kind = Kind::kChanged;
  unsigned aspects = 0;
  int step_a = 0;  // as the control counts; 0: not in this program
  int step_b = 0;
  std::string before;  // canonical text; empty when added
  std::string after;   // empty when removed
  // What changed within the step, one phrase each: "X 10.0 -> 12.0", "SPEED 10.0 -> 12.0 before
  // it", "goes to step 7 -> step 9".
  std::vector<std::string> what;
  // Moves whose targets are numbers in both: how far the target moved. Else 0.
  double target_moved_mm = 0.0;
};

// A figure of a run that differs, or that only one of the runs has (the other is 0 then).
struct FigureChange {
  std::string name;
  std::string unit;
  double before = 0.0;
  double after = 0.0;
};

struct ProgramDiff {
  std::vector<StepChange> steps;      // in the order of b; what was removed before what follows it
  std::vector<FigureChange> figures;  // by name
  unsigned aspects = 0;               // of all steps

  bool equal() const { return steps.empty() && figures.empty(); }
};

// One of two programs that are compared.
struct ComparedObject {
  std::string_view object;
  std::vector<Figure> figures{};  // of a run, when the caller made one
};

// Stateless; every method may be called from several threads at once.
class Tools {
 public:
  virtual ~Tools() = default;

  virtual const FileExtensions& extensions() const = 0;
  virtual const ToolCodes& codes() const = 0;

  virtual FileForm FormOf(std::string_view name, std::string_view bytes) const = 0;

  // Whether bytes are a text that may be rewritten. Errors: CellBadText.
  virtual Status CheckIsText(std::string_view name, std::string_view bytes) const = 0;

  // Never fails: bad programs are diagnostics.
  virtual CompiledProgram Compile(const SourceFile& file, const Parameters& parameters,
                                  const CompileOptions& options) const = 0;

  // Canonical source, or the programmer's own by the map of its compilation; a map that is damaged
  // or of another object is passed over. Errors: ObjectCorrupt (7034).
  virtual Result<RecoveredSource> Decompile(std::string_view object,
                                            std::optional<std::string_view> source_map) const = 0;

  // Errors: those of a link, 7102 to 7108, ObjectCorrupt (7034).
  virtual Result<LinkedProgram> Link(int slot, const ObjectLookup& lookup,
                                     const Parameters& parameters) const = 0;

  virtual FormattedText Format(const SourceFile& file) const = 0;

  // The arguments of the converter: a name, perhaps that of the output, perhaps the direction.
  // Nothing when there are none. Errors: those of the arguments.
  virtual Result<std::optional<ConvertRequest>> ReadConvertArguments(
      std::span<const std::string> arguments) const = 0;
  // Between inches with degrees and millimetres with radians. Its findings stop nothing.
  virtual RewrittenText Convert(std::string_view text, Direction direction,
                                const FileNames& names) const = 0;

  // Offsets the path by the radius of the tool, as the text asks for.
  virtual RewrittenText Compensate(std::string_view text, const FileNames& names,
                                   bool inch) const = 0;

  // Moves and turns what the program does: by its targets, or by the origin that it sets.
  virtual RewrittenText Transform(std::string_view text, const Displacement& by) const = 0;
  virtual RewrittenText Shift(std::string_view text, const Displacement& by) const = 0;

  // With line and step numbers. Errors: ObjectCorrupt (7034).
  virtual Result<std::string> List(std::string_view object) const = 0;

  // Applies the fixes of findings until none is left.
  virtual RepairedText Fix(const SourceFile& file, const ProgramCheck& check) const = 0;

  // What two programs do differently, not how they are written. Errors: ObjectCorrupt (7034).
  virtual Result<ProgramDiff> Diff(const ComparedObject& a, const ComparedObject& b) const = 0;
};

}  // namespace rmlcell::machine
