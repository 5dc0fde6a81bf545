// The table of motion.md 5.6: planned time against the bound that no plan can beat (the same path,
// limits on speed and acceleration only, optimal by one pass forward and one back on a fine grid),
// for both levels, for trapezoids, and with a stop at every corner. Also whether level 2 is ever
// slower than level 1 or than OVERSH 0, on random chains.
//   motion_table_bench
// Prints one JSON object a line.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "engine/motion/ride/trajectory.h"
#include "tests/bench/motion_paths.h"

namespace rmlcell::motion {
namespace {

constexpr double kTrapezoid = std::numeric_limits<double>::infinity();

MachineLimits Machine(double jerk, bool level_two) {
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = jerk;
  machine.ramps_across_passages = level_two;
  return machine;
}

double TimeOf(const std::vector<PlannedMotion>& motions) {
  LongSum sum;
  for (const PlannedMotion& motion : motions) sum.Add(motion.duration_s());
  return sum.value();
}

// Of 3-axis paths whose axes follow whatever the tip may do.
// `curve_jerk`: with the limit on jerk across curves too, v^3 sqrt(kappa'^2 + kappa^4)
// (motion.md 4.3), which no plan on this path may pass.
double Bound(const std::vector<PlannedMotion>& motions, const std::vector<MoveCommand>& chain,
             const MachineLimits& machine, bool curve_jerk = false) {
  struct Cell {
    double length;
    double square;  // highest v^2, then the v^2 reached at its end
    double curvature;
  };
  std::vector<Cell> cells;
  double settling = 0.0;
  std::vector<std::size_t> stops;  // cells at whose end the machine stands
  for (const PlannedMotion& motion : motions) {
    const double length = motion.path.length();
    const int count = std::max(50, static_cast<int>(length / 0.005));
    const auto move = static_cast<std::size_t>(motion.tag - chain.front().tag);
    const double speed = chain[move].speed_fraction * machine.tip_speed_mm_s;
    const bool blend = motion.path.kind() == PathPiece::Kind::kBlend;
    std::optional<CornerLength> by_length;
    if (blend) by_length.emplace(motion.path.curve());
    for (int k = 0; k < count; ++k) {
      const double s = length * (k + 0.5) / count;
      double curvature = 0.0;
      if (blend) {
        const CornerCurve& curve = motion.path.curve();
        const double u = by_length->ParameterAt(curve, motion.path.curve_start() + s);
        curvature = curve.SecondByLength(u).point.norm();
      } else {
        curvature = motion.path.Curvature(s).norm();
      }
      double square = speed * speed;
      if (curve_jerk && blend) {
        const double q = 1e-3 * length;
        const auto across = [&](double at) {
          const CornerCurve& curve = motion.path.curve();
          return curve.SecondByLength(by_length->ParameterAt(curve, motion.path.curve_start() + at))
              .point;
        };
        const double low = std::max(s - q, 0.0), high = std::min(s + q, length);
        const double change = (across(high) - across(low)).norm() / (high - low);
        square =
            std::min(square, std::pow(machine.normal_jerk() / std::max(change, 1e-12), 2.0 / 3.0));
      }
      if (curvature > 0.0) square = std::min(square, machine.normal_acceleration() / curvature);
      cells.push_back({length / count, square, curvature});
    }
    settling += motion.settling_s;
    if (motion.speed.end().speed == 0.0) stops.push_back(cells.size() - 1);
  }
  const auto gain = [&](const Cell& cell, double square) {
    const double across = std::min(square * cell.curvature, machine.tip_acceleration_mm_s2);
    const double along = std::sqrt(machine.tip_acceleration_mm_s2 * machine.tip_acceleration_mm_s2 -
                                   across * across);
    return 2.0 * along * cell.length;
  };
  // Speeds at the ends of cells: those of both neighbours hold.
  std::vector<double> end(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    end[k] = k + 1 < cells.size() ? std::min(cells[k].square, cells[k + 1].square) : 0.0;
  }
  for (const std::size_t stop : stops) end[stop] = 0.0;
  double square = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    square = end[k] = std::min(end[k], square + gain(cells[k], square));
  }
  for (std::size_t k = cells.size() - 1; k-- > 0;) {
    end[k] = std::min(end[k], end[k + 1] + gain(cells[k + 1], end[k + 1]));
  }
  double time = settling;
  square = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const double mean = 0.5 * (std::sqrt(square) + std::sqrt(end[k]));
    time += cells[k].length / mean;
    square = end[k];
  }
  return time;
}

void Row(const char* name, const std::vector<MoveCommand>& chain) {
  const MachineLimits level_one = Machine(40000.0, false);
  const std::vector<PlannedMotion> motions = Plan(chain, level_one);
  const double bound = Bound(motions, chain, level_one);
  const std::vector<PlannedMotion> flat = Plan(chain, Machine(kTrapezoid, false));
  const double flat_bound = Bound(flat, chain, level_one);
  std::vector<MoveCommand> stopping = chain;
  for (MoveCommand& move : stopping) move.fly = false;
  std::printf(
      "{\"path\": \"%s\", \"moves\": %zu, \"bound_s\": %.4f, \"bound_with_curve_jerk\": %.3f, "
      "\"level_1\": %.3f, \"level_2\": %.3f, "
      "\"trapezoid\": %.3f, \"trapezoid_level_2\": %.3f, \"all_stops\": %.3f}\n",
      name, chain.size(), bound, Bound(motions, chain, level_one, true) / bound,
      TimeOf(motions) / bound, TimeOf(Plan(chain, Machine(40000.0, true))) / bound,
      TimeOf(flat) / flat_bound, TimeOf(Plan(chain, Machine(kTrapezoid, true))) / flat_bound,
      TimeOf(Plan(stopping, level_one)) / bound);
  std::fflush(stdout);
}

// Random chains: how often, and by how much at most, level 2 takes longer than it should.
void NeverSlower() {
  int chains = 0, slower_than_one = 0, slower_than_stops = 0;
  double worst_one = 0.0, worst_stops = 0.0, total_one = 0.0, total_two = 0.0;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const ChainOptions options{.arcs = seed % 2 == 0,
                               .head = false,
                               .shortest_mm = seed % 3 == 0 ? 0.5 : 0.01,
                               .longest_mm = seed % 5 == 0 ? 300.0 : 6.0};
    std::vector<MoveCommand> chain = RandomChain(seed, 40, options);
    const double one = TimeOf(Plan(chain, Machine(40000.0, false)));
    const double two = TimeOf(Plan(chain, Machine(40000.0, true)));
    for (MoveCommand& move : chain) move.overshoot_fraction = 0.0;
    const double stops = TimeOf(Plan(chain, Machine(40000.0, true)));
    ++chains;
    total_one += one;
    total_two += two;
    if (two > one * (1 + 1e-9)) ++slower_than_one;
    if (two > stops * (1 + 1e-9)) ++slower_than_stops;
    worst_one = std::max(worst_one, two / one);
    worst_stops = std::max(worst_stops, two / stops);
  }
  std::printf(
      "{\"random_chains\": %d, \"level_2_to_1\": %.4f, \"slower_than_level_1\": %d, \"worst\": "
      "%.6f, "
      "\"slower_than_oversh_0\": %d, \"worst_to_oversh_0\": %.4f}\n",
      chains, total_two / total_one, slower_than_one, worst_one, slower_than_stops, worst_stops);
}

void Table() {
  const double degree = kPi / 180.0;
  Row("square 40 mm, SPEED 8", Polyline(Legs(4, 40.0, 90.0 * degree, false), 0.08));
  Row("90 degree corner, legs 300, SPEED 70", Polyline(Legs(2, 300.0, 90.0 * degree, false), 0.70));
  const double side = 2.0 * 50.0 * std::sin(1.0 * degree);
  Row("180-gon of radius 50, SPEED 12", Polyline(Legs(180, side, 2.0 * degree, false), 0.12));
  Row("arc polyline, eight 5 mm legs, 3 degrees, SPEED 20",
      Polyline(Legs(8, 5.0, 3.0 * degree, false), 0.20));
  Row("zigzag of three 2 mm legs, 90 degrees, SPEED 30",
      Polyline(Legs(3, 2.0, 90.0 * degree, true), 0.30));
  std::vector<MoveCommand> contour = Contour(1200, false, 0.30);
  contour.back().fly = false;
  Row("wavy contour of 2.5 mm lines, SPEED 30", contour);
  Row("rising zigzag of forty 4.3 mm legs, 140 degrees, SPEED 25",
      Polyline(Legs(40, 4.2, 140.0 * degree, true, 0.9), 0.25));
}

}  // namespace
}  // namespace rmlcell::motion

int main() {
  rmlcell::motion::Table();
  rmlcell::motion::NeverSlower();
}
