#include "engine/simulation/picture/plot.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/core/catalogue.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/simulation/path/profile_phases.h"
#include "engine/simulation/picture/plot_page.h"

namespace rmlcell::simulation {
namespace {

constexpr std::array<std::string_view, 3> kCurveNames = {"speed", "power", "axes"};
constexpr std::size_t kMarksMax = 40;  // more would cover the curves

}  // namespace

Result<std::vector<PlotCurve>> ParsePlotCurves(std::string_view text) {
  std::vector<PlotCurve> curves;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view name = text.substr(begin, end - begin);
    begin = end + 1;
    const auto found = std::find(kCurveNames.begin(), kCurveNames.end(), name);
    if (found == kCurveNames.end()) {
      return Error{
          ErrorCode::kCellUsage, "'" + Told("word", name) + "': curves are speed, power, axes", {}};
    }
    const auto curve = static_cast<PlotCurve>(found - kCurveNames.begin());
    if (std::find(curves.begin(), curves.end(), curve) != curves.end()) {
      return Error{ErrorCode::kCellUsage, "'" + Told("word", name) + "' is there twice", {}};
    }
    curves.push_back(curve);
  }
  return curves;
}

struct PlotRecorder::State {
  explicit State(const machine::MachineShape& machine) : shape(machine) {}

  // Between what motions and waits cover nothing moves and the beam is off.
  void StandUntil(SimTime at) {
    if (at <= told) return;
    values[PlotSeries::kSpeed] = values[PlotSeries::kFeed] = values[PlotSeries::kPower] = 0.0;
    if (!curves.envelope.buckets().empty()) curves.envelope.Add(told, values);
    if (!curves.envelope.buckets().empty()) curves.envelope.Add(at, values);
    told = at;
  }

  void Look(const machine::MotionDone& done, const motion::MotionView& view, double t_s) {
    const motion::TrajectoryPoint point =
        view.At(TimeWithin(*done.motion, done.profile_start_s + t_s));
    const double speed = point.tip_speed();
    values[PlotSeries::kSpeed] = speed;
    values[PlotSeries::kFeed] = done.programmed_mm_s;
    values[PlotSeries::kPower] =
        done.beam_on ? std::clamp(done.power.constant_percent + done.power.percent_per_mm_s * speed,
                                  0.0, 100.0)
                     : 0.0;
    const motion::AxisValues axes =
        shape.five_axis ? point.axes
                        : motion::AxisValues{point.tip.tip.x(), point.tip.tip.y(),
                                             point.tip.tip.z(), point.tip.a_rad, 0.0};
    std::copy(axes.begin(), axes.end(), values.begin() + PlotSeries::kFirstAxis);
    if (!std::exchange(moved, true)) {  // until now they stood here, and nobody had told where
      for (std::size_t k = 0; k < motion::kAxisCount; ++k)
        curves.envelope.Amend(PlotSeries::kFirstAxis + k, axes[k]);
    }
    curves.envelope.Add(std::min(done.start + FromSeconds(t_s), done.end), values);
  }

  // From `t_s` up to, not including, `end_s`: twice a bucket.
  void LookThrough(const machine::MotionDone& done, const motion::MotionView& view, double t_s,
                   double end_s) {
    while (t_s < end_s) {
      Look(done, view, t_s);
      t_s += 0.5 * ToSeconds(curves.envelope.width());
    }
  }

  machine::MachineShape shape;
  PlotPage::Curves curves;
  TimeEnvelope::Values values{};
  SimTime told{0};  // the curves are known up to here
  bool moved = false;
};

PlotRecorder::PlotRecorder(const machine::MachineShape& shape)
    : state_(std::make_unique<State>(shape)) {}
PlotRecorder::~PlotRecorder() = default;

void PlotRecorder::OnMotion(const machine::MotionDone& done) {
  if (done.motion == nullptr || done.end < done.start) return;
  state_->StandUntil(done.start);
  const motion::MotionView view(*done.motion);
  const double whole = ToSeconds(done.end - done.start);
  double t = 0.0;
  ForEachPhase(done.motion->speed, done.profile_start_s, done.profile_start_s + whole,
               [&](const PhasePart& part) {
                 const double end = t + part.duration_s;
                 // Where the acceleration is zero the speed has its peak.
                 const double peak = t + part.LevelAt();
                 state_->LookThrough(done, view, t, peak);
                 state_->LookThrough(done, view, peak, end);
                 t = end;
               });
  // What is left is settling: it stands.
  state_->Look(done, view, std::min(t, whole));
  state_->Look(done, view, whole);
  state_->told = std::max(state_->told, done.end);
}

void PlotRecorder::OnWait(const machine::Wait& wait) {
  state_->StandUntil(wait.start);
  TimeEnvelope::Values& values = state_->values;
  values[PlotSeries::kSpeed] = values[PlotSeries::kFeed] = 0.0;
  values[PlotSeries::kPower] = wait.beam_on ? wait.power_percent : 0.0;
  if (wait.end < state_->told) return;
  state_->curves.envelope.Add(state_->told, values);
  state_->curves.envelope.Add(wait.end, values);
  state_->told = wait.end;
}

void PlotRecorder::OnHalt(const machine::Halt& halt) {
  if (state_->curves.marks.size() >= kMarksMax) return;
  state_->curves.marks.push_back({halt.at, std::string(halt.why), false});
}

void PlotRecorder::OnDiagnostic(SimTime at, const Diagnostic& diagnostic) {
  if (diagnostic.severity == Severity::kAdvice || diagnostic.severity == Severity::kMessage) return;
  if (state_->curves.marks.size() >= kMarksMax) return;
  const bool warning = diagnostic.severity == Severity::kWarning;
  state_->curves.marks.push_back({at, CodeText(diagnostic.code), !warning});
}

const TimeEnvelope& PlotRecorder::Values(SimTime until) const {
  state_->StandUntil(until);
  return state_->curves.envelope;
}

std::string PlotRecorder::Svg(const RunReport& report, const PlotOptions& options) const {
  state_->StandUntil(report.cycle_time);
  return PlotPage(state_->curves, state_->shape, report, options).Svg();
}

}  // namespace rmlcell::simulation
