#include "engine/motion/corner.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/motion/least.h"

namespace rmlcell::motion {
namespace {

constexpr double kStraightHalfSine = 0.5e-6;               // a turn of 1e-6 rad
constexpr double kReversalHalfCosine = 0.043619387365336;  // a turn of 175 degrees
constexpr double kEqual = 1e-9;    // relative, for curvatures and rates that meet
constexpr double kNoRate = 1e-12;  // rad/mm

double Rho(double half_cosine) { return 2.0 * std::sqrt(half_cosine); }

// Peak curvature times cut between two lines; motion.md 4.2.
double Bend(double half_sine, double half_cosine, double rho) {
  const double middle = half_cosine * (15.0 / 8.0 - 7.0 * rho / 16.0);
  return 0.75 * rho * half_sine / (middle * middle);
}

// sqrt(kappa'^2 + kappa^4) at u: path jerk per speed cubed.
double JerkPerCube(const PathDerivatives& first, const Vec3& second, const Vec3& third) {
  const double square = Dot(first.tip, first.tip);
  const double speed = std::sqrt(square);
  const Vec3 cross = Cross(first.tip, second);
  const Vec3 change = Cross(first.tip, third);
  const double n = Norm(cross);
  const double kappa = n / (square * speed);
  const double n_change = n > 0.0 ? Dot(cross, change) / n : Norm(change);
  const double kappa_change =
      (n_change / (square * speed) - 3.0 * n * Dot(first.tip, second) / (square * square * speed)) /
      speed;
  return std::sqrt(kappa_change * kappa_change + kappa * kappa * kappa * kappa);
}

double JerkPerCube(const CornerCurve& curve, double u) {
  return JerkPerCube(curve.Derivative(u, 1), curve.Derivative(u, 2).tip,
                     curve.Derivative(u, 3).tip);
}

CornerCurve PlainCurve(double half_sine, double half_cosine) {
  // A corner of cut 1 at the origin, symmetric about the Y axis.
  const Vec3 in{half_cosine, -half_sine, 0.0};
  const Vec3 out{half_cosine, half_sine, 0.0};
  return CornerCurve({.pose = {-in}, .tangent = in, .curvature = {}},
                     {.pose = {out}, .tangent = out, .curvature = {}}, 1.0);
}

// Figures of the curve between two lines at cut 1, by the angle alone: made once, never changed.
class PlainTable {
 public:
  static const PlainTable& Get() {
    static const PlainTable table;
    return table;
  }

  // By q = sqrt(cos(theta/2)) = rho / 2, in which the length is smooth at both ends; four-point
  // interpolation.
  double Length(double rho) const {
    const double x = (0.5 * rho - kFirst) / kStep;
    const int k = std::clamp(static_cast<int>(x), 1, kNodes - 3);
    const double t = x - k;
    const auto at = [&](int i) { return length_[static_cast<std::size_t>(k + i)]; };
    return at(-1) * (-t * (t - 1.0) * (t - 2.0) / 6.0) +
           at(0) * ((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0) +
           at(1) * (-(t + 1.0) * t * (t - 2.0) / 2.0) + at(2) * ((t + 1.0) * t * (t - 1.0) / 6.0);
  }

  // The largest sqrt(kappa'^2 + kappa^4) as a share of J, by theta/2; never below the true one.
  double JerkShare(double half_sine, double half_cosine) const {
    const double x = std::atan2(half_sine, half_cosine) / kHalfTurnMax * (kNodes - 1);
    const int k = std::clamp(static_cast<int>(x), 0, kNodes - 2);
    const double t = x - k;
    const auto i = static_cast<std::size_t>(k);
    return (jerk_share_[i] * (1.0 - t) + jerk_share_[i + 1] * t) * (1.0 + kRoom);
  }

  static double Jerk(double half_sine, double half_cosine, double bend) {
    const double t = half_sine / half_cosine;
    return std::max(t * std::min(3.0 + 1.2 * t, 4.75), 1.04 * bend * bend);
  }

 private:
  static constexpr int kNodes = 1025;
  static constexpr double kFirst = 0.2088;  // sqrt(cos 87.5 degrees), rounded down
  static constexpr double kStep = (1.0 - kFirst) / (kNodes - 1);
  static constexpr double kHalfTurnMax = 1.5272;  // 87.5 degrees, rounded up
  static constexpr double kRoom = 1e-6;           // what straight lines between nodes may lack

  PlainTable() {
    for (int k = 0; k < kNodes; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double q = kFirst + kStep * k;
      const double cosine = std::min(q * q, 1.0);
      length_[i] = CornerLength(PlainCurve(std::sqrt(1.0 - cosine * cosine), cosine)).total();
      const double half_turn = std::max(kHalfTurnMax * k / (kNodes - 1), 1e-7);
      const double s = std::sin(half_turn);
      const double c = std::cos(half_turn);
      const CornerCurve curve = PlainCurve(s, c);
      constexpr int kIntervals = 40;  // of the first half: the curve is symmetric
      const double least =
          LeastAlong([&](double u) { return 1.0 / JerkPerCube(curve, u); }, 0.5, kIntervals);
      jerk_share_[i] = 1.0 / (least * Jerk(s, c, Bend(s, c, Rho(c))));
    }
  }

  std::array<double, kNodes> length_{};
  std::array<double, kNodes> jerk_share_{};
};

bool Same(const Vec3& a, const Vec3& b) {
  return Distance(a, b) <= kEqual * std::max(Norm(a), Norm(b));
}
bool Same(double a, double b) {
  return std::abs(a - b) <= std::max(kEqual * std::max(std::abs(a), std::abs(b)), kNoRate);
}

}  // namespace

void Corner::Assign(const PathPiece& before, const PathPiece& after) {
  const PathDerivatives in = before.First(before.length());
  const PathDerivatives out = after.First(0.0);
  half_sine_ = std::min(0.5 * Distance(in.tip, out.tip), 1.0);
  half_cosine_ = std::sqrt(std::max(0.0, 0.5 * (1.0 + Dot(in.tip, out.tip))));
  lines_ = before.kind() == PathPiece::Kind::kLine && after.kind() == PathPiece::Kind::kLine;
  const bool turns = in.a != 0.0 || in.b != 0.0 || out.a != 0.0 || out.b != 0.0;
  plain_ = lines_ && !turns;
  cut_max_mm_ = HUGE_VAL;
  curvature_jump_ = a_jump_ = b_jump_ = 0.0;
  straight_ = half_sine_ <= kStraightHalfSine;
  if (half_cosine_ < kReversalHalfCosine) {
    passage_ = Passage::kStopReversal;
    return;
  }
  bool smooth = true;
  if (!plain_) {
    straight_ = straight_ && Same(in.a, out.a) && Same(in.b, out.b);
    a_jump_ = std::abs(out.a - in.a);
    b_jump_ = std::abs(out.b - in.b);
  }
  if (!lines_) {
    const Vec3 bend_in = before.Second(before.length()).tip;
    const Vec3 bend_out = after.Second(0.0).tip;
    smooth = Same(bend_in, bend_out);
    curvature_jump_ = Distance(bend_in, bend_out);
    for (const PathPiece* piece : {&before, &after}) {
      if (piece->kind() != PathPiece::Kind::kArc) continue;
      cut_max_mm_ = std::min(cut_max_mm_, 0.5 * piece->radius_mm());
    }
  }
  passage_ = straight_ && smooth ? Passage::kThrough : Passage::kBlend;
  if (passage_ == Passage::kThrough) return;
  rho_ = Rho(half_cosine_);
  bend_ = Bend(half_sine_, half_cosine_, rho_);
  jerk_ = PlainTable::Jerk(half_sine_, half_cosine_, bend_);
}

double Corner::CutFor(double w, const MachineLimits& machine) const {
  const double square = w * w;
  const double cube = square * w;
  const double jerk = machine.normal_jerk();
  double cut =
      std::max(bend_ * square / machine.normal_acceleration(), std::sqrt(jerk_ * cube / jerk));
  if (curvature_jump_ > 0.0) cut = std::max(cut, 1.2 * curvature_jump_ * cube / jerk);
  if (a_jump_ > 0.0) {
    cut = std::max({cut, 0.75 * a_jump_ * square / machine.axes.acceleration[3],
                    std::sqrt(1.5 * a_jump_ * cube / machine.axes.jerk[3])});
  }
  if (b_jump_ > 0.0) {
    cut = std::max({cut, 0.75 * b_jump_ * square / machine.axes.acceleration[4],
                    std::sqrt(1.5 * b_jump_ * cube / machine.axes.jerk[4])});
  }
  return cut;
}

double Corner::PlainLength(double cut_mm) const {
  return cut_mm * PlainTable::Get().Length(rho_);
}

double Corner::PlainDeviation(double cut_mm) const {
  return cut_mm * half_sine_ * (1.0 - 5.0 * rho_ / 16.0);
}

double Corner::PlainBow(double cut_mm) const { return cut_mm * (0.5 - 5.0 * rho_ / 32.0); }

double Corner::PlainSpeed(double cut_mm, const MachineLimits& machine) const {
  const double by_acceleration = std::sqrt(machine.normal_acceleration() * cut_mm / bend_);
  if (std::isinf(machine.tip_jerk_mm_s3)) return by_acceleration;
  const double jerk = jerk_ * PlainTable::Get().JerkShare(half_sine_, half_cosine_);
  return std::min(by_acceleration, std::cbrt(machine.normal_jerk() * cut_mm * cut_mm / jerk));
}

double JunctionSpeed(const Vec3& tangent_in, const Vec3& tangent_out, double jump_mm_s) {
  const Vec3 turn = tangent_out - tangent_in;
  return jump_mm_s / std::max({std::abs(turn.x), std::abs(turn.y), std::abs(turn.z)});
}

CurveEnd EndAt(const PathPiece& path, double s) {
  const PathDerivatives first = path.First(s);
  return {.pose = path.At(s),
          .tangent = first.tip,
          .curvature = path.Second(s).tip,
          .a_rate = first.a,
          .b_rate = first.b};
}

bool AxesFollow(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                double speed, double bend_per_mm) {
  const CornerCurve::Bounds by_u = curve.DerivativeBounds();
  if (!(by_u.slowest > 0.0)) return false;
  const double per_mm = 1.0 / by_u.slowest;
  const double stretch = by_u.tip_second * per_mm;  // of (p' p'') / |p'|
  const double a = by_u.a_first * per_mm;
  const double b = by_u.b_first * per_mm;
  const double aa = (by_u.a_second + by_u.a_first * stretch) * per_mm * per_mm;
  const double bb = (by_u.b_second + by_u.b_first * stretch) * per_mm * per_mm;
  const double arm = head.arm_mm();
  const double first = 1.0 + arm * (a + b);
  const double second = bend_per_mm + arm * (aa + bb + (a + b) * (a + b));
  const AxisLimits& axes = machine.axes;
  const double square = speed * speed;
  bool enough = a * speed <= axes.speed[3] && b * speed <= axes.speed[4] &&
                aa * square <= axes.acceleration[3] && bb * square <= axes.acceleration[4];
  for (std::size_t i = 0; i < 3; ++i) {
    enough = enough && first * speed <= axes.speed[i] && second * square <= axes.acceleration[i];
  }
  return enough;
}

double SpeedOnCurve(const CornerCurve& curve, const Head& head, const MachineLimits& machine) {
  const double normal = machine.normal_acceleration();
  const double jerk = machine.normal_jerk();
  const auto allowed = [&](double u) {
    const PathDerivatives first = curve.FirstByLength(u);
    const PathDerivatives second = curve.SecondByLength(u);
    const double kappa = Norm(second.tip);
    double speed = SpeedWithinAxes(ThroughHead(head, curve.At(u), first, second), machine.axes);
    if (kappa > 0.0) speed = std::min(speed, std::sqrt(normal / kappa));
    if (std::isfinite(jerk)) {
      const double per_cube = JerkPerCube(curve, u);
      if (per_cube > 0.0) speed = std::min(speed, std::cbrt(jerk / per_cube));
    }
    return speed;
  };
  constexpr int kIntervals = 48;
  return LeastAlong(allowed, 1.0, kIntervals);
}

}  // namespace rmlcell::motion
