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
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].peak_speed = std::max(axes_[i].peak_speed, motion.peaks.axis_speed[i]);
    axes_[i].peak_acceleration =
        std::max(axes_[i].peak_acceleration, motion.peaks.axis_acceleration[i]);
    axes_[i].peak_jerk = std::max(axes_[i].peak_jerk, motion.peaks.axis_jerk[i]);
  }
  tip_path_.Add(motion.tip_path_mm);
  tip_peak_speed_ = std::max(tip_peak_speed_, motion.peaks.tip_speed);
  tip_peak_acceleration_ = std::max(tip_peak_acceleration_, motion.peaks.tip_acceleration);
  tip_peak_jerk_ = std::max(tip_peak_jerk_, motion.peaks.tip_jerk);
  if (!motion.tip_limited) return;
  limited_peak_speed_ = std::max(limited_peak_speed_, motion.peaks.tip_speed);
  limited_peak_acceleration_ = std::max(limited_peak_acceleration_, motion.peaks.tip_acceleration);
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
                        .peak_speed = axis.peak_speed,
                        .peak_acceleration = axis.peak_acceleration,
                        .peak_jerk = axis.peak_jerk,
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
                       .peak_speed = tip_peak_speed_,
                       .peak_acceleration = tip_peak_acceleration_,
                       .peak_jerk = tip_peak_jerk_};
  if (shape_.limits) {
    const bool speed_limited = tip_peak_speed_ <= limited_peak_speed_;
    const bool acceleration_limited = tip_peak_acceleration_ <= limited_peak_acceleration_;
    scope.tip_figures.speed_limit = speed_limited ? shape_.limits->tip_speed_mm_s : 0.0;
    scope.tip_figures.acceleration_limit =
        acceleration_limited ? shape_.limits->tip_acceleration_mm_s2 : 0.0;
    scope.tip_figures.jerk_limit = Finite(shape_.limits->tip_jerk_mm_s3);
  }
}

}  // namespace rmlcell::simulation
