#include <cmath>

#include "engine/core/number_text.h"
#include "engine/motion/geometry/hole.h"
#include "engine/optimo/control/control.h"

// MOVE and the instructions that decide how it moves.
namespace rmlcell::optimo {
namespace {

constexpr double kPercent = 0.01;
constexpr double kAccelLeast_percent = 0.1;  // OPT-B.22
// What ZERO moves at a time, as its moves are told. OPT-4.49
constexpr std::string_view kZeroGroups[] = {"ZERO_Z", "ZERO_AB", "ZERO_XY"};

motion::MoveCommand::Kind KindOf(PathType path, CoordType coord) {
  if (coord == CoordType::kRobot) return motion::MoveCommand::Kind::kPointToPointAxes;
  return path == PathType::kPtp ? motion::MoveCommand::Kind::kPointToPointTip
                                : motion::MoveCommand::Kind::kContour;
}

}  // namespace

motion::Head Control::HeadNow() const {
  return motion::GantryHead{.length_mm = parameters_.head_length_mm,
                            .tool = s_.machine.tool.offset};
}

// The five coordinates of a MOVE or its /VIA: a machine-frame tip in COORD ABSOL, a column in COORD
// ROBOT.
std::optional<motion::TipPose> Control::Target(const Instruction& i, bool via) {
  std::array<double, 5> v{};
  for (int n = 0; n < 5; ++n) {
    const std::optional<double> value = Real(via ? module().Via(i, n) : module().Value(i, n));
    if (!value) return std::nullopt;
    v[static_cast<std::size_t>(n)] = *value;
  }
  return FromProgram(v);
}

// In the machine frame; of COORD ROBOT the column.
motion::TipPose Control::FromProgram(const std::array<double, 5>& v) const {
  motion::TipPose pose{.tip = {v[0], v[1], v[2]}, .a_rad = v[3], .b_rad = v[4]};
  if (modal().coord == CoordType::kAbsol)
    pose.tip = s_.machine.work_offset.frame() * motion::ProgramPoint(pose.tip);
  return pose;
}

// A MOVE to where the motions so far end. No error is raised: the MOVE itself does that.
bool Control::GoesNowhere(const Instruction& i) {
  const bool robot = modal().coord == CoordType::kRobot;
  if (!robot && modal().path != PathType::kPtp && modal().path != PathType::kLin) return false;
  std::array<double, 5> v{};
  for (int n = 0; n < 5; ++n) {
    const Result<Value> value = Evaluate(module().Value(i, n), *this);
    if (!value) return true;
    v[static_cast<std::size_t>(n)] = value->number;
  }
  const motion::AxisPose& from = s_.planned_axes;
  const motion::TipPose to = FromProgram(v);
  const motion::PathPiece path =
      robot ? motion::PathPiece::Joint({from.column, from.a_rad, from.b_rad}, to)
            : motion::PathPiece::Line(HeadNow().TipOf(from), to);
  return !(path.length() > 0.0);
}

// OPT-B.22
bool Control::NeverMoves() const {
  return modal().speed_percent <= 0.0 || modal().accel_percent < kAccelLeast_percent;
}

// False: nothing is on its way. It ends where it begins, an error was raised, or the MOVE stands
// until its /TIME (no_motion).
bool Control::AppendMotion(const motion::PathPiece& path, const Instruction& i,
                           const MoveNote& note, bool settles) {
  double speed = modal().speed_percent * kPercent * s_.override_percent * kPercent;
  if (speed > 1.0) {
    speed = 1.0;
    if (!s_.speed_limited_told) {
      s_.speed_limited_told = true;
      Warn(ErrorCode::kSpeedLimited, "SPEED x override is over 100 %", "OPT-4.38");
    }
  }
  const auto never_ends = [&](std::string why) {
    if (i.Has(kTime)) {
      s_.no_motion = true;
    } else {
      Raise(ErrorCode::kNoMotion, std::move(why));
    }
    return false;
  };
  if (NeverMoves() && path.length() > 0.0) {
    return never_ends(modal().speed_percent <= 0.0 ? "SPEED is 0" : "ACCEL is below 0.1");
  }
  motion::MoveCommand command;
  command.kind = KindOf(note.path, modal().coord);
  command.path = path;
  command.head = HeadNow();
  command.speed_fraction = speed;
  command.acceleration_fraction = std::max(modal().accel_percent, kAccelLeast_percent) * kPercent;
  command.overshoot_fraction = modal().oversh_percent * kPercent;
  command.fly = note.fly;
  command.settles = settles;
  command.tag = s_.next_tag++;
  MoveNote kept = note;
  kept.kind = command.kind;
  kept.speed_percent = modal().speed_percent;
  kept.accel_fraction = command.acceleration_fraction;
  if (!path.by_sigma()) kept.feed_mm_s = command.speed_fraction * parameters_.limits.tip_speed_mm_s;
  if (command.kind != motion::MoveCommand::Kind::kContour) kept.feed_mm_s = 0.0;
  if (path.length() <= 0.0) {
    // Nothing moves; the planner must know that the passage before is a stop, unless this one flies
    // too.
    if (!note.fly) StopMotions();
    TellViolations(note.place, note.beyond);
    if (note.last && !s_.passing) {
      observer_.OnMove({.at = s_.now,
                        .place = note.place,
                        .tip = TipNow(),
                        .axes = AxesNow(),
                        .program_point = note.program_point,
                        .rotary_a = note.program_a,
                        .feed_mm_s = kept.feed_mm_s,
                        .path = note.path == PathType::kPtp ? "PTP" : "LIN"});
    }
    return false;
  }
  s_.notes.emplace_back(command.tag, kept);
  if (const Status appended = s_.planner.Append(command); !appended) {
    s_.notes.pop_back();
    if (appended.error().code == ErrorCode::kNoMotion) return never_ends(appended.error().detail);
    if (!note.beyond.empty()) {  // no machine is as large: not even a forecast can go there
      TellViolations(note.place, note.beyond);
      return false;
    }
    Raise(appended.error().code, appended.error().detail);
    return false;
  }
  const motion::TipPose& to = path.to();
  s_.planned_axes = path.kind() == motion::PathPiece::Kind::kJoint
                        ? motion::AxisPose{to.tip, to.a_rad, to.b_rad}
                        : command.head.ColumnOf(to);
  if (note.fly || s_.passing) s_.appended.push_back({.tag = command.tag, .move = command});
  s_.passing = note.fly;
  s_.run_ahead = 0;
  DrainPlanner();
  return true;
}

void Control::Move(const Instruction& i) {
  if (!s_.condition_met) {
    if (i.Has(kTime)) {
      const std::optional<double> seconds = Real(module().Time(i));
      if (!seconds) return;
      if (*seconds < 0.0)
        return Raise(ErrorCode::kValueRange, "/TIME is " + ShortestText(*seconds));
      if (!simulating()) {
        s_.time_gosub = DueGosub{.label = module().TimeLabel(i), .level = program().frames.size()};
        s_.time_due = TickAfter(*seconds);
        s_.time_limit_s = *seconds;
        s_.time_ran_out = false;
      }
    }
    if (i.Has(kStart) && !simulating()) {
      const ExprRange expression = RangeOf(module().Start(i));
      const std::optional<bool> met = Truth(expression);
      if (!met) return;
      if (!*met) {
        return Wait({.kind = Pending::Kind::kCondition,
                     .since = s_.now,
                     .expression = expression,
                     .of_move = true});
      }
    }
  }
  const Modal& m = modal();
  if (m.coord == CoordType::kRobot && m.path != PathType::kPtp) {
    return Raise(ErrorCode::kPathNeedsAbsol, "PATH LIN, CIR and HOLE need COORD ABSOL");
  }
  if (!s_.machine.zeroed && !simulating()) return Raise(ErrorCode::kNotZeroed, {});
  const std::optional<motion::TipPose> target = Target(i, false);
  if (!target) return;
  if (simulating()) return;  // no motion, and the position does not change: OPT-6.18

  MoveNote note{.place = s_.place, .path = m.path};
  const auto programmed = [&](int n) { return *Real(module().Value(i, n)); };
  note.program_point = {programmed(0), programmed(1), programmed(2)};
  note.program_a = programmed(3);
  const bool halts = s_.mode == machine::Mode::kSingle || s_.hold_requested ||
                     (s_.breakpoint && s_.breakpoint->program == s_.place.program &&
                      s_.breakpoint->step == s_.place.step);
  // How a MOVE with /END or /TIME ends is not known before: the program cannot run ahead of it.
  const bool may_end_early = i.Has(kEnd) || i.Has(kTime);
  note.fly = i.Has(kFly) && !halts && !may_end_early && !i.Has(kNext);
  if (i.Has(kFly) && !halts && may_end_early) {
    Warn(ErrorCode::kFlyCancelled, "/FLY with /END or /TIME: the machine stops at the target",
         "OPT-2.48");
  }
  const bool ran_ahead = s_.passing;
  const std::uint64_t first_tag = s_.next_tag;

  if (i.Has(kEnd)) {
    const std::optional<bool> met = Truth(RangeOf(module().End(i)));
    if (!met) return;
    if (*met) {
      s_.time_gosub.reset();
      return;  // true at the start: no motion at all
    }
    s_.end_condition = ConditionOf(module().End(i));
  }

  motion::PathPiece path;
  if (m.coord == CoordType::kRobot) {
    const motion::AxisPose& from = s_.planned_axes;
    path = motion::PathPiece::Joint({from.column, from.a_rad, from.b_rad}, *target);
  } else {
    const motion::TipPose from = HeadNow().TipOf(s_.planned_axes);
    if (m.path == PathType::kHole) {
      if (!MoveHole(i, from, *target, note)) return NotUnderWay(i);
      return WatchAndGoOn(i, first_tag, ran_ahead);
    }
    path = motion::PathPiece::Line(from, *target);
    if (m.path == PathType::kCir && !i.Has(kVia)) {
      Warn(ErrorCode::kViaMissing, "CIR without /VIA is a straight line", "OPT-2.21");
    } else if (m.path == PathType::kCir) {
      const std::optional<motion::TipPose> via = Target(i, true);
      if (!via) return;
      const Result<motion::PathPiece::Arc3> arc =
          motion::PathPiece::ArcThrough(from, via->tip, *target);
      if (!arc) return Raise(arc.error().code, arc.error().detail);
      path = arc->path;
      if (arc->kind == motion::PathPiece::ArcCase::kLineWarned) {
        Warn(ErrorCode::kArcIsStraight, "the three points lie on a line", "OPT-B.16");
      }
    }
  }
  if (!InTravel(path, note) || !AppendMotion(path, i, note, true)) return NotUnderWay(i);
  WatchAndGoOn(i, first_tag, ran_ahead);
}

// A MOVE that came to nothing, or that stands until its /TIME runs out.
void Control::NotUnderWay(const Instruction& i) {
  if (!s_.no_motion) return Unwatch();
  s_.watched_since = s_.now;
  if (!i.Has(kNext)) Wait({.kind = Pending::Kind::kNoMotion, .since = s_.now});
}

// The motions of a MOVE are on their way: /END and /TIME watch them, /NEXT goes on meanwhile.
void Control::WatchAndGoOn(const Instruction& i, std::uint64_t first_tag, bool ran_ahead) {
  if (i.Has(kEnd) || i.Has(kTime)) {
    s_.watched = {.first = first_tag, .last = s_.next_tag - 1};
    s_.watched_since = s_.now;
    s_.watch_begins = ran_ahead;
  }
  if (i.Has(kNext)) {
    StopMotions();
    // Behind a /FLY passage the program waits for this very move to begin.
    if (ran_ahead) s_.background_from = first_tag;
    s_.background = Busy() && !ran_ahead;
    if (!s_.active && !s_.timeline.empty()) StartNextItem();
  }
}

// motion.md 3.3: a line to the circle, a stop, one full turn.
// False: nothing is on its way.
bool Control::MoveHole(const Instruction& i, const motion::TipPose& from,
                       const motion::TipPose& target, MoveNote note) {
  if (!i.Has(kVia)) {
    if (modal().hole_radius_mm <= 0.0) {
      Raise(ErrorCode::kHoleRadiusZero, "radius is " + ShortestText(modal().hole_radius_mm));
      return false;
    }
    Warn(ErrorCode::kViaMissing, "HOLE without /VIA is a straight line to the centre", "OPT-2.29");
    const motion::PathPiece line = motion::PathPiece::Line(from, target);
    return InTravel(line, note) && AppendMotion(line, i, note, true);
  }
  const std::optional<motion::TipPose> normal = Target(i, true);
  if (!normal) return false;
  const motion::MachineFromProgram frame = s_.machine.work_offset.frame();
  const Result<motion::HolePath> hole = motion::HoleThrough({.from = from,
                                                             .centre = target,
                                                             .normal_point = normal->tip,
                                                             .radius_mm = modal().hole_radius_mm,
                                                             .program_x = frame.linear().col(0),
                                                             .program_y = frame.linear().col(1)});
  if (!hole) {
    Raise(hole.error().code, hole.error().detail);
    return false;
  }
  if (hole->starts_on_axis && parameters_.teach_simulator) {
    Raise(ErrorCode::kHoleStartOnAxis, "the hole starts on the line from centre to normal point");
    return false;
  }
  MoveNote lead = note;
  if (!InTravel(hole->lead, lead) || !InTravel(hole->circle, note)) return false;
  lead.last = false;
  lead.fly = false;
  if (hole->lead.length() > 0.0 && !AppendMotion(hole->lead, i, lead, false)) return false;
  return AppendMotion(hole->circle, i, note, true);
}

void Control::SetCoord(CoordType coord) { modal().coord = coord; }

void Control::SetPath(const Instruction& i) {
  const auto path = static_cast<PathType>(i.choice);
  if (path == PathType::kHole) {
    const std::optional<double> radius = Real(module().Value(i, 0));
    if (!radius) return;
    modal().hole_radius_mm = *radius;
  }
  modal().path = path;
}

// SPEED, ACCEL, OVERSH: outside 0 to 100 the old value stays (OPT-2.35).
void Control::SetPercent(const Instruction& i) {
  const std::optional<double> value = Real(module().Value(i, 0));
  if (!value) return;
  if (!(*value >= 0.0 && *value <= 100.0)) {
    return Raise(ErrorCode::kValueRange, std::string(Describe(i.op).name) + " is " +
                                             ShortestText(*value) + ", allowed are 0 to 100");
  }
  double& target = i.op == Op::kSpeed   ? modal().speed_percent
                   : i.op == Op::kAccel ? modal().accel_percent
                                        : modal().oversh_percent;
  target = *value;
}

void Control::SetWorkOffset(const Instruction& i) {
  WorkOffsetState offset;
  if (i.value_count == 6) {
    bool all_zero = true;
    for (int n = 0; n < 6; ++n) {
      const std::optional<double> value = Real(module().Value(i, n));
      if (!value) return;
      offset.values[static_cast<std::size_t>(n)] = *value;
      all_zero = all_zero && *value == 0.0;
    }
    offset.active = true;
    if (all_zero) Warn(ErrorCode::kSysdefAllZero, "SYSDEF with six zeros", "OPT-7.37");
  }
  s_.machine.work_offset = offset;
}

void Control::SetTool(const Instruction& i) {
  std::array<double, 6> v{};
  for (int n = 0; n < 6; ++n) {
    const std::optional<double> value = Real(module().Value(i, n));
    if (!value) return;
    v[static_cast<std::size_t>(n)] = *value;
  }
  const bool same_point = v[0] == v[3] && v[1] == v[4] && v[2] == v[5];
  if (same_point) {
    Warn(ErrorCode::kTcpAxisUndefined, "both points of TCP are equal", "OPT-4.71");
  } else if (v[2] < v[5]) {
    Warn(ErrorCode::kTcpReversed, "Z0 is below Z1: jogging along the tool is reversed", "OPT-4.55");
  }
  if (v[0] != 0.0 || v[1] != 0.0 || v[3] != 0.0 || v[4] != 0.0) {
    Warn(ErrorCode::kTcpOffAxis, "X or Y of TCP is not zero: applied as a tool offset", "OPT-4.70");
  }
  s_.machine.tool = {.offset = {v[0], v[1], v[2]}, .reference = {v[3], v[4], v[5]}};
}

// Z, then A and B, then X and Y: OPT-4.49, OPT-B.60. In virtual time each group is a joint motion
// to its mechanical zero, where its reference is found; each is told, also one that stands there
// already.
void Control::ZeroAxes() {
  if (simulating()) return;
  motion::AxisPose pose = s_.planned_axes;
  const motion::AxisPose& zero = parameters_.mechanical_zero;
  int group = 0;
  const auto move = [&](const motion::AxisPose& to) {
    const motion::PathPiece path = motion::PathPiece::Joint({pose.column, pose.a_rad, pose.b_rad},
                                                            {to.column, to.a_rad, to.b_rad});
    pose = to;
    if (path.length() > 0.0) {
      motion::MoveCommand command;
      command.kind = motion::MoveCommand::Kind::kPointToPointAxes;
      command.path = path;
      command.head = HeadNow();
      command.speed_fraction = 0.1;  // no override: OPT-4.51
      command.tag = s_.next_tag++;
      if (s_.planner.Append(command).ok()) {
        s_.notes.emplace_back(command.tag,
                              MoveNote{.place = s_.place, .path = PathType::kPtp, .last = false});
      }
    }
    const std::uint64_t tag = s_.next_tag++;
    const int zeroed = group++;
    s_.effects.emplace_back(
        tag,
        PassageEffect{.kind = PassageEffect::Kind::kZeroed, .place = s_.place, .index = zeroed});
    s_.planner.Mark(tag);
  };
  motion::AxisPose to = pose;
  to.column.z() = zero.column.z();
  move(to);
  to.a_rad = zero.a_rad;
  to.b_rad = zero.b_rad;
  move(to);
  to.column.x() = zero.column.x();
  to.column.y() = zero.column.y();
  move(to);
  s_.planned_axes = to;
  s_.machine.zeroed = true;
  StopMotions();
}

void Control::TellZeroed(int group) {
  const motion::AxisPose axes = AxesNow();
  observer_.OnMove({.at = s_.now,
                    .place = s_.place,
                    .tip = TipNow(),
                    .axes = axes,
                    .program_point = axes.column,
                    .rotary_a = axes.a_rad,
                    .path = kZeroGroups[group],
                    .programmed = false});
}

}  // namespace rmlcell::optimo
