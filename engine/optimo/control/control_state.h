#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/machine/run.h"
#include "engine/motion/planner/planner.h"
#include "engine/optimo/control/laser_unit.h"
#include "engine/optimo/control/machine_state.h"
#include "engine/optimo/language/linker.h"

// Everything that the control is at while it runs a program. One copyable value: a snapshot of a
// run is a copy of it. Programs are shared and never change (OPT-B.65).
namespace rmlcell::optimo {

// An executable as it was loaded.
struct LoadedProgram {
  Executable executable{};
  std::vector<ModuleIndex> index{};  // parallel to executable.modules

  int slot() const { return executable.modules.front().slot; }
};
using Loaded = std::shared_ptr<const LoadedProgram>;
Loaded Load(Executable executable);

// One activation of a module: main, or a FUNCTION.
struct Frame {
  int module = 0;                        // of the executable
  std::uint32_t next = 0;                // instruction
  std::vector<std::uint32_t> returns{};  // of GOSUB
  std::optional<int> error_label{};      // ERR, OPT-3.57
  std::array<float, kParameterCount> parameters{};
};

// Values that hold until they are changed; common to the modules of an executable (OPT-9.16).
struct Modal {
  CoordType coord = CoordType::kRobot;
  PathType path = PathType::kPtp;
  double hole_radius_mm = 0.0;
  double speed_percent = 70.0;
  double accel_percent = 100.0;
  double oversh_percent = 100.0;
  std::uint8_t updated = kAllGroups;  // UPDATE ON
  std::uint8_t imaged = 0;            // IMAGE
};

// TIMER. It belongs to the activation that set it: sequence numbers are local to a module.
struct ProgramTimer {
  SimTime due{0};
  SimTime period{0};
  int label = 0;
  bool repeats = false;
  std::size_t level = 0;    // ProgramContext::frames.size() where it was set
  std::size_t running = 0;  // depth of its GOSUB while that runs; 0: it does not
};

// A GOSUB that is made between two instructions: /TIME of a /NEXT motion.
struct DueGosub {
  int label = 0;
  std::size_t level = 0;
};

// An expression that is tested while the program goes on: with the PAR of its own activation.
struct Condition {
  Loaded program{};
  int module = 0;
  ExprRange expression{};
  std::array<float, kParameterCount> parameters{};
};

// A WORK that is not over when the program goes on: /START with /NEXT, the dwell with /NEXT, /END.
// OPT-3.38
struct WorkTask {
  enum class Stage { kStart, kDwell, kEnd };
  Stage stage = Stage::kStart;
  machine::Place place{};
  int kind = 0;
  int process = 0;
  bool on = true;
  bool stale = true;              // something happened since its condition was tested last
  SimTime since{0};               // of the instruction; conditions are tested each CYCLE from here
  SimTime until{0};               // kDwell
  machine::PowerBySpeed after{};  // kDwell: the power then
  std::optional<Condition> start{};
  std::optional<Condition> end{};
};

// A program that runs or waits for the one that it CALLed.
struct ProgramContext {
  Loaded program{};
  std::vector<Frame> frames{};  // main module first
  Modal modal{};
  Processes processes{};
  std::optional<ProgramTimer> timer{};
  SimTime timer_left{0};  // stands still while a CALLed program runs, OPT-B.89
  std::optional<DueGosub> due_gosub{};
  std::vector<WorkTask> work_tasks{};  // stand still while a CALLed program runs
};

// A command as the planner got it, kept until its motion is over; without a move: a mark.
struct AppendedItem {
  std::uint64_t tag = 0;
  std::optional<motion::MoveCommand> move{};
};

// An axis that a motion takes out of its travel.
struct BeyondTravel {
  int axis = 0;
  double excess = 0.0;  // the worst of the motion, mm or rad
  bool at_target = false;
  motion::AxisPose axes{};  // where it is worst
};

// What is told when a motion begins and when it is over.
struct MoveNote {
  machine::Place place{};
  motion::ProgramPoint program_point{};
  double program_a = 0.0;
  double feed_mm_s = 0.0;
  PathType path = PathType::kPtp;
  bool last = true;  // of its MOVE; false: the lead of a hole
  bool fly = false;
  motion::MoveCommand::Kind kind = motion::MoveCommand::Kind::kContour;
  double speed_percent = 0.0;  // as programmed; for a change of the override on the way
  double accel_fraction = 1.0;
  std::vector<BeyondTravel> beyond{};  // a forecast: told when the motion begins
};

// A motion under way.
struct ActiveMotion {
  motion::PlannedMotion motion{};
  MoveNote note{};
  SimTime start{0};
  SimTime arrival{0};  // end of the profile
  SimTime end{0};      // with settling
  SimTime told{0};     // parts up to here were reported
  bool ended = false;  // brought to rest by /END, /TIME or a MOVE that takes over

  double s_at(SimTime time) const { return motion.speed.At(ToSeconds(time - start)).s; }
};

// Something visible that happens between two motions (planner marks).
struct PassageEffect {
  // kZeroed: a group of axes stands at its mechanical zero; `index` says which.
  enum class Kind { kOutput, kAnalogue, kBeamOn, kBeamOff, kSchedule, kTable, kZeroed };
  Kind kind = Kind::kOutput;
  machine::Place place{};
  int index = 0;
  double value = 0.0;
  machine::PowerBySpeed power{};
};

// What the control waits for before it goes on with the program.
struct Pending {
  enum class Kind {
    kNone,
    kStandstill,  // motions to be over, then the program goes on at the same instruction
    kTime,        // until `until`
    kCondition,   // until the expression of the instruction is true, then it is carried out
    kTakeOver,    // the next tick, when the /NEXT motion is brought to rest
    kNoMotion,    // the end of ControlState::no_motion
  };
  Kind kind = Kind::kNone;
  SimTime since{0};
  SimTime until{0};
  SimTime told{0};  // reported up to here
  machine::WaitKind wait = machine::WaitKind::kDwell;
  machine::Place place{};  // of the instruction that waits
  ExprRange expression{};  // kCondition: of the module of the innermost frame
  bool of_move = false;    // kCondition: /START of a MOVE, whose /TIME counts the wait
};

// A loop that reads an input again and again, and lets no time pass by itself.
struct Polling {
  int program = 0;
  std::uint32_t instruction = 0;
  SimTime at{-1};     // when it was read last
  int count = 0;      // how often at that instant
  bool slow = false;  // each further time takes a CYCLE
};

// Dry run up to a step, OPT-6.12 to 6.30.
struct Simulated {
  bool active = false;
  machine::ProgramStep until{};
  int schedule = 0;  // selected last; 0: none
};

struct ControlState {
  MachineState machine{};
  machine::RunPhase phase = machine::RunPhase::kRunning;
  machine::Outcome outcome{};
  machine::Mode mode = machine::Mode::kCycle;
  double override_percent = 100.0;
  std::optional<machine::ProgramStep> breakpoint{};
  Simulated simulated{};

  SimTime now{0};
  std::uint64_t steps = 0;
  std::size_t next_input = 0;              // of the script
  std::vector<ProgramContext> programs{};  // innermost last
  Pending pending{};

  motion::Planner planner;
  motion::AxisPose planned_axes{};  // after everything that was appended
  std::uint64_t next_tag = 1;
  std::deque<std::pair<std::uint64_t, MoveNote>> notes{};
  std::deque<std::pair<std::uint64_t, PassageEffect>> effects{};
  std::deque<motion::PlannedItem> timeline{};
  std::optional<ActiveMotion> active{};
  std::deque<motion::PlannedItem> interrupted{};  // STOP: what follows at START
  std::deque<AppendedItem> appended{};            // while /FLY passages are open
  std::deque<AppendedItem> held{};                // HOLD: what follows at START
  machine::Place halted_behind{};  // the move that HOLD made exact, or that STOP interrupted
  // Where the program had run ahead to when HOLD or STOP halted the motion; set while halted.
  std::optional<machine::Place> place_ahead{};
  bool override_while_stopped = false;  // the feed override changed since a STOP
  bool halting = false;                 // coming to rest for a STOP, or a HOLD inside a chain
  bool passing = false;                 // the planner may hold a /FLY motion back
  bool background = false;              // the motion under way is one of /NEXT
  std::optional<std::uint64_t> background_from{};  // it is the one of this tag, still to come
  bool condition_met = false;  // /START of the instruction in execution was true
  SimTime instruction_since{0};
  Polling polling{};
  int run_ahead = 0;  // instructions executed since the last motion

  // The motions of the MOVE with /END or /TIME, by tag.
  struct Watched {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };
  std::optional<Watched> watched{};
  std::optional<Condition> end_condition{};  // of /END
  std::optional<DueGosub> time_gosub{};      // of /TIME
  SimTime time_due{0};
  double time_limit_s = 0.0;
  SimTime watched_since{0};
  bool watch_begins = false;  // with the motion: the program ran ahead through a /FLY passage
  bool time_ran_out = false;
  // A MOVE that could never end (SPEED 0) stands until its /TIME runs out or its /END is true: from
  // watched_since on. With /NEXT the program goes on meanwhile. OPT-B.22
  bool no_motion = false;

  bool input_changed = false;  // conditions are to be tested again
  bool tasks_input = false;    // the same for the /START of WORK in the background
  bool hold_requested = false;
  bool stop_requested = false;     // STOP on a motion that cannot be left just now
  bool halt_after_step = false;    // SINGLE, breakpoint: also where a STOP comes before
  bool beam_returns = false;       // START brings it back (OPT-B.34)
  std::string_view halt_reason{};  // of halt_after_step
  SimTime halted_at{0};
  std::optional<Error> deferred{};  // raised ahead of motion: handled when it is over
  machine::Place deferred_place{};
  machine::Place place{};  // of the instruction in execution
  Op op = Op::kInvalid;

  Beam beam{};
  machine::PowerBySpeed power_before_pierce{};
  std::map<int, std::string> made_executables{};
  std::map<int, Loaded> loaded{};  // executables of this run, by slot
  bool speed_limited_told = false;
  // A forecast: the first motion that leaves the travel, and how many do.
  std::optional<Diagnostic> first_violation{};
  std::uint64_t violations = 0;
  std::set<std::pair<int, int>> held_by_axis{};  // program and step, told already
  std::uint64_t steps_at_repeat = 0;             // REPEAT: executed before this repetition

  explicit ControlState(const motion::MachineLimits& limits) : planner(limits) {}
};

}  // namespace rmlcell::optimo
