#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/indices.h"
#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/least.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr int kCurveIntervalsMin = 16;
constexpr int kCurveIntervalsMax = 48;
constexpr double kPerWidth = 4.0;  // intervals at least, on the way on which the curve turns

// What keeps the speed on a curve down: the normal acceleration, the jerk, the speed of each axis
// and its acceleration. Each allows a speed that falls with what the curve asks of it, its demand:
// the root of limit over demand, of first, second or third degree. Demands are compared, and roots
// taken of few.
class CurveDemand {
 public:
  static constexpr std::size_t kAxisSpeed = 0;         // of the first axis
  static constexpr std::size_t kAxisAcceleration = 6;  // the last of six is nothing: CurveRates
  static constexpr std::size_t kNormal = 5;
  static constexpr std::size_t kJerk = 11;
  static constexpr std::size_t kLimits = 12;
  using Demands = std::array<double, kLimits>;

  CurveDemand(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
              bool of_lines)
      : curve_(curve), head_(head), tip_asks_(!of_lines), rates_(curve) {
    limits_[kNormal] = machine.normal_acceleration();
    limits_[kJerk] = machine.normal_jerk();
    for (const std::size_t i : kAxes) {
      limits_[kAxisSpeed + i] = machine.axes.speed[i];
      limits_[kAxisAcceleration + i] = machine.axes.acceleration[i];
    }
    middle_ = curve.HeadAt(0.5);
    sines_ = HeadSines::At(middle_.a_rad, middle_.b_rad);
  }

  Demands At(double u) const {
    const CurveRates::Values by_u = rates_.First(u), by_u_twice = rates_.Second(u);
    const auto dot = [](const CurveRates::Values& p, const CurveRates::Values& q) {
      return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    };
    const double per_square = 1.0 / dot(by_u, by_u);
    const double per_mm = std::sqrt(per_square);
    const double along = dot(by_u, by_u_twice) * per_square;  // d(|p'|)/du over |p'|
    CurveRates::Values first, second;
    for (const std::size_t i : IndicesOf(first)) {
      first[i] = by_u[i] * per_mm;
      second[i] = (by_u_twice[i] - by_u[i] * along) * per_square;
    }
    const Swing swing =
        head_.SwingAt(SinesAt(u), {{}, first[3], first[4]}, {{}, second[3], second[4]});
    Demands demands;
    for (const std::size_t i : IndicesOf(first)) {
      const bool column = i < 3;
      const auto axis = static_cast<int>(i);
      demands[kAxisSpeed + i] = std::abs(first[i] + (column ? swing.first[axis] : 0.0));
      demands[kAxisAcceleration + i] = std::abs(second[i] + (column ? swing.second[axis] : 0.0));
    }
    demands[kNormal] = tip_asks_ ? Known(std::sqrt(dot(second, second))) : 0.0;
    demands[kJerk] = tip_asks_ ? Known(curve_.JerkPerCube(u)) : 0.0;
    return demands;
  }

  // One of them.
  double Of(std::size_t limit, double u) const {
    return limit == kJerk ? Known(curve_.JerkPerCube(u)) : At(u)[limit];
  }

  // The speed that a demand leaves.
  double Speed(std::size_t limit, double demand) const {
    const double share = limits_[limit] / demand;
    if (limit == kJerk) return std::cbrt(share);
    return DegreeOf(limit) == 2 ? std::sqrt(share) : share;
  }
  // Above which demand the speed falls below this one, but for rounding.
  double DemandFor(std::size_t limit, double speed) const {
    double power = speed;
    for (int k = 1; k < DegreeOf(limit); ++k) power *= speed;
    return limits_[limit] / power;
  }
  static constexpr int DegreeOf(std::size_t limit) {
    if (limit == kJerk) return 3;
    return limit < kNormal ? 1 : 2;
  }

 private:
  // Where the curve stands still it asks for no number: nothing then.
  static double Known(double demand) { return std::max(0.0, demand); }

  HeadSines SinesAt(double u) const {
    const CornerCurve::HeadPlace at = curve_.HeadAt(u);
    const double a = at.a_rad - middle_.a_rad, b = at.b_rad - middle_.b_rad;
    const bool little = std::max(std::abs(a), std::abs(b)) <= HeadSines::kLittle_rad;
    return little ? sines_.Turned(a, b) : HeadSines::At(at.a_rad, at.b_rad);
  }

  const CornerCurve& curve_;
  const Head& head_;
  bool tip_asks_;
  CurveRates rates_;
  CornerCurve::HeadPlace middle_;
  HeadSines sines_;  // there
  std::array<double, kLimits> limits_;
};

// LeastOfSampled of the speeds between two places, found by the demands.
class LeastOnPart {
 public:
  // `intervals`: at most kCurveIntervalsMax.
  LeastOnPart(const CurveDemand& demand, double from, double length, int intervals)
      : demand_(demand), from_(from), length_(length), intervals_(intervals) {}

  double Find(double enough) {
    enough_ = enough;
    CurveDemand::Demands most{};
    for (int k = 0; k <= intervals_; ++k) {
      CurveDemand::Demands& sample = samples_[static_cast<std::size_t>(k)];
      sample = demand_.At(from_ + Place(k));
      for (const std::size_t i : IndicesOf(most)) most[i] = std::max(most[i], sample[i]);
    }
    for (const std::size_t i : IndicesOf(most)) {
      best_ = std::min(best_, demand_.Speed(i, most[i]));  // infinite where nothing is asked
    }
    std::array<std::size_t, CurveDemand::kLimits> asked{};  // limits that may have a valley
    std::size_t count = 0;
    for (const std::size_t i : IndicesOf(most)) {
      // What is drawn on over a sample is at most twice what is asked there: as a share of the
      // speed.
      enough_demand_[i] = demand_.DemandFor(i, std::min(best_, enough_)) /
                          static_cast<double>(1 << CurveDemand::DegreeOf(i)) * kSurely;
      if (most[i] > enough_demand_[i]) asked[count++] = i;
    }
    for (int k = 1; k < intervals_; ++k) {
      for (const std::size_t i : Indices(count)) LookAbout(asked[i], k);
    }
    return best_;
  }

 private:
  static constexpr double kSurely = 1.0 - 1e-9;  // beyond what rounding does to a demand

  double Place(int k) const { return length_ * k / intervals_; }
  double DemandAt(std::size_t limit, int k) const {
    return samples_[static_cast<std::size_t>(k)][limit];
  }
  double SpeedAt(std::size_t limit, int k) const {
    return demand_.Speed(limit, DemandAt(limit, k));
  }

  void LookAbout(std::size_t limit, int k) {
    const bool first = k == 1, last = k == intervals_ - 1;
    const double a = DemandAt(limit, k - 1), b = DemandAt(limit, k), c = DemandAt(limit, k + 1);
    if (b >= a && b >= c) {
      if (b > enough_demand_[limit]) LookBetween(limit, k);
    } else if (first && a > b) {
      if (a > enough_demand_[limit]) LookAtEnd(limit, c, 1, 0);
    } else if (last && c > b) {
      if (c > enough_demand_[limit]) LookAtEnd(limit, a, k, intervals_);
    }
  }

  static constexpr double kGain = 1e-12;  // relative; less is rounding
  bool Matters(double most_asked) const {
    return most_asked * std::min(best_, enough_) > 1.0 + kGain;
  }

  // A demand that is highest at sample k of its neighbours.
  void LookBetween(std::size_t limit, int k) {
    const double beside = std::max(SpeedAt(limit, k - 1), SpeedAt(limit, k + 1));
    if (!Matters(DrawnOn(beside, SpeedAt(limit, k)))) return;
    if (limit == CurveDemand::kJerk) return LookBySections(limit, k - 1, k + 1);
    Keep(limit,
         MostByParabolas([&](double x) { return demand_.Of(limit, from_ + x); },
                         {Place(k - 1), Place(k), Place(k + 1)},
                         {DemandAt(limit, k - 1), DemandAt(limit, k), DemandAt(limit, k + 1)}));
  }

  // One that rises towards an end.
  void LookAtEnd(std::size_t limit, double before_next, int next, int end) {
    const double at_next = DemandAt(limit, next), at_end = DemandAt(limit, end);
    const auto speed = [&](double demand) { return demand_.Speed(limit, demand); };
    if (!Matters(MostAskedAtEnd(speed(before_next), speed(at_next), speed(at_end)))) return;
    if (limit == CurveDemand::kJerk)
      return LookBySections(limit, std::min(next, end), std::max(next, end));
    Keep(limit, MostNearEnd([&](double x) { return demand_.Of(limit, from_ + x); }, Place(end),
                            at_end, Place(next), at_next));
  }

  // Where the curve bends the other way from there on, beside an arc, the jerk has a corner: it is
  // not smooth, and may have a second peak right behind its end.
  void LookBySections(std::size_t limit, int from, int to) {
    const auto less = [&](double x) { return -demand_.Of(limit, from_ + x); };
    Keep(limit, -LeastBySections(less, Place(from), Place(to)));
  }
  void Keep(std::size_t limit, double demand) {
    best_ = std::min(best_, demand_.Speed(limit, demand));
  }

  const CurveDemand& demand_;
  double from_;
  double length_;
  int intervals_;
  double enough_ = HUGE_VAL;
  double best_ = HUGE_VAL;
  std::array<double, CurveDemand::kLimits> enough_demand_{};  // below: no valley that matters
  std::array<CurveDemand::Demands, kCurveIntervalsMax + 1> samples_;
};

}  // namespace

double SpeedOnCurve(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                    double enough, bool of_lines) {
  const CurveDemand demand(curve, head, machine, of_lines);
  // Between lines the curve is as smooth as it is wide, which is on how much of it it turns; beside
  // an arc its bend may change faster.
  if (of_lines) {
    const CornerCurve::Bounds bounds = curve.DerivativeBounds();
    if (bounds.slowest * kCurveIntervalsMin >= kPerWidth * bounds.tip_second) {  // surely
      return LeastOnPart(demand, 0.0, 1.0, kCurveIntervalsMin).Find(enough);
    }
  }
  const double sharpest = curve.SlowestPlace();
  const double width = curve.Speed(sharpest) / curve.Derivative(sharpest, 2).point.norm();
  const double wanted = std::ceil(kPerWidth / width);
  const int few =
      std::max(static_cast<int>(std::min(double{kCurveIntervalsMax}, wanted)), kCurveIntervalsMin);
  const int intervals = of_lines ? few : kCurveIntervalsMax;
  const double least = LeastOnPart(demand, 0.0, 1.0, intervals).Find(enough);
  if (!(width * kCurveIntervalsMax < kPerWidth)) return least;
  // Near a cusp all happens between two samples.
  constexpr double kWidths = 8.0;
  const double from = std::max(0.0, sharpest - kWidths * width);
  const double to = std::min(1.0, sharpest + kWidths * width);
  return std::min(least, LeastOnPart(demand, from, to - from, kCurveIntervalsMax).Find(enough));
}

}  // namespace rmlcell::motion
