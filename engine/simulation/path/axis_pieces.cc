#include "engine/simulation/path/axis_pieces.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;
using motion::PathDerivatives;
using motion::PathPiece;

// Rounding is no change of direction: this share of what the tip and the arm make.
constexpr double kStandingShare = 1e-9;

// Derivatives of tip and head by the parameter at one place; [0] is the first.
struct Derivatives {
  std::array<PathDerivatives, 3> by;
};

Derivatives At(const PartCurve& curve, double p) {
  if (curve.bends())
    return {{curve.Derivative(p, 1), curve.Derivative(p, 2), curve.Derivative(p, 3)}};
  return {{curve.Rate(p), {}, {}}};
}

// Bounds of the fourth derivatives along the part: the third are quadratic, so that their values at
// both ends and in the middle tell.
struct FourthBounds {
  double tip = 0.0;
  double turning = 0.0;  // of A and B together
};

FourthBounds FourthOf(const PartCurve& curve) {
  if (!curve.bends()) return {};
  const double whole = curve.end() - curve.begin();
  const PathDerivatives begin = curve.Derivative(curve.begin(), 3);
  const PathDerivatives middle = curve.Derivative(curve.begin() + 0.5 * whole, 3);
  const PathDerivatives end = curve.Derivative(curve.end(), 3);
  const double per = 1.0 / whole;
  const auto most = [&](double b, double m, double e) {
    return std::max(std::abs(4.0 * m - 3.0 * b - e), std::abs(3.0 * e - 4.0 * m + b)) * per;
  };
  MachineVector tip;
  for (int i = 0; i < 3; ++i) tip[i] = most(begin.point[i], middle.point[i], end.point[i]);
  return {.tip = tip.norm(),
          .turning = most(begin.a, middle.a, end.a) + most(begin.b, middle.b, end.b)};
}

// The arm from tip to column, Rz(A) Rx(B) r, while A and B change: its first three derivatives. In
// the plane of X and Y it is a complex number, turned by A.
class Arm {
 public:
  explicit Arm(const motion::Head& head) : r_(head.ColumnOf({}).column) {}

  double reach_mm() const { return r_.norm(); }

  std::array<MachineVector, 3> Swing(const motion::PathPose& pose, const Derivatives& d) const {
    const double sin_b = std::sin(pose.b_rad);
    const double cos_b = std::cos(pose.b_rad);
    const double m = r_.y() * cos_b - r_.z() * sin_b;
    const double n = r_.y() * sin_b + r_.z() * cos_b;
    const double b1 = d.by[0].b;
    const double b2 = d.by[1].b;
    const double b3 = d.by[2].b;
    const std::array<double, 3> m_by = {-n * b1, -n * b2 - m * b1 * b1,
                                        -n * b3 - 3.0 * m * b1 * b2 + n * b1 * b1 * b1};
    const std::array<double, 3> n_by = {m * b1, m * b2 - n * b1 * b1,
                                        m * b3 - 3.0 * n * b1 * b2 - m * b1 * b1 * b1};
    const double a1 = d.by[0].a;
    const double a2 = d.by[1].a;
    const double a3 = d.by[2].a;
    // What turns with A, before A turns it: derivatives of (x + i m) exp(i A) over exp(i A).
    const double x = r_.x();
    const std::array<double, 3> turn_real = {0.0, -a1 * a1, -3.0 * a1 * a2};
    const std::array<double, 3> turn_imaginary = {a1, a2, a3 - a1 * a1 * a1};
    const std::array<double, 3> real = {
        -turn_imaginary[0] * m,
        turn_real[1] * x - turn_imaginary[1] * m - 2.0 * turn_imaginary[0] * m_by[0],
        turn_real[2] * x - turn_imaginary[2] * m - 3.0 * turn_imaginary[1] * m_by[0] -
            3.0 * turn_imaginary[0] * m_by[1]};
    const std::array<double, 3> imaginary = {
        turn_imaginary[0] * x + m_by[0], turn_real[1] * m + turn_imaginary[1] * x + m_by[1],
        turn_real[2] * m + turn_imaginary[2] * x + 3.0 * turn_real[1] * m_by[0] + m_by[2]};
    const double sin_a = std::sin(pose.a_rad);
    const double cos_a = std::cos(pose.a_rad);
    std::array<MachineVector, 3> swing;
    for (std::size_t k = 0; k < 3; ++k) {
      swing[k] = {real[k] * cos_a - imaginary[k] * sin_a, real[k] * sin_a + imaginary[k] * cos_a,
                  n_by[k]};
    }
    return swing;
  }

 private:
  MachineVector r_;
};

// Along a piece of 2 * `half`, from the values in its middle and a bound of the next derivative.
double Reach(double middle, double half, double next) { return std::abs(middle) + half * next; }

// Of the speed of the tip by the parameter. False: it may come near 0.
bool BoundTip(const Derivatives& d, double half, double fourth, AxisPieces::Piece& piece) {
  const MachineVector& first = d.by[0].point;
  const MachineVector& second = d.by[1].point;
  const MachineVector& third = d.by[2].point;
  piece.tip_third = Reach(third.norm(), half, fourth);
  piece.tip_second = Reach(second.norm(), half, piece.tip_third);
  const double speed = first.norm();
  const double least = speed - half * piece.tip_second;
  if (!(least > 0.5 * speed)) return false;
  piece.second_change = piece.tip_third + piece.tip_second * piece.tip_second / least;
  piece.change = Reach(first.dot(second) / speed, half, piece.second_change);
  piece.slowest = speed - half * piece.change;
  piece.fastest = speed + half * piece.change;
  const double cross = Reach(first.cross(second).norm(), half, piece.fastest * piece.tip_third);
  piece.curvature = cross / (piece.slowest * piece.slowest * piece.slowest);
  return true;
}

}  // namespace

bool AxisPieces::AreFor(const PathPiece& path) {
  return path.kind() == PathPiece::Kind::kLine || path.kind() == PathPiece::Kind::kRotary ||
         (path.kind() == PathPiece::Kind::kBlend && !path.in_axes());
}

AxisPieces::AxisPieces(const PartCurve& curve, std::size_t count) : count_(count) {
  const Arm arm(curve.head());
  const FourthBounds fourth = FourthOf(curve);
  half_ = 0.5 * (curve.end() - curve.begin()) / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    Piece& piece = pieces_[k];
    piece = {};
    const double p = curve.begin() + half_ * static_cast<double>(2 * k + 1);
    const Derivatives d = At(curve, p);
    if (curve.bends()) {
      known_ = BoundTip(d, half_, fourth.tip, piece);
      if (!known_) return;
    } else {
      piece.slowest = piece.fastest = 1.0;  // the parameter is s
    }
    const double turning_3 =
        Reach(std::abs(d.by[2].a) + std::abs(d.by[2].b), half_, fourth.turning);
    const double turning_2 = Reach(std::abs(d.by[1].a) + std::abs(d.by[1].b), half_, turning_3);
    const double turning = Reach(std::abs(d.by[0].a) + std::abs(d.by[0].b), half_, turning_2);
    const double square = turning * turning;
    const double arm_4 =
        arm.reach_mm() * (square * square + 6.0 * square * turning_2 + 3.0 * turning_2 * turning_2 +
                          4.0 * turning * turning_3 + fourth.turning);
    const std::array<MachineVector, 3> swing = arm.Swing(curve.Pose(p), d);
    for (int i = 0; i < motion::kAxisCount; ++i) {
      const auto of = [&](std::size_t order) {
        const PathDerivatives& by = d.by[order];
        return i == 3 ? by.a : i == 4 ? by.b : by.point[i] + swing[order][i];
      };
      piece.middle[i] = of(0);
      piece.third[i] = Reach(of(2), half_, i < 3 ? fourth.tip + arm_4 : fourth.turning);
      piece.second[i] = Reach(of(1), half_, piece.third[i]);
      piece.first[i] = Reach(of(0), half_, piece.second[i]);
    }
  }
}

bool AxisPieces::GoesOneWay(int axis) const {
  if (!known_) return false;
  const double sign = pieces_[0].middle[axis] > 0.0 ? 1.0 : -1.0;
  return std::ranges::all_of(pieces(), [&](const Piece& piece) {
    const double least = sign * piece.middle[axis] - half_ * piece.second[axis];
    return least > kStandingShare * piece.first.maxCoeff();
  });
}

}  // namespace rmlcell::simulation
