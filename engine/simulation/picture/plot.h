#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/observer.h"
#include "engine/machine/shape.h"
#include "engine/simulation/picture/time_envelope.h"
#include "engine/simulation/report/report.h"

// Curves over virtual time as SVG: what the tip, the beam and the axes did. Drawn from the profiles
// themselves, so that every peak is there.
namespace rmlcell::simulation {

enum class PlotCurve {
  kSpeed,  // of the tip, mm/s, with the feed rate asked for
  kPower,  // of the beam, percent of its rated power
  kAxes,   // positions of the axes that moved, mm and rad
};

// "speed,power,axes", in the order wanted. Errors: CellUsage for an unknown name, a name twice or
// none at all.
Result<std::vector<PlotCurve>> ParsePlotCurves(std::string_view text);

// The series of what is collected.
struct PlotSeries {
  static constexpr std::size_t kSpeed = 0;      // mm/s
  static constexpr std::size_t kFeed = 1;       // mm/s asked for; 0: as fast as the axes can
  static constexpr std::size_t kPower = 2;      // percent
  static constexpr std::size_t kFirstAxis = 3;  // X Y Z A B, mm and rad
};

struct PlotOptions {
  std::vector<PlotCurve> curves{PlotCurve::kSpeed, PlotCurve::kPower, PlotCurve::kAxes};
  int width_px = 1600;  // of the whole picture; its height follows
};

// Collects what a plot needs, in memory of fixed size.
class PlotRecorder final : public machine::RunObserver {
 public:
  explicit PlotRecorder(const machine::MachineShape& shape);
  ~PlotRecorder() override;

  void OnMotion(const machine::MotionDone& done) override;
  void OnWait(const machine::Wait& wait) override;
  void OnHalt(const machine::Halt& halt) override;
  void OnDiagnostic(SimTime at, const Diagnostic& diagnostic) override;

  // What is drawn, up to this time: the series of PlotSeries.
  const TimeEnvelope& Values(SimTime until) const;

  // A standalone SVG document: no script, nothing from outside. Title and duration come from the
  // report.
  std::string Svg(const RunReport& report, const PlotOptions& options) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rmlcell::simulation
