#include "tests/conformance/motion_case_kinds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/motion/geometry/frames.h"
#include "engine/motion/geometry/hole.h"
#include "engine/motion/planner/feed_steps.h"
#include "engine/motion/ride/interruption.h"
#include "engine/optimo/machine/laser_unit.h"
#include "engine/simulation/report/beam_work.h"
#include "tests/conformance/mill_case_kinds.h"
#include "tests/conformance/motion_case_input.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

using nlohmann::json;

void Put(Figures& figures, const std::string& name, const MachineVector& v) {
  figures[name + ".x"] = v.x();
  figures[name + ".y"] = v.y();
  figures[name + ".z"] = v.z();
}

TipPose Pose(const json& tip, const json& ab) {
  return {PointOf(tip), ab.at(0).get<double>(), ab.at(1).get<double>()};
}

Head HeadOf(const json& input) {
  GantryHead head;
  if (input.contains("tcp")) {
    const MachineVector offset = PointOf(input.at("tcp"));
    head.tool = {offset.x(), offset.y(), offset.z()};
  }
  return head;
}

MachineFromProgram OffsetOf(const json& input) {
  const json& s = input.at("sysdef");
  return MachineFromProgram(RigidMotionOf(PointOf(s), s.at(3).get<double>(), s.at(4).get<double>(),
                                          s.at(5).get<double>()));
}

Figures DirectionOf(const json& input) {
  Figures figures;
  Put(figures, "u", ToolDirection(NumberOf(input, "A"), NumberOf(input, "B")));
  return figures;
}

Figures Inverse(const json& input) {
  Figures figures;
  const MachinePoint tip = OffsetOf(input) * ProgramPoint::FromOrigin(PointOf(input.at("tip")));
  Put(figures, "machine_tip", tip);
  Put(figures, "column",
      HeadOf(input).ColumnOf({tip, NumberOf(input, "A"), NumberOf(input, "B")}).column);
  return figures;
}

Figures Forward(const json& input) {
  Figures figures;
  const AxisPose axes{PointOf(input.at("column")), NumberOf(input, "A"), NumberOf(input, "B")};
  Put(figures, "tip", OffsetOf(input).ToProgram(HeadOf(input).TipOf(axes).tip).from_origin());
  return figures;
}

Figures ColumnRates(const json& input) {
  Figures figures;
  const double a = NumberOf(input, "A");
  const double b = NumberOf(input, "B");
  const TipRates first{PointOf(input.at("tip_v")), NumberOf(input, "A1"), NumberOf(input, "B1")};
  const TipRates second{PointOf(input.at("tip_a")), NumberOf(input, "A2"), NumberOf(input, "B2")};
  const auto [v, w] = HeadOf(input).RatesOfBoth(a, b, first, second);
  Put(figures, "v", {v[0], v[1], v[2]});
  Put(figures, "a", {w[0], w[1], w[2]});
  return figures;
}

Figures JogCase(const json& input) {
  const std::string mode = input.at("mode").get<std::string>();
  const std::string axis = input.at("axis").get<std::string>();
  Jog jog;
  jog.mode = mode == "TCP" ? JogMode::kTool : mode == "ABS" ? JogMode::kAbsolute : JogMode::kRobot;
  jog.axis = static_cast<int>(std::string("XYZAB").find(axis));
  jog.distance = NumberOf(input, "dist");
  const AxisPose from{PointOf(input.at("column")), NumberOf(input, "A"), NumberOf(input, "B")};
  const AxisPose to = Jogged(from, HeadOf(input), jog);
  Figures figures{{"A", to.a_rad}, {"B", to.b_rad}};
  Put(figures, "column", to.column);
  return figures;
}

Figures Orientation(const json& input) {
  const json& near = input.at("near");
  const HeadAngles angles =
      AnglesOf(PointOf(input.at("u")), {near.at(0).get<double>(), near.at(1).get<double>()});
  return {{"A", angles.a_rad}, {"B", angles.b_rad}};
}

Figures Arc(const json& input) {
  const Result<PathPiece::Arc3> arc = PathPiece::ArcThrough(
      {PointOf(input.at("E"))}, PointOf(input.at("F")), {PointOf(input.at("G"))});
  if (!arc) return {{"kind", -1.0}};
  if (arc->kind == PathPiece::ArcCase::kNoTipMotion) return {{"kind", 2.0}};
  if (arc->kind != PathPiece::ArcCase::kArc) return {{"kind", 0.0}};
  const PathPiece& path = arc->path;
  Figures figures{{"kind", 1.0},
                  {"R", path.radius_mm()},
                  {"sweep", path.sweep_rad()},
                  {"length", path.length()}};
  Put(figures, "centre", path.centre());
  Put(figures, "normal", path.normal());
  return figures;
}

// SPEED x override, each within its bounds: motion.md 5.1.
double ShareOf(const json& input) {
  const double speed = std::clamp(NumberOf(input, "speed"), 0.0, 100.0) / 100.0;
  return std::min(1.0, speed * NumberOr(input, "override", 100.0) / 100.0);
}

// One commanded motion, from rest to rest.
PlannedMotion Single(const MoveCommand& move) {
  Planner planner(StandardMachine());
  PlannedMotion motion;
  if (const Status appended = planner.Append(move); !appended)
    throw SenselessCase(appended.error().detail);
  planner.Stop();
  if (std::optional<PlannedItem> item = planner.Next()) motion = std::get<PlannedMotion>(*item);
  return motion;
}

Figures Hole(const json& input) {
  const TipPose start = Pose(input.at("start"), input.at("start_ab"));
  const json& ab = input.at("ab");
  const TipPose centre = Pose(input.at("centre"), ab);
  const Result<HolePath> hole = HoleThrough({.from = start,
                                             .centre = centre,
                                             .normal_point = PointOf(input.at("normal")),
                                             .radius_mm = NumberOf(input, "radius")});
  if (!hole) return {{"kind", -1.0}};
  MoveCommand move{
      .path = hole->lead, .speed_fraction = NumberOf(input, "speed") / 100.0, .settles = false};
  const PlannedMotion lead = Single(move);
  move.path = hole->circle;
  move.settles = true;
  const PlannedMotion circle = Single(move);
  Figures figures{{"length", hole->lead.length() + hole->circle.length()},
                  {"v_circle", circle.limits.speed},
                  {"T", lead.duration_s() + circle.duration_s()}};
  Put(figures, "entry", hole->circle.from().point);
  Put(figures, "quarter", hole->circle.At(0.25 * hole->circle.length()).point);
  return figures;
}

PathLimits LimitsFrom(const json& input, double speed) {
  return {
      speed, PositiveOf(input, "a"),
      input.at("j").is_null() ? std::numeric_limits<double>::infinity() : PositiveOf(input, "j")};
}

Figures Profile(const json& input) {
  const PathLimits limits = LimitsFrom(input, PositiveOf(input, "v"));
  const double length = NotBelowZero(NumberOf(input, "dist"), "dist");
  const double v0 = NotBelowZero(NumberOr(input, "v0", 0.0), "v0");
  const double v1 = NotBelowZero(NumberOr(input, "v1", 0.0), "v1");
  constexpr double kRoom = 1.0 + 1e-9;
  if (std::max(v0, v1) > limits.speed * kRoom) throw SenselessCase("an end is faster than v");
  if (RampLength(v0, v1, limits) > length * kRoom)
    throw SenselessCase("dist is too short to get from v0 to v1");
  const SpeedProfile profile = SpeedProfile::Span(length, v0, v1, limits);
  return {{"T", profile.duration_s()}, {"v_peak", profile.peak_speed()}};
}

Figures ReachCase(const json& input) {
  return {
      {"v1", Reach(NotBelowZero(NumberOf(input, "v0"), "v0"),
                   NotBelowZero(NumberOf(input, "dist"), "dist"), LimitsFrom(input, HUGE_VAL))}};
}

Figures PointToPoint(const json& input, bool axes) {
  MoveCommand move;
  move.speed_fraction = ShareOf(input);
  move.acceleration_fraction = NumberOr(input, "accel", 100.0) / 100.0;
  move.settles = false;
  if (axes) {
    move.kind = MoveCommand::Kind::kPointToPointAxes;
    const auto pose = [](const json& q) {
      return AxisPose{PointOf(q), q.at(3).get<double>(), q.at(4).get<double>()};
    };
    move.path = PathPiece::Joint(pose(input.at("q0")), pose(input.at("q1")));
  } else {
    move.kind = MoveCommand::Kind::kPointToPointTip;
    move.path = PathPiece::Line(Pose(input.at("p0"), input.at("ab0")),
                                Pose(input.at("p1"), input.at("ab1")));
  }
  const PlannedMotion motion = Single(move);
  const double length = motion.path.length();  // 1, or mm: the figures are by sigma
  return {{"T", motion.duration_s()},
          {"sigma_peak", motion.speed.peak_speed() / length},
          {"sigma_v", motion.limits.speed / length},
          {"sigma_a", motion.limits.acceleration / length},
          {"sigma_j", motion.limits.jerk / length}};
}

// A chain of moves from rest to rest, with the final settling.
Figures PlanCase(const json& input) {
  TipPose at = Pose(input.at("start"), input.at("start_ab"));
  MachineLimits machine = StandardMachine();
  if (!input.value("jerk", true)) machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  Planner planner(machine);
  Figures figures{{"T", 0.0}, {"length", 0.0}};
  int count = 0;
  for (const json& m : input.at("moves")) {
    const TipPose target = Pose(m.at("target"), m.at("ab"));
    MoveCommand move;
    move.path = PathPiece::Line(at, target);
    const std::string type = m.at("type").get<std::string>();
    if (type != "LIN" && type != "CIR")
      throw SenselessCase("there is no move of type '" + type + "'");
    if (type == "CIR" && m.contains("via") && !m.at("via").is_null()) {  // without /VIA: a line
      const Result<PathPiece::Arc3> arc = PathPiece::ArcThrough(at, PointOf(m.at("via")), target);
      if (!arc) return Figures{{"kind", -1.0}};
      move.path = arc->path;
    }
    move.speed_fraction = ShareOf(m);
    move.acceleration_fraction = NumberOr(m, "accel", 100.0) / 100.0;
    move.overshoot_fraction = NumberOr(m, "oversh", 100.0) / 100.0;
    move.fly = m.value("fly", false);
    move.tag = static_cast<std::uint64_t>(++count);
    if (const Status appended = planner.Append(move); !appended)
      throw SenselessCase(appended.error().detail);
    figures[Numbered("vlim", move.tag)] = LimitsOf(move, machine).speed;
    at = target;
  }
  planner.Stop();
  double cut_sum = 0.0;
  double deviation_max = 0.0;
  while (const std::optional<PlannedItem> item = planner.Next()) {
    const auto& motion = std::get<PlannedMotion>(*item);
    figures["T"] += motion.duration_s();
    if (motion.path.kind() != PathPiece::Kind::kRotary) figures["length"] += motion.path.length();
    if (!motion.ends_move) continue;
    figures[Numbered("v", motion.tag)] = motion.corner.speed;
    figures[Numbered("d", motion.tag)] = motion.corner.cut_mm;
    figures[Numbered("dev", motion.tag)] = motion.corner.deviation_mm;
    cut_sum += motion.corner.cut_mm;
    deviation_max = std::max(deviation_max, motion.corner.deviation_mm);
  }
  figures["d_sum"] = cut_sum;
  figures["dev_max"] = deviation_max;
  return figures;
}

machine::PowerBySpeed RampOf(double speed, double power) {
  return optimo::RampedPower({.speed_percent = speed, .power_percent = power},
                             StandardMachine().tip_speed_mm_s);
}

Figures Power(const json& input) {
  const auto ramp = RampOf(PositiveOf(input, "speed"), NumberOf(input, "power"));
  return {{"power_pct", ramp.PercentAt(NumberOf(input, "v"))}};
}

Figures Cut(const json& input) {
  const double length = PositiveOf(input, "dist");
  const double delay = NumberOf(input, "delay");
  const double rated = NumberOf(input, "laser_W");
  const PlannedMotion motion = Single({.path = PathPiece::Line({}, {{length, 0.0, 0.0}}),
                                       .speed_fraction = NumberOf(input, "speed") / 100.0});
  const auto ramp = RampOf(PositiveOf(input, "wd_speed"), NumberOf(input, "wd_power"));
  const double energy = simulation::BeamWork(rated, StandardMachine().tip_speed_mm_s)
                            .Moving(motion.speed, 0.0, motion.duration_s(), 1.0, ramp);
  const double beam_on = delay + motion.duration_s();
  return {{"beam_on", beam_on},
          {"E_pierce", rated * NumberOf(input, "peak") / 100.0 * delay},
          {"E_cut", energy},
          {"J_per_mm", energy / length},
          {"T", beam_on}};
}

// One line from rest at ACCEL 100, without settling.
PlannedMotion Cruise(const json& input, double percent) {
  MoveCommand move;
  move.path = PathPiece::Line({}, {{NumberOf(input, "dist"), 0.0, 0.0}});
  move.speed_fraction = NumberOf(input, "speed") / 100.0 * percent / 100.0;
  move.settles = false;
  return Single(move);
}

// When something happens, while the motion is on its way.
double TimeWithin(const PlannedMotion& motion, double t, const char* name) {
  if (!(NotBelowZero(t, name) <= motion.duration_s()))
    throw SenselessCase(std::string(name) + " is after the end of the motion");
  return t;
}

Figures OverrideChange(const json& input) {
  const PlannedMotion before = Cruise(input, NumberOf(input, "override0"));
  const PlannedMotion wanted = Cruise(input, NumberOf(input, "override1"));
  const double t = TimeWithin(before, NumberOf(input, "t"), "t");
  if (!FromFits(before.speed.At(t), before.path.length(), 0.0, wanted.limits))
    throw SenselessCase("t is where the motion brakes for its end: nothing changes any more");
  const SpeedProfile rest =
      SpeedProfile::From(before.speed.At(t), before.path.length(), 0.0, wanted.limits);
  // The reference's peak is the speed that it settles to: the one half way through what is left.
  return {{"T", t + rest.duration_s()}, {"v_peak", rest.At(0.5 * rest.duration_s()).speed}};
}

Figures StopResume(const json& input) {
  const PlannedMotion motion = Cruise(input, 100.0);
  const double t = TimeWithin(motion, NumberOf(input, "t"), "t");
  const SpeedProfile stop = motion.speed.StopFrom(t, motion.limits);
  const double s = stop.end().s;
  const SpeedProfile rest = SpeedProfile::Span(motion.path.length() - s, 0.0, 0.0, motion.limits);
  return {{"T", t + stop.duration_s() + NumberOf(input, "wait") + rest.duration_s()},
          {"s_stop", s}};
}

Figures EndCondition(const json& input) {
  constexpr double kTick_s = 0.048;
  const double asked = NotBelowZero(NumberOf(input, "t_true"), "t_true");
  const PlannedMotion motion = Cruise(input, 100.0);
  const double seen =
      TimeWithin(motion, std::ceil(asked / kTick_s - 1e-9) * kTick_s, "the tick after t_true");
  const SpeedProfile stop = motion.speed.StopFrom(seen, motion.limits);
  return {{"t_seen", seen}, {"s_stop", stop.end().s}, {"T", seen + stop.duration_s()}};
}

}  // namespace

Result<Figures> Compute(const json& input) try {
  const std::string f = input.at("f").get<std::string>();
  if (f == "tool_direction") return DirectionOf(input);
  if (f == "inverse") return Inverse(input);
  if (f == "forward") return Forward(input);
  if (f == "column_rates") return ColumnRates(input);
  if (f == "jog") return JogCase(input);
  if (f == "orientation") return Orientation(input);
  if (f == "arc3") return Arc(input);
  if (f == "hole") return Hole(input);
  if (f == "rest_to_rest" || f == "span") return Profile(input);
  if (f == "reach") return ReachCase(input);
  if (f == "ptp_robot" || f == "ptp_absol") return PointToPoint(input, f == "ptp_robot");
  if (f == "power") return Power(input);
  if (f == "cut") return Cut(input);
  if (f == "plan") return PlanCase(input);
  if (f == "override_change") return OverrideChange(input);
  if (f == "stop_resume") return StopResume(input);
  if (f == "end_condition") return EndCondition(input);
  if (std::optional<Figures> figures = ComputeMill(f, input)) return *figures;
  return InvalidArgument("there is no kind of case '" + f + "'");
} catch (const SenselessCase& error) {
  return InvalidArgument(error.what());
}

}  // namespace rmlcell::motion
