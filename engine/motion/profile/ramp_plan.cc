#include "engine/motion/profile/ramp_plan.h"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/core/check.h"

namespace rmlcell::motion {
namespace {

// A ramp over several cells, and looking at the limits of them, takes as long as so many cells by
// themselves.
constexpr int kLooked = 3;

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

}  // namespace

// One span over several cells, and the cell or the end of a cell whose limit it breaks most.
struct RampPlan::Try {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  SpeedProfile profile;
  double time = std::numeric_limits<double>::infinity();  // infinite: not allowed
  std::size_t worst = kNone;
  bool worst_is_end = false;
};

// The speed between two cells on one span: a bound, until somebody has to know.
struct RampPlan::SpeedBetween {
  SpeedProfile::Place place{};
  double speed = 0.0;
  bool exact = false;

  double Exact(const SpeedProfile& profile) {
    if (!exact) speed = profile.SpeedAt(place);
    exact = true;
    return speed;
  }
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

// One ramp over several cells, whose limits are looked at from cell to cell.
struct RampPlan::Look {
  std::size_t first = 0;
  std::size_t last = 0;
  Try whole{};
  PathLimits limits{};  // of the ramp
  double length = 0.0;
  double start_speed = 0.0;
  double end_speed = 0.0;
  double peak_place = 0.0;
  std::size_t at = 0;  // the next cell, which begins at `from`
  double from = 0.0;
  SpeedProfile::Place place{};
  SpeedBetween before{};
  Excess excess{};

  double slowest() const {
    return std::max(start_speed, end_speed);
  }  // all the way, if it is steady
};

struct RampPlan::Task {
  std::size_t first = 0;
  std::size_t last = 0;
  bool begun = false;     // of many cells: whether one ramp over all is looked at
  bool looks = false;     // and is not done
  std::size_t apart = 0;  // the next of them that is timed by itself, and the time of those before
  double time_apart = 0.0;
  Try together{};
  struct Range {
    std::size_t first = 0;
    std::size_t last = 0;
  };
  std::array<Range, 3> parts{};  // what it falls into otherwise
  std::size_t count = 0;
  std::size_t next = 0;   // of parts; of few cells, the one to whose end ways are sought
  std::size_t begin = 0;  // and the one where the last ramp of the next way begins
  double time = 0.0;      // of those before
  std::size_t ramps_before = 0;
};

RampPlan::RampPlan() : look_(1) {}
RampPlan::~RampPlan() = default;
RampPlan::RampPlan(const RampPlan&) = default;
RampPlan& RampPlan::operator=(const RampPlan&) = default;

void RampPlan::Begin(std::span<const RampCell> cells, double start_speed) {
  RMLCELL_CHECK(!cells.empty() && cells.size() <= kCellsMax);
  cells_ = cells;
  start_speed_ = level_speed_ = start_speed;
  ramps_.clear();
  last_cell_.clear();
  timing_.clear();
  tasks_.clear();
  part_ = level_next_ = 0;
  time_ = level_one_ = 0.0;
  done_ = false;
  // Without a limit on jerk the two passes were the optimum.
  const bool joins = std::isfinite(cells.front().limits.jerk);
  if (joins && Pass()) {
    least_.assign(cells.size(), kNotAsked);
    NextPart();
  } else {
    LevelOne();
    End();
  }
}

int RampPlan::GoOn() {
  constexpr int kAtOnce = 8;
  int done = 0;
  for (; level_next_ < part_ && done < kAtOnce; ++level_next_, ++done) {
    const RampCell& each = cells_[level_next_];
    level_one_ +=
        SpeedProfile::Span(each.length, level_speed_, each.end_speed, each.limits).duration_s();
    level_speed_ = each.end_speed;
  }
  if (level_next_ < part_) return done;
  return done + Start(tasks_.back());
}

// Up to the next end of a cell that is passed as fast as it may be.
void RampPlan::NextPart() {
  std::size_t last = part_;
  while (last + 1 < cells_.size() && speeds_[last] < CapAfter(last) * (1.0 - kRoom)) ++last;
  tasks_.push_back({.first = part_, .last = last});
  part_ = last + 1;
}

void RampPlan::End() {
  std::size_t cell = 0;
  for (std::size_t ramp = 0; ramp < ramps_.size(); ++ramp) {
    double at = 0.0;
    for (; cell <= last_cell_[ramp]; ++cell) {
      const double end = cell == last_cell_[ramp] ? ramps_[ramp].end().s : at + cells_[cell].length;
      timing_.push_back({ramp, at, end});
      at = end;
    }
  }
  done_ = true;
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

// Appends the fastest ramps found for the cells of a task, or lets it fall into parts.
int RampPlan::Start(Task& task) {
  const std::size_t first = task.first, last = task.last;
  if (first == last) {
    const RampCell& cell = cells_[first];
    Append(SpeedProfile::Span(cell.length, SpeedBefore(first), speeds_[first], cell.limits), first);
    return 1 + Return(ramps_.back().duration_s());
  }
  if (last - first < kExactMax) {
    if (task.next == 0 && task.begin == 0) ways_.fill({});
    constexpr int kTriesAtOnce = 3;
    int work = 0;
    for (int k = 0; k < kTriesAtOnce && first + task.next <= last; ++k) {
      work += task.begin == task.next ? 1 : kLooked;
      FindWay(first, task.begin, task.next);
      if (task.begin++ < task.next) continue;
      task.begin = 0;
      ++task.next;
    }
    return first + task.next <= last ? work : work + Return(TakeWays(first, last));
  }
  // Many: one ramp over all of them, which is as much to look at.
  constexpr std::size_t kAtOnce = 2;
  Look& look = look_[0];
  if (!task.begun) {
    task.begun = true;
    task.apart = first;
    look = {.first = first, .last = last};
    task.looks = BeginLook(look);
    return kLooked;
  }
  if (task.looks) {
    for (std::size_t k = 0; k < kAtOnce && look.at <= last; ++k) LookAtCell(look);
    if (look.at <= last) return kLooked * kAtOnce;
    EndLook(look);
    task.looks = false;
  }
  const Try& together = task.together = look.whole;
  const bool broken = together.worst != Try::kNone;
  if (!broken) {
    // Against each cell by itself.
    const std::size_t until = std::min(task.apart + 2 * kAtOnce, last + 1);
    for (; task.apart < until; ++task.apart)
      task.time_apart += Together(task.apart, task.apart).time;
    if (task.apart <= last) return 2 * kAtOnce;
    if (together.time <= task.time_apart) {
      Append(together.profile, last);
      return kLooked + Return(together.time);
    }
  }
  task.ramps_before = ramps_.size();
  const auto add = [&](std::size_t from, std::size_t to) { task.parts[task.count++] = {from, to}; };
  if (broken && !together.worst_is_end) {  // that cell by itself
    if (together.worst > first) add(first, together.worst - 1);
    add(together.worst, together.worst);
    if (together.worst < last) add(together.worst + 1, last);
  } else {
    const std::size_t end = broken ? together.worst : first + (last - first) / 2;
    add(first, end);
    add(end + 1, last);
  }
  const Task::Range part = task.parts[task.next++];
  tasks_.push_back({.first = part.first, .last = part.last});
  return kLooked;
}

// The last task has its ramps, which take this long: on to the next part of the one below it, or
// below that. Returns 0: no ramp was tried.
int RampPlan::Return(double time) {
  for (;;) {
    tasks_.pop_back();
    if (tasks_.empty()) break;
    Task& below = tasks_.back();
    below.time += time;
    if (below.next < below.count) {
      const Task::Range part = below.parts[below.next++];
      tasks_.push_back({.first = part.first, .last = part.last});
      return 0;
    }
    time = below.time;
    if (below.time <= below.together.time) continue;
    ramps_.resize(below.ramps_before);
    last_cell_.resize(below.ramps_before);
    Append(below.together.profile, below.last);
    time = below.together.time;
  }
  time_ += time;
  if (part_ < cells_.size()) {
    NextPart();
    return 0;
  }
  if (time_ > level_one_) LevelOne();
  End();
  return 0;
}

// All ways to join neighbours: the fastest to the end of each cell, from those before it.
void RampPlan::FindWay(std::size_t first, std::size_t begin, std::size_t end) {
  const double before = begin == 0 ? 0.0 : ways_[begin - 1].time;
  const Try ramp = Together(first + begin, first + end);
  if (before + ramp.time < ways_[end].time) {
    ways_[end] = {before + ramp.time, begin, ramp.profile};
  }
}

double RampPlan::TakeWays(std::size_t first, std::size_t last) {
  std::array<std::size_t, kExactMax> ends{};
  std::size_t ramps = 0;
  const std::size_t count = last - first + 1;
  for (std::size_t end = count; end > 0; end = ways_[end - 1].begin) ends[ramps++] = end - 1;
  while (ramps > 0) {
    const std::size_t end = ends[--ramps];
    Append(ways_[end].ramp, first + end);
  }
  return ways_[count - 1].time;
}

double RampPlan::LeastOfMost(std::size_t cell) {
  if (least_[cell] == kNotAsked) {
    const std::span<const double> most = cells_[cell].most;
    least_[cell] = most.empty() ? RampCell::kNoCap : *std::ranges::min_element(most);
  }
  return least_[cell];
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
    if (std::max(begin, end) <= cap || ramp.SpeedAtMost(place) <= cap) continue;
    excess.Keep(ramp.SpeedAt(place), cap, cell, false);
  }
}

// One ramp over all cells of `look`, before its limits are looked at. False: it does not fit at
// all.
bool RampPlan::BeginLook(Look& look) const {
  look.limits = cells_[look.first].limits;
  look.at = look.first;
  look.start_speed = SpeedBefore(look.first);
  look.end_speed = speeds_[look.last];
  for (std::size_t k = look.first; k <= look.last; ++k) {
    const PathLimits& own = cells_[k].limits;
    look.length += cells_[k].length;
    look.limits.speed = std::max(look.limits.speed, own.speed);
    look.limits.acceleration = std::min(look.limits.acceleration, own.acceleration);
    look.limits.jerk = std::min(look.limits.jerk, own.jerk);
  }
  if (RampLength(look.start_speed, look.end_speed, look.limits) > look.length * (1.0 + kRoom)) {
    return false;
  }
  SpeedProfile& profile = look.whole.profile;
  profile = SpeedProfile::Span(look.length, look.start_speed, look.end_speed, look.limits);
  look.peak_place = PlaceOfPeak(profile);
  look.before = {.speed = look.start_speed, .exact = true};
  return true;
}

// At its next cell. The speed rises to one peak and falls: it is highest at an end of the cell or
// at the peak.
void RampPlan::LookAtCell(Look& look) {
  const SpeedProfile& profile = look.whole.profile;
  const std::size_t k = look.at++;
  const RampCell& cell = cells_[k];
  const bool last = k == look.last;
  const double from = look.from;
  const double to = last ? look.length : from + cell.length;
  SpeedBetween after{.speed = look.end_speed, .exact = true};
  if (!last) {
    profile.Advance(look.place, to);
    after = {.place = look.place, .speed = profile.SpeedAtMost(look.place), .exact = false};
  }
  const bool peaks = from <= look.peak_place && look.peak_place <= to;
  const double highest = peaks ? profile.peak_speed() : std::max(look.before.speed, after.speed);
  if (highest > cell.limits.speed) {
    look.excess.Keep(peaks ? highest : std::max(look.before.Exact(profile), after.Exact(profile)),
                     cell.limits.speed, k, false);
  }
  if (!last && after.speed > cell.end_cap) {
    look.excess.Keep(after.Exact(profile), cell.end_cap, k, true);
  }
  if (highest > LeastOfMost(k)) LookAlong(profile, k, from, to, look.excess);
  look.from = to;
  look.before = after;
}

// What all cells said.
void RampPlan::EndLook(Look& look) {
  Try& whole = look.whole;
  const double lowest_broken = look.excess.lowest_broken;
  whole.worst = look.excess.worst;
  whole.worst_is_end = look.excess.worst_is_end;
  if (lowest_broken > look.limits.speed) {  // none is broken
    whole.time = whole.profile.duration_s();
    return;
  }
  // Slower all the way it keeps them all, when its ends allow that.
  if (lowest_broken < look.slowest()) return;
  look.limits.speed = lowest_broken;
  whole.profile = SpeedProfile::Span(look.length, look.start_speed, look.end_speed, look.limits);
  whole.time = whole.profile.duration_s();
}

// Of few cells: whether it fits, and how long it takes.
RampPlan::Try RampPlan::Together(std::size_t first, std::size_t last) {
  Look look{.first = first, .last = last};
  if (first == last) {
    const RampCell& cell = cells_[first];
    look.whole.profile =
        SpeedProfile::Span(cell.length, SpeedBefore(first), speeds_[last], cell.limits);
    look.whole.time = look.whole.profile.duration_s();
    return look.whole;
  }
  if (!BeginLook(look)) return look.whole;
  while (look.at <= last) {
    LookAtCell(look);
    if (look.excess.lowest_broken < look.slowest()) return look.whole;
  }
  EndLook(look);
  return look.whole;
}

}  // namespace rmlcell::motion
