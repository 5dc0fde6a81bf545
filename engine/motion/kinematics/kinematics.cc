#include "engine/motion/kinematics/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/units.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

AxisValues Together(const MachinePoint& column, double a, double b) {
  return {column.x(), column.y(), column.z(), a, b};
}

constexpr double kAlongZ = 1e-9;   // below: the direction does not tell A
constexpr int kRangePieces = 16;   // 17 points on any piece, motion.md 2.6
constexpr int kRangePerTurn = 32;  // on arcs

void KeepWorse(TravelExcess& worst, const TravelExcess& other) {
  if (other.excess > worst.excess) worst = other;
}

// By how much a value lies outside the travel of its axis; 0 inside.
double ExcessOf(std::size_t axis, double value, const AxisLimits& limits) {
  if (std::isnan(value)) return std::numeric_limits<double>::infinity();
  return std::max({limits.travel_min[axis] - value, value - limits.travel_max[axis], 0.0});
}

AxisPose AxesAt(const PathPiece& path, const Head& head, double s) {
  return AxesOn(path, head, path.At(s));
}

// The places of a path at which its range is looked at: motion.md 2.6.
template <class Look>
void ForEachRangePoint(const PathPiece& path, Look look) {
  const bool arc = path.kind() == PathPiece::Kind::kArc;
  const int pieces =
      arc ? std::max(kRangePieces,
                     static_cast<int>(std::ceil(path.sweep_rad() / kTurn * kRangePerTurn)))
          : kRangePieces;
  for (int k = 0; k <= pieces; ++k) look(path.length() * k / pieces);
  if (!arc) return;

  // Where the circle is farthest along X, Y and Z: tangent(x) = t cos x + c sin x has no such
  // component. The first such place may lie before the arc: that is its start, once more.
  const MachineVector t = path.Tangent(0.0);
  const MachineVector c = path.Curvature(0.0) * path.radius_mm();
  for (const auto& [along, inward] :
       {std::pair{t.x(), c.x()}, std::pair{t.y(), c.y()}, std::pair{t.z(), c.z()}}) {
    for (double angle = std::atan2(-along, inward); angle < path.sweep_rad(); angle += kPi)
      look(angle * path.radius_mm());
  }
}

}  // namespace

// w(A, B) = Rz(A) Rx(B) r
MachineVector GantryHead::Offset(double a_rad, double b_rad) const {
  const HeadSines at = HeadSines::At(a_rad, b_rad);
  const double x = -tool.x_mm, y = -tool.y_mm, z = length_mm - tool.z_mm;
  const double m = y * at.cos_b - z * at.sin_b;
  return {x * at.cos_a - m * at.sin_a, x * at.sin_a + m * at.cos_a, y * at.sin_b + z * at.cos_b};
}

double GantryHead::reach_mm() const {
  return MachineVector(tool.x_mm, tool.y_mm, length_mm - tool.z_mm).norm();
}

AxisPose Head::ColumnOf(const TipPose& pose) const {
  const MachineVector offset =
      std::visit([&](const auto& head) { return head.Offset(pose.a_rad, pose.b_rad); }, kind_);
  return {pose.tip + offset, pose.a_rad, pose.b_rad};
}

TipPose TipOn(const PathPiece& path, const Head& head, const PathPose& place) {
  return path.in_axes() ? head.TipOf(path.AxesOf(place)) : path.TipOf(place);
}

AxisPose AxesOn(const PathPiece& path, const Head& head, const PathPose& place) {
  return path.in_axes() ? path.AxesOf(place) : head.ColumnOf(path.TipOf(place));
}

TipPose Head::TipOf(const AxisPose& pose) const {
  const MachineVector offset =
      std::visit([&](const auto& head) { return head.Offset(pose.a_rad, pose.b_rad); }, kind_);
  return {pose.column - offset, pose.a_rad, pose.b_rad};
}

double Head::reach_mm() const {
  return std::visit([](const auto& head) { return head.reach_mm(); }, kind_);
}

AxisValues Head::Rates(double a_rad, double b_rad, const TipRates& first) const {
  if (first.a == 0.0 && first.b == 0.0) return Together(first.tip, 0.0, 0.0);
  return RatesOfBoth(a_rad, b_rad, first, {}).first;
}

BothAxisRates Head::RatesOfBoth(double a_rad, double b_rad, const TipRates& first,
                                const TipRates& second) const {
  const Swing swing = std::visit(
      [&](const auto& head) { return head.SwingOf(a_rad, b_rad, first, second); }, kind_);
  return {Together(first.tip + swing.first, first.a, first.b),
          Together(second.tip + swing.second, second.a, second.b)};
}

double NearestTurn(double angle, double near) {
  return angle + kTurn * std::round((near - angle) / kTurn);
}

HeadSolutions SolutionsOf(const MachineVector& u, double near_a_rad) {
  const double across = LengthOf(PlanOf(u));
  const double b = std::atan2(across, u.z());
  const double a = std::atan2(u.x(), -u.y());
  return {.first = {NearestTurn(a, near_a_rad), b},
          .twin = {NearestTurn(a + kPi, near_a_rad), -b},
          .a_is_free = across < kAlongZ};
}

double DistanceOf(const HeadAngles& one, const HeadAngles& other) {
  return std::abs(one.a_rad - other.a_rad) + std::abs(one.b_rad - other.b_rad);
}

HeadAngles AnglesOf(const MachineVector& u, const HeadAngles& near) {
  const HeadSolutions both = SolutionsOf(u, near.a_rad);
  if (both.a_is_free) return {near.a_rad, both.first.b_rad};
  return DistanceOf(both.twin, near) < DistanceOf(both.first, near) ? both.twin : both.first;
}

AxisPose Jogged(const AxisPose& from, const Head& head, const Jog& jog) {
  AxisPose to = from;
  if (jog.axis >= 3) {
    TipPose held = head.TipOf(from);
    (jog.axis == 3 ? held.a_rad : held.b_rad) += jog.distance;
    if (jog.mode == JogMode::kAbsolute) return head.ColumnOf(held);
    to.a_rad = held.a_rad;
    to.b_rad = held.b_rad;
    return to;
  }
  if (jog.mode != JogMode::kTool) {
    to.column[jog.axis] += jog.distance;
    return to;
  }
  const double sign = jog.tool_z_down && jog.axis > 0 ? -1.0 : 1.0;
  const MachineVector direction = ToolRotation(from.a_rad, from.b_rad).col(jog.axis);
  to.column = from.column + direction * (sign * jog.distance);
  return to;
}

TravelExcess WorstExcess(const AxisPose& pose, const AxisLimits& limits) {
  const AxisValues values = Together(pose.column, pose.a_rad, pose.b_rad);
  TravelExcess worst;
  for (const std::size_t i : kAxes) {
    KeepWorse(worst, {static_cast<int>(i), ExcessOf(i, values[i], limits)});
  }
  return worst;
}

double ExcessOfAxis(int axis, const AxisPose& pose, const AxisLimits& limits) {
  const auto i = static_cast<std::size_t>(axis);
  return ExcessOf(i, Together(pose.column, pose.a_rad, pose.b_rad)[i], limits);
}

TravelExcess WorstExcess(const PathPiece& path, const Head& head, const AxisLimits& limits) {
  TravelExcess worst;
  ForEachRangePoint(
      path, [&](double s) { KeepWorse(worst, WorstExcess(AxesAt(path, head, s), limits)); });
  return worst;
}

std::array<PlacedExcess, kAxisCount> ExcessOfEach(const PathPiece& path, const Head& head,
                                                  const AxisLimits& limits) {
  std::array<PlacedExcess, kAxisCount> worst{};
  ForEachRangePoint(path, [&](double s) {
    const AxisPose pose = AxesAt(path, head, s);
    const AxisValues values = Together(pose.column, pose.a_rad, pose.b_rad);
    for (const std::size_t i : kAxes) {
      const double excess = ExcessOf(i, values[i], limits);
      if (excess > worst[i].excess) worst[i] = {excess, s};
    }
  });
  return worst;
}

}  // namespace rmlcell::motion
