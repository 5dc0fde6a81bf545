#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"

namespace rmlcell::optimo::testing {

// The tip where a new machine stands: home, the head 300 mm long and straight down. OPT-B.02
inline const motion::MachinePoint kHomeTip{21.02, 2201.2, -350.0};

// What a run told, as words in order: "beam on 95", "shutter open", "OL[11] 1", "schedule 11",
// "wait pierce 1.5", "halt STOP", "E7408" ...
struct Ran {
  // Where and when something was told.
  struct Event {
    std::string what;
    double at_s = 0.0;
    int program = 0;
    int step = 0;
  };
  // A motion, or a part of one.
  struct Part {
    motion::PlannedMotion motion;
    machine::MotionDone done;  // its `motion` is null: use the copy

    double SpeedAt(double t_s) const;  // mm/s, t_s after `done.start`
    double PowerAt(double t_s) const;  // percent; 0 while the beam is off
    double duration_s() const { return ToSeconds(done.end - done.start); }
  };

  machine::Outcome outcome;
  std::vector<std::string> told;
  std::vector<Event> events;  // parallel to `told`
  std::vector<Diagnostic> findings;
  std::vector<machine::MoveDone> moves;
  std::vector<Part> parts;
  std::vector<machine::Wait> waits;
  std::vector<machine::TravelViolation> violations;
  std::vector<int> steps_begun;                  // step numbers in order, of whatever program
  std::string machine_state;                     // as the run left it
  std::map<int, std::string> executables;        // made by the run
  std::map<std::string, std::string> variables;  // those asked for
  double time_s = 0.0;
  std::uint64_t steps = 0;
  machine::RunState end;

  bool Told(const std::string& what) const;
  int Count(const std::string& what) const;
  // Preconditions: it was told.
  const Event& First(const std::string& what) const;
  const Diagnostic& Finding(int code) const;
  double DistanceTo(
      const motion::MachinePoint& point) const;  // of the tip path, where it comes nearest
  double BeamOnLength() const;                   // mm of tip path with the beam on
};

struct RunOptions {
  std::map<int, std::string> programs;  // further ones, by slot; the first is program 1
  machine::InputScript inputs;
  machine::Mode mode = machine::Mode::kCycle;
  std::map<std::string, std::string> parameters;
  std::vector<std::string> variables;
  std::optional<machine::ProgramStep> breakpoint;
  std::optional<machine::ProgramStep> simul;
  double override_percent = 100.0;
  machine::RunBudget budget;
  std::string profile;
  // The run is saved then, goes on to its end, and is restored and goes on again: the second end
  // counts.
  std::optional<SimTime> restore_at;
  std::string machine_state;
  std::vector<machine::LaserSchedule> schedules;
  std::map<int, std::string> executables;      // by slot
  SimTime slice = std::chrono::seconds(1000);  // of one Advance
  bool forecast = false;
};

// A setup of `main` as program 1, to be run by hand.
machine::RunSetup SetupOf(const std::string& main, const RunOptions& options = {});

// A run of it, to be advanced; nobody is told anything.
std::unique_ptr<machine::Run> RunOfText(const std::string& main, const RunOptions& options = {});

// Compiles `main` as program 1 and runs it to its end, or until nothing more happens.
Ran RunText(const std::string& main, const RunOptions& options = {});

// The value that a variable has in the end.
std::string Value(const std::string& text, const std::string& variable, RunOptions options = {});

// A program, a variable, and the value that it has in the end.
struct ValueRow {
  std::string text;
  std::string variable;
  std::string wanted;
};

void ExpectValues(const std::vector<ValueRow>& rows, const RunOptions& options = {});

// The number of the code that a run ended with; 0: none.
int CodeOf(const Ran& ran);

SimTime At(double seconds);

// How programs begin: steps 1 and 2.
inline const std::string kAbsol = "COORD ABSOL\nPATH LIN\n";
// Steps 1 to 4, which bring the tip to (1000,1000,-400); at SPEED 10 from there on.
inline const std::string kThere = kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 10\n";

// From the end of a motion until the next may begin.
inline constexpr double kSettle_s = 0.048;

}  // namespace rmlcell::optimo::testing
