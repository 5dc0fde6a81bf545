#include "engine/optimo/control/move_watch.h"

namespace rmlcell::optimo {

void MoveWatch::Arm(int time_label, double seconds) {
  s_.stage = WatchStage::kArmed;
  s_.time = {.limit_s = seconds,
             .due = cycle_.TickAfter(situation_.now, seconds),
             .gosub = {.label = time_label, .level = counter_.level()}};
}

void MoveWatch::Disarm() {
  s_.stage = WatchStage::kIdle;
  s_.time.reset();
}

void MoveWatch::Watch(std::uint64_t first, std::uint64_t last, bool ran_ahead) {
  s_.stage = ran_ahead ? WatchStage::kComes : WatchStage::kWatches;
  s_.first = first;
  s_.last = last;
  s_.since = situation_.now;
}

void MoveWatch::Stand() {
  s_.stage = WatchStage::kStands;
  s_.since = situation_.now;
}

void MoveWatch::Clear() {
  s_.stage = WatchStage::kIdle;
  s_.end.reset();
  s_.time.reset();
}

bool MoveWatch::watches() const {
  if (s_.stage != WatchStage::kWatches && s_.stage != WatchStage::kRanOut) return false;
  const motion::MotionUnderWay* active = ride_.under_way();
  return active != nullptr && !active->ended && active->motion.tag >= s_.first &&
         active->motion.tag <= s_.last;
}

SimTime MoveWatch::NextEvent(bool last_input) const {
  SimTime next = kForever;
  if (!watches() && !stands()) return next;
  // Where the program stands and no input is to come, ticks would show nothing new.
  const bool settled = waits_.pending().kind == Pending::Kind::kNoMotion && !ride_.busy() &&
                       last_input && !waits_.input_changed();
  if (s_.end && !settled) next = cycle_.NextTick(situation_.now, s_.since);
  if (time_runs()) next = std::min(next, time_due());
  return next;
}

Status MoveWatch::Look() {
  if (time_runs() && situation_.now >= s_.time->due && TimeOut()) return {};
  const bool stood = stands();
  if (!s_.end || !(stood || watches())) return {};
  if (!cycle_.IsTick(situation_.now, s_.since)) return {};
  if (stood) waits_.InputSeen();
  const Result<bool> met = data_.Truth(*s_.end);
  if (!met) return met.error();
  if (!*met) return {};
  if (stood) {
    EndStanding();
  } else {
    ride_.EndHere();
  }
  return {};
}

// False: its motions are still to come.
bool MoveWatch::TimeOut() {
  if (waits_.pending().kind == Pending::Kind::kCondition && waits_.pending().of_move) {
    MakeGosubDue();
    waits_.End();
    Clear();
    ++counter_.frame().next;
    return true;
  }
  if (stands()) {
    MakeGosubDue();
    EndStanding();
    return true;
  }
  if (!watches()) return false;
  s_.stage = WatchStage::kRanOut;
  ride_.EndHere();
  return true;
}

void MoveWatch::EndStanding() {
  if (waits_.pending().kind == Pending::Kind::kNoMotion) waits_.End();
  Clear();
}

void MoveWatch::Shift(SimTime stood) {
  s_.since += stood;
  if (s_.time) s_.time->due += stood;
}

void MoveWatch::OnMotionBegins(std::uint64_t tag) {
  if (s_.stage != WatchStage::kComes || tag < s_.first || tag > s_.last) return;
  s_.stage = WatchStage::kWatches;
  s_.since = situation_.now;
  if (s_.time) s_.time->due = cycle_.TickAfter(situation_.now, s_.time->limit_s);
}

void MoveWatch::OnMoveOver(std::uint64_t tag) {
  const bool watched = s_.stage == WatchStage::kComes || s_.stage == WatchStage::kWatches ||
                       s_.stage == WatchStage::kRanOut;
  if (!watched || tag < s_.first) return;
  if (s_.stage == WatchStage::kRanOut) MakeGosubDue();
  Clear();
}

}  // namespace rmlcell::optimo
