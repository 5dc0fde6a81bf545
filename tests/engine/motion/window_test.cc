// What waits in the planner when its window is full. motion.md 5.5.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Takes what comes out after each move, and tells how many moves waited at most.
class Counted {
 public:
  Counted(const MachineLimits& machine, std::size_t window) : planner_(machine, window) {}

  void Go(const MachineVector& step, double speed) {
    MoveCommand move;
    move.path = PathPiece::Line({at_}, {at_ + step});
    move.speed_fraction = speed;
    move.fly = true;
    at_ = move.path.to().point;
    ASSERT_TRUE(planner_.Append(move));
    ++waiting_;
    most_ = std::max(most_, waiting_);
    Take();
  }
  void Stop() {
    planner_.Stop();
    Take();
  }
  std::size_t waiting() const { return waiting_; }
  std::size_t most() const { return most_; }
  const Planner& planner() const { return planner_; }

 private:
  void Take() {
    while (const PlannedItem* item = planner_.NextInPlace()) {
      if (std::get<PlannedMotion>(*item).ends_move) --waiting_;
    }
  }
  Planner planner_;
  MachineVector at_{1000, 900, -200};
  std::size_t waiting_ = 0;
  std::size_t most_ = 0;
};

// A bend whose size hangs on how long the run behind it is, and that run goes on and on in steps
// too short to tell: no more waits than twice what the window holds, each time.
TEST(Window, AnUndecidedBendDoesNotFillIt) {
  for (const std::size_t window : {64u, 256u}) {
    Counted chain(StandardMachine(), window);
    for (int corner = 0; corner < 3; ++corner) {
      chain.Go({100, 0, 0}, 1.0);
      for (std::size_t k = 0; k < 8 * window; ++k) chain.Go({0, 1e-5, 0}, k % 2 == 0 ? 0.9 : 1.0);
    }
    EXPECT_LE(chain.most(), 2 * window);
    EXPECT_GT(chain.planner().lookahead_starved(), 0u);
    chain.Stop();
    EXPECT_EQ(chain.waiting(), 0u);
  }
}

// The window is full with its last move, not before: nothing is decided too early up to there.
TEST(Window, HoldsAsManyMovesAsItSays) {
  Counted chain(StandardMachine(), 64);
  chain.Go({100, 0, 0}, 1.0);
  for (int k = 2; k < 64; ++k) chain.Go({0, 1e-5, 0}, k % 2 == 0 ? 0.9 : 1.0);
  EXPECT_EQ(chain.waiting(), 63u);
  EXPECT_EQ(chain.planner().lookahead_starved(), 0u);
  chain.Go({0, 1e-5, 0}, 0.9);
  EXPECT_EQ(chain.planner().lookahead_starved(), 1u);
}

std::vector<PlannedMotion> Drain(Planner& planner) {
  std::vector<PlannedMotion> motions;
  planner.Stop();
  while (const PlannedItem* item = planner.NextInPlace()) {
    motions.push_back(std::get<PlannedMotion>(*item));
  }
  return motions;
}

void ExpectSame(const PlannedMotion& got, const PlannedMotion& want) {
  EXPECT_EQ(got.tag, want.tag);
  EXPECT_EQ(got.path.kind(), want.path.kind());
  EXPECT_EQ(got.path.from(), want.path.from());
  EXPECT_EQ(got.path.to(), want.path.to());
  EXPECT_EQ(got.path.length(), want.path.length());
  EXPECT_EQ(got.head, want.head);
  EXPECT_EQ(got.limits.speed, want.limits.speed);
  EXPECT_EQ(got.limits.acceleration, want.limits.acceleration);
  EXPECT_EQ(got.limits.jerk, want.limits.jerk);
  EXPECT_EQ(got.restart_speed, want.restart_speed);
  EXPECT_EQ(got.settling_s, want.settling_s);
  EXPECT_EQ(got.ends_move, want.ends_move);
  EXPECT_EQ(got.corner.passage, want.corner.passage);
  EXPECT_EQ(got.corner.speed, want.corner.speed);
  EXPECT_EQ(got.corner.wanted_speed, want.corner.wanted_speed);
  EXPECT_EQ(got.corner.cut_mm, want.corner.cut_mm);
  EXPECT_EQ(got.corner.deviation_mm, want.corner.deviation_mm);
  EXPECT_EQ(got.speed.phase_count(), want.speed.phase_count());
  EXPECT_EQ(got.speed.duration_s(), want.speed.duration_s());
  EXPECT_EQ(got.speed.peak_speed(), want.speed.peak_speed());
}

constexpr int kMoves = 40;

// Chains of one kind each: stops that settle, bends, points straight on at other speeds, moves of
// the axes, and all kinds mixed.
std::vector<std::vector<MoveCommand>> KindsOfChains() {
  std::vector<std::vector<MoveCommand>> chains;
  const auto add = [&](auto change) {
    std::vector<MoveCommand> chain;
    MachinePoint at{1000, 900, -200};
    for (int k = 0; k < kMoves; ++k) {
      MoveCommand move;
      move.speed_fraction = 0.1;
      move.fly = k + 1 < kMoves;
      move.tag = static_cast<std::uint64_t>(k);
      const MachineVector step = change(move, k);
      move.path = move.kind == MoveCommand::Kind::kPointToPointAxes
                      ? PathPiece::Joint({at}, {at + step})
                      : PathPiece::Line({at}, {at + step});
      at = at + step;
      chain.push_back(move);
    }
    chains.push_back(chain);
  };
  add([](MoveCommand& move, int) {
    move.fly = false;
    return MachineVector{3, 0, 0};
  });
  add([](MoveCommand& move, int k) {
    move.speed_fraction = 0.6;
    return k % 2 == 0 ? MachineVector{1, 0, 0} : MachineVector{0, 1, 0};
  });
  add([](MoveCommand& move, int k) {
    move.speed_fraction = k % 2 == 0 ? 0.1 : 0.15;
    return MachineVector{2, 0, 0};
  });
  add([](MoveCommand& move, int k) {
    move.kind = MoveCommand::Kind::kPointToPointAxes;
    return k % 2 == 0 ? MachineVector{50, 0, 0} : MachineVector{0, 30, 0};
  });
  chains.push_back(RandomChain(5, kMoves, {.shortest_mm = 0.1, .longest_mm = 20.0}));
  return chains;
}

// Where the machine stood, what came before leaves no trace in what comes next, whatever both are.
TEST(Window, WhatWasPlannedBeforeLeavesNoTrace) {
  for (const bool jerk_limited : {true, false}) {
    MachineLimits machine = StandardMachine();
    if (!jerk_limited) machine.tip_jerk_mm_s3 = kNoLimit;
    const auto chains = KindsOfChains();
    for (std::size_t before = 0; before < chains.size(); ++before) {
      for (std::size_t after = 0; after < chains.size(); ++after) {
        Planner used(machine), fresh(machine);
        // Every queue as long as it will be, then all of its places used by the one kind.
        auto earlier = chains;
        earlier.insert(earlier.end(), 2, chains[before]);
        for (const std::vector<MoveCommand>& chain : earlier) {
          for (const MoveCommand& move : chain) ASSERT_TRUE(used.Append(move));
          (void)Drain(used);
        }
        for (const MoveCommand& move : chains[after]) {
          ASSERT_TRUE(used.Append(move));
          ASSERT_TRUE(fresh.Append(move));
        }
        const std::vector<PlannedMotion> got = Drain(used), want = Drain(fresh);
        ASSERT_EQ(got.size(), want.size()) << before << " " << after;
        for (std::size_t k = 0; k < got.size() && !testing::Test::HasFailure(); ++k) {
          ExpectSame(got[k], want[k]);
        }
        ASSERT_FALSE(testing::Test::HasFailure()) << before << " " << after;
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
