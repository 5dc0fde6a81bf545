#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/editing.h"
#include "engine/machine/language_word.h"
#include "engine/machine/program_file.h"
#include "engine/machine/run_setup.h"
#include "engine/machine/tools.h"
#include "engine/machine/verdict.h"

namespace rmlcell::machine {

class Handbox;         // handbox.h
class Run;             // run.h
class RunObserver;     // observer.h
class Standing;        // standing.h
struct MachineShape;   // shape.h
struct MachineStatus;  // machine_status.h
struct Panel;          // panel.h
struct ProgramEdit;    // handbox.h

// How a check that runs a program reads the codes of its family.
struct CheckCodes {
  std::span<const ErrorCode> of_motion{};  // findings of a run that the check tells
  std::span<const ErrorCode> by_speed{};   // of these warnings only: the speed may be another
  std::span<const ErrorCode> not_given{};  // of outcomes: what was given to the check is not all
  // The instruction that sets the work offset, which outlives the program that set it. Empty: none.
  std::string_view work_offset{};
};

struct FamilyInfo {
  std::string_view id{};               // "optimo"
  std::string_view title{};            // "Amada OPTIMO 5-axis laser"
  std::string_view extensions{};       // ".S .SI .CMP .O", space separated, compared without case
  std::string_view axes{};             // "X Y Z A B"
  std::string_view editor_language{};  // how editors call its programs: "optimo-rml"
  bool has_executables = false;        // makes executables at slot + 100
  int schedules = 0;                // laser schedules 1 to this, and process definitions; or none
  bool checked_by_running = false;  // Translate does not follow the motion: CHECK runs the program
  bool hold_in_remote = false;      // the HOLD key works in mode REMOTE, too
  bool turns_in_degrees = false;    // its programs write rotary axes in degrees
  // The profile of a machine for which nobody named one; empty: the family has no profiles.
  std::string_view default_profile{};
  // Parameters that say where program zero lies on the machine: X, Y and Z, in mm. Empty: programs
  // set it themselves.
  std::array<std::string_view, 3> origin_parameters{};
  std::string_view clamps_parameter{};  // height of the clamps above program zero, mm; empty: none
  double override_min_percent = 1.0;    // of the feed rate, where a person sets it at a machine
  double override_max_percent = 100.0;
  double override_step_percent = 0.0;  // from the least one on; 0: it is set to any
  bool has_repeat = false;             // the mode REPEAT
  // Keys that move its axes by hand; empty: none. In MANUAL alone, as one of the modes that a panel
  // with such keys has, with references; or whatever the mode is.
  std::string_view jog_axes{};  // "X Y Z A B C"
  bool jogs_in_manual = false;
  bool cover_stops_jog = false;  // it has a cover, and keys move nothing while that is open
  // What finds the reference of the axes, as a program; empty: they have it always. Started from
  // the console it is followed by the program of a slot; 0: by none.
  std::string_view zero_program{};
  int home_program = 0;
  bool start_takes_back = false;     // START a HOLD or STOP that has not halted the run yet
  std::string_view spindle_speed{};  // variable: rpm of a spindle that turns; empty: it has none
  // Instructions that wait for an input or a time.
  std::span<const std::string_view> waiting{};
  bool steps_come_again = false;  // in loops and calls; else a run comes to each of them once
  bool has_dry_run = false;       // up to a step, RunSetup::simul
  bool has_breakpoints = false;   // Run::SetBreakpoints

  // What the machine calls what the cell finds. What has no number in its manual the cell says in
  // its own words: a machine without program memory has no slots.
  ErrorCode no_slot = ErrorCode::kCellInvalidArgument;      // a number that is none
  ErrorCode empty_slot = ErrorCode::kCellNotFound;          // a slot without program
  ErrorCode in_use = ErrorCode::kCellMachineState;          // its program, by an open run
  ErrorCode no_schedule = ErrorCode::kCellInvalidArgument;  // a number that is no laser schedule
  ErrorCode travel_left = ErrorCode::kCellTravelLeft;       // a motion leaves the travel of an axis
  ErrorCode not_zeroed = ErrorCode::kCellMachineState;      // its axes have no reference
  ErrorCode emergency_stop = ErrorCode::kCellEmergencyStop;
  // Of a project: a slot or a process twice; a slot without source, or no program at all.
  ErrorCode given_twice = ErrorCode::kCellInvalidArgument;
  ErrorCode no_source = ErrorCode::kCellInvalidArgument;
  std::optional<ErrorCode> torn{};  // the data ends inside a command; none: that is an error
  CheckCodes check{};               // where it is checked_by_running
};

// The key that holds a run from afar: HOLD, after the present instruction; STOP, at once on the
// path, where HOLD has no effect.
inline InputKind HoldKey(const FamilyInfo& info, Mode mode) {
  const bool works = mode != Mode::kRemote || info.hold_in_remote;
  return works ? InputKind::kHold : InputKind::kStop;
}

// Of a program memory: objects and executables together.
struct MemoryLimit {
  std::int64_t bytes = 0;
  ErrorCode full = ErrorCode::kCellTooLarge;  // what the machine calls it that there is no room
};

// A process definition of a project: WORKDEF n, p with its parameters. OPT-3.01 to 3.08.
struct ProcessDefinition {
  int kind = 0;     // n
  int process = 0;  // p
  std::vector<double> values{};
  std::string note{};

  bool operator==(const ProcessDefinition&) const = default;
};

struct ProjectProgram {
  int slot = 0;
  SourceFile file{};
  bool inch = false;
};
struct ProjectBundle {
  std::vector<ProjectProgram> programs{};
  std::vector<LaserSchedule> schedules{};
  std::vector<ProcessDefinition> processes{};
};
struct TransferOptions {
  bool insert_missing_definitions = false;  // put WORKDEFs of the project before the first WORK
};
// What a transfer would store: every program or none.
struct TransferPlan {
  bool ok = false;
  struct Program {
    int slot = 0;
    std::string source;  // as compiled: metric, with inserted definitions
    std::string object;
    // The text of the project, whatever its units, says the same: it may be kept beside the object.
    bool own_text = false;
  };
  std::vector<Program> programs{};
  std::vector<Diagnostic> diagnostics{};  // at most kDiagnosticsMax
  UntoldFindings diagnostics_dropped{};
};

// A program of the product's own that programs of the family count on, and that its machines do not
// have when they are new: stored when somebody asks for it.
struct SpecialProgram {
  int slot = 0;
  std::string_view name{};       // "Z-UP"
  std::string_view file_name{};  // "2.S"
  std::string_view source{};
};

// A figure that runs of a family may give (Run::figures): its name never changes meaning.
struct FigureInfo {
  std::string_view name{};  // "programmed.cut_length"
  std::string_view unit{};  // "mm"; empty for counts
  std::string_view text{};  // what it means, one sentence

  // In the report that people read: the row and what it says, with '#' for the number. Figures that
  // follow each other in one row share it. Empty: it stands among the facts alone.
  std::string_view row{};   // "tool"
  std::string_view said{};  // "up # s"
  bool when_zero = false;   // said of nothing, too
  // kCheckMachine: of a check, when machine coordinates are asked for.
  enum class Where : std::uint8_t { kReport, kCheck, kBoth, kCheckMachine };
  Where where = Where::kReport;  // has the row
};

// Why an executable is no longer what a new link of the stored objects would give (OPT-1.12
// to 1.15).
enum class StaleReason {
  kObjectChanged,    // the object of its program is another one
  kObjectMissing,    // the object of its program is gone
  kFunctionChanged,  // a FUNCTION that it contains is stored with another object
  kFunctionDeleted,  // a FUNCTION that it contains was deleted
  kDamaged,          // it cannot be read
};
struct StalePart {
  int slot = 0;  // 1..99, of the object concerned
  StaleReason reason = StaleReason::kFunctionChanged;
  std::string text{};  // the reason, for people

  bool operator==(const StalePart&) const = default;
};
struct StaleExecutable {
  int slot = 0;                    // of its program; the executable lies in slot + 100
  std::vector<StalePart> parts{};  // its own object first, then FUNCTIONs in order of first use

  bool operator==(const StaleExecutable&) const = default;
};

// One machine family. A new family is one folder under engine/ and one line in
// engine/families/registry.cc.
// Stateless; every method may be called from several threads at once.
class MachineFamily {
 public:
  virtual ~MachineFamily() = default;
  virtual const FamilyInfo& info() const = 0;
  virtual std::span<const ParameterInfo> parameters() const = 0;
  virtual std::span<const MachineProfile> profiles() const { return {}; }

  // Whether the parameters of a machine fit together: what no range of a single one tells. Whoever
  // takes parameters from outside asks this before anything is kept or run. Error:
  // CellParameterRange, with both names and values.
  virtual Status CheckParameters(const Parameters& /*parameters*/) const { return {}; }

  // Whether Run::ReadVariable knows the name, on a machine with these parameters.
  virtual bool HasVariable(const Parameters& /*parameters*/, std::string_view /*name*/) const {
    return false;
  }

  // Whether WriteVariable of a run or of a machine that stands takes this value. Errors:
  // CellInvalidArgument for no such variable, one that only the machine writes, or a value that it
  // cannot hold. A family whose programs alone write its variables has none to be written.
  virtual Status CheckWrite(const Parameters& parameters, std::string_view name,
                            double value) const;

  // Whether Run::SetBreakpoints takes it. One of a family whose programs have no expressions, and
  // come to each step once, has neither condition nor pass. Errors: CellInvalidArgument;
  // CellNotLive where there are none.
  virtual Status CheckBreakpoint(const Breakpoint& breakpoint) const;

  // Every figure that Run::figures can hold; docs/facts.md lists them.
  virtual std::span<const FigureInfo> figures() const { return {}; }

  // By which of its figures a run of this family is judged, most serious rules first.
  virtual std::span<const VerdictRule> verdict_rules() const { return {}; }

  // What report and pictures need to know of a machine with these parameters.
  virtual MachineShape Shape(const Parameters& parameters) const;

  // What is to be seen at a machine that is so. That of a machine of which nothing is known but
  // that it has power.
  virtual Panel ShowPanel(const MachineStatus& status) const;

  // What Handbox::Save kept; of nothing, a new one. Null: the machine has none. Errors:
  // CellBadText.
  virtual Result<std::unique_ptr<Handbox>> NewHandbox(const Parameters& parameters,
                                                      std::string_view saved) const;

  // The object before an edit that its handbox made, of that behind it; empty: there was no
  // program. Errors: CellEtagMismatch, for another object; CellNotLive without handbox.
  virtual Result<std::string> UndoEdit(const ProgramEdit& edit, std::string_view object) const;

  // Checks and translates. Bad programs are diagnostics, not errors.
  virtual Translation Translate(const SourceFile& file, const Parameters& parameters,
                                const CheckOptions& options) const = 0;

  // What there is to say about storing a program of these bytes in this slot (1..99).
  virtual std::vector<Diagnostic> CheckSlot(int /*slot*/, std::string_view /*program*/) const {
    return {};
  }

  // By slot; a family may have none.
  virtual std::span<const SpecialProgram> special_programs() const { return {}; }

  // What is wrong with a process definition by itself, whatever the programs say (OPT-3.01
  // to 3.08).
  virtual std::vector<Diagnostic> CheckProcess(const ProcessDefinition& /*definition*/) const {
    return {};
  }

  // Checks a project and makes what its transfer would store. That of a machine whose programs are
  // kept as they come: it has no schedules and no processes, and no other units.
  virtual TransferPlan PlanTransfer(const ProjectBundle& project, const Parameters& parameters,
                                    const TransferOptions& options) const;

  // The tools for program texts; null: programs are streams.
  virtual const Tools* tools() const { return nullptr; }

  // What an editor asks about program texts; null: nobody writes them by hand.
  virtual const Editing* editing() const { return nullptr; }

  // The words of its language, by name.
  virtual std::vector<LanguageWord> words() const { return {}; }

  // Whether bytes are an executable of this family, made of the program of this slot (1..99).
  // Errors: ObjectCorrupt (7034), CellInvalidArgument for that of another program.
  virtual Status CheckExecutable(std::string_view /*executable*/, int /*slot*/) const { return {}; }

  // What all programs and executables of a machine with these parameters may have together;
  // nothing: as much as comes.
  virtual std::optional<MemoryLimit> ProgramMemory(const Parameters& /*parameters*/) const {
    return std::nullopt;
  }

  // Whether all is there that a run of this program can come to and names: programs that can be
  // read, schedules, room for the executables that it makes. `schedules` as in RunSetup. Errors:
  // those that the run would end with.
  virtual Status CheckNeeds(const std::map<int, StoredProgram>& programs,
                            const std::vector<LaserSchedule>& schedules,
                            const Parameters& parameters, int main_slot) const;

  // Which executables of a program memory are stale, by slot. `deleted` as in RunSetup.
  virtual std::vector<StaleExecutable> FindStaleExecutables(
      const std::map<int, StoredProgram>& /*programs*/, const std::set<int>& /*deleted*/) const {
    return {};
  }

  // Errors: ProgramMissing (7102), ObjectCorrupt (7034), the link errors 7103..7108 and the like
  // are not errors here: the run ends with them. Only a setup that makes no sense is refused.
  // `observer` must outlive the run.
  virtual Result<std::unique_ptr<Run>> NewRun(RunSetup setup, RunObserver& observer) const = 0;

  // The machine that these bytes of SaveMachine or Standing::Save keep; of none: a new one. Errors:
  // CellBadText for bytes that are none; parameters that do not fit together.
  // Of a family that keeps nothing it holds the bytes alone.
  virtual Result<std::unique_ptr<Standing>> NewStanding(const Parameters& parameters,
                                                        std::string_view machine_state) const;
};

// "Roland monoFab SRM-20 (srm-20)", or "My mill, based on Roland monoFab SRM-20 (srm-20)". That
// nobody said which machine it is must not be overlooked: then ": no profile was named" stands
// behind it, or that it is the default where somebody's own machine is based on no other.
std::string MachineTitle(const MachineFamily& family, std::string_view profile, bool named,
                         std::string_view own_name = {});

// Parameters of a machine: defaults of the family, then the profile, then single values. Errors:
// CellInvalidArgument (no such profile), CellUnknownParameter, CellParameterRange, also of values
// that do not fit together.
Result<Parameters> MakeParameters(const MachineFamily& family, const std::string& profile,
                                  const std::map<std::string, std::string>& parameters);

}  // namespace rmlcell::machine
