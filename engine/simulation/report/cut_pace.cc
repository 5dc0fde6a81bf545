#include "engine/simulation/report/cut_pace.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

constexpr double kFullPower_percent = 100.0;

}  // namespace

void CutPace::Stretch::Go(bool on, double way_mm, const machine::Place& where) {
  if (!on) return End();
  if (!(mm > 0.0)) place = where;
  mm += way_mm;
}

void CutPace::Stretch::End() {
  longest.Raise(mm, place);
  mm = 0.0;
}

// A constant power asks for its energy at the speed of the program. A ramp asks for the same at
// every speed (motion.md 8.1): it can only give less, where the power is at its limit.
void CutPace::Begin(double programmed_mm_s, const machine::PowerBySpeed& power,
                    const machine::Place& place) {
  programmed_ = programmed_mm_s;
  programmed_max_ = std::max(programmed_max_, programmed_mm_s);
  place_ = place;
  const double slope = power.percent_per_mm_s;
  ramped_ = slope > 0.0;
  asked_ = programmed_mm_s > 0.0 ? power.PercentAt(programmed_mm_s) / programmed_mm_s : 0.0;
  if (ramped_) asked_ = std::max(asked_, slope);
  const double above = kHotEnergy * asked_ - slope;
  bounds_ = {kSlowSpeed * programmed_mm_s, above > 0.0 ? power.constant_percent / above : 0.0,
             ramped_ ? kFullPower_percent / (kWeakEnergy * asked_) : 0.0};
}

void CutPace::Add(double duration_s, double tip_speed, double power_percent) {
  const double mm = tip_speed * duration_s;
  if (!(mm > 0.0)) return;
  if (!(programmed_ > 0.0)) {
    if (!(uncontrolled_mm_ > 0.0)) uncontrolled_place_ = place_;
    uncontrolled_mm_ += mm;
    hot_.End();
    weak_.End();
    return;
  }
  if (tip_speed < kSlowSpeed * programmed_) slow_mm_ += mm;
  const double given = power_percent / tip_speed;
  hot_.Go(given > kHotEnergy * asked_, mm, place_);
  weak_.Go(ramped_ && given < kWeakEnergy * asked_, mm, place_);
}

void CutPace::Close(CutFigures& figures) {
  hot_.End();
  weak_.End();
  figures.hot_mm.Raise(hot_.longest.value, hot_.longest.place);
  figures.weak_mm.Raise(weak_.longest.value, weak_.longest.place);
  if (uncontrolled_mm_ > 0.0) {
    Extreme& all = figures.uncontrolled_mm;
    if (!(all.value > 0.0)) all.place = uncontrolled_place_;
    all.value += uncontrolled_mm_;
  }
  *this = {};
}

}  // namespace rmlcell::simulation
