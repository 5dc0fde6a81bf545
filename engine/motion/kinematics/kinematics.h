#pragma once

#include <array>
#include <cmath>
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

// The sines of both angles of a head.
struct HeadSines {
  double sin_a, cos_a, sin_b, cos_b;

  static HeadSines At(double a_rad, double b_rad) {
    return {std::sin(a_rad), std::cos(a_rad), std::sin(b_rad), std::cos(b_rad)};
  }
  // Where the head has turned on by a little, to the last digits without a sine. Precondition: both
  // at most kLittle_rad.
  HeadSines Turned(double a_rad, double b_rad) const {
    const OfSmall a(a_rad), b(b_rad);
    return {sin_a * a.cosine + cos_a * a.sine, cos_a * a.cosine - sin_a * a.sine,
            sin_b * b.cosine + cos_b * b.sine, cos_b * b.cosine - sin_b * b.sine};
  }
  static constexpr double kLittle_rad = 0.1;  // the first term left out is 3e-17

 private:
  struct OfSmall {
    double sine, cosine;
    explicit OfSmall(double x) {
      const double z = x * x;
      sine = x * (1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z / 362880.0))));
      cosine = 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - z / 40320.0)));
    }
  };
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
  Swing SwingOf(double a_rad, double b_rad, const TipRates& first, const TipRates& second) const {
    return SwingAt(HeadSines::At(a_rad, b_rad), first, second);
  }
  Swing SwingAt(const HeadSines& at, const TipRates& first, const TipRates& second) const;
  // The farthest that the column ever stands off: bounds of the above.
  double reach_mm() const;

  bool operator==(const GantryHead&) const = default;
};

// A mill: the axes X Y Z are where the tip is. Its rotary axis, when it has one, turns the work: A.
// motion.md section 7.
struct MillHead {
  MachineVector Offset(double, double) const { return {}; }
  Swing SwingOf(double, double, const TipRates&, const TipRates&) const { return {}; }
  Swing SwingAt(const HeadSines&, const TipRates&, const TipRates&) const { return {}; }
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
  // What the column does beyond the tip, where the sines are known.
  Swing SwingAt(const HeadSines& at, const TipRates& first, const TipRates& second) const {
    return std::visit([&](const auto& head) { return head.SwingAt(at, first, second); }, kind_);
  }

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

// Written out: of matrices g++ keeps the parts on the stack.
inline Swing GantryHead::SwingAt(const HeadSines& at, const TipRates& first,
                                 const TipRates& second) const {
  const double x = -tool.x_mm, y = -tool.y_mm, z = length_mm - tool.z_mm;
  const double m = y * at.cos_b - z * at.sin_b;
  const double n = y * at.sin_b + z * at.cos_b;
  // The vector from the tip to the column by A, and by B.
  const double ax = -x * at.sin_a - m * at.cos_a, ay = x * at.cos_a - m * at.sin_a;
  const double bx = n * at.sin_a, by = -n * at.cos_a, bz = m;
  const double aa = first.a * first.a, ab = 2.0 * first.a * first.b, bb = first.b * first.b;
  return {.first = {ax * first.a + bx * first.b, ay * first.a + by * first.b, bz * first.b},
          .second = {ax * second.a + bx * second.b + (m * at.sin_a - x * at.cos_a) * aa +
                         n * at.cos_a * ab + m * at.sin_a * bb,
                     ay * second.a + by * second.b + (-x * at.sin_a - m * at.cos_a) * aa +
                         n * at.sin_a * ab - m * at.cos_a * bb,
                     bz * second.b - n * bb}};
}

}  // namespace rmlcell::motion
