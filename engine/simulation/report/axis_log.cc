#include "engine/simulation/report/axis_log.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace rmlcell::simulation {
namespace {

constexpr std::array<std::string_view, motion::kAxisCount> kAxisNames = {"X", "Y", "Z", "A", "B"};
constexpr std::size_t kFirstRotary = 3;

double Finite(double limit) { return std::isfinite(limit) ? limit : 0.0; }

}  // namespace

std::string_view AxisName(int axis) { return kAxisNames[static_cast<std::size_t>(axis)]; }
bool IsRotaryAxis(int axis) { return static_cast<std::size_t>(axis) >= kFirstRotary; }

void AxisLog::AddSweep(Axis& axis, const CoordinateSweep& sweep) {
  axis.minimum = axis.seen ? std::min(axis.minimum, sweep.minimum) : sweep.minimum;
  axis.maximum = axis.seen ? std::max(axis.maximum, sweep.maximum) : sweep.maximum;
  axis.seen = true;
  if (sweep.travel == 0.0) return;
  axis.travel.Add(sweep.travel);
  axis.reversals += static_cast<std::uint64_t>(sweep.turns);
  if (sweep.first_sign != 0 && axis.last_sign == -sweep.first_sign) ++axis.reversals;
  if (sweep.last_sign != 0) axis.last_sign = sweep.last_sign;
}

void AxisLog::Add(const Motion& motion) {
  for (std::size_t i = 0; i < kFirstRotary; ++i) AddSweep(axes_[i], motion.xyz[i]);
  AddSweep(axes_[3], motion.ab[0]);
  AddSweep(axes_[4], motion.ab[1]);
  peaks_.Raise(motion.peaks);
  tip_path_.Add(motion.tip_path_mm);
  if (!motion.tip_limited) return;
  limited_peak_speed_ = std::max(limited_peak_speed_, motion.peaks.tip_speed);
  limited_peak_acceleration_ = std::max(limited_peak_acceleration_, motion.peaks.tip_acceleration);
}

MotionPeaks AxisLog::Known(bool tip_limited) const {
  MotionPeaks known = peaks_;
  if (tip_limited) {
    known.tip_speed = limited_peak_speed_;
    known.tip_acceleration = limited_peak_acceleration_;
  }
  return known;
}

void AxisLog::WriteTo(ScopeFigures& scope) const {
  scope.axes.clear();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    const bool rotary = i >= kFirstRotary;
    if (rotary && !shape_.five_axis && axis.travel.value() == 0.0) continue;
    AxisFigures figures{.name = std::string(kAxisNames[i]),
                        .rotary = rotary,
                        .travel = axis.travel.value(),
                        .minimum = axis.minimum,
                        .maximum = axis.maximum,
                        .peak_speed = peaks_.axis_speed[i],
                        .peak_acceleration = peaks_.axis_acceleration[i],
                        .peak_jerk = peaks_.axis_jerk[i],
                        .reversals = axis.reversals};
    if (shape_.limits) {
      figures.speed_limit = shape_.limits->axes.speed[i];
      figures.acceleration_limit = shape_.limits->axes.acceleration[i];
      figures.jerk_limit = Finite(shape_.limits->axes.jerk[i]);
    }
    scope.axes.push_back(std::move(figures));
  }
  scope.tip_figures = {.name = "tip",
                       .travel = tip_path_.value(),
                       .peak_speed = peaks_.tip_speed,
                       .peak_acceleration = peaks_.tip_acceleration,
                       .peak_jerk = peaks_.tip_jerk};
  if (shape_.limits) {
    const bool speed_limited = peaks_.tip_speed <= limited_peak_speed_;
    const bool acceleration_limited = peaks_.tip_acceleration <= limited_peak_acceleration_;
    scope.tip_figures.speed_limit = speed_limited ? shape_.limits->tip_speed_mm_s : 0.0;
    scope.tip_figures.acceleration_limit =
        acceleration_limited ? shape_.limits->tip_acceleration_mm_s2 : 0.0;
    scope.tip_figures.jerk_limit = Finite(shape_.limits->tip_jerk_mm_s3);
  }
}

}  // namespace rmlcell::simulation
