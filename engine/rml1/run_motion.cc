// How a run carries out the actions of its device.
#include <algorithm>
#include <cmath>

#include "engine/rml1/carriage.h"
#include "engine/rml1/run.h"

namespace rmlcell::rml1 {
namespace {

bool ByAngle(const motion::PathPiece& path) {
  return path.kind() == motion::PathPiece::Kind::kRotary;
}
double Turn(const motion::PathPiece& path) { return std::abs(path.to().a_rad - path.from().a_rad); }

// The speed along `path`, when the speed along `old_path` was `speed`: by mm it is the same, by the
// share of a turn it counts for the turn that is left.
double SpeedOn(const motion::PathPiece& path, const motion::PathPiece& old_path, double speed) {
  if (ByAngle(path) != ByAngle(old_path)) return 0.0;  // a last micrometre of the other kind
  return ByAngle(path) ? speed * Turn(old_path) / Turn(path) : speed;
}

}  // namespace

using machine::Signal;
using machine::WaitKind;

void MillRun::Begin(const Action& action) {
  State& s = state_;
  if (action.kind == Action::Kind::kMotion) return BeginMotion(action);
  s.chain = Chain::kAlone;
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

void MillRun::BeginMotion(const Action& action) {
  State& s = state_;
  const MotionPlan plan = PlanMotion(profile(), s.tool, action, s.override_percent);
  s.motion.action = action;
  s.motion.from = s.tool;
  s.motion.first_leg = true;
  s.motion.stopping = false;
  s.motion.feed_mm_s = plan.feed_mm_s;
  s.motion.joins = action.chain != Chain::kAlone && action.chain == s.chain;
  s.motion.leg = Ride(plan.path, 0.0, 0.0, plan.limits);
  s.chain = action.chain;
  StartLeg();
}

void MillRun::StartLeg() {
  State& s = state_;
  s.motion.leg.upper_bound = s.motion.joins;
  s.busy = Busy::kMotion;
  s.busy_from = s.now;
  s.clock.Add(s.motion.leg.duration_s());
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
  ReportLeg(s.motion.leg.speed.end().s);
  s.busy = Busy::kNothing;
  if (s.motion.stopping) {
    s.rest_left = true;
    s.tool = ToolAt(s.motion.leg.path.At(s.motion.leg.speed.end().s));
    return;
  }
  s.tool = s.motion.action.to;
  const motion::TipPose tip = s.motion.leg.path.to();
  observer_.OnMove({.at = s.now,
                    .place = s.place,
                    .tip = tip,
                    .axes = {.column = tip.tip, .a_rad = tip.a_rad, .b_rad = 0.0},
                    .program_point = {s.tool.x - profile().origin_x, s.tool.y - profile().origin_y,
                                      s.tool.z - s.device.registers().z0},
                    .rotary_a = s.tool.a,
                    .feed_mm_s = s.motion.feed_mm_s,
                    .path = RowOf(s.device.command().op).name});
}

// The leg is over, or as much of it as was ridden.
void MillRun::ReportLeg(double travelled) {
  State& s = state_;
  const bool not_begun = s.now == s.busy_from && travelled < s.motion.leg.path.length();
  if (not_begun) return;
  const Motion& m = s.motion;
  const motion::PathPiece& path = m.leg.path;
  const Point from = m.first_leg ? m.from : ToolAt(path.from());
  const bool to_end = travelled >= path.length() && !m.stopping;
  const Point to = to_end ? m.action.to : ToolAt(path.At(travelled));
  s.physical.OnRide({.from = from,
                     .to = to,
                     .use = m.action.use,
                     .length_mm = motion::Distance(path.from().tip, path.At(travelled).tip),
                     .time_s = ToSeconds(s.now - s.busy_from),
                     .first = m.first_leg},
                    s.device.registers());
  observer_.OnMotion({.start = s.busy_from,
                      .end = s.now,
                      .place = s.place,
                      .use = m.action.use,
                      .motion = &m.leg,
                      .travelled = travelled,
                      .programmed_mm_s = m.action.rapid ? 0.0 : m.feed_mm_s});
  s.motion.first_leg = false;
}

// STOP: a ramp to rest at once; the rest of the path follows with START. Override: over to the new
// speed on the rest of the path. motion.md section 6.
void MillRun::CutMotion(bool stop) {
  State& s = state_;
  const motion::PathState along = s.motion.leg.speed.At(ElapsedInLeg());
  const motion::PathPiece old_path = s.motion.leg.path;
  ReportLeg(along.s);
  s.clock.Set(s.now);
  s.tool = ToolAt(old_path.At(along.s));
  const MotionPlan plan = PlanMotion(profile(), s.tool, s.motion.action, s.override_percent);
  const double length = plan.path.length();
  // Rounding must not leave it too fast to stop within what is left.
  const double speed =
      std::min(SpeedOn(plan.path, old_path, along.speed), motion::Reach(0.0, length, plan.limits));
  s.motion.feed_mm_s = plan.feed_mm_s;
  s.motion.joins = false;
  s.motion.leg = {};
  s.motion.leg.path = plan.path;
  s.motion.leg.limits = plan.limits;
  const double ramp = motion::RampLength(speed, 0.0, plan.limits);
  s.motion.stopping = stop && ramp < length;
  if (s.motion.stopping && !(ramp > 0.0)) {  // it had not begun to move
    s.motion.stopping = false;
    s.busy = Busy::kNothing;
    s.rest_left = true;
    return;
  }
  motion::PathLimits limits = plan.limits;
  if (s.motion.stopping) limits.speed = speed;  // no faster, only down
  s.motion.leg.speed = motion::SpeedProfile::From({.s = 0.0, .speed = speed, .acceleration = 0.0},
                                                  s.motion.stopping ? ramp : length, 0.0, limits);
  StartLeg();
}

// From where STOP left the tool, with the override of now.
void MillRun::ResumeMotion() {
  State& s = state_;
  s.rest_left = false;
  s.motion.stopping = false;
  const MotionPlan plan = PlanMotion(profile(), s.tool, s.motion.action, s.override_percent);
  s.motion.feed_mm_s = plan.feed_mm_s;
  s.motion.leg = Ride(plan.path, 0.0, 0.0, plan.limits);
  StartLeg();
}

double MillRun::ElapsedInLeg() const { return ToSeconds(state_.now - state_.busy_from); }

motion::TipPose MillRun::TipNow() const {
  const State& s = state_;
  if (s.busy != Busy::kMotion) return PoseOf(profile(), s.tool);
  return s.motion.leg.path.At(s.motion.leg.speed.At(ElapsedInLeg()).s);
}

Point MillRun::ToolAt(const motion::TipPose& pose) const {
  const double units = profile().units_per_mm;
  const double sense = profile().rotary_reversed ? -1.0 : 1.0;
  return {pose.tip.x * units, pose.tip.y * units, pose.tip.z * units,
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
