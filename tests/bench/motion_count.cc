// Plans a contour of short lines and nothing else: motion_instructions.py counts what that costs.
//   motion_count jerk|trapezoid|mill|five_axis|arcs|short|ramps|zigzag LINES
//   motion_count walk|walk_trapezoid|walk_mill|walk_five_axis LINES
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string_view>

#include "tests/bench/motion_paths.h"

namespace rmlcell::motion {
namespace {

// Every line of the contour as an arc that bulges by a hundredth of its length.
std::vector<MoveCommand> Arcs(int count) {
  std::vector<MoveCommand> chain = Contour(count, false);
  for (MoveCommand& move : chain) {
    const TipPose from = move.path.tip_from(), to = move.path.tip_to();
    const MachineVector way = to.tip - from.tip;
    const MachinePoint via = from.tip + way * 0.5 + MachineVector{-way.y(), way.x(), 0.0} * 0.01;
    if (const Result<PathPiece::Arc3> arc = PathPiece::ArcThrough(from, via, to)) {
      move.path = arc->path;
    }
  }
  return chain;
}

int Main(std::string_view what, int count) {
  const bool walk = what.starts_with("walk");
  MachineLimits machine = walk ? WalkMachine() : StandardMachine();
  std::vector<MoveCommand> loop;
  if (walk) {
    loop = Walk(2400, what == "walk_five_axis");
  } else if (what == "arcs") {
    loop = Arcs(600);
  } else if (what == "ramps") {  // bends use up the lines: the speed changes all the time
    loop = Contour(600, false, 0.3);
  } else if (what == "short") {  // sharp bends, all at one low speed
    loop = Polyline(Legs(600, 0.8, 0.5 * kPi, true), 0.3);
    loop.back().fly = true;
  } else if (what == "zigzag") {  // as long as its bends: no line is left between them
    loop = Polyline(Legs(600, 2.0, 0.5 * kPi, true), 0.3);
    loop.back().fly = true;
  } else {
    loop = Contour(600, what == "five_axis");
  }
  if (what.ends_with("trapezoid")) {
    machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  }
  if (what.ends_with("mill")) {  // polylines as they are, acceleration-limited: motion.md section 7
    machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
    machine.corners = MachineLimits::Corners::kThrough;
    machine.junction_jump_mm_s = 3.0;
  }
  Planner planner(machine);
  double sum = 0.0;
  const auto drain = [&] {
    while (const PlannedItem* item = planner.NextInPlace()) {
      sum += std::get<PlannedMotion>(*item).speed.duration_s();
    }
  };
  for (int k = 0; k < count; ++k) {
    if (!planner.Append(loop[static_cast<std::size_t>(k) % loop.size()])) return 1;
    drain();
  }
  planner.Stop();
  drain();
  std::printf("%.9g\n", sum);
  return 0;
}

}  // namespace
}  // namespace rmlcell::motion

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr,
                 "usage: motion_count jerk|trapezoid|mill|five_axis|arcs|short|ramps|zigzag|"
                 "walk|walk_trapezoid|walk_mill|walk_five_axis LINES\n");
    return 2;
  }
  return rmlcell::motion::Main(argv[1], std::atoi(argv[2]));
}
