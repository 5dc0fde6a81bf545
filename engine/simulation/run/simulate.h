#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "engine/machine/family.h"
#include "engine/simulation/run/drive.h"
#include "engine/simulation/run/recorder.h"

// Drives a run through virtual time. Nothing here looks at a clock: who paces a run against real
// time calls Step with slices as real time passes.
namespace rmlcell::simulation {

// One run with its products, step by step; for workers.
//
//   Simulation simulation(run, recorder);
//   while (simulation.Step(slice) == machine::RunPhase::kRunning) Publish(simulation.state());
//   RunReport report = simulation.Finish();
//
// Cutting virtual time into other slices changes nothing in the products.
class Simulation {
 public:
  // The recorder must be the observer of the run, which has not begun. Both must outlive this.
  Simulation(machine::Run& run, Recorder& recorder);

  // Goes on by `slice` of virtual time, at most. While halted with scripted inputs to come, up to
  // the next of them. kHalted: nothing scripted will make it go on; apply a key, or end it.
  machine::RunPhase Step(SimTime slice) { return drive_.Step(slice); }
  // Where it is halted: START, or its end where that changes nothing. True: it was started.
  bool StartOrEnd() { return drive_.StartOrEnd(); }

  // A key or input at the present time. Hold, resume, stop and override act through this.
  void Apply(const machine::InputChange& input) { drive_.run().Apply(input); }

  // Ends the run here: CANCELLED with CellCancelled, or a budget of the caller with its code.
  void Cancel() { End(machine::OutcomeKind::kCancelled, ErrorCode::kCellCancelled); }
  void End(machine::OutcomeKind kind, ErrorCode code) { drive_.End(kind, code); }

  machine::RunPhase phase() const { return drive_.phase(); }
  bool finished() const { return drive_.finished(); }
  machine::RunState state() const { return drive_.run().state(); }
  std::uint64_t steps_executed() const { return drive_.run().steps_executed(); }
  bool cut_off() const { return recorder_.cut_off(); }  // a product is over its budget

  // The report so far, for people who watch.
  RunReport Report() const { return recorder_.Report(drive_.run()); }

  // Precondition: finished(). Closes the products; once.
  RunReport Finish();

 private:
  Recorder& recorder_;
  Drive drive_;
};

// A run at its beginning, with what watches it. The recorder and the run outlive their simulation.
struct BegunRun {
  std::unique_ptr<Recorder> recorder{};
  std::unique_ptr<machine::Run> run{};
  std::unique_ptr<Simulation> simulation{};
};
// Describes the inputs and makes all of it. Errors: those of MachineFamily::NewRun.
Result<BegunRun> Begin(const machine::MachineFamily& family, machine::RunSetup setup,
                       Products products);

// How far a run is; views are valid during the call.
struct Progress {
  machine::RunState state;
  std::uint64_t steps = 0;
  bool output_cut_off = false;
};

// What becomes of a run that waits for a key that is not scripted.
enum class AtHalt {
  kEnd,    // it ends as stopped, CellWaitsForever (9308), at the place of the halt
  kStart,  // START is given, every time
};

struct SimulationOptions {
  AtHalt at_halt = AtHalt::kEnd;
  bool end_when_cut_off = false;  // a product over its budget ends the run: CellOutputBudget (9306)
  SimTime slice = std::chrono::seconds(1);        // virtual time between two calls of `progress`
  std::function<bool(const Progress&)> progress;  // false cancels the run; may be empty
};

// Runs to the end.
RunReport RunToEnd(Simulation& simulation, const SimulationOptions& options);

struct SimulationResult {
  RunReport report;
  std::string svg;                                // empty when not asked for
  std::string plot;                               // empty when not asked for
  std::optional<HeightField> material;            // what is left of the block, when there is one
  std::optional<Target> target;                   // what that was compared with
  std::string machine_state;                      // for the next run on this machine
  std::map<int, std::string> executables;         // that the run made, by slot
  std::vector<machine::NamedVariable> variables;  // those asked for and known
};

// Everything in one call: describes the inputs, makes the run, drives it to its end, makes the
// products. Errors: those of MachineFamily::NewRun, a setup that makes no sense.
struct SimulationRequest {
  Products products;
  PictureOptions picture;
  PlotOptions plot;
  SimulationOptions options;
  std::vector<std::string> variables;  // to read at the end: "VR[5]"
};
Result<SimulationResult> Simulate(const machine::MachineFamily& family, machine::RunSetup setup,
                                  SimulationRequest request);

}  // namespace rmlcell::simulation
