// How a run carries out the actions of its device.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/rml1/carriage.h"
#include "engine/rml1/entry.h"
#include "engine/rml1/run.h"

namespace rmlcell::rml1 {
using machine::Signal;
using machine::WaitKind;

void MillRun::Begin(const Action& action) {
  if (action.kind == Action::Kind::kMotion) return BeginMotion(action);
  switch (action.kind) {
    case Action::Kind::kSpindleStart:
      state_.spindle_stopped = false;
      EmitSignal(Signal::kSpindle, 1.0, action.rpm);
      BeginWait(WaitKind::kSpinUp, profile().spin_up_s);
      break;
    case Action::Kind::kSpindleStop:
      if (std::exchange(state_.spindle_stopped, false)) break;  // it stands already
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
  motion::RideProtocol& protocol = s.ride.protocol();
  const bool after_halt = !protocol.goes() && !Moves();
  if (after_halt) {
    protocol.Resume();
    s.ahead.Replan(protocol.intent(), s.override_percent);
  }
  s.motion.action = action;
  s.motion.from = s.tool;
  s.motion.first_leg = true;
  s.motion.approach = s.approaching;
  s.ride.Leave();
  s.busy = Busy::kMotion;
  s.busy_from = s.busy_until = s.now;
}

// How many bytes may be read before the stream is asked again. Where it still comes the last one
// that is here waits: with it the stream would seem to be over.
std::size_t MillRun::Await() {
  if (program_.whole()) return std::numeric_limits<std::size_t>::max();
  program_.ReadOn(std::max(state_.sender.sent(), state_.scout.sent()) + kBytesAwaited);
  return program_.whole() ? std::numeric_limits<std::size_t>::max() : stream().size() - 1;
}

// False: the bytes that may be read ahead now are used up.
bool MillRun::PlanLeg(std::size_t sent_max) {
  State& s = state_;
  while (!s.ahead.NextLeg(s.ride.place().motion, s.motion.leg)) {
    if (!s.scout.Read(program_, state_.halts, sent_max, s.ahead)) return false;
  }
  if (s.motion.leg.halts && !(s.ahead.speed() > 0.0)) {  // at rest for a STOP
    s.busy = Busy::kNothing;
    s.rest_left = true;
    s.ride.protocol().Rest();
  } else {
    StartLeg();
  }
  return true;
}

void MillRun::StartLeg() {
  State& s = state_;
  s.busy_from = s.now;
  s.clock.Add(s.ride.place().motion.duration_s());
  s.busy_until = std::max(s.now, s.clock.time());
  s.ride.BeginInPlace(s.busy_from, s.busy_until);
}

void MillRun::TurnSpindle() {
  state_.spindle_stopped = false;
  EmitSignal(machine::Signal::kSpindle, 1.0, state_.device.registers().rpm);
}

Status MillRun::SwitchSpindle() {
  State& s = state_;
  if (SpindleTurns()) {
    EmitSignal(machine::Signal::kSpindle, 0.0, 0.0);
    s.spindle_stopped = true;
  } else if (s.spindle_stopped) {
    TurnSpindle();
  } else {
    return Error{ErrorCode::kCellMachineState, "the program has not started the spindle", {}};
  }
  return {};
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
  if (s.approaching) {
    // no work of the program
  } else if (s.wait_kind == WaitKind::kDwell) {
    s.physical.OnDwell(seconds, s.device.registers());
  } else {
    s.physical.OnSpindleWait(seconds, s.device.registers());
  }
  observer_.OnWait({.start = s.busy_from, .end = s.now, .place = s.place, .kind = s.wait_kind});
}

void MillRun::EndLeg() {
  State& s = state_;
  const motion::PlannedMotion& leg = s.ride.place().motion;
  const motion::PathState end = leg.speed.end();
  if (leg.ends_move) {
    ReportLeg(end.s);
    s.ride.Leave();
    EndMotion(end.speed);
  } else {
    LeaveLeg(end);  // PlanLeg sees when it has come to rest for a STOP
  }
}

// The motion goes on from there, with another leg.
void MillRun::LeaveLeg(const motion::PathState& along) {
  State& s = state_;
  ReportLeg(along.s);
  s.tool = ToolAt(s.ride.place().motion.path.TipAt(along.s));
  s.ahead.Ride({.length = along.s, .speed = along.speed, .tool = s.tool});
  s.ride.Leave();
  s.busy_from = s.busy_until = s.now;
}

void MillRun::EndMotion(double speed) {
  State& s = state_;
  s.busy = Busy::kNothing;
  s.ahead.Finish(speed);
  if (!(speed > 0.0) && s.ride.protocol().comes_to_rest()) s.ride.protocol().Rest();
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
                    .path = s.motion.approach ? NameOfApproach(s.motion.action)
                                              : RowOf(s.device.command().op).name,
                    .programmed = !s.motion.approach,
                    .approach = s.motion.approach});
}

// The leg is over, or as much of it as was ridden.
void MillRun::ReportLeg(double travelled) {
  State& s = state_;
  const Motion& m = s.motion;
  const motion::PlannedMotion& leg = s.ride.place().motion;
  const motion::PathPiece& path = leg.path;
  const bool not_begun = s.now == s.busy_from && travelled < path.length();
  if (not_begun) return;
  const Point from = m.first_leg ? m.from : ToolAt(path.tip_from());
  const bool to_end = leg.ends_move && travelled >= path.length();
  const Point to = to_end ? m.action.to : ToolAt(path.TipAt(travelled));
  // A key cuts the motion in parts: whether it goes into the work does not hang on that.
  const bool in_work = Physical::IsInWork(m.action.use, m.from, m.action.to, s.device.registers());
  if (!m.approach) {
    s.physical.OnRide({.from = from,
                       .to = to,
                       .use = m.action.use,
                       .length_mm = (path.At(travelled).point - path.from().point).norm(),
                       .time_s = ToSeconds(s.now - s.busy_from),
                       .first = m.first_leg,
                       .in_work = in_work,
                       .rapid = m.action.rapid,
                       .chain = m.action.chain,
                       .spindle_turns = s.device.spindle_turns() && !s.spindle_stopped},
                      s.device.registers(), s.device.command());
  }
  observer_.OnMotion({.start = s.busy_from,
                      .end = s.now,
                      .place = s.place,
                      .use = m.action.use,
                      .motion = &leg,
                      .travelled = travelled,
                      .programmed_mm_s = m.action.rapid ? 0.0 : m.leg.feed_mm_s,
                      .in_work = !m.approach && in_work,
                      .approach = m.approach});
  s.motion.first_leg = false;
}

// What a key or another override makes of the motions ahead; motion.md section 6. The leg ends here
// and now, and the next one begins at the same speed.
void MillRun::PlanAnew() {
  State& s = state_;
  s.clock.Set(s.now);
  if (const motion::MotionUnderWay* leg = s.ride.under_way()) {
    const motion::PathState along = leg->At(s.now);
    if (leg->motion.path.length() - along.s <= LookAhead::kNothing_mm) {
      EndLeg();
    } else {
      LeaveLeg(along);
    }
  }
  if (s.busy == Busy::kMotion && s.ahead.NothingLeft()) EndMotion(s.ahead.speed());
  s.ahead.Replan(s.ride.protocol().intent(), s.override_percent);
}

// From where STOP left the tool, with the override of now. A HOLD that came on the way lets it end.
void MillRun::ResumeMotion() {
  State& s = state_;
  s.rest_left = false;
  motion::RideProtocol& protocol = s.ride.protocol();
  protocol.Resume();
  if (s.halt_wanted == HaltCause::kHold) protocol.Hold();
  s.ahead.Replan(protocol.intent(), s.override_percent);
  s.busy = Busy::kMotion;
  s.busy_from = s.busy_until = s.now;
}

motion::TipPose MillRun::TipNow() const {
  const State& s = state_;
  if (s.away) return PoseOf(profile(), *s.away);
  const motion::MotionUnderWay* leg = s.ride.under_way();
  return leg == nullptr ? PoseOf(profile(), s.tool) : leg->TipAt(s.now);
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
