#pragma once

#include <memory>

#include "engine/machine/shape.h"
#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/picture/picture.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/report/report.h"
#include "engine/simulation/report/samples.h"
#include "engine/simulation/report/trace.h"
#include "engine/simulation/run/input_description.h"
#include "engine/simulation/toolpath/toolpath_recorder.h"

namespace rmlcell::simulation {

// What to make of a run besides its report.
struct Products {
  TraceSink trace{};  // empty: no trace
  std::uint64_t trace_records_max = kTraceRecordsMax;
  ToolpathSink toolpath{};  // empty: no toolpath
  ToolpathOptions toolpath_options{};
  bool each_step = true;  // the report has a row for each step
  bool picture = false;
  bool plot = false;
  SampleSink samples{};  // empty: no samples
  double samples_hz = 1000.0;
  std::optional<Milling> milling{};      // checked; nothing: material is not modelled
  ParallelFor* parallel = nullptr;       // for its material; may be null; outlives the recorder
  machine::RunObserver* also = nullptr;  // told everything too, before the products; may be null
};

// The observer that makes the products. One per run; must outlive it.
class Recorder final : public machine::RunObserver {
 public:
  Recorder(const machine::MachineShape& shape, InputDescription inputs, Products products);
  ~Recorder() override;

  void OnStep(SimTime at, const machine::Place& place, std::string_view instruction) override;
  void OnMotion(const machine::MotionDone& done) override;
  void OnMove(const machine::MoveDone& move) override;
  void OnSignal(const machine::SignalChange& change) override;
  void OnWait(const machine::Wait& wait) override;
  void OnHalt(const machine::Halt& halt) override;
  void OnResume(SimTime at, const machine::Place& place) override;
  void OnEntered(SimTime at) override;
  void OnProgram(SimTime at, const machine::Place& place, std::string_view what,
                 int program) override;
  void OnMessage(SimTime at, const machine::Place& place, std::string_view text) override;
  void OnLost(const machine::LostWay& way) override;
  void OnViolation(const machine::TravelViolation& violation) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;
  void OnCounted(SimTime at, const Diagnostic& diagnostic) override;
  void OnAssumed(const machine::Assumed& assumed) override;

  // Once, before the run goes on: where the machine stands.
  void Begin(const machine::Run& run);

  // A product reached its budget and is cut off.
  bool cut_off() const;

  const InputDescription& inputs() const;

  // The block of the toolpath that is not full yet; empty: there is none.
  std::string OpenToolpathBlock() const;

  // The report up to now. Whole after Finish.
  RunReport Report(const machine::Run& run) const;

  // Once, when the run is over: closes trace and toolpath.
  void Finish(const machine::Run& run);

  // Null when material is not modelled.
  MillingRecorder* milling() const;

  // Empty when no picture was asked for.
  std::string Svg(const RunReport& report, const PictureOptions& options) const;

  // What a plot draws, up to this time (PlotSeries); null when none was asked for.
  const TimeEnvelope* Values(SimTime until) const;

  // Empty when no plot was asked for.
  std::string PlotSvg(const RunReport& report, const PlotOptions& options) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rmlcell::simulation
