#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/units.h"
#include "engine/machine/family.h"
#include "engine/machine/run.h"
#include "engine/machine/shape.h"

// What a run did, in figures. Plain values: copy, compare and convert them freely. motion.md 8.2.
// Lengths mm, speeds mm/s, angles rad, energy J, times in virtual nanoseconds.
namespace rmlcell::simulation {

// Steps with figures of their own; what later steps do is added up in RunReport::rest. A stream
// counts every command as a step, and no reader looks at ten thousand of them one by one.
inline constexpr std::size_t kReportedStepsMax = 10'000;
inline constexpr std::size_t kReportedProgramsMax = 128;  // slots 1..99 and 0 fit

// Where virtual time went. The parts add up to the cycle time exactly.
struct TimeParts {
  SimTime motion{0};
  SimTime settling{0};       // standing still after a motion, as part of it
  SimTime dwell{0};          // DELAY; W and !DW
  SimTime pierce{0};         // delay of WORK 1
  SimTime condition{0};      // waiting for an input: /START, WAIT
  SimTime operator_wait{0};  // waiting for a key; halts
  SimTime spin_up{0};
  SimTime load{0};        // loading a CALLed program
  SimTime standstill{0};  // none of these

  SimTime total() const;
  bool operator==(const TimeParts&) const = default;
};

// What a job, a program or a step did.
struct WorkFigures {
  std::uint64_t steps = 0;  // executed
  TimeParts time;
  double tip_path_mm = 0.0;  // = cut + travel
  double cut_mm = 0.0;       // beam on; tool in the material: cuts and plunges
  double travel_mm = 0.0;    // the rest
  double plunge_mm = 0.0;    // part of cut_mm
  SimTime beam_on{0};
  std::uint64_t beam_switches = 0;  // off to on
  std::uint64_t pierces = 0;        // beam on while standing: WORK 1 with delay, DELAY after WORK 0
  std::uint64_t plunges = 0;
  SimTime shutter_open{0};
  double cut_energy_j = 0.0;     // of motion with the beam on
  double pierce_energy_j = 0.0;  // of the beam on a standing tip

  // The highest mean over a part of it: of a step over its motions, else over the steps.
  double energy_j_per_mm_max = 0.0;

  double energy_j() const { return cut_energy_j + pierce_energy_j; }
  // Mean over the cut; 0 without one.
  double energy_j_per_mm() const { return cut_mm > 0.0 ? cut_energy_j / cut_mm : 0.0; }

  bool operator==(const WorkFigures&) const = default;
};

struct StepFigures {
  int program = 0;
  int step = 0;
  int line = 0;  // 0: not known
  WorkFigures figures;

  bool operator==(const StepFigures&) const = default;
};

// Position of tool and axes. Machine frame, but program_point is as the program wrote it.
struct FinalPosition {
  motion::TipPose tip;
  motion::AxisPose axes;
  motion::ProgramPoint program_point;
  double program_a = 0.0;  // rad, or degrees of a stream
  double program_b = 0.0;

  bool operator==(const FinalPosition&) const = default;
};

// One axis, or the tip, over the run. mm and mm/s, or rad and rad/s.
struct AxisFigures {
  std::string name;  // "X"; "tip"
  bool rotary = false;
  double travel = 0.0;   // sum of what it moved
  double minimum = 0.0;  // of its position; 0 for the tip
  double maximum = 0.0;
  double peak_speed = 0.0;
  double peak_acceleration = 0.0;
  double peak_jerk = 0.0;    // within the phases of the ramps; not a limit, see motion.md 5.1
  double speed_limit = 0.0;  // 0: not known; of the tip also when a PTP motion was the fastest
  double acceleration_limit = 0.0;
  double jerk_limit = 0.0;  // 0: not known, or none
  std::uint64_t reversals = 0;

  bool operator==(const AxisFigures&) const = default;
};

// How the moves of a program passed into each other; motion.md 4, 8.2. Every move counts once.
struct CornerFigures {
  std::uint64_t stops = 0;           // without /FLY, or where the program stands
  std::uint64_t stops_with_fly = 0;  // OVERSH 0, a neighbour or a length that allows no blend
  std::uint64_t reversals = 0;       // /FLY at a turn of more than 175 degrees: a stop
  std::uint64_t through = 0;         // straight on, or at the vertex of a polyline
  std::uint64_t blended = 0;         // at the speed that OVERSH asks for
  std::uint64_t capped = 0;          // blended slower, because of a short neighbour or an axis
  double deviation_mm_max = 0.0;     // of the path from a target
  machine::Place deviation_place;
  motion::MachinePoint deviation_point;  // the tip in the middle of that corner

  bool operator==(const CornerFigures&) const = default;
};

// Why a move never reached the speed asked for. The first two are limits along its whole way, which
// it did reach; else its way is too short for its ramps, with all the acceleration of the tip, or
// because ACCEL or an axis takes some of that.
enum class SlowCause { kAxis, kRadius, kShort, kAcceleration };
std::string_view SlowCauseText(SlowCause cause);  // "axis", "radius", "short", "acceleration"

// The slowest move of a step, by the share that it reached.
inline constexpr std::size_t kReportedSlowMovesMax = 1000;
struct SlowMove {
  machine::Place place;
  SlowCause cause = SlowCause::kShort;
  std::string axis;           // kAxis: "A"
  double wanted_mm_s = 0.0;   // SPEED and override
  double allowed_mm_s = 0.0;  // on its line or arc
  double reached_mm_s = 0.0;
  std::uint64_t count = 1;  // moves of this step that were too slow

  bool operator==(const SlowMove&) const = default;
};

// How many moves never reached the speed asked for, by cause, and the one that came least near.
struct SpeedShortfall {
  std::uint64_t moves = 0;
  std::uint64_t by_axis = 0;
  std::uint64_t by_radius = 0;
  std::uint64_t too_short = 0;
  std::uint64_t by_acceleration = 0;
  machine::Place worst;  // least share of what was asked
  double wanted_mm_s = 0.0;
  double reached_mm_s = 0.0;

  bool operator==(const SpeedShortfall&) const = default;
};

// How long the beam was on at which speed and power; both add up to the beam-on time.
inline constexpr int kSpeedBins = 21;  // standing; then 5 % each of the highest tip speed
inline constexpr int kPowerBins = 20;  // 5 % each: [0,5) ... [95,100]
struct BeamHistogram {
  std::array<SimTime, kSpeedBins> by_speed{};
  std::array<SimTime, kPowerBins> by_power{};

  bool operator==(const BeamHistogram&) const = default;
};

// One connected cut: what a beam does from going on to going off. A halt on the way, during which
// the machine takes the beam away and gives it back, is not its end.
inline constexpr std::size_t kReportedContoursMax = 1000;
struct Contour {
  machine::Place place;  // that switched the beam on
  SimTime begin{0};
  SimTime time{0};  // with the beam on
  double length_mm = 0.0;
  double slow_mm = 0.0;  // of it below kSlowSpeed of the speed asked for, as slow_percent counts
  double cut_energy_j = 0.0;
  double pierce_energy_j = 0.0;  // on a standing tip

  double energy_j() const { return cut_energy_j + pierce_energy_j; }
  bool operator==(const Contour&) const = default;
};

// The most of something, and where that was.
struct Extreme {
  double value = 0.0;
  machine::Place place{};

  void Raise(double seen, const machine::Place& where) {
    if (seen > value) *this = {.value = seen, .place = where};
  }
  bool operator==(const Extreme&) const = default;
};

// How near the cuts of a beam keep to what is asked of them, at the worst place. By these a laser
// is judged: docs/verdict.md has the limits, decision 0021 their reasons.
inline constexpr double kSlowSpeed = 0.8;   // of the speed asked for: below it is slow
inline constexpr double kHotEnergy = 1.5;   // of the energy by length asked for: above it is hot
inline constexpr double kWeakEnergy = 0.8;  // of the same: below it is weak
inline constexpr double kEndZone_mm = 5.0;  // before the end of the travel of X, Y, Z
inline constexpr double kEndZone_rad = kRadPerDegree;  // of A and B
struct CutFigures {
  std::uint64_t contours = 0;
  SimTime longest{0};         // of the times of contours
  double energy_max_j = 0.0;  // of one contour

  // Of the length of a contour; the first and last ramp of one that comes to its speed left out.
  Extreme slow_percent;
  Extreme hot_mm;           // of a stretch
  Extreme weak_mm;          // of a stretch
  Extreme uncontrolled_mm;  // in all, where no speed is asked for; the first place
  Extreme standing_s;       // of one stand with power that is no piercing
  Extreme singular_rad;     // that A turns in one go within 1 degree of B = 0
  std::array<Extreme, motion::kAxisCount> near_end{};  // how far into the end zone of an axis

  bool operator==(const CutFigures&) const = default;
};

// A finding of the run; the same finding at the same step is counted, not repeated.
struct Finding {
  Diagnostic diagnostic;
  SimTime first_at{0};
  std::uint64_t count = 1;

  bool operator==(const Finding&) const = default;
};

// An axis that a step takes out of its travel: the worst time that it did. motion.md 2.6.
inline constexpr std::size_t kReportedViolationsMax = machine::kDiagnosticsMax;
struct AxisViolation {
  machine::Place place;
  std::string axis;  // "X"
  bool rotary = false;
  double excess = 0.0;     // mm or rad
  bool at_target = false;  // the target lies outside; else the path on the way
  motion::AxisPose axes;   // where it is worst
  motion::MachinePoint tip;
  SimTime first_at{0};  // that the step did it: a motion begins
  std::uint64_t count = 1;

  bool operator==(const AxisViolation&) const = default;
};

// A place seen from above, from the work origin.
struct PlanePlace {
  double x_mm = 0.0;
  double y_mm = 0.0;

  bool operator==(const PlanePlace&) const = default;
};

// What is left of a block beside what should be.
struct TargetFigures {
  double tolerance_mm = 0.0;  // up to which a difference is none
  double left_mm = 0.0;       // highest of what stands above the target
  PlanePlace left_at;         // where that is
  double left_mm3 = 0.0;
  double deep_mm = 0.0;  // deepest of what is missing below the target
  PlanePlace deep_at;    // where that is
  double deep_mm3 = 0.0;
  double good_percent = 0.0;  // of the area that is compared: within the tolerance
  double compared_mm2 = 0.0;

  bool operator==(const TargetFigures&) const = default;
};

// What the edges of a mill took off, beside what is usual for tool and material. Passes in material
// alone, where it is not said of plunges.
struct ChipFigures {
  double thick_percent = 0.0;  // greatest chip load, of the most that is usual
  machine::Place thick_place;
  double plunge_percent = 0.0;  // the same of plunges
  machine::Place plunge_place;
  double thin_percent = 0.0;  // how much the least one is below the least that is usual
  machine::Place thin_place;
  double speed_percent = 0.0;  // greatest speed of an edge, of the most that is usual
  machine::Place speed_place;

  bool operator==(const ChipFigures&) const = default;
};

// What a mill took off a block, when it was told of block and tool. motion.md 8.2, 9.
struct MillingFigures {
  double removed_mm3 = 0.0;
  std::uint64_t gouges = 0;     // motions at travel speed through material
  double gouge_depth_mm = 0.0;  // of the deepest
  machine::Place gouge_place;   // where that was
  SimTime gouge_at{0};
  double below_mm = 0.0;          // how far the tool went below the block
  machine::Place below_place;     // where it did first
  double remaining_mm3 = 0.0;     // of the block
  double deepest_cut_mm = 0.0;    // below its top
  double tool_diameter_mm = 0.0;  // of the cutting part
  double deepest_pass_mm = 0.0;   // most that one motion across took off over a cell
  machine::Place pass_place;      // where that was
  double fast_plunge_mm = 0.0;    // most that a way down took off nearly as fast as Z travels
  double fast_plunge_mm_s = 0.0;  // how fast that was
  machine::Place fast_plunge_place;
  double pass_mm_s = 0.0;        // of the fastest motion across in material
  double shank_depth_mm = 0.0;   // deepest that shank or holder went into material
  machine::Place shank_place;    // where that was
  double beside_mm = 0.0;        // way in the work with the tool far beside the block
  machine::Place beside_place;   // where that began
  double beside_x_low_mm = 0.0;  // how far it leads beyond each edge
  double beside_x_high_mm = 0.0;
  double beside_y_low_mm = 0.0;
  double beside_y_high_mm = 0.0;
  double cell_mm = 0.0;                   // edge of the cells that the block is looked at in
  double reach_mm = 0.0;                  // how far the tool went below its top, over the block
  machine::Place reach_place;             // where it was deepest
  double reach_width_mm = 0.0;            // of the tool at the top of the block, there
  std::optional<TargetFigures> target{};  // nothing: there is none
  std::optional<ChipFigures> chips{};     // nothing: the material is not told

  bool operator==(const MillingFigures&) const = default;
};

// How far a product went before its budget was used up.
struct ProductState {
  bool made = false;
  bool complete = true;       // false: cut off at the budget
  std::uint64_t records = 0;  // trace records; toolpath points; picture elements
  std::uint64_t bytes = 0;    // toolpath
  std::uint64_t dropped = 0;  // records that did not fit

  bool operator==(const ProductState&) const = default;
};

std::string_view OutcomeText(machine::OutcomeKind kind);  // "completed", "budget_exceeded" ...

// Every figure that a job and each of its programs has. motion.md 8.2.
struct ScopeFigures {
  WorkFigures total;  // of the job: time.total() == cycle_time
  BeamHistogram beam;
  CornerFigures corners;
  SpeedShortfall shortfall;

  machine::ProgramBox programmed;
  machine::Box tip;     // where the tip was, machine frame; true extremes of arcs
  machine::Box cut;     // where it cut
  machine::Box column;  // gantry: the column; mill: the same as the tip
  AxisFigures tip_figures;
  std::vector<AxisFigures> axes;

  bool operator==(const ScopeFigures&) const = default;
};

// Collisions are not modelled: the machine knows neither part nor fixture.
struct RunReport : ScopeFigures {
  std::string family;            // "optimo"
  machine::MachineUsed machine;  // its profile, and what was changed of that
  std::string title;             // of the program: its name
  std::string engine_version;
  std::string inputs_hash;  // of everything the run depends on; see input_description.h
  std::map<std::string, std::string> changed_parameters;  // those that differ from the defaults

  bool finished = false;         // false: a report on the way
  machine::Outcome outcome;      // meaningless before
  machine::Judgement judgement;  // the same
  SimTime cycle_time{0};
  std::uint64_t steps_executed = 0;
  std::uint64_t halts = 0;
  FinalPosition final_position;
  std::optional<motion::MachinePoint> work_origin;  // machine frame; Z: the surface

  std::uint64_t lookahead_starved = 0;  // knots that the planner decided before it saw enough

  std::map<int, ScopeFigures> programs;  // by slot; at most kReportedProgramsMax
  std::vector<StepFigures> steps;  // by program and step; the first kReportedStepsMax that ran
  WorkFigures rest;                // of all other steps

  std::vector<Finding> findings;  // in order of first occurrence; at most machine::kDiagnosticsMax
  UntoldFindings findings_dropped;
  std::vector<SlowMove> slow_moves;       // in order of first occurrence
  std::uint64_t slow_moves_dropped = 0;   // at further steps, past kReportedSlowMovesMax
  std::vector<AxisViolation> violations;  // in order of first occurrence
  std::uint64_t violations_dropped = 0;   // at further steps, past kReportedViolationsMax
  std::vector<Contour> contours;          // of a beam, in order of time
  std::uint64_t contours_dropped = 0;     // further ones, past kReportedContoursMax
  CutFigures cut_figures;                 // of them all
  std::vector<machine::Figure> figures;   // the family's own
  std::optional<MillingFigures> milling;  // nothing: not asked for

  ProductState trace;
  ProductState toolpath;
  ProductState picture;
};

}  // namespace rmlcell::simulation
