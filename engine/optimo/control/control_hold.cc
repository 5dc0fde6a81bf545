#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/optimo/control/control.h"
#include "engine/optimo/control/motion_place.h"

// HOLD inside a chain of /FLY passages: the move under way becomes exact. The program has run ahead
// by then; what it appended behind that move waits, and is planned anew at START. motion.md 6,
// OPT-4.17
namespace rmlcell::optimo {
namespace {

constexpr double kReaches = 1.0 + 1e-9;  // rounding, where braking takes just the way that is left

// The way to rest when the acceleration is first brought to zero.
double RoomToRest(const motion::PathState& state, const motion::PathLimits& limits) {
  const double a = state.acceleration;
  if (a == 0.0 || std::isinf(limits.jerk)) return motion::RampLength(state.speed, 0.0, limits);
  const double time = std::abs(a) / limits.jerk;
  const double level = std::max(state.speed + 0.5 * a * time, 0.0);
  return time * (state.speed + a * time / 3.0) + motion::RampLength(level, 0.0, limits);
}

}  // namespace

// The command that was appended with this tag; null when it is over.
const motion::MoveCommand* Control::Appended(std::uint64_t tag) const {
  for (const AppendedItem& item : s_.appended) {
    if (item.tag == tag && item.move) return &*item.move;
  }
  return nullptr;
}

// Ends the motions at the first target where the machine can come to rest: that of the move under
// way, or of a later one when its passage has begun or is too near. False: they end by themselves,
// or not enough is planned yet.
bool Control::EndAtATarget() {
  if (!s_.active || s_.active->ended || s_.halting || !s_.interrupted.empty()) return false;
  std::vector<motion::PlannedItem> kept;  // between the motion under way and the exact one
  motion::PlannedMotion exact = s_.active->motion;
  motion::PathState state = exact.speed.At(ToSeconds(s_.now - s_.active->start));
  auto next = s_.timeline.begin();
  for (bool under_way = true;; under_way = false) {
    const bool last = s_.appended.empty() || s_.appended.back().tag <= exact.tag;
    const motion::MoveCommand* command = Appended(exact.tag);
    if (last || command == nullptr || exact.speed.end().speed <= 0.0) return false;
    if (LineOrArc(exact.path) && LineOrArc(command->path)) {
      const double begin = PlaceOn(command->path, exact.path.from().tip);
      const double way = command->path.length() - begin - state.s;
      if (way > 0.0 && RoomToRest(state, exact.limits) <= way * kReaches) {
        exact.path = command->path.Part(begin + state.s, command->path.length());
        const double length = exact.path.length();
        exact.speed = motion::SpeedProfile::From(
            {.s = 0.0, .speed = state.speed, .acceleration = state.acceleration}, length, 0.0,
            exact.limits);
        exact.settling_s = command->settles ? parameters_.limits.settling_s : 0.0;
        exact.ends_move = true;
        exact.corner = {};
        HoldBehind(exact, kept, under_way);
        return true;
      }
    }
    if (!under_way) kept.emplace_back(exact);
    state = exact.speed.end();
    state.s = 0.0;
    for (; next != s_.timeline.end() && std::holds_alternative<motion::PlannedMark>(*next);
         ++next) {
      kept.push_back(*next);
    }
    if (next == s_.timeline.end()) return false;
    exact = std::get<motion::PlannedMotion>(*next++);
  }
}

// `exact` is the last motion before the halt; everything that was appended behind it is held back.
void Control::HoldBehind(const motion::PlannedMotion& exact,
                         const std::vector<motion::PlannedItem>& kept, bool under_way) {
  if (const MoveNote* note = NoteOf(exact.tag)) s_.halted_behind = note->place;
  s_.timeline.assign(kept.begin(), kept.end());
  if (under_way) {
    TellMotion(s_.now);
    s_.active->motion = exact;
    BeginProfile();
  } else {
    s_.timeline.emplace_back(exact);
  }
  std::erase_if(s_.appended, [&](AppendedItem& item) {
    if (item.tag <= exact.tag) return false;
    s_.held.push_back(std::move(item));
    return true;
  });
  s_.planner = motion::Planner(parameters_.limits);
  s_.halting = true;
  s_.hold_requested = false;
}

// START after such a HOLD: the moves that were held back, from rest.
void Control::PlanHeld() {
  if (s_.held.empty()) return;
  s_.place = s_.place_ahead;
  for (AppendedItem& item : s_.held) {
    if (!item.move) {
      s_.planner.Mark(item.tag);
    } else {
      // It was accepted before, with the same limits.
      RMLCELL_CHECK(bool(s_.planner.Append(*item.move)));
    }
    s_.appended.push_back(std::move(item));
  }
  s_.held.clear();
  if (!s_.passing) s_.planner.Stop();
  DrainPlanner();
}

}  // namespace rmlcell::optimo
