#pragma once

#include <optional>

#include "engine/machine/observer.h"
#include "engine/machine/shape.h"
#include "engine/simulation/path/path_extent.h"
#include "engine/simulation/report/cut_pace.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// The contours of a run, and how well they are cut, in bounded memory.
//
//   none      the beam goes on      open
//   open      the beam goes off     ending
//   ending    halted by the same    held: the machine took the beam away, and gives it back
//   held      the beam goes on      open: the same contour
//   ending    anything else         over
class ContourLog {
 public:
  explicit ContourLog(const machine::MachineShape& shape);

  void BeamOn(SimTime at, const machine::Place& place);
  void BeamOff();
  void Halt();
  void Step();

  // Where the motion that is about to be counted shows its stretches; with the beam on.
  CutPace* PaceOf(const machine::MotionDone& done);
  // The motion: what it did, and how far the axes went.
  struct Motion {
    const machine::MotionDone& done;
    const WorkFigures& work;
    const PointSweep& column;
    const std::array<CoordinateSweep, 2>& rotary;
  };
  void Add(const Motion& motion);
  // A motion without the beam.
  void Travel();
  // A wait with the beam on.
  void Add(const machine::Wait& wait, const WorkFigures& work, bool pierces);
  // Standstill that nobody told about, with the beam on.
  void Add(const WorkFigures& work);

  // With what is open as far as it has come.
  void WriteTo(RunReport& report) const;

 private:
  enum class State { kNone, kOpen, kEnding, kHeld };

  void OpenAt(SimTime at, const machine::Place& place);
  void Close();
  void AddTimes(const WorkFigures& work);
  void AddStand(double seconds, double power_percent, const machine::Place& place);
  double RampsLeftOut_mm() const;
  void EndStand();
  void EndSwing();
  void AddAxes(const Motion& motion);

  std::optional<motion::MachineLimits> limits_;
  State state_ = State::kNone;
  Contour contour_;
  CutPace pace_;
  Extreme stand_;     // the one that goes on
  Extreme singular_;  // turning of A since B came near 0
  CutFigures figures_;
  std::vector<Contour> contours_;
  std::uint64_t dropped_ = 0;
};

}  // namespace rmlcell::simulation
