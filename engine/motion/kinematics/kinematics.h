#pragma once

#include <array>
#include <variant>

#include "engine/motion/geometry/frames.h"
#include "engine/motion/geometry/path.h"

namespace rmlcell::motion {

// Speed, acceleration, jerk and travel of each axis: mm and rad.
struct AxisLimits {
  AxisValues speed{};
  AxisValues acceleration{};
  AxisValues jerk{};
  AxisValues travel_min{};
  AxisValues travel_max{};
};

// Tool offset of TCP: tool coordinates, Z towards the lens. motion.md 2.2.
struct ToolOffset {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double z_mm = 0.0;

  bool operator==(const ToolOffset&) const = default;
};

// How the tip and the head angles change, by time or by path length.
struct TipRates {
  MachineVector tip;
  double a = 0.0;
  double b = 0.0;
};
// And the axes with them: motion.md 2.4.
struct BothAxisRates {
  AxisValues first;
  AxisValues second;
};

// What the column does beyond the tip while the head turns: first and second rates.
struct Swing {
  MachineVector first;
  MachineVector second;
};

// Where the column stands off the tip, and how that changes when the head turns: all that one
// machine's kinematics differs in from another's. A new one is one class with these members, named
// in Head::Kind.

// The A-B head of the gantry: column = tip + R(A,B) (-X0, -Y0, L - Z0). motion.md 2.2.
struct GantryHead {
  double length_mm = 300.0;
  ToolOffset tool{};

  MachineVector Offset(double a_rad, double b_rad) const;
  // motion.md 2.4
  Swing SwingOf(double a_rad, double b_rad, const TipRates& first, const TipRates& second) const;
  // The farthest that the column ever stands off: bounds of the above.
  double reach_mm() const;

  bool operator==(const GantryHead&) const = default;
};

// A mill: the axes X Y Z are where the tip is. Its rotary axis, when it has one, turns the work: A.
// motion.md section 7.
struct MillHead {
  MachineVector Offset(double, double) const { return {}; }
  Swing SwingOf(double, double, const TipRates&, const TipRates&) const { return {}; }
  double reach_mm() const { return 0.0; }

  bool operator==(const MillHead&) const = default;
};

// What carries the tool, of whatever machine: a value.
class Head {
 public:
  using Kind = std::variant<GantryHead, MillHead>;

  Head() = default;  // the gantry's, with the calibrated tip
  Head(const Kind& kind) : kind_(kind) {}
  Head(const GantryHead& head) : kind_(head) {}
  Head(const MillHead& head) : kind_(head) {}

  AxisPose ColumnOf(const TipPose& pose) const;
  TipPose TipOf(const AxisPose& pose) const;
  double reach_mm() const;

  AxisValues Rates(double a_rad, double b_rad, const TipRates& first) const;
  BothAxisRates RatesOfBoth(double a_rad, double b_rad, const TipRates& first,
                            const TipRates& second) const;

  // Whether two put the tip at the same place; a TCP that changes it is a stop. motion.md 3.6.
  bool operator==(const Head&) const = default;

 private:
  Kind kind_;
};

// What the tip, and what the axes do at a place of this path.
TipPose TipOn(const PathPiece& path, const Head& head, const PathPose& place);
AxisPose AxesOn(const PathPiece& path, const Head& head, const PathPose& place);

struct HeadAngles {
  double a_rad = 0.0;
  double b_rad = 0.0;
};
// The angle that differs from `angle` by whole turns and is nearest to `near`.
double NearestTurn(double angle, double near);
// The head angles at which the tool points along `u`, which need not be a unit vector: (A, B) with
// B in 0..pi and (A + pi, -B), A of each in the turn nearest to `near_a_rad`. `a_is_free`: u is
// along Z, which does not tell A. motion.md 2.5.
struct HeadSolutions {
  HeadAngles first;
  HeadAngles twin;
  bool a_is_free = false;
};
HeadSolutions SolutionsOf(const MachineVector& u, double near_a_rad);
double DistanceOf(const HeadAngles& one, const HeadAngles& other);  // |dA| + |dB|
// The one of them nearest to `near`; A stays where it is when it is free.
HeadAngles AnglesOf(const MachineVector& u, const HeadAngles& near);

// Jog by a distance (mm or rad) along one axis, 0..4 for X Y Z A B. motion.md section 6.
// kRobot: one axis alone. kAbsolute: A or B with the tip held. kTool: X Y Z along the tool axes.
enum class JogMode { kRobot, kAbsolute, kTool };
struct Jog {
  JogMode mode = JogMode::kRobot;
  int axis = 0;
  double distance = 0.0;
  bool tool_z_down = false;  // TCP with Z0 < Z1: Z (and with it Y) reversed, motion.md 2.2
};
AxisPose Jogged(const AxisPose& from, const Head& head, const Jog& jog);

// By how much, in mm or rad, an axis of `pose` leaves its travel; 0 when it does not. OPT-B.08.
struct TravelExcess {
  int axis = -1;  // 0..4, -1: inside
  double excess = 0.0;
};
TravelExcess WorstExcess(const AxisPose& pose, const AxisLimits& limits);
double ExcessOfAxis(int axis, const AxisPose& pose, const AxisLimits& limits);

// The worst excess along a tip path at the points of motion.md 2.6.
TravelExcess WorstExcess(const PathPiece& path, const Head& head, const AxisLimits& limits);

// The same for every axis by itself, and where on the path it is worst: the first such place.
struct PlacedExcess {
  double excess = 0.0;  // 0: inside its travel all along
  double s = 0.0;
};
std::array<PlacedExcess, kAxisCount> ExcessOfEach(const PathPiece& path, const Head& head,
                                                  const AxisLimits& limits);

}  // namespace rmlcell::motion
