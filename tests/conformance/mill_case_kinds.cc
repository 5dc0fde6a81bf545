#include "tests/conformance/mill_case_kinds.h"

#include <algorithm>
#include <limits>

#include "engine/motion/planner/feed_steps.h"
#include "engine/motion/planner/planner.h"
#include "engine/rml1/carriage.h"
#include "engine/simulation/material/mill_tool.h"
#include "tests/conformance/motion_case_input.h"

namespace rmlcell::motion {
namespace {

using nlohmann::json;

// The motion test profile of motion.md section 7.
MachineLimits TestMill() {
  MachineLimits mill;
  mill.tip_speed_mm_s = 15.0;
  mill.tip_acceleration_mm_s2 = 200.0;
  mill.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  mill.settling_s = 0.0;
  mill.corners = MachineLimits::Corners::kThrough;
  mill.junction_jump_mm_s = 3.0;
  mill.axes.speed.fill(kLargest);
  mill.axes.acceleration.fill(kLargest);
  mill.axes.jerk.fill(kLargest);
  return mill;
}

// One chain from rest to rest; with a dwell before each move every vertex is a stop.
Figures MillPath(const json& input, double speed, double dwell) {
  const json& points = input.at("points");
  Planner planner(TestMill());
  double time = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    MoveCommand move;
    move.path = PathPiece::Line({PointOf(points.at(k - 1))}, {PointOf(points.at(k))});
    move.speed_fraction = speed / planner.limits().tip_speed_mm_s;
    move.fly = dwell == 0.0;
    move.tag = k;
    if (const Status appended = planner.Append(move); !appended)
      throw SenselessCase(appended.error().detail);
    if (move.path.length() > 0.0) time += dwell;  // RML1-9.49
  }
  planner.Stop();
  Figures figures;
  while (const std::optional<PlannedItem> item = planner.Next()) {
    const auto& motion = std::get<PlannedMotion>(*item);
    time += motion.duration_s();
    if (motion.ends_move) figures[Numbered("v", motion.tag)] = motion.corner.speed;
  }
  figures["T"] = time;
  return figures;
}

Figures MillJob(const json& input) {
  double time = NumberOf(input, "spin_up");
  for (const json& leg : input.at("legs"))
    time += MillPath(leg, PositiveOf(leg, "speed"), 0.0)["T"];
  return {{"T", time}};
}

// The points at which the tool arrives when it follows the commanded ones, within the box.
Figures Clip(const json& input) {
  const MachinePoint low = PointOf(input.at("box").at(0));
  const MachinePoint high = PointOf(input.at("box").at(1));
  if (!(low.x() < high.x()) || !(low.y() < high.y()) || !(low.z() < high.z()))
    throw SenselessCase("the box ends before it begins");
  rml1::Profile profile;
  const double units = profile.units_per_mm;
  profile.x = {low.x() * units, high.x() * units};
  profile.y = {low.y() * units, high.y() * units};
  profile.z = {low.z() * units, high.z() * units};
  const auto in_units = [&](const json& point) {
    const MachinePoint p = PointOf(point) * units;
    return rml1::Point{p.x(), p.y(), p.z(), 0.0};
  };
  const json& points = input.at("points");
  rml1::Carriage carriage(profile);
  carriage.Place(in_units(points.at(0)));
  rml1::Registers registers(profile);
  registers.rotation = false;
  rml1::ActionQueue queue;
  std::vector<rml1::Point> reached{carriage.physical()};
  for (std::size_t k = 1; k < points.size(); ++k) {
    carriage.MoveXYZ({profile, registers, queue}, in_units(points.at(k)));
    for (; !queue.empty(); queue.Pop()) reached.push_back(queue.front().to);
  }
  Figures figures{{"n", static_cast<double>(reached.size())}};
  for (std::size_t k = 0; k < reached.size(); ++k) {
    const std::string name = Numbered("p", k);
    figures[name + ".x"] = reached[k].x / units;
    figures[name + ".y"] = reached[k].y / units;
    figures[name + ".z"] = reached[k].z / units;
  }
  return figures;
}

Figures Sweep(const json& input) {
  const json& t = input.at("tool");
  const std::string kind = t.at("kind").get<std::string>();
  using Shape = simulation::MillTool::Shape;
  if (kind != "flat" && kind != "ball" && kind != "vee")
    throw SenselessCase("there is no tool of kind '" + kind + "'");
  simulation::MillTool tool{.shape = kind == "flat"   ? Shape::kFlat
                                     : kind == "ball" ? Shape::kBall
                                                      : Shape::kVee,
                            .radius_mm = PositiveOf(t, "R")};
  if (tool.shape == Shape::kVee) {
    tool.half_angle_rad = NumberOf(t, "half");
    tool.tip_radius_mm = NumberOr(t, "r0", 0.0);
  }
  if (const Status sound = simulation::CheckTool(tool); !sound)
    throw SenselessCase(sound.error().detail);
  constexpr double kNotHit = 1e9;  // as the reference writes it
  const json& segment = input.at("seg");
  const json& cell = input.at("cell");
  const std::optional<double> height =
      simulation::SweptHeight(tool, PointOf(segment.at(0)), PointOf(segment.at(1)),
                              cell.at(0).get<double>(), cell.at(1).get<double>());
  return {{"hit", height ? 1.0 : 0.0}, {"z", height.value_or(kNotHit)}};
}

}  // namespace

std::optional<Figures> ComputeMill(const std::string& f, const json& input) {
  if (f == "quant") return Figures{{"v", FeedSteps{}.Nearest(NumberOf(input, "value"))}};
  if (f == "rml_path") return MillPath(input, PositiveOf(input, "speed"), NumberOf(input, "dwell"));
  if (f == "rml_job") return MillJob(input);
  if (f == "clip") return Clip(input);
  if (f == "sweep") return Sweep(input);
  return std::nullopt;
}

}  // namespace rmlcell::motion
