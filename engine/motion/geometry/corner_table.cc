#include "engine/motion/geometry/corner_table.h"

#include <vector>

#include "engine/core/units.h"
#include "engine/motion/geometry/least.h"

namespace rmlcell::motion {
namespace {

CornerCurve PlainCurve(double half_sine, double half_cosine) {
  // A corner of cut 1 at the origin, symmetric about the Y axis.
  const MachineVector in{half_cosine, -half_sine, 0.0};
  const MachineVector out{half_cosine, half_sine, 0.0};
  return CornerCurve({.pose = {-in, 0.0, 0.0}, .tangent = in, .curvature = {}},
                     {.pose = {out, 0.0, 0.0}, .tangent = out, .curvature = {}}, 1.0);
}

// The weights of four neighbouring nodes for a place `t` behind the second one: the cubic through
// them.
struct CubicWeights {
  double before, here, after, beyond;
  explicit CubicWeights(double t)
      : before(-t * (t - 1.0) * (t - 2.0) / 6.0),
        here((t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0),
        after(-(t + 1.0) * t * (t - 2.0) / 2.0),
        beyond((t + 1.0) * t * (t - 1.0) / 6.0) {}
};

// By q = sqrt(cos(theta/2)) = rho / 2, in which the length is smooth at both ends.
class LengthTable {
 public:
  static const LengthTable& Get() {
    static const LengthTable table;
    return table;
  }
  double At(double rho) const {
    const double x = (0.5 * rho - kFirst) / kStep;
    const int k = std::clamp(static_cast<int>(x), 1, kNodes - 3);
    const CubicWeights w(x - k);
    const auto at = [&](int i) { return length_[static_cast<std::size_t>(k + i)]; };
    return at(-1) * w.before + at(0) * w.here + at(1) * w.after + at(2) * w.beyond;
  }

 private:
  static constexpr int kNodes = 1025;
  static constexpr double kFirst = 0.2088;  // sqrt(cos 87.5 degrees), rounded down
  static constexpr double kStep = (1.0 - kFirst) / (kNodes - 1);

  LengthTable() {
    for (int k = 0; k < kNodes; ++k) {
      const double q = kFirst + kStep * k;
      const double cosine = std::min(q * q, 1.0);
      length_[static_cast<std::size_t>(k)] =
          CornerLength(PlainCurve(std::sqrt(1.0 - cosine * cosine), cosine)).total();
    }
  }
  std::array<double, kNodes> length_{};
};

// About what the peak of path jerk is, at every angle, and smooth: J has corners, which straight
// lines between the nodes of a table would cut.
double JerkScale(double tangent, double curvature) { return 3.0 * tangent + curvature * curvature; }

// By theta/2. Apart from the lengths: it takes longer, and only corners that are capped ask for it.
class JerkTable {
 public:
  static const JerkTable& Get() {
    static const JerkTable table;
    return table;
  }
  double At(double half_sine, double half_cosine) const {
    const double x = std::atan2(half_sine, half_cosine) / kHalfTurnMax * (kNodes - 1);
    const int k = std::clamp(static_cast<int>(x), 0, kNodes - 2);
    const double t = x - k;
    const auto i = static_cast<std::size_t>(k);
    return (share_[i] * (1.0 - t) + share_[i + 1] * t) * (1.0 + kRoom);
  }

 private:
  static constexpr int kNodes = 2049;
  static constexpr double kHalfTurnMax = 1.5272;  // 87.5 degrees, rounded up
  static constexpr double kRoom = 1e-6;           // what straight lines between nodes may lack

  JerkTable() {
    for (int k = 0; k < kNodes; ++k) {
      const double half_turn = std::max(kHalfTurnMax * k / (kNodes - 1), 1e-7);
      const double s = std::sin(half_turn);
      const double c = std::cos(half_turn);
      const CornerCurve curve = PlainCurve(s, c);
      constexpr int kIntervals = 40;  // of the first half: the curve is symmetric
      const double least =
          LeastAlong([&](double u) { return 1.0 / curve.JerkPerCube(u); }, 0.5, kIntervals);
      share_[static_cast<std::size_t>(k)] =
          1.0 / (least * JerkScale(s / c, CornerCurvature(s, c, CornerRho(c))));
    }
  }
  std::array<double, kNodes> share_{};
};

// By theta/2, as JerkTable.
class HalfTable {
 public:
  static const HalfTable& Get() {
    static const HalfTable table;
    return table;
  }
  HalfCorner At(double half_sine, double half_cosine) const {
    const double x = std::atan2(half_sine, half_cosine) / kHalfTurnMax * (kNodes - 1);
    const int k = std::clamp(static_cast<int>(x), 0, kNodes - 2);
    const auto t = static_cast<float>(x - k);
    const Node* at = &nodes_[static_cast<std::size_t>(k)];
    HalfCorner half;
    for (std::size_t i = 0; i < half.by_curvature.size(); ++i) {
      half.by_curvature[i] =
          kRoom * (at[0].by_curvature[i] + (at[1].by_curvature[i] - at[0].by_curvature[i]) * t);
      half.by_jerk[i] = kRoom * (at[0].by_jerk[i] + (at[1].by_jerk[i] - at[0].by_jerk[i]) * t);
    }
    return half;
  }

 private:
  static constexpr int kNodes = 1025;
  static constexpr double kHalfTurnMax = 1.5272;  // 87.5 degrees, rounded up
  static constexpr double kRoom = 1.0 - 3e-4;     // what straight lines between nodes may lack
  static constexpr double kMost = 1e3;            // where the curve is straight
  struct Node {
    std::array<float, HalfCorner::kSteps + 1> by_curvature;
    std::array<float, HalfCorner::kSteps + 1> by_jerk;
  };

  HalfTable() : nodes_(kNodes) {
    for (int k = 0; k < kNodes; ++k) {
      const double half_turn = std::max(kHalfTurnMax * k / (kNodes - 1), 1e-7);
      const double s = std::sin(half_turn);
      const double c = std::cos(half_turn);
      const CornerCurve curve = PlainCurve(s, c);
      const CornerLength length(curve);
      const double curvature = CornerCurvature(s, c, CornerRho(c));
      Node& node = nodes_[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < node.by_curvature.size(); ++i) {
        const double way = 0.5 * length.total() * static_cast<double>(i) / HalfCorner::kSteps;
        const double u = length.ParameterAt(curve, way);
        const double kappa = curve.SecondByLength(u).point.norm();
        const double jerk = curve.JerkPerCube(u);
        node.by_curvature[i] = static_cast<float>(std::min(std::sqrt(curvature / kappa), kMost));
        node.by_jerk[i] = static_cast<float>(std::min(std::cbrt(curvature / jerk), kMost));
      }
    }
  }
  std::vector<Node> nodes_;
};

// By sin^2(theta/2). The curve is symmetric: with y = 2 share - 1 and w = 2 u - 1, w is odd in y,
// and (w/y - 1) / (1 - y^2) is smooth in y^2. It is met at Chebyshev's places.
class MeasureTable {
 public:
  using Terms = std::array<double, PlainMeasure::kTerms>;
  static constexpr double kSquareMax = 0.9096;  // sin^2 of 72.5 degrees

  static const MeasureTable& Get() {
    static const MeasureTable table;
    return table;
  }
  Terms At(double half_sine_square) const {
    const double x = half_sine_square / kStep;
    const int k = std::clamp(static_cast<int>(x), 1, kNodes - 3);
    const CubicWeights w(x - k);
    const Terms* at = &terms_[static_cast<std::size_t>(k)];
    Terms terms;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      terms[i] =
          at[-1][i] * w.before + at[0][i] * w.here + at[1][i] * w.after + at[2][i] * w.beyond;
    }
    return terms;
  }

 private:
  static constexpr int kNodes = 257;
  static constexpr double kStep = kSquareMax / (kNodes - 2);  // one node beyond

  MeasureTable() {
    constexpr std::size_t n = PlainMeasure::kTerms;
    for (int k = 0; k < kNodes; ++k) {
      const double sine = std::sqrt(kStep * k);
      const CornerCurve curve = PlainCurve(sine, std::sqrt(1.0 - sine * sine));
      const CornerLength length(curve);
      // Newton's divided differences in z, then multiplied out.
      Terms z{}, difference{};
      for (std::size_t i = 0; i < n; ++i) {
        const double y = std::sqrt(0.5 + 0.5 * std::cos(kPi * (static_cast<double>(i) + 0.5) / n));
        const double u = length.ParameterAt(curve, 0.5 * (1.0 + y) * length.total());
        z[i] = y * y;
        difference[i] = ((2.0 * u - 1.0) / y - 1.0) / (1.0 - y * y);
      }
      for (std::size_t order = 1; order < n; ++order) {
        for (std::size_t i = n - 1; i >= order; --i) {
          difference[i] = (difference[i] - difference[i - 1]) / (z[i] - z[i - order]);
        }
      }
      Terms& sum = terms_[static_cast<std::size_t>(k)];
      for (std::size_t i = n; i-- > 0;) {  // sum = sum * (z - z[i]) + difference[i]
        for (std::size_t power = n - 1; power > 0; --power) {
          sum[power] = sum[power - 1] - z[i] * sum[power];
        }
        sum[0] = difference[i] - z[i] * sum[0];
      }
    }
  }
  std::array<Terms, kNodes> terms_{};
};

}  // namespace

double CornerJerkPeak(double half_sine, double half_cosine, double curvature) {
  return JerkTable::Get().At(half_sine, half_cosine) *
         JerkScale(half_sine / half_cosine, curvature);
}

HalfCorner CornerHalf(double half_sine, double half_cosine) {
  return HalfTable::Get().At(half_sine, half_cosine);
}

double CornerArcLength(double rho) { return LengthTable::Get().At(rho); }

PlainMeasure::PlainMeasure(const PlainCorner& corner) {
  const MachineVector turn = corner.tangent_out - corner.tangent_in;
  const double half_sine_square = 0.25 * turn.dot(turn);
  known_ = half_sine_square <= MeasureTable::kSquareMax;
  if (known_) coefficients_ = MeasureTable::Get().At(half_sine_square);
}

}  // namespace rmlcell::motion
