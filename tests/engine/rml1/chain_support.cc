#include "tests/engine/rml1/chain_support.h"

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"

namespace rmlcell::rml1 {

machine::Parameters MotionTestProfile() {
  machine::Parameters parameters = ParametersOf("t1");
  for (const auto& [name, value] : {std::pair{"XY_SPEED_MIN", 0.5},
                                    {"XY_SPEED_MAX", 15.0},
                                    {"Z_SPEED_MAX", 15.0},
                                    {"TRAVEL_SPEED", 15.0},
                                    {"ACCELERATION", 200.0},
                                    {"SPEED_JUMP", 3.0},
                                    {"SPIN_UP", 2.0},
                                    {"SPIN_DOWN", 2.0}}) {
    RMLCELL_CHECK(parameters.Set(name, value).ok());
  }
  return parameters;
}

ChainPlan PlanOf(const std::vector<Vertex>& chain, double acceleration, double jump) {
  const std::size_t n = chain.size();
  std::vector<double> length(n, 0.0);
  std::vector<motion::MachinePoint> direction(n);
  for (std::size_t k = 1; k < n; ++k) {
    length[k] = (chain[k].at - chain[k - 1].at).norm();
    direction[k] = (chain[k].at - chain[k - 1].at) * (1.0 / length[k]);
  }
  ChainPlan plan;
  plan.speeds.assign(n, 0.0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const motion::MachineVector turn = direction[k + 1] - direction[k];
    const double most = std::max({std::abs(turn.x()), std::abs(turn.y()), std::abs(turn.z())});
    plan.speeds[k] = std::min(chain[k].speed, chain[k + 1].speed);
    if (most > 0.0) plan.speeds[k] = std::min(plan.speeds[k], jump / most);
  }
  const auto reach = [&](double from, std::size_t k) {
    return std::sqrt(from * from + 2.0 * acceleration * length[k]);
  };
  for (std::size_t k = 1; k < n; ++k) {
    plan.speeds[k] = std::min(plan.speeds[k], reach(plan.speeds[k - 1], k));
  }
  for (std::size_t k = n - 1; k > 0; --k) {
    plan.speeds[k - 1] = std::min(plan.speeds[k - 1], reach(plan.speeds[k], k));
  }
  for (std::size_t k = 1; k < n; ++k) {
    const double v0 = plan.speeds[k - 1];
    const double v1 = plan.speeds[k];
    const double highest = std::sqrt(acceleration * length[k] + 0.5 * (v0 * v0 + v1 * v1));
    const double peak = std::min(chain[k].speed, highest);
    const double ramps = (2.0 * peak * peak - v0 * v0 - v1 * v1) / (2.0 * acceleration);
    plan.time_s += (2.0 * peak - v0 - v1) / acceleration + (length[k] - ramps) / peak;
  }
  return plan;
}

Velocity VelocityAt(const RunRecord::Motion& motion, double time_s) {
  constexpr double kStep_s = 1e-7;
  const double duration = motion.planned.speed.duration_s();
  const double from = std::clamp(time_s - 0.5 * kStep_s, 0.0, std::max(duration - kStep_s, 0.0));
  const double to = std::min(from + kStep_s, duration);
  const auto pose = [&](double t) { return motion.planned.path.At(motion.planned.speed.At(t).s); };
  const double rate = 1.0 / (to - from);
  return {.tip = (pose(to).point - pose(from).point) * rate,
          .a_deg_s = (pose(to).a_rad - pose(from).a_rad) * rate / kRadPerDegree};
}

double LargestJump(const Velocity& before, const Velocity& after) {
  const motion::MachineVector jump = after.tip - before.tip;
  return std::max({std::abs(jump.x()), std::abs(jump.y()), std::abs(jump.z())});
}

}  // namespace rmlcell::rml1
