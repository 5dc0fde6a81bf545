#include "engine/optimo/ride/ride.h"

// STOP, and START after it. motion.md 6, OPT-4.18
namespace rmlcell::optimo {

bool Ride::Stop() {
  const motion::MotionUnderWay& active = *under_way();
  const motion::AxisLimits& axis_limits = parameters_.limits.axes;
  const auto plan = s_.path.PlanStop(situation_.now, axis_limits);
  if (!plan) return false;
  TellMotion(situation_.now);
  s_.axes = axes();
  if (settles() && active.motion.ends_move) TellEnd(active.motion, false);
  s_.path.Stop(*plan, axis_limits);
  s_.halted_behind = situation_.place;  // beside a motion of /NEXT
  if (const MoveNote* note = NoteOf(plan->rests_on); note != nullptr && !beside()) {
    s_.halted_behind = note->place;
  }
  Start();
  return true;
}

machine::Place Ride::Rest() {
  protocol().Rest();
  return s_.halted_behind;
}

Status Ride::Resume() {
  Status from_here = GoFromHere();
  const bool interrupted = s_.path.TakeUpInterrupted();
  PlanHeld();
  if (!busy()) EndBeside();
  const bool overridden = protocol().Resume();
  if (interrupted && overridden) {
    Start();
    AdaptMotions();
  }
  return from_here;
}

}  // namespace rmlcell::optimo
