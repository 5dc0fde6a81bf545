#pragma once

#include <array>
#include <cstddef>

#include "engine/motion/geometry/pose.h"

namespace rmlcell::motion {

// Where a corner curve leaves or joins a path: pose, unit tangent, curvature vector (1/mm) and the
// rates of the head (rad/mm).
struct CurveEnd {
  PathPose pose;
  MachineVector tangent;
  MachineVector curvature;
  double a_rate = 0.0;
  double b_rate = 0.0;
};

// Derivatives of a path by its own variable.
struct PathDerivatives {
  MachineVector point;
  double a = 0.0;
  double b = 0.0;
};

// Where two lines meet, passed with a steady head: all that the curve there follows from. Nearly
// every corner is one, so motions carry this and not the coefficients.
struct PlainCorner {
  PathPose at;
  MachineVector tangent_in;
  MachineVector tangent_out;
  double cut_mm = 0.0;  // the curve begins and ends this far from the corner

  PathPose Start() const { return {at.point - tangent_in * cut_mm, at.a_rad, at.b_rad}; }
  PathPose Finish() const { return {at.point + tangent_out * cut_mm, at.a_rad, at.b_rad}; }
};

// The curve of a /FLY passage: a quintic in X Y Z A B whose position, tangent, curvature and head
// rates meet those of both pieces. motion.md 4.2. A value of fixed size. Between two moves in COORD
// ROBOT it is a curve of the axes by time instead (4.5): the same quintic with rho = 2, whose u
// grows evenly.
class CornerCurve {
 public:
  CornerCurve() = default;

  // Both ends are cut at the distance `cut_mm` from the corner.
  CornerCurve(const CurveEnd& from, const CurveEnd& to, double cut_mm);

  // From the corner itself, so that a curve of 1e-3 mm far from the origin keeps its digits.
  explicit CornerCurve(const PlainCorner& corner);

  // Between two kJoint pieces, measured by the time that they take at full speed; `cut_s` of it is
  // cut off both.
  static CornerCurve InAxes(const CurveEnd& from, const CurveEnd& to, double cut_s);
  bool in_axes() const { return way_s_ > 0.0; }
  void MeasureBy(double factor) { way_s_ *= factor; }
  double way_s() const { return way_s_; }  // in_axes: the length of the curve in that measure

  // u runs from 0 to 1.
  PathPose At(double u) const;
  PathDerivatives Derivative(double u, int order) const;  // by u; order 1 to 3

  // What the head does at u, and the third derivative of the tip alone, as of At and Derivative.
  struct HeadPlace {
    double a_rad = 0.0;
    double b_rad = 0.0;
  };
  HeadPlace HeadAt(double u) const;
  MachineVector TipDerivative(double u, int order) const;

  // Derivatives by s, which is arc length but in_axes: first (the tangent), second (the curvature
  // vector).
  PathDerivatives FirstByLength(double u) const;
  PathDerivatives SecondByLength(double u) const;

  // Path jerk per speed cubed: sqrt(kappa'^2 + kappa^4).
  double JerkPerCube(double u) const {
    return JerkPerCube(TipDerivative(u, 1), TipDerivative(u, 2), TipDerivative(u, 3));
  }

  // The same from the derivatives by u, for who asks for several of them at one place; s is arc
  // length.
  static PathDerivatives FirstByLength(const PathDerivatives& first);
  static PathDerivatives SecondByLength(const PathDerivatives& first,
                                        const PathDerivatives& second);
  static double JerkPerCube(const MachineVector& first, const MachineVector& second,
                            const MachineVector& third);

  // Bounds of the derivatives by u, from control points: cheap, and good on gentle curves.
  struct Bounds {
    double slowest = 0.0;     // of |dp/du|, from below; at most 0 when nothing is known
    double tip_second = 0.0;  // the rest from above
    double a_first = 0.0;
    double b_first = 0.0;
    double a_second = 0.0;
    double b_second = 0.0;
  };
  Bounds DerivativeBounds() const;

  // Distance of `point` from the curve, and from its nearest place.
  double DistanceFrom(const MachinePoint& point) const;

  double Speed(double u) const;  // |dp/du|
  // Where that is least, and with it the curve sharpest.
  double SlowestPlace() const;
  // Whether it comes to a point on its way: it is bent ten times as sharp there as a curve between
  // lines at the turn that is a stop, 175 degrees, with the same cut. Only curves beside an arc can
  // (docs/decisions/0011-cusps.md).
  bool HasCusp(double cut_mm) const;
  double Integral(double u_from, double u_to) const;  // arc length, one panel

 private:
  friend class CurveRates;
  static double Scale(const MachineVector& tangent_in, const MachineVector& tangent_out,
                      double cut_mm);
  void FitEnds(const CurveEnd& from, const CurveEnd& to, double scale);
  bool turns_ = false;  // the head; else only the first of a_ and b_ counts
  double way_s_ = 0.0;
  // Coefficients of u^0 .. u^5.
  std::array<MachineVector, 6> tip_{};
  std::array<double, 6> a_{};
  std::array<double, 6> b_{};
};

// The derivatives of a curve by u, for who asks for them at many places.
class CurveRates {
 public:
  // Of X Y Z A B; the last is nothing: they are worked out in pairs.
  using Values = std::array<double, 6>;

  explicit CurveRates(const CornerCurve& curve);

  Values First(double u) const {
    Values values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = (((first_[4][i] * u + first_[3][i]) * u + first_[2][i]) * u + first_[1][i]) * u +
                  first_[0][i];
    }
    return values;
  }
  Values Second(double u) const {
    Values values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = ((second_[3][i] * u + second_[2][i]) * u + second_[1][i]) * u + second_[0][i];
    }
    return values;
  }

 private:
  std::array<Values, 5> first_;  // coefficients of u^0 .. u^4
  std::array<Values, 4> second_;
};

// Arc length along a corner curve by Gauss-Legendre on eight panels; on sixteen, narrower towards
// the place where the curve is sharpest, when it nearly has a cusp. Of a curve in_axes its own even
// measure.
class CornerLength {
 public:
  explicit CornerLength(const CornerCurve& curve);

  double total() const { return reached_[panels_]; }
  double ParameterAt(const CornerCurve& curve, double s) const;  // 0 <= s <= total()

 private:
  static constexpr std::size_t kPanels = 8;
  static constexpr std::size_t kPanelsMax = 16;
  void ChoosePanels(const CornerCurve& curve);

  std::size_t panels_ = 0;
  std::array<double, kPanelsMax + 1> edge_{};     // u
  std::array<double, kPanelsMax + 1> reached_{};  // arc length there
};

}  // namespace rmlcell::motion
