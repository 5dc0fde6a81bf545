#pragma once

#include <memory>

namespace rmlcell::bench {

// The limit of a planner with a limit on jerk: the bare two-pass loop of the shared bare_plan.h
// over the walk of the goals, geometry, junction speeds, backward and forward pass, the time of
// each segment. It keeps no paths, blends no corners and gives nothing out.
class BarePlan {
 public:
  BarePlan(int lines, int axes);
  ~BarePlan();
  BarePlan(const BarePlan&) = delete;
  BarePlan& operator=(const BarePlan&) = delete;

  // All of it anew. Returns the machine time, in seconds.
  double Run();

 private:
  struct Arrays;
  std::unique_ptr<Arrays> arrays_;
};

}  // namespace rmlcell::bench
