#include "engine/optimo/control/moves.h"

#include <algorithm>

#include "engine/core/number_text.h"
#include "engine/motion/geometry/hole.h"
#include "engine/optimo/machine/motion_errors.h"

namespace rmlcell::optimo {
namespace {

constexpr double kPercent = 0.01;
constexpr int kRotaryFirst = 3;              // axis A
constexpr double kAccelLeast_percent = 0.1;  // OPT-B.22

motion::MoveCommand::Kind KindOf(PathType path, CoordType coord) {
  if (coord == CoordType::kRobot) return motion::MoveCommand::Kind::kPointToPointAxes;
  return path == PathType::kPtp ? motion::MoveCommand::Kind::kPointToPointTip
                                : motion::MoveCommand::Kind::kContour;
}

}  // namespace

Status Moves::Execute(const Instruction& i) {
  switch (i.op) {
    case Op::kMove:
      return Move(i);
    case Op::kCoord:
      counter_.modal().coord = static_cast<CoordType>(i.choice);
      return {};
    case Op::kPath:
      return SetPath(i);
    case Op::kSysdef:
      return SetWorkOffset(i);
    case Op::kTcp:
      return SetTool(i);
    case Op::kZero:
      return ZeroAxes();
    default:
      return SetPercent(i);
  }
}

// A TCP that leaves the tip where it is needs no stop. Values may be expressions, which are looked
// at without an error here: the instruction itself has it.
bool Moves::NeedsStandstill(const Instruction& i) {
  if (i.op == Op::kMove) {
    return i.Has(kStart) || (i.Has(kTime) && NeverMoves()) || (!i.Has(kFly) && GoesNowhere(i));
  }
  motion::ToolOffset offset;
  int n = 0;
  for (double* of : {&offset.x_mm, &offset.y_mm, &offset.z_mm}) {
    const Result<double> value = data_.Real(counter_.module().Value(i, n++));
    if (!value) return true;
    *of = *value;
  }
  return offset != situation_.tool.offset;
}

Result<Moves::Coordinates> Moves::TargetOf(const Instruction& i) {
  const Module& module = counter_.module();
  return data_.Reals<5>(5, [&](int n) { return module.Value(i, n); });
}

Result<motion::TipPose> Moves::ViaOf(const Instruction& i) {
  const Module& module = counter_.module();
  const auto via = data_.Reals<5>(5, [&](int n) { return module.Via(i, n); });
  if (!via) return via.error();
  return TipAt(*via);
}

// In the machine frame.
motion::TipPose Moves::TipAt(const Coordinates& v) const {
  return {.tip = s_.work_offset.frame() * motion::ProgramPoint(v[0], v[1], v[2]),
          .a_rad = v[3],
          .b_rad = v[4]};
}

// Of COORD ROBOT.
motion::AxisPose Moves::AxesAt(const Coordinates& v) {
  return {.column = {v[0], v[1], v[2]}, .a_rad = v[3], .b_rad = v[4]};
}

// A MOVE to where the motions so far end.
bool Moves::GoesNowhere(const Instruction& i) {
  const Modal& modal = counter_.modal();
  const bool robot = modal.coord == CoordType::kRobot;
  if (!robot && modal.path != PathType::kPtp && modal.path != PathType::kLin) return false;
  const Result<Coordinates> to = TargetOf(i);
  if (!to) return true;
  const motion::AxisPose& from = ride_.planned_axes();
  const motion::PathPiece path =
      robot ? motion::PathPiece::Joint(from, AxesAt(*to))
            : motion::PathPiece::Line(ride_.head().TipOf(from), TipAt(*to));
  return !(path.length() > 0.0);
}

// OPT-B.22
bool Moves::NeverMoves() const {
  const Modal& modal = counter_.modal();
  return modal.speed_percent <= 0.0 || modal.accel_percent < kAccelLeast_percent;
}

Status Moves::Move(const Instruction& i) {
  const Result<bool> begins = MayBegin(i);
  if (!begins) return begins.error();
  if (!*begins) return {};
  const Modal& modal = counter_.modal();
  if (modal.coord == CoordType::kRobot && modal.path != PathType::kPtp) {
    return Error{ErrorCode::kPathNeedsAbsol, "PATH LIN, CIR and HOLE need COORD ABSOL", {}};
  }
  if (!s_.zeroed && !situation_.simulating()) {
    return Error{ErrorCode::kNotZeroed, {}, {}};
  }
  const Result<Coordinates> target = TargetOf(i);
  if (!target) return target.error();
  if (situation_.simulating()) return {};  // no motion, the position does not change: OPT-6.18

  Programmed move{.i = i,
                  .target = *target,
                  .note = NoteOf(i, *target),
                  .first_tag = ride_.next_tag(),
                  .ran_ahead = ride_.passing()};
  if (i.Has(kEnd)) {
    const Result<bool> met = data_.Truth(data_.RangeOf(counter_.module().End(i)));
    if (!met) return met.error();
    if (*met) {  // true at the start: no motion at all
      watch_.Disarm();
      return {};
    }
    watch_.SetEnd(data_.ConditionOf(counter_.module().End(i)));
  }
  const Result<bool> under_way = AppendPath(move);
  if (!under_way) return under_way.error();
  if (*under_way) {
    GoOn(move);
  } else if (!watch_.stands()) {
    watch_.Clear();  // it came to nothing
  } else if (!i.Has(kNext)) {
    waits_.BeginNoMotion();
  }
  return {};
}

Result<bool> Moves::MayBegin(const Instruction& i) {
  if (waits_.condition_met()) return true;
  const Module& module = counter_.module();
  if (i.Has(kTime)) {
    const Result<double> seconds = data_.Real(module.Time(i));
    if (!seconds) return seconds.error();
    if (*seconds < 0.0) {
      return Error{ErrorCode::kValueRange,
                   "/TIME is " + Told("time", *seconds, "s", ShortestText(*seconds)),
                   {}};
    }
    if (!situation_.simulating()) watch_.Arm(module.TimeLabel(i), *seconds);
  }
  if (!i.Has(kStart) || situation_.simulating()) return true;
  const ExprRange expression = data_.RangeOf(module.Start(i));
  const Result<bool> met = data_.Truth(expression);
  if (met && !*met) waits_.BeginCondition(expression, true);
  return met;
}

// How a MOVE with /END or /TIME ends is not known before: the program cannot run ahead of it.
MoveNote Moves::NoteOf(const Instruction& i, const Coordinates& target) {
  const bool halts = halts_.will_halt_behind(situation_.place);
  const bool may_end_early = i.Has(kEnd) || i.Has(kTime);
  const bool fly = i.Has(kFly) && !halts;
  if (fly && may_end_early) {
    telling_.Warn(ErrorCode::kFlyCancelled,
                  "/FLY with /END or /TIME: the machine stops at the target", "OPT-2.48");
  }
  return {.place = situation_.place,
          .program_point = {target[0], target[1], target[2]},
          .program_a = target[3],
          .path = counter_.modal().path,
          .fly = fly && !may_end_early && !i.Has(kNext)};
}

Result<bool> Moves::AppendPath(Programmed& move) {
  const Modal& modal = counter_.modal();
  const motion::AxisPose& axes = ride_.planned_axes();
  if (modal.coord == CoordType::kRobot) {
    return Append(move.i, motion::PathPiece::Joint(axes, AxesAt(move.target)), move.note);
  }
  const motion::TipPose from = ride_.head().TipOf(axes);
  if (modal.path == PathType::kHole) return AppendHole(move, from);
  const motion::TipPose target = TipAt(move.target);
  if (modal.path != PathType::kCir) {
    return Append(move.i, motion::PathPiece::Line(from, target), move.note);
  }
  if (move.i.Has(kVia)) {
    const Result<motion::TipPose> via = ViaOf(move.i);
    if (!via) return via.error();
    move.note.via = via->tip;
  }
  const Result<motion::PathPiece> path = CirclePath(from, target, move.note.via);
  if (!path) return path.error();
  return Append(move.i, *path, move.note);
}

Result<motion::PathPiece> Moves::CirclePath(const motion::TipPose& from,
                                            const motion::TipPose& target,
                                            const std::optional<motion::MachinePoint>& via) {
  if (!via) {
    telling_.Warn(ErrorCode::kViaMissing, "CIR without /VIA is a straight line", "OPT-2.21");
    return motion::PathPiece::Line(from, target);
  }
  const Result<motion::PathPiece::Arc3> arc = motion::PathPiece::ArcThrough(from, *via, target);
  if (!arc) return OnOptimo(arc.error());
  if (arc->kind == motion::PathPiece::ArcCase::kLineWarned) {
    telling_.Warn(ErrorCode::kArcIsStraight, "the three points lie on a line", "OPT-B.16");
  }
  return arc->path;
}

// motion.md 3.3: a line to the circle, a stop, one full turn.
Result<bool> Moves::AppendHole(Programmed& move, const motion::TipPose& from) {
  const Instruction& i = move.i;
  const double radius = counter_.modal().hole_radius_mm;
  const motion::TipPose target = TipAt(move.target);
  if (!i.Has(kVia)) {
    if (radius <= 0.0) {
      return Error{ErrorCode::kHoleRadiusZero,
                   "radius is " + Told("radius", radius, "mm", ShortestText(radius)),
                   {}};
    }
    telling_.Warn(ErrorCode::kViaMissing, "HOLE without /VIA is a straight line to the centre",
                  "OPT-2.29");
    return Append(i, motion::PathPiece::Line(from, target), move.note);
  }
  const Result<motion::TipPose> normal = ViaOf(i);
  if (!normal) return normal.error();
  const motion::Rotation program_axes = s_.work_offset.frame().axes();
  const Result<motion::HolePath> hole = motion::HoleThrough({.from = from,
                                                             .centre = target,
                                                             .normal_point = normal->tip,
                                                             .radius_mm = radius,
                                                             .program_x = program_axes.col(0),
                                                             .program_y = program_axes.col(1)});
  if (!hole) return OnOptimo(hole.error());
  if (hole->starts_on_axis && parameters_.teach_simulator) {
    return Error{
        ErrorCode::kHoleStartOnAxis, "the hole starts on the line from centre to normal point", {}};
  }
  MoveNote lead = move.note;
  lead.last = false;
  lead.fly = false;
  // Both are looked at before the machine moves.
  for (const motion::PathPiece& path : {hole->lead, hole->circle}) {
    if (Result<std::vector<BeyondTravel>> inside = travel_.Look(path, move.note.place); !inside) {
      return inside.error();
    }
  }
  if (hole->lead.length() > 0.0) {
    Result<bool> led = Append(i, hole->lead, lead, false);
    if (!led || !*led) return led;
  }
  return Append(i, hole->circle, move.note);
}

// SPEED x override, which is told once where it is too much. OPT-4.38
double Moves::SpeedFraction() {
  const double speed =
      counter_.modal().speed_percent * kPercent * ride_.override_percent() * kPercent;
  if (speed <= 1.0) return speed;
  if (!s_.speed_limited_told) {
    s_.speed_limited_told = true;
    telling_.Warn(ErrorCode::kSpeedLimited, "SPEED x override is over 100 %", "OPT-4.38");
  }
  return 1.0;
}

Result<bool> Moves::Append(const Instruction& i, const motion::PathPiece& path, MoveNote& note,
                           bool settles) {
  Result<std::vector<BeyondTravel>> beyond = travel_.Look(path, note.place);
  if (!beyond) return beyond.error();
  note.beyond = *std::move(beyond);
  const Modal& modal = counter_.modal();
  // SYSDEF leaves A and B as they are programmed (OPT-7.28).
  for (BeyondTravel& one : note.beyond)
    one.by_work_offset = modal.coord == CoordType::kAbsol && one.axis < kRotaryFirst;
  motion::MoveCommand command{.kind = KindOf(note.path, modal.coord),
                              .path = path,
                              .head = ride_.head(),
                              .speed_fraction = SpeedFraction()};
  if (NeverMoves() && path.length() > 0.0) {
    return NeverEnds(i, modal.speed_percent <= 0.0 ? "SPEED is 0" : "ACCEL is below 0.1");
  }
  command.acceleration_fraction = std::max(modal.accel_percent, kAccelLeast_percent) * kPercent;
  command.overshoot_fraction = modal.oversh_percent * kPercent;
  command.fly = note.fly;
  command.settles = settles;
  note.kind = command.kind;
  note.speed_percent = modal.speed_percent;
  note.accel_fraction = command.acceleration_fraction;
  if (command.kind == motion::MoveCommand::Kind::kContour && !path.by_sigma()) {
    note.feed_mm_s = command.speed_fraction * parameters_.limits.tip_speed_mm_s;
  }
  if (path.length() <= 0.0) {
    TellStanding(note);
    return false;
  }
  const Status appended = ride_.Append(std::move(command), note);
  if (appended) return true;
  if (appended.error().code == ErrorCode::kNoMotion) return NeverEnds(i, appended.error().detail);
  if (note.beyond.empty()) return appended.error();
  travel_.TellViolations(note.place, note.beyond);  // no machine is as large: not even a forecast
  return false;                                     // can go there
}

Result<bool> Moves::NeverEnds(const Instruction& i, Detail why) {
  if (!i.Has(kTime)) return Error{ErrorCode::kNoMotion, std::move(why), {}};
  watch_.Stand();
  return false;
}

// Nothing moves; the planner must know that the passage before is a stop, unless this one flies
// too.
void Moves::TellStanding(const MoveNote& note) {
  if (!note.fly) ride_.EndChain();
  travel_.TellViolations(note.place, note.beyond);
  if (ride_.passing()) return;
  telling_.observer().OnMove({.at = situation_.now,
                              .place = note.place,
                              .tip = ride_.tip(),
                              .axes = ride_.axes(),
                              .program_point = note.program_point,
                              .rotary_a = note.program_a,
                              .feed_mm_s = note.feed_mm_s,
                              .path = note.path == PathType::kPtp ? "PTP" : "LIN"});
}

// Its motions are on their way: /END and /TIME watch them, /NEXT goes on meanwhile.
void Moves::GoOn(const Programmed& move) {
  if (move.i.Has(kEnd) || move.i.Has(kTime)) {
    watch_.Watch(move.first_tag, ride_.next_tag() - 1, move.ran_ahead);
  }
  if (move.i.Has(kNext)) ride_.GoOnBeside(move.first_tag, move.ran_ahead);
}

Status Moves::SetPath(const Instruction& i) {
  const auto path = static_cast<PathType>(i.choice);
  if (path == PathType::kHole) {
    const Result<double> radius = data_.Real(counter_.module().Value(i, 0));
    if (!radius) return radius.error();
    counter_.modal().hole_radius_mm = *radius;
  }
  counter_.modal().path = path;
  return {};
}

// SPEED, ACCEL, OVERSH: outside 0 to 100 the old value stays (OPT-2.35).
Status Moves::SetPercent(const Instruction& i) {
  const Result<double> value = data_.Real(counter_.module().Value(i, 0));
  if (!value) return value.error();
  if (!(*value >= 0.0 && *value <= 100.0)) {
    return Error{ErrorCode::kValueRange,
                 Told("instruction", Describe(i.op).name) + " is " +
                     Told("value", *value, "%", ShortestText(*value)) + ", allowed are 0 to 100",
                 {}};
  }
  Modal& modal = counter_.modal();
  double& target = i.op == Op::kSpeed   ? modal.speed_percent
                   : i.op == Op::kAccel ? modal.accel_percent
                                        : modal.oversh_percent;
  target = *value;
  return {};
}

Result<std::array<double, 6>> Moves::SixValues(const Instruction& i) {
  return data_.Reals<6>(6, [&](int n) { return counter_.module().Value(i, n); });
}

Status Moves::SetWorkOffset(const Instruction& i) {
  WorkOffsetState offset;
  if (i.value_count == 6) {
    const Result<std::array<double, 6>> values = SixValues(i);
    if (!values) return values.error();
    offset.values = *values;
    offset.active = true;
    if (std::ranges::all_of(*values, [](double value) { return value == 0.0; })) {
      telling_.Warn(ErrorCode::kSysdefAllZero, "SYSDEF with six zeros", "OPT-7.37");
    }
  }
  s_.work_offset = offset;
  return {};
}

Status Moves::SetTool(const Instruction& i) {
  const Result<std::array<double, 6>> values = SixValues(i);
  if (!values) return values.error();
  const std::array<double, 6>& v = *values;
  const bool same_point = v[0] == v[3] && v[1] == v[4] && v[2] == v[5];
  if (same_point) {
    telling_.Warn(ErrorCode::kTcpAxisUndefined, "both points of TCP are equal", "OPT-4.71");
  } else if (v[2] < v[5]) {
    telling_.Warn(ErrorCode::kTcpReversed, "Z0 is below Z1: jogging along the tool is reversed",
                  "OPT-4.55");
  }
  if (v[0] != 0.0 || v[1] != 0.0 || v[3] != 0.0 || v[4] != 0.0) {
    telling_.Warn(ErrorCode::kTcpOffAxis, "X or Y of TCP is not zero: applied as a tool offset",
                  "OPT-4.70");
  }
  situation_.tool = {.offset = {v[0], v[1], v[2]}, .reference = {v[3], v[4], v[5]}};
  return {};
}

// Z, then A and B, then X and Y: OPT-4.49, OPT-B.60. In virtual time each group is a joint motion
// to its mechanical zero, where its reference is found; each is told, also one that stands there
// already.
Status Moves::ZeroAxes() {
  if (situation_.simulating()) return {};
  const motion::AxisPose& zero = parameters_.mechanical_zero;
  motion::AxisPose to = ride_.planned_axes();
  to.column.z() = zero.column.z();
  if (const Status z = ZeroGroup(0, to); !z) return z.error();
  to.a_rad = zero.a_rad;
  to.b_rad = zero.b_rad;
  if (const Status ab = ZeroGroup(1, to); !ab) return ab.error();
  to.column.x() = zero.column.x();
  to.column.y() = zero.column.y();
  if (const Status xy = ZeroGroup(2, to); !xy) return xy.error();
  s_.zeroed = true;
  ride_.EndChain();
  return {};
}

Status Moves::ZeroGroup(int group, const motion::AxisPose& to) {
  motion::MoveCommand command;
  command.kind = motion::MoveCommand::Kind::kPointToPointAxes;
  command.path = motion::PathPiece::Joint(ride_.planned_axes(), to);
  command.head = ride_.head();
  command.speed_fraction = 0.1;  // no override: OPT-4.51
  if (command.path.length() > 0.0) {
    const MoveNote note{.place = situation_.place, .path = PathType::kPtp, .last = false};
    if (const Status appended = ride_.Append(std::move(command), note); !appended)
      return appended.error();
  }
  ride_.PutAt(to);
  effects_.ShowBehind(
      {.kind = PassageEffect::Kind::kZeroed, .place = situation_.place, .index = group});
  return {};
}

}  // namespace rmlcell::optimo
