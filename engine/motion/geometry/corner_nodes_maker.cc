// Works out what the tables of corners have at their nodes, and writes it as a source of the engine
// on standard output. Runs when the engine is built. motion.md 4.2, 4.3
#include <cstdio>
#include <memory>

#include "engine/core/units.h"
#include "engine/motion/geometry/corner_nodes.h"
#include "engine/motion/geometry/least.h"

namespace {

using namespace rmlcell;          // NOLINT: one program, one purpose
using namespace rmlcell::motion;  // NOLINT

CornerCurve PlainCurve(double half_sine, double half_cosine) {
  // A corner of cut 1 at the origin, symmetric about the Y axis.
  const MachineVector in{half_cosine, -half_sine, 0.0};
  const MachineVector out{half_cosine, half_sine, 0.0};
  return CornerCurve({.pose = {-in, 0.0, 0.0}, .tangent = in, .curvature = {}},
                     {.pose = {out, 0.0, 0.0}, .tangent = out, .curvature = {}}, 1.0);
}

void MakeLengths(LengthNodes& nodes) {
  for (int k = 0; k < LengthNodes::kCount; ++k) {
    const double q = LengthNodes::kFirst + LengthNodes::kStep * k;
    const double cosine = std::min(q * q, 1.0);
    nodes.length[static_cast<std::size_t>(k)] =
        CornerLength(PlainCurve(std::sqrt(1.0 - cosine * cosine), cosine)).total();
  }
}

void MakeJerks(JerkNodes& nodes) {
  for (int k = 0; k < JerkNodes::kCount; ++k) {
    const double half_turn = std::max(JerkNodes::kHalfTurnMax * k / (JerkNodes::kCount - 1), 1e-7);
    const double s = std::sin(half_turn);
    const double c = std::cos(half_turn);
    const CornerCurve curve = PlainCurve(s, c);
    constexpr int kIntervals = 40;  // of the first half: the curve is symmetric
    const double least =
        LeastAlong([&](double u) { return 1.0 / curve.JerkPerCube(u); }, 0.5, kIntervals);
    nodes.share[static_cast<std::size_t>(k)] =
        1.0 / (least * JerkScale(s / c, CornerCurvature(s, c, CornerRho(c))));
  }
}

void MakeHalves(HalfNodes& nodes) {
  for (int k = 0; k < HalfNodes::kCount; ++k) {
    const double half_turn = std::max(HalfNodes::kHalfTurnMax * k / (HalfNodes::kCount - 1), 1e-7);
    const double s = std::sin(half_turn);
    const double c = std::cos(half_turn);
    const CornerCurve curve = PlainCurve(s, c);
    const CornerLength length(curve);
    const double curvature = CornerCurvature(s, c, CornerRho(c));
    HalfNodes::Node& node = nodes.nodes[static_cast<std::size_t>(k)];
    for (std::size_t i = 0; i < node.by_curvature.size(); ++i) {
      const double way = 0.5 * length.total() * static_cast<double>(i) / HalfCorner::kSteps;
      const double u = length.ParameterAt(curve, way);
      const double kappa = curve.SecondByLength(u).point.norm();
      const double jerk = curve.JerkPerCube(u);
      node.by_curvature[i] =
          static_cast<float>(std::min(std::sqrt(curvature / kappa), HalfNodes::kMost));
      node.by_jerk[i] = static_cast<float>(std::min(std::cbrt(curvature / jerk), HalfNodes::kMost));
    }
  }
}

void MakeMeasures(MeasureNodes& nodes) {
  constexpr std::size_t n = PlainMeasure::kTerms;
  for (int k = 0; k < MeasureNodes::kCount; ++k) {
    const double sine = std::sqrt(MeasureNodes::kStep * k);
    const CornerCurve curve = PlainCurve(sine, std::sqrt(1.0 - sine * sine));
    const CornerLength length(curve);
    // Newton's divided differences in z, then multiplied out.
    MeasureNodes::Terms z{}, difference{};
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
    MeasureNodes::Terms& sum = nodes.terms[static_cast<std::size_t>(k)];
    for (std::size_t i = n; i-- > 0;) {  // sum = sum * (z - z[i]) + difference[i]
      for (std::size_t power = n - 1; power > 0; --power)
        sum[power] = sum[power - 1] - z[i] * sum[power];
      sum[0] = difference[i] - z[i] * sum[0];
    }
  }
}

// All digits of each: the engine has the very numbers.
template <class Numbers>
void Write(const Numbers& numbers) {
  std::printf("{{");
  for (const auto number : numbers) std::printf("%a,", static_cast<double>(number));
  std::printf("}}");
}

struct AllNodes {
  LengthNodes lengths{};
  JerkNodes jerks{};
  HalfNodes halves{};
  MeasureNodes measures{};
};

}  // namespace

int main() {
  const auto all = std::make_unique<AllNodes>();
  MakeLengths(all->lengths);
  MakeJerks(all->jerks);
  MakeHalves(all->halves);
  MakeMeasures(all->measures);
  std::printf(
      "// Written by corner_nodes_maker.cc.\n"
      "#include \"engine/motion/geometry/corner_nodes.h\"\n\nnamespace rmlcell::motion {\n\n");
  std::printf("const LengthNodes kLengthNodes = {");
  Write(all->lengths.length);
  std::printf("};\nconst JerkNodes kJerkNodes = {");
  Write(all->jerks.share);
  std::printf("};\nconst MeasureNodes kMeasureNodes = {{{\n");
  for (const MeasureNodes::Terms& terms : all->measures.terms) {
    Write(terms);
    std::printf(",\n");
  }
  std::printf("}}};\nconst HalfNodes kHalfNodes = {{{\n");
  for (const HalfNodes::Node& node : all->halves.nodes) {
    std::printf("{");
    Write(node.by_curvature);
    std::printf(",");
    Write(node.by_jerk);
    std::printf("},\n");
  }
  std::printf("}}};\n\n}  // namespace rmlcell::motion\n");
  return std::fflush(stdout) == 0 ? 0 : 1;
}
