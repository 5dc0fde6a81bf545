#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"

namespace rmlcell::rml1 {

using Figures = std::map<std::string, double>;
Figures ByName(const std::vector<machine::Figure>& figures);

// Writes down what an observer is told, in order.
class RunRecord final : public machine::RunObserver {
 public:
  struct Motion {
    double start_s = 0.0;
    double end_s = 0.0;
    machine::Place place;
    machine::MotionUse use = machine::MotionUse::kTravel;
    motion::PlannedMotion planned;
    double travelled = 0.0;
    double programmed_mm_s = 0.0;
  };

  void OnStep(SimTime at, const machine::Place& place, std::string_view instruction) override;
  void OnMotion(const machine::MotionDone& motion) override;
  void OnMove(const machine::MoveDone& move) override;
  void OnSignal(const machine::SignalChange& change) override;
  void OnWait(const machine::Wait& wait) override;
  void OnHalt(const machine::Halt& halt) override;
  void OnResume(SimTime at, const machine::Place& place) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;

  // "0.000 step 1 PU", "0.741 move 100,0,500 at 60": one line an event, times to a microsecond.
  const std::string& text() const { return text_; }
  // The events without their times, one a line: "move 100,0,500", "spin 4500", "dwell 0.1".
  std::vector<std::string> Events() const { return events_; }
  std::string CommandLog() const;  // codes 1..3, "1,2,2"
  const std::vector<Motion>& motions() const { return motions_; }
  const std::vector<machine::MoveDone>& moves() const { return moves_; }
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }
  int CountOf(ErrorCode code) const;

  bool keep_events = true;  // off for long programs: diagnostics alone are kept

 private:
  void Add(SimTime at, const std::string& event);

  std::string text_;
  std::vector<std::string> events_;
  std::vector<Motion> motions_;
  std::vector<machine::MoveDone> moves_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace rmlcell::rml1
