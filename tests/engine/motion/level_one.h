#pragma once

#include <algorithm>
#include <vector>

#include "engine/motion/profile/ramp_plan.h"

// Level 1 of a section by itself, to compare plans with.
namespace rmlcell::motion {

// Fills in the speeds of level 1: forward and backward by Reach, from `start` to `end`.
inline void TimeByLevelOne(std::vector<RampCell>& cells, double start, double end) {
  const auto reachable = [](double from, const RampCell& cell, double cap) {
    if (cap <= from || RampLength(from, cap, cell.limits) <= cell.length) return cap;
    return std::min(cap, Reach(from, cell.length, cell.limits));
  };
  double speed = start;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    double cap = std::min(cells[k].limits.speed, cells[k].end_cap);
    if (k + 1 < cells.size()) cap = std::min(cap, cells[k + 1].limits.speed);
    if (k + 1 == cells.size()) cap = std::min(cap, end);
    speed = cells[k].end_speed = reachable(speed, cells[k], cap);
  }
  for (std::size_t k = cells.size() - 1; k-- > 0;) {
    cells[k].end_speed = reachable(cells[k + 1].end_speed, cells[k + 1], cells[k].end_speed);
  }
}

inline double LevelOneTime(const std::vector<RampCell>& cells, double start) {
  double time = 0.0;
  for (const RampCell& cell : cells) {
    time += SpeedProfile::Span(cell.length, start, cell.end_speed, cell.limits).duration_s();
    start = cell.end_speed;
  }
  return time;
}

inline double TimeOf(const RampPlan& plan) {
  double time = 0.0;
  for (const SpeedProfile& ramp : plan.ramps()) time += ramp.duration_s();
  return time;
}

}  // namespace rmlcell::motion
