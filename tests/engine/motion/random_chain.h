#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <variant>
#include <vector>

#include "engine/core/units.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {

// Chains of moves from one number, the same on every machine: the generator's bits are used
// directly, since the distributions of the library differ between vendors.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_(seed) {}
  double Uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
  }
  double Magnitude(double low, double high) {  // even on a logarithmic scale
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  bool Chance(double share) { return Uniform(0.0, 1.0) < share; }
  MachineVector Direction() {
    for (;;) {
      const MachineVector v{Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1)};
      const double n = v.norm();
      if (n > 0.05 && n < 1.0) return v * (1.0 / n);
    }
  }

 private:
  std::mt19937_64 bits_;
};

struct ChainOptions {
  bool arcs = true;
  bool head = true;  // A and B turn in some of the moves
  bool all_fly = false;
  double shortest_mm = 1e-3;
  double longest_mm = 300.0;
};

inline std::vector<MoveCommand> RandomChain(std::uint64_t seed, int count,
                                            const ChainOptions& options = {}) {
  Dice dice(seed);
  std::vector<MoveCommand> chain;
  TipPose at{{1000.0, 900.0, -200.0}, 0.3, 0.4};
  MachineVector direction = dice.Direction();
  double speed = 0.3, acceleration = 1.0, overshoot = 1.0;
  for (int k = 0; k < count; ++k) {
    MoveCommand move;
    if (dice.Chance(0.2)) speed = dice.Magnitude(0.004, 1.0);
    if (dice.Chance(0.1)) acceleration = dice.Magnitude(0.05, 1.0);
    if (dice.Chance(0.2)) overshoot = dice.Chance(0.6) ? 1.0 : dice.Uniform(0.0, 1.0);
    if (!dice.Chance(0.1)) {  // else straight on
      const double turn = dice.Magnitude(0.01, 3.0);
      direction = direction + dice.Direction() * turn;
      direction = direction * (1.0 / direction.norm());
    }
    const double length = dice.Magnitude(options.shortest_mm, options.longest_mm);
    TipPose to{at.tip + direction * length, at.a_rad, at.b_rad};
    if (options.head && dice.Chance(0.4)) {
      to.a_rad += dice.Uniform(-0.3, 0.3) * std::min(1.0, length);
      to.b_rad += dice.Uniform(-0.2, 0.2) * std::min(1.0, length);
    }
    move.path = PathPiece::Line(at, to);
    if (options.arcs && length > 0.01 && dice.Chance(0.3)) {
      const MachinePoint via = at.tip + direction * (0.5 * length) +
                               dice.Direction() * (dice.Uniform(0.02, 0.6) * length);
      if (const Result<PathPiece::Arc3> arc = PathPiece::ArcThrough(at, via, to)) {
        move.path = arc->path;
        direction = move.path.Tangent(move.path.length());
      }
    }
    move.speed_fraction = speed;
    move.acceleration_fraction = acceleration;
    move.overshoot_fraction = overshoot;
    move.fly = options.all_fly || dice.Chance(0.9);
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  return chain;
}

inline std::vector<PlannedMotion> Plan(const std::vector<MoveCommand>& chain,
                                       const MachineLimits& machine = StandardMachine(),
                                       std::size_t window = Planner::kWindow) {
  Planner planner(machine, window);
  std::vector<PlannedMotion> motions;
  const auto drain = [&] {
    while (const std::optional<PlannedItem> item = planner.Next()) {
      if (const auto* motion = std::get_if<PlannedMotion>(&*item)) motions.push_back(*motion);
    }
  };
  for (const MoveCommand& move : chain) {
    if (planner.Append(move)) drain();
  }
  planner.Stop();
  drain();
  return motions;
}

}  // namespace rmlcell::motion
