#pragma once

#include <map>
#include <optional>

#include "engine/machine/observer.h"
#include "engine/simulation/report/beam_work.h"
#include "engine/simulation/report/contour_log.h"
#include "engine/simulation/report/figure_log.h"
#include "engine/simulation/report/finding_list.h"
#include "engine/simulation/report/move_speeds.h"
#include "engine/simulation/report/report.h"
#include "engine/simulation/report/slow_move_list.h"
#include "engine/simulation/report/time_ledger.h"
#include "engine/simulation/report/violation_list.h"
#include "engine/simulation/report/work_table.h"

namespace rmlcell::simulation {

// Adds up what a run tells into the figures of its report, in bounded memory. Every nanosecond of
// virtual time is counted once: under the motion or wait that covers it, else as standstill (or as
// waiting for the operator, while halted).
class ReportRecorder final : public machine::RunObserver {
 public:
  // Without `each_step` the report has no row for each step, of which there may be ten thousand.
  explicit ReportRecorder(const machine::MachineShape& shape, bool each_step = true);

  void OnStep(SimTime at, const machine::Place& place, std::string_view instruction) override;
  void OnMotion(const machine::MotionDone& done) override;
  // The same for who has the shape of what was ridden.
  void Add(const machine::MotionDone& done, PartShape& shape);
  void OnMove(const machine::MoveDone& move) override;
  void OnSignal(const machine::SignalChange& change) override;
  void OnWait(const machine::Wait& wait) override;
  void OnHalt(const machine::Halt& halt) override;
  void OnResume(SimTime at, const machine::Place& place) override;
  void OnEntered(SimTime at) override;
  void OnViolation(const machine::TravelViolation& violation) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;
  void OnCounted(SimTime at, const Diagnostic& diagnostic) override;

  // Once, first: of a run that begins at a step its time and its steps up to there are nobody's,
  // and so is what it does on the way there. LIVE-6.09
  void Begin(const machine::Run& run);

  // Once, when the run is over: what nothing was told about since is standstill.
  void Finish(SimTime at);

  // The figures of what was told so far; a motion under way is not in them.
  RunReport Report(const machine::Run& run) const;

 private:
  // What goes on now, for time that nothing is told about.
  TimeLedger::Gap Now() const { return {{}, {}, place_, beam_on_, halted_}; }
  void CountStandstill(const TimeLedger::Gap& gap);
  bool Cuts(const machine::MotionDone& done) const;
  void AddLengths(const machine::MotionDone& done, double length, WorkFigures& work);
  void AddShape(const machine::MotionDone& done, PartShape& shape, double profile_end_s,
                const WorkFigures& work);
  FigureLog* LogOf(int program);
  bool HasItsOwn(int program);
  SimTime ShutterShare(SimTime end, SimTime claimed);
  void CloseShutter(SimTime at, const machine::Place& place);

  machine::MachineShape shape_;
  TimeLedger time_;
  WorkTable work_;
  bool each_step_;
  FigureLog job_;
  std::map<int, FigureLog> programs_;  // of those that work_ has room for
  std::optional<int> only_program_;    // its figures, but for the beam, are those of job_
  bool several_programs_ = false;
  BeamWork beam_;
  ContourLog contours_;
  MoveSpeeds speeds_;
  SlowMoveList slow_moves_;
  FindingList findings_;
  ViolationList violations_;
  machine::Place place_;
  bool halted_ = false;
  std::uint64_t halts_ = 0;
  std::uint64_t steps_before_ = 0;
  bool approaching_ = false;

  bool beam_on_ = false;
  bool stands_since_beam_on_ = false;  // no motion yet: a dwell is a pierce
  bool pierce_counted_ = false;
  bool shutter_open_ = false;
  SimTime shutter_since_{0};
  SimTime shutter_counted_{0};  // since then, under what went on meanwhile
  bool plunging_ = false;

  FinalPosition last_;
};

}  // namespace rmlcell::simulation
