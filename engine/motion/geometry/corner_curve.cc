#include "engine/motion/geometry/corner_curve.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "engine/core/indices.h"

namespace rmlcell::motion {
namespace {

// Gauss-Legendre with eight points on [-1, 1]; the speed along a sharp corner is far from a
// polynomial.
constexpr std::array kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                           0.9602898564975363};
constexpr std::array kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                             0.1012285362903763};
static_assert(kNode.size() == kWeight.size());

// The quintic from p0 to p0 + h with these first and second derivatives at u = 0 and 1;
// motion.md 4.2.
template <class T>
void Fit(std::array<T, 6>& c, const std::type_identity_t<T>& p0, const std::type_identity_t<T>& h,
         const std::type_identity_t<T>& v0, const std::type_identity_t<T>& v1,
         const std::type_identity_t<T>& c0, const std::type_identity_t<T>& c1) {
  c[0] = p0;
  c[1] = v0;
  c[2] = c0 * 0.5;
  c[3] = h * 10.0 - v0 * 6.0 - v1 * 4.0 - c0 * 1.5 + c1 * 0.5;
  c[4] = h * -15.0 + v0 * 8.0 + v1 * 7.0 + c0 * 1.5 - c1;
  c[5] = h * 6.0 - v0 * 3.0 - v1 * 3.0 - c0 * 0.5 + c1 * 0.5;
}

double Value(const std::array<double, 6>& c, double u) {
  return c[0] + (c[1] + (c[2] + (c[3] + (c[4] + c[5] * u) * u) * u) * u) * u;
}
double First(const std::array<double, 6>& c, double u) {
  return c[1] + (c[2] * 2.0 + (c[3] * 3.0 + (c[4] * 4.0 + c[5] * (5.0 * u)) * u) * u) * u;
}
double Second(const std::array<double, 6>& c, double u) {
  return c[2] * 2.0 + (c[3] * 6.0 + (c[4] * 12.0 + c[5] * (20.0 * u)) * u) * u;
}
double Third(const std::array<double, 6>& c, double u) {
  return c[3] * 6.0 + (c[4] * 24.0 + c[5] * (60.0 * u)) * u;
}

using Tips = std::array<MachineVector, 6>;
// Of one coordinate after the other: of a vector's expression g++ keeps the parts on the stack.
template <double (*kOf)(const std::array<double, 6>&, double)>
MachineVector Of(const Tips& c, double u) {
  const auto along = [&](int axis) {
    return kOf({c[0][axis], c[1][axis], c[2][axis], c[3][axis], c[4][axis], c[5][axis]}, u);
  };
  return {along(0), along(1), along(2)};
}
MachineVector Value(const Tips& c, double u) { return Of<Value>(c, u); }
MachineVector First(const Tips& c, double u) { return Of<First>(c, u); }
MachineVector Second(const Tips& c, double u) { return Of<Second>(c, u); }
MachineVector Third(const Tips& c, double u) { return Of<Third>(c, u); }

}  // namespace

double CornerCurve::Scale(const MachineVector& tangent_in, const MachineVector& tangent_out,
                          double cut_mm) {
  // rho = 2 sqrt(cos(theta/2)) keeps the peak of curvature low at every angle.
  const double half_cosine = std::sqrt(std::max(0.0, 0.5 * (1.0 + tangent_in.dot(tangent_out))));
  return 2.0 * std::sqrt(half_cosine) * cut_mm;
}

CornerCurve::CornerCurve(const CurveEnd& from, const CurveEnd& to, double cut_mm) {
  FitEnds(from, to, Scale(from.tangent, to.tangent, cut_mm));
}

CornerCurve CornerCurve::InAxes(const CurveEnd& from, const CurveEnd& to, double cut_s) {
  CornerCurve curve;
  curve.way_s_ = 2.0 * cut_s;
  curve.FitEnds(from, to, curve.way_s_);
  return curve;
}

void CornerCurve::FitEnds(const CurveEnd& from, const CurveEnd& to, double scale) {
  turns_ = true;
  const double square = scale * scale;
  Fit(tip_, from.pose.point, to.pose.point - from.pose.point, from.tangent * scale,
      to.tangent * scale, from.curvature * square, to.curvature * square);
  Fit(a_, from.pose.a_rad, to.pose.a_rad - from.pose.a_rad, from.a_rate * scale, to.a_rate * scale,
      0.0, 0.0);
  Fit(b_, from.pose.b_rad, to.pose.b_rad - from.pose.b_rad, from.b_rate * scale, to.b_rate * scale,
      0.0, 0.0);
}

CornerCurve::CornerCurve(const PlainCorner& corner) {
  const double cut = corner.cut_mm;
  const double scale = Scale(corner.tangent_in, corner.tangent_out, cut);
  Fit(tip_, corner.at.point - corner.tangent_in * cut,
      (corner.tangent_in + corner.tangent_out) * cut, corner.tangent_in * scale,
      corner.tangent_out * scale, MachineVector{}, MachineVector{});
  a_[0] = corner.at.a_rad;
  b_[0] = corner.at.b_rad;
}

PathPose CornerCurve::At(double u) const {
  if (!turns_) return {Value(tip_, u), a_[0], b_[0]};
  return {Value(tip_, u), Value(a_, u), Value(b_, u)};
}

PathDerivatives CornerCurve::Derivative(double u, int order) const {
  if (order == 1) return {First(tip_, u), First(a_, u), First(b_, u)};
  if (order == 2) return {Second(tip_, u), Second(a_, u), Second(b_, u)};
  return {Third(tip_, u), Third(a_, u), Third(b_, u)};
}

CornerCurve::HeadPlace CornerCurve::HeadAt(double u) const {
  if (!turns_) return {a_[0], b_[0]};
  return {Value(a_, u), Value(b_, u)};
}

MachineVector CornerCurve::TipDerivative(double u, int order) const {
  if (order == 1) return First(tip_, u);
  return order == 2 ? Second(tip_, u) : Third(tip_, u);
}

PathDerivatives CornerCurve::FirstByLength(double u) const {
  const PathDerivatives d = Derivative(u, 1);
  if (!in_axes()) return FirstByLength(d);
  const double per_s = 1.0 / way_s_;
  return {d.point * per_s, d.a * per_s, d.b * per_s};
}

PathDerivatives CornerCurve::FirstByLength(const PathDerivatives& d) {
  const double per_mm = 1.0 / d.point.norm();
  return {d.point * per_mm, d.a * per_mm, d.b * per_mm};
}

PathDerivatives CornerCurve::SecondByLength(double u) const {
  const PathDerivatives e = Derivative(u, 2);
  if (!in_axes()) return SecondByLength(Derivative(u, 1), e);
  const double square = 1.0 / (way_s_ * way_s_);
  return {e.point * square, e.a * square, e.b * square};
}

PathDerivatives CornerCurve::SecondByLength(const PathDerivatives& d, const PathDerivatives& e) {
  const double square = 1.0 / d.point.dot(d.point);
  const double along = d.point.dot(e.point) * square;  // d(|p'|)/du over |p'|
  return {(e.point - d.point * along) * square, (e.a - d.a * along) * square,
          (e.b - d.b * along) * square};
}

double CornerCurve::JerkPerCube(const MachineVector& first, const MachineVector& second,
                                const MachineVector& third) {
  const double square = first.dot(first);
  const double speed = std::sqrt(square);
  const MachineVector cross = first.cross(second);
  const MachineVector change = first.cross(third);
  const double n = cross.norm();
  const double kappa = n / (square * speed);
  // Where the curve meets a line it does not bend, and what rounding leaves of that points
  // anywhere: it begins to bend the way that it changes.
  constexpr double kNoTurn_rad = 1e-10;  // by u
  const double n_change = n > kNoTurn_rad * square ? cross.dot(change) / n : change.norm();
  const double kappa_change =
      (n_change / (square * speed) - 3.0 * n * first.dot(second) / (square * square * speed)) /
      speed;
  return std::sqrt(kappa_change * kappa_change + kappa * kappa * kappa * kappa);
}

CornerCurve::Bounds CornerCurve::DerivativeBounds() const {
  // Control points of the first derivative (degree 4) and the second (degree 3).
  const auto first = []<class T>(const std::array<T, 6>& c) {
    return std::array<T, 5>{c[1], c[1] + c[2] * 0.5, c[1] + c[2] + c[3] * 0.5,
                            c[1] + c[2] * 1.5 + c[3] * 1.5 + c[4], First(c, 1.0)};
  };
  const auto second = []<class T>(const std::array<T, 6>& c) {
    return std::array<T, 4>{c[2] * 2.0, c[2] * 2.0 + c[3] * 2.0,
                            c[2] * 2.0 + c[3] * 4.0 + c[4] * 4.0, Second(c, 1.0)};
  };
  const auto largest = [](const auto& values) {
    double most = 0.0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
  };
  Bounds bounds;
  const std::array<MachineVector, 5> tip = first(tip_);
  const MachineVector sum = tip[0] + tip[4];  // along the bisector: both ends have the same length
  const double along = sum.norm();
  double least = HUGE_VAL;
  for (const MachinePoint& control : tip) least = std::min(least, control.dot(sum));
  bounds.slowest = least / along;
  double square = 0.0;
  for (const MachinePoint& control : second(tip_)) square = std::max(square, control.dot(control));
  bounds.tip_second = std::sqrt(square);
  bounds.a_first = largest(first(a_));
  bounds.b_first = largest(first(b_));
  bounds.a_second = largest(second(a_));
  bounds.b_second = largest(second(b_));
  return bounds;
}

CurveRates::CurveRates(const CornerCurve& curve) {
  for (const std::size_t k : IndicesOf(first_)) {
    const MachineVector& tip = curve.tip_[k + 1];
    const double order = static_cast<double>(k + 1);
    const Values c{tip.x(), tip.y(), tip.z(), curve.a_[k + 1], curve.b_[k + 1], 0.0};
    for (const std::size_t i : IndicesOf(c)) first_[k][i] = order * c[i];
  }
  for (const std::size_t k : IndicesOf(second_)) {
    const double order = static_cast<double>(k + 1);
    for (const std::size_t i : IndicesOf(second_[k])) second_[k][i] = order * first_[k + 1][i];
  }
}

double CornerCurve::Speed(double u) const { return First(tip_, u).norm(); }

// Speed at all nodes side by side, each in the order of its operations, so that two of them are
// worked out at once: most of what it takes to find a place by its length.
double CornerCurve::Integral(double from, double to) const {
  constexpr std::size_t kPlaces = 2 * kNode.size();
  const double middle = 0.5 * (from + to);
  const double half = 0.5 * (to - from);
  std::array<double, kPlaces> u;
  for (const std::size_t k : IndicesOf(kNode)) {
    u[2 * k] = middle - half * kNode[k];
    u[2 * k + 1] = middle + half * kNode[k];
  }
  std::array<std::array<double, kPlaces>, 3> rate;
  for (const std::size_t axis : IndicesOf(rate)) {
    const auto i = static_cast<Eigen::Index>(axis);
    const std::array<double, 5> c{tip_[1][i], tip_[2][i] * 2.0, tip_[3][i] * 3.0, tip_[4][i] * 4.0,
                                  tip_[5][i]};
    for (const std::size_t k : IndicesOf(u))
      rate[axis][k] = c[0] + (c[1] + (c[2] + (c[3] + c[4] * (5.0 * u[k])) * u[k]) * u[k]) * u[k];
  }
  std::array<double, kPlaces> speed;
  for (const std::size_t k : IndicesOf(speed))  // added as norm() adds them
    speed[k] =
        std::sqrt(rate[0][k] * rate[0][k] + rate[1][k] * rate[1][k] + rate[2][k] * rate[2][k]);
  double sum = 0.0;
  for (const std::size_t k : IndicesOf(kNode))
    sum += kWeight[k] * (speed[2 * k] + speed[2 * k + 1]);
  return half * sum;
}

double CornerCurve::SlowestPlace() const {
  constexpr int kSamples = 16;
  double slowest = HUGE_VAL;
  double where = 0.5;
  for (int k = 0; k <= kSamples; ++k) {
    const double u = static_cast<double>(k) / kSamples;
    const double speed = Speed(u);
    if (speed < slowest) {
      slowest = speed;
      where = u;
    }
  }
  // Newton on d|p'|^2 / du, which has a simple root near a cusp.
  for (int step = 0; step < 8; ++step) {
    const MachineVector first = Derivative(where, 1).point;
    const MachineVector second = Derivative(where, 2).point;
    const double slope = second.dot(second) + first.dot(Derivative(where, 3).point);
    if (!(slope > 0.0)) break;
    where = std::clamp(where - first.dot(second) / slope, 0.0, 1.0);
  }
  return where;
}

bool CornerCurve::HasCusp(double cut_mm) const {
  constexpr double kSharpest = 574.0;  // 10 K(175 degrees), motion.md 4.2: curvature x cut
  const double bend = SecondByLength(SlowestPlace()).point.norm();
  return !(bend * cut_mm < kSharpest);  // also when it stands still there
}

void CornerLength::ChoosePanels(const CornerCurve& curve) {
  constexpr int kSamples = 16;
  constexpr double kNearCusp = 0.25;  // of the mean: above, equal panels are good to 1e-12
  double slowest = HUGE_VAL;
  double sum = 0.0;
  for (int k = 0; k <= kSamples; ++k) {
    const double speed = curve.Speed(static_cast<double>(k) / kSamples);
    sum += speed;
    slowest = std::min(slowest, speed);
  }
  if (slowest * (kSamples + 1) > kNearCusp * sum) {
    panels_ = kPanels;
    for (std::size_t k = 1; k <= kPanels; ++k) edge_[k] = static_cast<double>(k) / kPanels;
    return;
  }
  const double where = curve.SlowestPlace();
  panels_ = kPanelsMax;
  constexpr std::size_t kSide = kPanelsMax / 2;
  constexpr double kShrink = 0.3;
  double share = 1.0;
  for (const std::size_t k : Indices(kSide)) {
    edge_[k] = where * (1.0 - share);
    edge_[kPanelsMax - k] = where + (1.0 - where) * share;
    share *= kShrink;
  }
  edge_[kSide] = where;
}

CornerLength::CornerLength(const CornerCurve& curve) {
  if (curve.in_axes()) {
    panels_ = 1;
    reached_[1] = curve.way_s();
    return;
  }
  ChoosePanels(curve);
  for (const std::size_t k : Indices(panels_)) {
    reached_[k + 1] = reached_[k] + curve.Integral(edge_[k], edge_[k + 1]);
  }
}

double CornerLength::ParameterAt(const CornerCurve& curve, double s) const {
  if (!(s > 0.0)) return 0.0;
  if (s >= reached_[panels_]) return 1.0;
  if (curve.in_axes()) return s / reached_[1];
  std::size_t panel = 0;
  while (s > reached_[panel + 1]) ++panel;
  const double from = edge_[panel];
  const double to = edge_[panel + 1];
  const double wanted = s - reached_[panel];
  double u = from + (to - from) * wanted / (reached_[panel + 1] - reached_[panel]);
  constexpr int kSteps = 4;  // quadratic from a guess within a panel: 1e-2, 1e-4, 1e-8, 1e-16
  for (int step = 0; step < kSteps; ++step) {
    const double miss = curve.Integral(from, u) - wanted;
    u = std::clamp(u - miss / curve.Speed(u), from, to);
    if (std::abs(miss) <= 1e-15 * reached_[panels_]) break;
  }
  return u;
}

double CornerCurve::DistanceFrom(const MachinePoint& point) const {
  constexpr int kSamples = 64;
  double best = 0.0;
  double best_square = HUGE_VAL;
  for (int k = 0; k <= kSamples; ++k) {
    const double u = static_cast<double>(k) / kSamples;
    const MachineVector gap = Value(tip_, u) - point;
    if (gap.dot(gap) < best_square) {
      best_square = gap.dot(gap);
      best = u;
    }
  }
  // Newton on the foot point; the curve is nearly a parabola at this scale.
  for (int step = 0; step < 6; ++step) {
    const MachineVector gap = Value(tip_, best) - point;
    const MachineVector first = First(tip_, best);
    const double slope = first.dot(first) + gap.dot(Second(tip_, best));
    if (!(slope > 0.0)) break;
    best = std::clamp(best - gap.dot(first) / slope, 0.0, 1.0);
  }
  return std::min(std::sqrt(best_square), (Value(tip_, best) - point).norm());
}

}  // namespace rmlcell::motion
