// Bends that are passed with changing speed because the window is full. motion.md 5.4, 6, 10.
#include <gtest/gtest.h>

#include "tests/engine/motion/plan_check.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr int kBends = 60;

// Bend after bend that leaves nothing of the lines between them, while the head turns.
std::vector<MoveCommand> TurningBends(std::uint64_t seed) {
  Dice dice(seed);
  std::vector<MoveCommand> chain;
  TipPose at{{1000.0, 900.0, -200.0}, 0.3, 0.4};
  MachineVector heading{1.0, 0.0, 0.0};
  for (int k = 0; k < kBends; ++k) {
    heading = heading + dice.Direction() * 0.7;
    heading = heading * (1.0 / heading.norm());
    TipPose to{at.tip + heading * dice.Uniform(1.0, 12.0), at.a_rad + dice.Uniform(-0.25, 0.25),
               at.b_rad + dice.Uniform(-0.25, 0.25)};
    MoveCommand move;
    move.path = PathPiece::Line(at, to);
    move.fly = true;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  return chain;
}

// The ramps on the way leave each axis what the bend itself asks of it, whichever of them is weak.
TEST(VariedBends, KeepEveryAxisWhileTheHeadTurns) {
  for (std::size_t weak = 0; weak < kAxisCount; ++weak) {
    MachineLimits machine = StandardMachine();
    machine.axes.acceleration[weak] *= 0.2;
    machine.axes.jerk[weak] *= 0.1;
    int varied = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const std::vector<MoveCommand> chain = TurningBends(seed);
      const std::vector<PlannedMotion> motions = Plan(chain, machine, 8);
      for (const PlannedMotion& motion : motions) {
        const bool bend = motion.path.kind() == PathPiece::Kind::kBlend;
        if (!bend || motion.speed.end().speed == motion.speed.At(0.0).speed) continue;
        ++varied;
        // At 0.95 of the speed at which the first axis is at its limit an axis moves by as much
        // for a mm of the way.
        for (std::size_t i = 0; i < kAxisCount; ++i) {
          const double per_mm = 0.95 * machine.axes.speed[i] / motion.limits.speed;
          EXPECT_LE(motion.limits.jerk * per_mm, machine.axes.jerk[i] * (1.0 + 1e-9));
        }
      }
      const PlanCheck check{chain, motions, machine, 12};
      for (const std::string& violation : check.Violations()) {
        ADD_FAILURE() << "axis " << weak << " chain " << seed << ", " << violation;
      }
    }
    EXPECT_GT(varied, 200);
  }
}

// Whether a bend between these pieces that is smaller than its speed needs is passed with changing
// speed.
bool Varies(const PathPiece& in, const PathPiece& out, const MachineLimits& machine) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = in;
  chain[0].fly = true;
  chain[1].path = out;
  bool varies = false;
  int bends = 0;
  for (const PlannedMotion& motion : Plan(chain, machine)) {
    if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
    ++bends;
    varies = varies || motion.restart_speed < kLargest;
  }
  EXPECT_GT(bends, 0);
  return varies;
}

// motion.md 5.4: only where no axis can be asked for more than the tip, whatever its speed does:
// each by its acceleration and by its jerk, unless there is no limit on jerk at all.
TEST(VariedBends, NeedAxesThatFollowTheTip) {
  const PathPiece in = PathPiece::Line({{990, 900, -200}}, {{1000, 900, -200}});
  const PathPiece out = PathPiece::Line({{1000, 900, -200}}, {{1000, 910, -200}});
  EXPECT_TRUE(Varies(in, out, StandardMachine()));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    MachineLimits machine = StandardMachine();
    machine.axes.jerk[axis] *= 2.0;
    machine.axes.acceleration[axis] *= 2.0;
    EXPECT_TRUE(Varies(in, out, machine)) << axis;
    machine.axes.jerk[axis] = 0.99 * machine.tip_jerk_mm_s3;
    EXPECT_FALSE(Varies(in, out, machine)) << axis;
    machine = StandardMachine();
    machine.axes.acceleration[axis] *= 0.99;
    EXPECT_FALSE(Varies(in, out, machine)) << axis;
    machine = StandardMachine();
    machine.axes.jerk[axis] *= 0.99;
    machine.tip_jerk_mm_s3 = kNoLimit;
    EXPECT_TRUE(Varies(in, out, machine)) << axis;
  }
}

// motion.md 5.4: the head must not turn on either side, by A or by B.
TEST(VariedBends, NeedAHeadThatStands) {
  const auto in = [](double a_rad, double b_rad) {
    return PathPiece::Line({{990, 900, -200}, 0.3 - a_rad, 0.4 - b_rad},
                           {{1000, 900, -200}, 0.3, 0.4});
  };
  const auto out = [](double a_rad, double b_rad) {
    return PathPiece::Line({{1000, 900, -200}, 0.3, 0.4},
                           {{1000, 910, -200}, 0.3 + a_rad, 0.4 + b_rad});
  };
  // A quarter of a circle of 20 mm, so that the bend is no plain one.
  const PathPiece arc =
      PathPiece::ArcThrough({{980, 880, -200}, 0.3, 0.4}, {985.857864376, 894.142135624, -200},
                            {{1000, 900, -200}, 0.3, 0.4})
          ->path;
  EXPECT_TRUE(Varies(arc, out(0, 0), StandardMachine()));
  EXPECT_FALSE(Varies(in(0.02, 0), out(0, 0), StandardMachine()));
  EXPECT_FALSE(Varies(in(0, 0.02), out(0, 0), StandardMachine()));
  EXPECT_FALSE(Varies(in(0, 0), out(0.02, 0), StandardMachine()));
  EXPECT_FALSE(Varies(in(0, 0), out(0, 0.02), StandardMachine()));
}

}  // namespace
}  // namespace rmlcell::motion
