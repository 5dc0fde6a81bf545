#include "engine/simulation/report/contour_log.h"

#include <algorithm>
#include <cmath>

#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::simulation {
namespace {

constexpr double kNearStraightDown_rad = kRadPerDegree;  // motion.md 2.5
constexpr double kRounding = 1e-6;                       // mm, rad; motion.md section 1
constexpr double kLeastCut_mm = 0.01;                    // a point: it has no speed to keep

// How much of a range lies within 1 degree of straight down: A and B go in step.
double ShareNearSingular(const CoordinateSweep& b) {
  const double low = std::max(b.minimum, -kNearStraightDown_rad);
  const double high = std::min(b.maximum, kNearStraightDown_rad);
  if (low > high) return 0.0;
  const double range = b.maximum - b.minimum;
  return range > 0.0 ? (high - low) / range : 1.0;
}

// How much of the ramp from rest to this speed is slow.
double SlowLengthOfRamp(double speed_mm_s, const motion::PathLimits& limits) {
  const double length = motion::RampLength(0.0, speed_mm_s, limits);
  const auto ramp = motion::SpeedProfile::Span(length, 0.0, speed_mm_s, limits);
  for (int k = 0; k < ramp.phase_count(); ++k) {
    const auto& [duration_s, jerk, start] = ramp.phase(k);
    const double change = kSlowSpeed * speed_mm_s - start.speed;
    const bool last = k + 1 == ramp.phase_count();
    if (!last && ramp.phase(k + 1).start.speed < start.speed + change) continue;
    // Both roots of the speed by time, without a difference of like numbers.
    const double a = start.acceleration;
    const double t = 2.0 * change / (a + std::sqrt(std::max(0.0, a * a + 2.0 * jerk * change)));
    return start.s + t * (start.speed + t * (0.5 * a + t * jerk / 6.0));
  }
  return 0.0;
}

}  // namespace

ContourLog::ContourLog(const machine::MachineShape& shape) : limits_(shape.limits) {}

void ContourLog::BeamOn(SimTime at, const machine::Place& place) {
  if (state_ == State::kHeld) {
    state_ = State::kOpen;
    return;
  }
  Close();
  state_ = State::kOpen;
  contour_ = {.place = place, .begin = at};
}

// Of who tells of a beam that nobody switched on.
void ContourLog::OpenAt(SimTime at, const machine::Place& place) {
  if (state_ != State::kOpen) BeamOn(at, place);
}

void ContourLog::BeamOff() {
  EndStand();
  if (state_ == State::kOpen) state_ = State::kEnding;
}

void ContourLog::Halt() {
  if (state_ == State::kEnding) state_ = State::kHeld;
}

void ContourLog::Step() {
  if (state_ == State::kEnding) Close();
}

void ContourLog::Travel() {
  if (state_ != State::kNone) Close();
}

CutPace* ContourLog::PaceOf(const machine::MotionDone& done) {
  OpenAt(done.start, done.place);
  pace_.Begin(done.programmed_mm_s, done.power, done.place);
  return &pace_;
}

void ContourLog::Add(const Motion& motion) {
  const double length = motion.work.cut_mm;
  contour_.length_mm += length;
  AddTimes(motion.work);
  // A tip that only the head turns about stands, too.
  if (length > 0.0) {
    EndStand();
  } else {
    AddStand(ToSeconds(motion.work.time.motion), motion.done.power.PercentAt(0.0),
             motion.done.place);
  }
  AddStand(ToSeconds(motion.work.time.settling), motion.done.power.PercentAt(0.0),
           motion.done.place);
  AddAxes(motion);
}

void ContourLog::Add(const machine::Wait& wait, const WorkFigures& work, bool pierces) {
  OpenAt(wait.start, wait.place);
  AddTimes(work);
  if (!pierces) AddStand(ToSeconds(work.beam_on), wait.power_percent, wait.place);
}

void ContourLog::Add(const WorkFigures& work) { AddTimes(work); }

void ContourLog::AddTimes(const WorkFigures& work) {
  contour_.time += work.beam_on;
  contour_.cut_energy_j += work.cut_energy_j;
  contour_.pierce_energy_j += work.pierce_energy_j;
}

void ContourLog::AddStand(double seconds, double power_percent, const machine::Place& place) {
  if (!(seconds > 0.0 && power_percent > 0.0)) return;
  if (!(stand_.value > 0.0)) stand_.place = place;
  stand_.value += seconds;
}

void ContourLog::EndStand() {
  figures_.standing_s.Raise(stand_.value, stand_.place);
  stand_ = {};
}

void ContourLog::EndSwing() {
  figures_.singular_rad.Raise(singular_.value, singular_.place);
  singular_ = {};
}

void ContourLog::AddAxes(const Motion& motion) {
  const machine::Place& place = motion.done.place;
  const double share = ShareNearSingular(motion.rotary[1]);
  if (share > 0.0) {
    if (!(singular_.value > 0.0)) singular_.place = place;
    singular_.value += share * motion.rotary[0].travel;
  } else {
    EndSwing();
  }
  if (!limits_) return;
  const motion::AxisLimits& axes = limits_->axes;
  for (std::size_t i = 0; i < motion::kAxisCount; ++i) {
    const bool rotary = i >= motion.column.size();
    const CoordinateSweep& sweep =
        rotary ? motion.rotary[i - motion.column.size()] : motion.column[i];
    const double zone = rotary ? kEndZone_rad : kEndZone_mm;
    const double room =
        std::min(sweep.minimum - axes.travel_min[i], axes.travel_max[i] - sweep.maximum);
    // Beyond the end is told as that. An axis of hardly any travel has no middle to keep to.
    if (room >= zone || room < -kRounding) continue;
    if (axes.travel_max[i] - axes.travel_min[i] <= 4.0 * zone) continue;
    figures_.near_end[i].Raise(zone - room, place);
  }
}

// From rest to its speed, and to rest again: no contour can do without. One that never comes to its
// speed has no such ramps: all of it is slow.
double ContourLog::RampsLeftOut_mm() const {
  if (!limits_ || pace_.slow_mm() >= contour_.length_mm - kRounding) return 0.0;
  const motion::PathLimits tip{.speed = limits_->tip_speed_mm_s,
                               .acceleration = limits_->tip_acceleration_mm_s2,
                               .jerk = limits_->tip_jerk_mm_s3};
  return 2.0 * SlowLengthOfRamp(pace_.programmed_max_mm_s(), tip);
}

void ContourLog::Close() {
  if (state_ == State::kNone) return;
  state_ = State::kNone;
  EndStand();
  if (contour_.length_mm > kLeastCut_mm) {
    contour_.slow_mm = std::max(0.0, pace_.slow_mm() - RampsLeftOut_mm());
    figures_.slow_percent.Raise(100.0 * contour_.slow_mm / contour_.length_mm, contour_.place);
  }
  pace_.Close(figures_);
  EndSwing();
  if (contour_.time <= SimTime::zero()) return;
  ++figures_.contours;
  figures_.longest = std::max(figures_.longest, contour_.time);
  figures_.energy_max_j = std::max(figures_.energy_max_j, contour_.energy_j());
  if (contours_.size() < kReportedContoursMax) {
    contours_.push_back(contour_);
  } else {
    ++dropped_;
  }
}

void ContourLog::WriteTo(RunReport& report) const {
  ContourLog whole = *this;
  whole.Close();
  report.contours = std::move(whole.contours_);
  report.contours_dropped = whole.dropped_;
  report.cut_figures = whole.figures_;
}

}  // namespace rmlcell::simulation
