#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/observer.h"
#include "engine/machine/shape.h"

// The machine at evenly spaced instants of virtual time, as lines of text. motion.md section 9.
namespace rmlcell::simulation {

inline constexpr double kSampleRateMin_hz = 1.0;
inline constexpr double kSampleRateMax_hz = 10'000.0;  // finer than any servo of these machines

// Takes some whole lines, valid during the call. False: no more.
using SampleSink = std::function<bool(std::string_view lines)>;

// Errors: CellUsage when the rate is not within its limits.
Result<double> ParseSampleRate(std::string_view text);

// Writes CSV: a line of headings, then one line for each t = k / rate (computed anew, not added
// up), and one at every event: a signal, a halt, the end. Columns: t_s; X_mm Y_mm Z_mm A_rad B_rad
// of the axes; tip_x_mm tip_y_mm tip_z_mm; speed_mm_s of the tip; power_percent; program, step;
// event (empty for the evenly spaced ones). What is not told in motions stands still; lines begin
// when the first position is known: by StandsAt, else the first motion. Memory is bounded.
class SampleRecorder final : public machine::RunObserver {
 public:
  // Preconditions: the rate is within its limits, `sink` is not empty.
  SampleRecorder(const machine::MachineShape& shape, double rate_hz, SampleSink sink);
  ~SampleRecorder() override;

  // Before anything is told: where the machine stands.
  void StandsAt(const motion::TipPose& tip, const motion::AxisPose& axes);

  void OnMotion(const machine::MotionDone& done) override;
  void OnWait(const machine::Wait& wait) override;
  void OnSignal(const machine::SignalChange& change) override;
  void OnHalt(const machine::Halt& halt) override;

  // Once, when the run is over.
  void Finish(SimTime at);

  std::uint64_t lines() const;  // without the headings
  bool complete() const;        // false: the sink took no more

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rmlcell::simulation
