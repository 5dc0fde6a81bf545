#include "engine/simulation/report/samples.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/number_text.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/path/profile_phases.h"
#include "engine/simulation/report/trace.h"

namespace rmlcell::simulation {
namespace {

constexpr std::size_t kBlockBytes = 1 << 16;  // handed out together
constexpr std::string_view kHeadings =
    "t_s,X_mm,Y_mm,Z_mm,A_rad,B_rad,tip_x_mm,tip_y_mm,tip_z_mm,speed_mm_s,power_percent,program,"
    "step,event\n";

}  // namespace

Result<double> ParseSampleRate(std::string_view text) {
  const std::optional<double> rate = ParseDouble(text);
  if (rate && *rate >= kSampleRateMin_hz && *rate <= kSampleRateMax_hz) return *rate;
  return Error{
      ErrorCode::kCellUsage, "'" + Told("word", text) + "': samples a second, 1 to 10000", {}};
}

struct SampleRecorder::State {
  State(const machine::MachineShape& machine, double rate, SampleSink to)
      : shape(machine), rate_hz(rate), sink(std::move(to)) {
    block = kHeadings;
  }

  double NextTime() const { return static_cast<double>(next) / rate_hz; }

  // Lines up to `until_s`, not including it, with the machine standing as it is.
  void StandUntil(double until_s) {
    if (!known) return;
    if (until_s > looked_s) speed = 0.0;
    for (; NextTime() < until_s && !closed; ++next) Line(NextTime(), {});
  }

  // The lines before it are still those of the place before.
  void Event(SimTime at, const machine::Place& of, std::string_view what) {
    StandUntil(ToSeconds(at));
    place = of;
    if (known) Line(ToSeconds(at), what);
  }

  void Line(double time_s, std::string_view event) {
    if (closed) return;
    const auto add = [&](double value, int decimals) {
      block += FixedText(value, decimals);
      block += ',';
    };
    add(time_s, 9);
    for (int i = 0; i < motion::kAxisCount; ++i) add(axes[i], i < 3 ? 6 : 9);
    add(tip.x(), 6);
    add(tip.y(), 6);
    add(tip.z(), 6);
    add(speed, 6);
    add(power, 4);
    block += std::to_string(place.program) + ',' + std::to_string(place.step) + ',';
    block += event;
    block += '\n';
    ++lines;
    if (block.size() >= kBlockBytes) HandOut();
  }

  void HandOut() {
    if (!closed && !block.empty() && !sink(block)) closed = true;
    block.clear();
  }

  void Look(const motion::TrajectoryPoint& point, double at_s) {
    looked_s = at_s;
    speed = point.tip_speed();
    StandAt(point.tip, point.axes);
  }

  void StandAt(const motion::TipPose& pose, const motion::AxisValues& of_axes) {
    tip = pose.tip;
    axes =
        shape.five_axis ? of_axes : motion::AxisValues{tip.x(), tip.y(), tip.z(), pose.a_rad, 0.0};
    known = true;
  }

  machine::MachineShape shape;
  double rate_hz;
  SampleSink sink;
  std::string block;
  std::uint64_t next = 0;  // k of the next evenly spaced line
  std::uint64_t lines = 0;
  bool closed = false;

  bool known = false;     // where the machine is
  double looked_s = 0.0;  // when it was there
  motion::AxisValues axes{};
  motion::MachinePoint tip;
  double speed = 0.0;
  double power = 0.0;
  machine::Place place;
};

SampleRecorder::SampleRecorder(const machine::MachineShape& shape, double rate_hz, SampleSink sink)
    : state_(std::make_unique<State>(shape, rate_hz, std::move(sink))) {
  RMLCELL_CHECK(state_->sink && rate_hz >= kSampleRateMin_hz && rate_hz <= kSampleRateMax_hz);
}
SampleRecorder::~SampleRecorder() = default;

void SampleRecorder::StandsAt(const motion::TipPose& tip, const motion::AxisPose& axes) {
  state_->StandAt(tip, {axes.column.x(), axes.column.y(), axes.column.z(), axes.a_rad, axes.b_rad});
}

void SampleRecorder::OnMotion(const machine::MotionDone& done) {
  if (done.motion == nullptr) return;
  State& s = *state_;
  const motion::MotionView view(*done.motion);
  const double start = ToSeconds(done.start);
  const double end = ToSeconds(done.end);
  if (!s.known) s.Look(view.At(done.profile_start_s), 0.0);  // it stood there before
  s.power = 0.0;
  s.StandUntil(start);
  s.place = done.place;
  for (; s.NextTime() < end && !s.closed; ++s.next) {
    s.Look(view.At(TimeWithin(*done.motion, done.profile_start_s + (s.NextTime() - start))),
           s.NextTime());
    s.power = done.beam_on
                  ? std::clamp(done.power.constant_percent + done.power.percent_per_mm_s * s.speed,
                               0.0, 100.0)
                  : 0.0;
    s.Line(s.NextTime(), {});
  }
  s.Look(view.At(TimeWithin(*done.motion, done.profile_start_s + (end - start))), end);
}

void SampleRecorder::OnWait(const machine::Wait& wait) {
  State& s = *state_;
  s.power = 0.0;
  s.StandUntil(ToSeconds(wait.start));
  s.place = wait.place;
  s.power = wait.beam_on ? wait.power_percent : 0.0;
  s.StandUntil(ToSeconds(wait.end));
}

void SampleRecorder::OnSignal(const machine::SignalChange& change) {
  std::string what(SignalName(change.signal));
  if (change.signal == machine::Signal::kOutput || change.signal == machine::Signal::kAnalogue) {
    what += ' ' + std::to_string(change.index);
  }
  state_->Event(change.at, change.place, what + " = " + ShortestText(change.value));
}

void SampleRecorder::OnHalt(const machine::Halt& halt) {
  state_->Event(halt.at, halt.place, "halt");
}

void SampleRecorder::Finish(SimTime at) {
  state_->power = 0.0;
  state_->Event(at, machine::Place(state_->place), "end");
  state_->HandOut();
}

std::uint64_t SampleRecorder::lines() const { return state_->lines; }
bool SampleRecorder::complete() const { return !state_->closed; }

}  // namespace rmlcell::simulation
