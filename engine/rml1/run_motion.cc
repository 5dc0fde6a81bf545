// How a run carries out the actions of its device.
#include <algorithm>
#include <cmath>

#include "engine/rml1/carriage.h"
#include "engine/rml1/run.h"

namespace rmlcell::rml1 {
using machine::Signal;
using machine::WaitKind;

void MillRun::Begin(const Action& action) {
  if (action.kind == Action::Kind::kMotion) return BeginMotion(action);
  switch (action.kind) {
    case Action::Kind::kSpindleStart:
      EmitSignal(Signal::kSpindle, 1.0, action.rpm);
      BeginWait(WaitKind::kSpinUp, profile().spin_up_s);
      break;
    case Action::Kind::kSpindleStop:
      EmitSignal(Signal::kSpindle, 0.0, 0.0);
      if (action.waits) BeginWait(WaitKind::kSpinUp, profile().spin_down_s);
      break;
    case Action::Kind::kSpindleSpeed:
      EmitSignal(Signal::kSpindleSpeed, action.rpm, 0.0);
      break;
    case Action::Kind::kDwell:
      BeginWait(WaitKind::kDwell, action.dwell_ms * 1e-3);
      break;
    case Action::Kind::kMotion:
    case Action::Kind::kPause:
      break;
  }
}

// The tool is where the last motion ended, and may be on its way.
void MillRun::BeginMotion(const Action& action) {
  State& s = state_;
  const bool after_halt = !s.ride.goes() && !Moves();
  if (after_halt) {
    s.ride.Resume();
    s.ahead.Replan(s.ride.intent(), s.override_percent);
  }
  s.motion.action = action;
  s.motion.from = s.tool;
  s.motion.first_leg = true;
  s.motion.planned = false;
  s.busy = Busy::kMotion;
  s.busy_from = s.busy_until = s.now;
}

// False: the bytes that may be read ahead now are used up.
bool MillRun::PlanLeg(std::size_t sent_max) {
  State& s = state_;
  while (!s.ahead.NextLeg(s.motion.leg)) {
    if (!s.scout.Read(stream(), halts_, sent_max, s.ahead)) return false;
  }
  if (s.motion.leg.halts && !(s.ahead.speed() > 0.0)) {  // at rest for a STOP
    s.busy = Busy::kNothing;
    s.rest_left = true;
    s.ride.Rest();
  } else {
    StartLeg();
  }
  return true;
}

void MillRun::StartLeg() {
  State& s = state_;
  s.motion.planned = true;
  s.busy_from = s.now;
  s.clock.Add(s.motion.leg.ride.duration_s());
  s.busy_until = std::max(s.now, s.clock.time());
}

void MillRun::BeginWait(WaitKind kind, double seconds) {
  if (!(seconds > 0.0)) return;
  State& s = state_;
  s.wait_kind = kind;
  s.busy = Busy::kWait;
  s.busy_from = s.now;
  s.clock.Add(seconds);
  s.busy_until = std::max(s.now, s.clock.time());
}

void MillRun::EndBusy() {
  if (state_.busy == Busy::kWait) {
    EndWait();
  } else {
    EndLeg();
  }
}

void MillRun::EndWait() {
  State& s = state_;
  s.busy = Busy::kNothing;
  const double seconds = ToSeconds(s.now - s.busy_from);
  if (s.wait_kind == WaitKind::kDwell) {
    s.physical.OnDwell(seconds, s.device.registers());
  } else {
    s.physical.OnSpindleWait(seconds, s.device.registers());
  }
  observer_.OnWait({.start = s.busy_from, .end = s.now, .place = s.place, .kind = s.wait_kind});
}

void MillRun::EndLeg() {
  State& s = state_;
  const LookAhead::Leg& leg = s.motion.leg;
  const motion::PathState end = leg.ride.speed.end();
  ReportLeg(end.s);
  if (leg.ends_motion) return EndMotion(end.speed);
  s.tool = ToolAt(leg.ride.path.At(end.s).tip());
  s.ahead.Ride({.length = end.s, .speed = end.speed, .tool = s.tool});
  s.motion.planned = false;  // PlanLeg sees when it has come to rest for a STOP
  s.busy_from = s.busy_until = s.now;
}

void MillRun::EndMotion(double speed) {
  State& s = state_;
  s.busy = Busy::kNothing;
  s.ahead.Finish(speed);
  if (!(speed > 0.0) && s.ride.comes_to_rest()) s.ride.Rest();
  s.tool = s.motion.action.to;
  const motion::TipPose tip = PoseOf(profile(), s.tool);
  observer_.OnMove({.at = s.now,
                    .place = s.place,
                    .tip = tip,
                    .axes = {.column = tip.tip, .a_rad = tip.a_rad, .b_rad = 0.0},
                    .program_point = {s.tool.x - profile().origin_x, s.tool.y - profile().origin_y,
                                      s.tool.z - s.device.registers().z0},
                    .rotary_a = s.tool.a,
                    .feed_mm_s = s.motion.leg.feed_mm_s,
                    .path = RowOf(s.device.command().op).name});
}

// The leg is over, or as much of it as was ridden.
void MillRun::ReportLeg(double travelled) {
  State& s = state_;
  const Motion& m = s.motion;
  const motion::PathPiece& path = m.leg.ride.path;
  const bool not_begun = s.now == s.busy_from && travelled < path.length();
  if (not_begun) return;
  const Point from = m.first_leg ? m.from : ToolAt(path.from().tip());
  const bool to_end = m.leg.ends_motion && travelled >= path.length();
  const Point to = to_end ? m.action.to : ToolAt(path.At(travelled).tip());
  s.physical.OnRide({.from = from,
                     .to = to,
                     .use = m.action.use,
                     .length_mm = (path.At(travelled).point - path.from().point).norm(),
                     .time_s = ToSeconds(s.now - s.busy_from),
                     .first = m.first_leg,
                     .rapid = m.action.rapid,
                     .chain = m.action.chain,
                     .spindle_turns = s.device.spindle_turns()},
                    s.device.registers(), s.device.command());
  observer_.OnMotion({.start = s.busy_from,
                      .end = s.now,
                      .place = s.place,
                      .use = m.action.use,
                      .motion = &m.leg.ride,
                      .travelled = travelled,
                      .programmed_mm_s = m.action.rapid ? 0.0 : m.leg.feed_mm_s});
  s.motion.first_leg = false;
}

// What a key or another override makes of the motions ahead; motion.md section 6. The leg ends here
// and now, and the next one begins at the same speed.
void MillRun::PlanAnew() {
  State& s = state_;
  s.clock.Set(s.now);
  if (s.busy == Busy::kMotion && s.motion.planned) {
    const motion::PathPiece& path = s.motion.leg.ride.path;
    const motion::PathState along = s.motion.leg.ride.speed.At(ElapsedInLeg());
    if (path.length() - along.s <= LookAhead::kNothing_mm) {
      EndLeg();
    } else {
      ReportLeg(along.s);
      s.tool = ToolAt(path.At(along.s).tip());
      s.ahead.Ride({.length = along.s, .speed = along.speed, .tool = s.tool});
      s.motion.planned = false;
      s.busy_from = s.busy_until = s.now;
    }
  }
  if (s.busy == Busy::kMotion && s.ahead.NothingLeft()) EndMotion(s.ahead.speed());
  s.ahead.Replan(s.ride.intent(), s.override_percent);
}

// From where STOP left the tool, with the override of now. A HOLD that came on the way lets it end.
void MillRun::ResumeMotion() {
  State& s = state_;
  s.rest_left = false;
  s.ride.Resume();
  if (s.halt_wanted == HaltCause::kHold) s.ride.Hold();
  s.ahead.Replan(s.ride.intent(), s.override_percent);
  s.busy = Busy::kMotion;
  s.busy_from = s.busy_until = s.now;
}

double MillRun::ElapsedInLeg() const { return ToSeconds(state_.now - state_.busy_from); }

motion::TipPose MillRun::TipNow() const {
  const State& s = state_;
  if (s.busy != Busy::kMotion || !s.motion.planned) return PoseOf(profile(), s.tool);
  const motion::PlannedMotion& ride = s.motion.leg.ride;
  return ride.path.At(ride.speed.At(ElapsedInLeg()).s).tip();
}

Point MillRun::ToolAt(const motion::TipPose& pose) const {
  const double units = profile().units_per_mm;
  const double sense = profile().rotary_reversed ? -1.0 : 1.0;
  return {pose.tip.x() * units, pose.tip.y() * units, pose.tip.z() * units,
          sense * pose.a_rad / kRadPerDegree};
}

void MillRun::EmitSignal(Signal signal, double value, double detail) {
  observer_.OnSignal({.at = state_.now,
                      .place = state_.place,
                      .signal = signal,
                      .index = 0,
                      .value = value,
                      .detail = detail});
}

}  // namespace rmlcell::rml1
