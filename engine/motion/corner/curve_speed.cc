#include <algorithm>
#include <array>
#include <cmath>

#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/least.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr int kCurveIntervals = 48;

// What keeps the speed on a curve down: the normal acceleration, the jerk, the speed of each axis
// and its acceleration. Each allows a speed that falls with what the curve asks of it, its demand:
// the root of limit over demand, of first, second or third degree. Demands are compared, and roots
// taken of few.
class CurveDemand {
 public:
  static constexpr std::size_t kLimits = 2 + 2 * kAxisCount;
  static constexpr std::size_t kNormal = 0;
  static constexpr std::size_t kJerk = 1;
  static constexpr std::size_t kAxisSpeed = 2;  // of the first axis
  static constexpr std::size_t kAxisAcceleration = kAxisSpeed + kAxisCount;
  using Demands = std::array<double, kLimits>;

  CurveDemand(const CornerCurve& curve, const Head& head, const MachineLimits& machine)
      : curve_(curve), head_(head) {
    limits_[kNormal] = machine.normal_acceleration();
    limits_[kJerk] = machine.normal_jerk();
    for (const std::size_t i : kAxes) {
      limits_[kAxisSpeed + i] = machine.axes.speed[i];
      limits_[kAxisAcceleration + i] = machine.axes.acceleration[i];
    }
  }

  Demands At(double u) const {
    const PathDerivatives by_u = curve_.Derivative(u, 1);
    const PathDerivatives by_u_twice = curve_.Derivative(u, 2);
    const PathDerivatives second = CornerCurve::SecondByLength(by_u, by_u_twice);
    const BothAxisRates q = AxisRates(u, CornerCurve::FirstByLength(by_u), second);
    Demands demands;
    demands[kNormal] = Known(second.point.norm());
    demands[kJerk] =
        Known(CornerCurve::JerkPerCube(by_u.point, by_u_twice.point, curve_.TipDerivative(u, 3)));
    for (const std::size_t i : kAxes) {
      demands[kAxisSpeed + i] = std::abs(q.first[i]);
      demands[kAxisAcceleration + i] = std::abs(q.second[i]);
    }
    return demands;
  }

  // One of them.
  double Of(std::size_t limit, double u) const {
    if (limit == kJerk) return Known(curve_.JerkPerCube(u));
    const PathDerivatives by_u = curve_.Derivative(u, 1);
    const PathDerivatives second = CornerCurve::SecondByLength(by_u, curve_.Derivative(u, 2));
    if (limit == kNormal) return Known(second.point.norm());
    if (limit == kAxisAcceleration + 3) return std::abs(second.a);
    if (limit == kAxisAcceleration + 4) return std::abs(second.b);
    const BothAxisRates q = AxisRates(u, CornerCurve::FirstByLength(by_u), second);
    return std::abs(limit < kAxisAcceleration ? q.first[limit - kAxisSpeed]
                                              : q.second[limit - kAxisAcceleration]);
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
    return limit >= kAxisSpeed && limit < kAxisAcceleration ? 1 : 2;
  }

 private:
  // Where the curve stands still it asks for no number: nothing then.
  static double Known(double demand) { return demand > 0.0 ? demand : 0.0; }

  BothAxisRates AxisRates(double u, const PathDerivatives& first,
                          const PathDerivatives& second) const {
    const CornerCurve::HeadPlace at = curve_.HeadAt(u);
    return head_.RatesOfBoth(at.a_rad, at.b_rad, {first.point, first.a, first.b},
                             {second.point, second.a, second.b});
  }

  const CornerCurve& curve_;
  const Head& head_;
  std::array<double, kLimits> limits_;
};

// LeastOfSampled of the speeds between two places, found by the demands: the same result.
class LeastOnPart {
 public:
  LeastOnPart(const CurveDemand& demand, double from, double length, double enough)
      : demand_(demand), from_(from), length_(length), enough_(enough) {}

  double Find() {
    for (int k = 0; k <= kCurveIntervals; ++k) {
      samples_[static_cast<std::size_t>(k)] = demand_.At(from_ + Place(k));
    }
    std::array<std::size_t, CurveDemand::kLimits> asked{};  // limits that may have a valley
    std::size_t count = 0;
    CurveDemand::Demands most{};
    for (std::size_t i = 0; i < most.size(); ++i) {
      for (const CurveDemand::Demands& sample : samples_) most[i] = std::max(most[i], sample[i]);
      KeepLeastSpeed(i, most[i]);
    }
    for (std::size_t i = 0; i < most.size(); ++i) {
      // What is drawn on over a sample is at most twice what is asked there: as a share of the
      // speed.
      enough_demand_[i] = demand_.DemandFor(i, std::min(best_, enough_)) /
                          static_cast<double>(1 << CurveDemand::DegreeOf(i)) * kSurely;
      if (most[i] > enough_demand_[i]) asked[count++] = i;
    }
    for (int k = 1; k < kCurveIntervals; ++k) {
      for (std::size_t i = 0; i < count; ++i) LookAbout(asked[i], k);
    }
    return best_;
  }

 private:
  static constexpr double kSurely = 1.0 - 1e-9;  // beyond what rounding does to a demand
  static constexpr double kAlike = 1.0 - 1e-12;  // demands whose speeds may be the same

  double Place(int k) const { return length_ * k / kCurveIntervals; }
  double DemandAt(std::size_t limit, int k) const {
    return samples_[static_cast<std::size_t>(k)][limit];
  }
  double SpeedAt(std::size_t limit, int k) const {
    return demand_.Speed(limit, DemandAt(limit, k));
  }

  // The lowest speed at the samples: where most is asked, but that a cubic root of the library may
  // fall by its last digit where its argument rises.
  void KeepLeastSpeed(std::size_t limit, double most) {
    if (limit != CurveDemand::kJerk) {
      best_ = std::min(best_, demand_.Speed(limit, most));
      return;
    }
    for (const CurveDemand::Demands& sample : samples_) {
      if (!(sample[limit] >= most * kAlike)) continue;
      best_ = std::min(best_, demand_.Speed(limit, sample[limit]));
    }
  }

  void LookAbout(std::size_t limit, int k) {
    const bool first = k == 1, last = k == kCurveIntervals - 1;
    const double here = DemandAt(limit, k);
    const double before = DemandAt(limit, k - 1), after = DemandAt(limit, k + 1);
    const bool valley = here >= before * kAlike && here >= after * kAlike;
    const bool at_start = first && before >= here * kAlike;
    const bool at_end = last && after >= here * kAlike;
    if (!valley && !at_start && !at_end) return;
    const double most = std::max({here, first ? before : 0.0, last ? after : 0.0});
    if (!(most > enough_demand_[limit])) return;
    const double a = SpeedAt(limit, k - 1), b = SpeedAt(limit, k), c = SpeedAt(limit, k + 1);
    if (b <= a && b <= c) {
      Look(limit, DrawnOn(std::max(a, c), b), k - 1, k + 1);
    } else if (first && a < b) {
      Look(limit, MostAskedAtEnd(c, b, a), 0, 1);
    } else if (last && c < b) {
      Look(limit, MostAskedAtEnd(a, b, c), k, kCurveIntervals);
    }
  }

  void Look(std::size_t limit, double most_asked, int from, int to) {
    constexpr double kGain = 1e-12;  // relative; less is rounding
    if (!(most_asked * std::min(best_, enough_) > 1.0 + kGain)) return;
    const auto speed = [&](double x) { return demand_.Speed(limit, demand_.Of(limit, from_ + x)); };
    best_ = std::min(best_, LeastBySections(speed, Place(from), Place(to)));
  }

  const CurveDemand& demand_;
  double from_;
  double length_;
  double enough_;
  double best_ = HUGE_VAL;
  std::array<double, CurveDemand::kLimits> enough_demand_{};  // below: no valley that matters
  std::array<CurveDemand::Demands, kCurveIntervals + 1> samples_;
};

}  // namespace

double SpeedOnCurve(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                    double enough) {
  const CurveDemand demand(curve, head, machine);
  const double least = LeastOnPart(demand, 0.0, 1.0, enough).Find();
  // Near a cusp all happens between two samples: as far about the sharpest place as the curve needs
  // to turn.
  const double sharpest = curve.SlowestPlace();
  const double width = curve.Speed(sharpest) / curve.Derivative(sharpest, 2).point.norm();
  if (!(width * kCurveIntervals < 4.0)) return least;
  constexpr double kWidths = 8.0;
  const double from = std::max(0.0, sharpest - kWidths * width);
  const double to = std::min(1.0, sharpest + kWidths * width);
  return std::min(least, LeastOnPart(demand, from, to - from, enough).Find());
}

}  // namespace rmlcell::motion
