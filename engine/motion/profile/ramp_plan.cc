#include "engine/motion/profile/ramp_plan.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/core/check.h"

namespace rmlcell::motion {
namespace {

constexpr double kRoom = 1e-12;  // relative, for speeds and lengths that other formulas gave

// Where a span is fastest.
double PlaceOfPeak(const SpeedProfile& profile) {
  double place = profile.end().s;
  double peak = profile.end().speed;
  for (int k = 0; k < profile.phase_count(); ++k) {
    const PathState& start = profile.phase(k).start;
    if (start.speed <= peak) continue;
    peak = start.speed;
    place = start.s;
  }
  return place;
}

double Reachable(double from, const RampCell& cell, double cap) {
  if (cap <= from || RampLength(from, cap, cell.limits) <= cell.length) return cap;
  return std::min(cap, Reach(from, cell.length, cell.limits));
}

double SpeedAt(const SpeedProfile& profile, double s) {
  return profile.At(profile.TimeAt(s)).speed;
}

}  // namespace

// One span over several cells, and the cell or the end of a cell whose limit it breaks most.
struct RampPlan::Try {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  SpeedProfile profile;
  double time = std::numeric_limits<double>::infinity();  // infinite: not allowed
  std::size_t worst = kNone;
  bool worst_is_end = false;
};

// The limits that a ramp breaks.
struct RampPlan::Excess {
  double lowest_broken = std::numeric_limits<double>::infinity();
  double most = 1.0;  // speed over limit
  std::size_t worst = Try::kNone;
  bool worst_is_end = false;

  void Keep(double speed, double cap, std::size_t cell, bool at_end) {
    if (speed <= cap * (1.0 + kRoom)) return;
    lowest_broken = std::min(lowest_broken, cap);
    // The end of a stretch and the stretch behind it are often broken alike: the first one counts.
    if (speed <= cap * most * (1.0 + kRoom)) return;
    most = speed / cap;
    worst = cell;
    worst_is_end = at_end;
  }
};

void RampPlan::Plan(std::span<const RampCell> cells, double start_speed) {
  RMLCELL_CHECK(!cells.empty() && cells.size() <= kCellsMax);
  cells_ = cells;
  start_speed_ = start_speed;
  ramps_.clear();
  last_cell_.clear();
  timing_.clear();
  // Without a limit on jerk the two passes were the optimum.
  const bool joins = std::isfinite(cells.front().limits.jerk);
  if (joins && Pass()) {
    double time = 0.0;
    std::size_t first = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (k + 1 < cells.size() && speeds_[k] < CapAfter(k) * (1.0 - kRoom)) continue;
      time += Best(first, k);
      first = k + 1;
    }
    double level_one = 0.0;
    double speed = start_speed;
    for (const RampCell& each : cells) {
      level_one += SpeedProfile::Span(each.length, speed, each.end_speed, each.limits).duration_s();
      speed = each.end_speed;
    }
    if (time > level_one) LevelOne();
  } else {
    LevelOne();
  }
  std::size_t cell = 0;
  for (std::size_t ramp = 0; ramp < ramps_.size(); ++ramp) {
    double at = 0.0;
    for (; cell <= last_cell_[ramp]; ++cell) {
      const double end = cell == last_cell_[ramp] ? ramps_[ramp].end().s : at + cells[cell].length;
      timing_.push_back({ramp, at, end});
      at = end;
    }
  }
}

double RampPlan::CapAfter(std::size_t cell) const {
  return std::min({cells_[cell].limits.speed, cells_[cell + 1].limits.speed, cells_[cell].end_cap});
}

// Forward and backward over all cells. False: the ends are not met, by the last digits, or because
// Reach is not quite monotone.
bool RampPlan::Pass() {
  const std::size_t count = cells_.size();
  const double end_speed = cells_.back().end_speed;
  speeds_.resize(count);
  double speed = start_speed_;
  for (std::size_t k = 0; k < count; ++k) {
    speed = speeds_[k] = Reachable(speed, cells_[k], k + 1 < count ? CapAfter(k) : end_speed);
  }
  if (speed < end_speed) return false;
  for (std::size_t k = count - 1; k > 0; --k) {
    speeds_[k - 1] = Reachable(speeds_[k], cells_[k], speeds_[k - 1]);
  }
  const RampCell& first = cells_[0];
  if (start_speed_ <= speeds_[0] ||
      RampLength(start_speed_, speeds_[0], first.limits) <= first.length * (1.0 + kRoom)) {
    return true;
  }
  // Of a short ramp the length hangs on the last digits of both speeds.
  return Reach(speeds_[0], first.length, first.limits) >= start_speed_ * (1.0 - kRoom);
}

void RampPlan::LevelOne() {
  ramps_.clear();
  last_cell_.clear();
  double speed = start_speed_;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const RampCell& cell = cells_[k];
    Append(SpeedProfile::Span(cell.length, speed, cell.end_speed, cell.limits), k);
    speed = cell.end_speed;
  }
}

void RampPlan::Append(const SpeedProfile& ramp, std::size_t last) {
  ramps_.push_back(ramp);
  last_cell_.push_back(last);
}

// Appends the fastest ramps found for these cells and returns their time.
double RampPlan::Best(std::size_t first, std::size_t last) {
  if (last - first < kExactMax) return BestOfAll(first, last);
  const Try together = Together(first, last);
  const bool broken = together.worst != Try::kNone;
  if (!broken && together.time <= TimeApart(first, last)) {
    Append(together.profile, last);
    return together.time;
  }
  const std::size_t before = ramps_.size();
  double time = 0.0;
  if (broken && !together.worst_is_end) {  // that cell by itself
    if (together.worst > first) time += Best(first, together.worst - 1);
    time += Best(together.worst, together.worst);
    if (together.worst < last) time += Best(together.worst + 1, last);
  } else {
    const std::size_t end = broken ? together.worst : first + (last - first) / 2;
    time = Best(first, end) + Best(end + 1, last);
  }
  if (time <= together.time) return time;
  ramps_.resize(before);
  last_cell_.resize(before);
  Append(together.profile, last);
  return together.time;
}

double RampPlan::TimeApart(std::size_t first, std::size_t last) const {
  double time = 0.0;
  for (std::size_t k = first; k <= last; ++k) time += Together(k, k).time;
  return time;
}

// All ways to join neighbours: the fastest to the end of each cell, from those before it.
double RampPlan::BestOfAll(std::size_t first, std::size_t last) {
  struct Way {
    double time = std::numeric_limits<double>::infinity();
    std::size_t begin = 0;  // cell at which its last ramp begins
    SpeedProfile ramp;
  };
  std::array<Way, kExactMax> ways;
  const std::size_t count = last - first + 1;
  for (std::size_t end = 0; end < count; ++end) {
    for (std::size_t begin = 0; begin <= end; ++begin) {
      const double before = begin == 0 ? 0.0 : ways[begin - 1].time;
      const Try ramp = Together(first + begin, first + end);
      if (before + ramp.time < ways[end].time)
        ways[end] = {before + ramp.time, begin, ramp.profile};
    }
  }
  std::array<std::size_t, kExactMax> ends{};
  std::size_t ramps = 0;
  for (std::size_t end = count; end > 0; end = ways[end - 1].begin) ends[ramps++] = end - 1;
  while (ramps > 0) {
    const std::size_t end = ends[--ramps];
    Append(ways[end].ramp, first + end);
  }
  return ways[count - 1].time;
}

// The places of a bend that lies on the ramp between `from` and `to`.
void RampPlan::LookAlong(const SpeedProfile& ramp, std::size_t cell, double from, double to,
                         Excess& excess) const {
  const std::span<const double> most = cells_[cell].most;
  const double step = (to - from) / static_cast<double>(most.size() - 1);
  SpeedProfile::Place place;
  for (std::size_t k = 0; k < most.size(); ++k) {
    const double s = std::min(from + step * static_cast<double>(k), to);
    ramp.Advance(place, s);
    // Within a phase of a ramp the speed does not turn: where both its ends are slow enough, so is
    // the place.
    const int next = place.phase + 1;
    const double begin =
        place.phase < ramp.phase_count() ? ramp.phase(place.phase).start.speed : ramp.end().speed;
    const double end = next < ramp.phase_count() ? ramp.phase(next).start.speed : ramp.end().speed;
    constexpr double kPlaceRoom = 1.0 + 1e-9;  // places are found to less
    const double cap = most[k] * kPlaceRoom;
    if (std::max(begin, end) <= cap) continue;
    excess.Keep(SpeedAt(ramp, s), cap, cell, false);
  }
}

RampPlan::Try RampPlan::Together(std::size_t first, std::size_t last) const {
  Try whole;
  const double start_speed = SpeedBefore(first);
  const double end_speed = speeds_[last];
  if (first == last) {
    const RampCell& cell = cells_[first];
    whole.profile = SpeedProfile::Span(cell.length, start_speed, end_speed, cell.limits);
    whole.time = whole.profile.duration_s();
    return whole;
  }
  PathLimits limits = cells_[first].limits;
  double length = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const PathLimits& own = cells_[k].limits;
    length += cells_[k].length;
    limits.speed = std::max(limits.speed, own.speed);
    limits.acceleration = std::min(limits.acceleration, own.acceleration);
    limits.jerk = std::min(limits.jerk, own.jerk);
  }
  if (RampLength(start_speed, end_speed, limits) > length * (1.0 + kRoom)) return whole;
  whole.profile = SpeedProfile::Span(length, start_speed, end_speed, limits);
  // The speed rises to one peak and falls: within a cell it is highest at an end or at the peak.
  const double peak_place = PlaceOfPeak(whole.profile);
  Excess excess;
  double from = 0.0;
  double speed_from = start_speed;
  for (std::size_t k = first; k <= last; ++k) {
    const double to = k == last ? length : from + cells_[k].length;
    const double speed_to = k == last ? end_speed : SpeedAt(whole.profile, to);
    const bool peaks = from <= peak_place && peak_place <= to;
    const double highest = peaks ? whole.profile.peak_speed() : std::max(speed_from, speed_to);
    excess.Keep(highest, cells_[k].limits.speed, k, false);
    if (k < last) excess.Keep(speed_to, cells_[k].end_cap, k, true);
    if (!cells_[k].most.empty()) LookAlong(whole.profile, k, from, to, excess);
    from = to;
    speed_from = speed_to;
  }
  const double lowest_broken = excess.lowest_broken;
  whole.worst = excess.worst;
  whole.worst_is_end = excess.worst_is_end;
  if (lowest_broken > limits.speed) {  // none is broken
    whole.time = whole.profile.duration_s();
    return whole;
  }
  // Slower all the way it keeps them all, when its ends allow that.
  if (lowest_broken < std::max(start_speed, end_speed)) return whole;
  limits.speed = lowest_broken;
  whole.profile = SpeedProfile::Span(length, start_speed, end_speed, limits);
  whole.time = whole.profile.duration_s();
  return whole;
}

}  // namespace rmlcell::motion
