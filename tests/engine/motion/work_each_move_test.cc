// The work of the planner is spread over the moves: what that must not change, and what it must
// give.
#include <gtest/gtest.h>

#include <memory>

#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Short lines at a speed that their bends do not allow: long sections of ramps.
std::vector<MoveCommand> Wave(int count) {
  std::vector<MoveCommand> chain;
  const auto at = [](int k) {
    const double t = kTurn * k / 600.0;
    const double r = 200.0 + 20.0 * std::sin(7 * t);
    return TipPose{{1000.0 + r * std::cos(t), 900.0 + r * std::sin(t), -200.0}, 0, 0};
  };
  for (int k = 0; k < count; ++k) {
    MoveCommand move;
    move.path = PathPiece::Line(at(k), at(k + 1));
    move.speed_fraction = 0.3;
    move.fly = true;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
  }
  return chain;
}

struct Given {
  std::vector<double> durations;
  std::vector<std::uint64_t> tags;
  bool operator==(const Given&) const = default;
};

void Take(Planner& planner, Given& given) {
  while (const PlannedItem* item = planner.NextInPlace()) {
    const auto& motion = std::get<PlannedMotion>(*item);
    given.durations.push_back(motion.duration_s());
    given.tags.push_back(motion.tag);
  }
}

// A copy is made while a section is half planned, and the first one goes: the copy must not look at
// it.
TEST(WorkEachMove, ACopyGoesOnByItself) {
  const std::vector<MoveCommand> chain = Wave(400);
  Given whole;
  Planner all(StandardMachine());
  for (const MoveCommand& move : chain) {
    ASSERT_TRUE(all.Append(move));
    Take(all, whole);
  }
  all.Stop();
  Take(all, whole);

  for (std::size_t cut = 100; cut < 300; cut += 7) {
    auto first = std::make_unique<Planner>(StandardMachine());
    Given given;
    for (std::size_t k = 0; k < cut; ++k) {
      ASSERT_TRUE(first->Append(chain[k]));
      Take(*first, given);
    }
    Planner copy = *first;
    for (std::size_t k = cut; k < chain.size(); ++k) {
      ASSERT_TRUE(first->Append(chain[k]));
      Given other;
      Take(*first, other);  // overwrites what a copy must not look at
    }
    first.reset();
    for (std::size_t k = cut; k < chain.size(); ++k) {
      ASSERT_TRUE(copy.Append(chain[k]));
      Take(copy, given);
    }
    copy.Stop();
    Take(copy, given);
    EXPECT_EQ(given, whole) << cut;
  }
}

// Who takes items only at the end gets the same as who takes them with each move.
TEST(WorkEachMove, DoesNotHangOnWhenItIsTaken) {
  const std::vector<MoveCommand> chain = Wave(400);
  Given often, once;
  Planner one(StandardMachine()), other(StandardMachine());
  for (const MoveCommand& move : chain) {
    ASSERT_TRUE(one.Append(move));
    Take(one, often);
    ASSERT_TRUE(other.Append(move));
  }
  one.Stop();
  Take(one, often);
  other.Stop();
  Take(other, once);
  EXPECT_EQ(often, once);
}

// A batch of lines is decided at once, 32 or more of them. Three motions a line come out of it: no
// move gives them all.
TEST(WorkEachMove, AFewItemsWithEachMove) {
  const std::vector<MoveCommand> chain = Wave(2000);
  Planner planner(StandardMachine());
  std::size_t most = 0;
  std::size_t taken = 0;
  std::size_t waiting_most = 0;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    ASSERT_TRUE(planner.Append(chain[k]));
    Given given;
    Take(planner, given);
    most = std::max(most, given.tags.size());
    taken = given.tags.empty() ? taken : given.tags.back();
    waiting_most = std::max(waiting_most, k - taken);
  }
  EXPECT_LE(most, 32U);
  EXPECT_LE(waiting_most, 300U);  // and none waits for long: two batches, and the longest section
}

// Where the machine stands all comes out at once, with or without Stop.
TEST(WorkEachMove, AllComesOutWhereTheMachineStands) {
  std::vector<MoveCommand> chain = Wave(100);
  chain.back().fly = false;
  Planner planner(StandardMachine());
  Given given;
  for (const MoveCommand& move : chain) {
    ASSERT_TRUE(planner.Append(move));
    Take(planner, given);
  }
  ASSERT_FALSE(given.tags.empty());
  EXPECT_EQ(given.tags.back(), 99U);
}

}  // namespace
}  // namespace rmlcell::motion
