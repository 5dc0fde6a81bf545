// What must not change the path, and what must change it with it: motion.md section 10, properties
// 5 to 10, place by place along the way.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/random_chain.h"
#include "tests/engine/motion/whole_planner.h"

namespace rmlcell::motion {
namespace {

constexpr int kPlaces = 60;

struct Case {
  std::uint64_t seed;
  int count;
};
Case DrawCase(int most = 30) {
  return {*rc::gen::noShrink(rc::gen::arbitrary<std::uint64_t>()), *rc::gen::inRange(1, most)};
}

// Where a plan passes, by the way that lies behind.
class Way {
 public:
  explicit Way(const std::vector<PlannedMotion>& motions) : motions_(motions) {
    LongSum sum;
    for (const PlannedMotion& motion : motions) {
      sum.Add(motion.path.tip_length_mm());
      reached_.push_back(sum.value());
    }
  }
  double length() const { return reached_.empty() ? 0.0 : reached_.back(); }
  TipPose At(double x) const {
    std::size_t k = 0;
    while (k + 1 < motions_.size() && reached_[k] < x) ++k;
    const PathPiece& path = motions_[k].path;
    return path.TipAt(x - (reached_[k] - path.tip_length_mm()));
  }

 private:
  const std::vector<PlannedMotion>& motions_;
  std::vector<double> reached_;
};

// At equal shares of the way the second path is where `expected` says for the first one.
template <class Expected>
void AssertSameWay(const std::vector<PlannedMotion>& first,
                   const std::vector<PlannedMotion>& second, Expected expected,
                   bool backwards = false) {
  const Way one(first), two(second);
  RC_ASSERT(std::abs(one.length() - two.length()) <= 1e-9 * std::max(1.0, one.length()));
  for (int k = 0; k <= kPlaces; ++k) {
    const double share = static_cast<double>(k) / kPlaces;
    const TipPose here = expected(one.At(one.length() * share));
    const TipPose there = two.At(two.length() * (backwards ? 1.0 - share : share));
    RC_ASSERT((here.tip - there.tip).norm() <= 1e-6);
    RC_ASSERT(std::abs(here.a_rad - there.a_rad) <= 1e-6);
    RC_ASSERT(std::abs(here.b_rad - there.b_rad) <= 1e-6);
  }
}

TipPose AsItIs(const TipPose& pose) { return pose; }

// A line or arc with its poses moved; `turn` is linear but for a shift.
template <class Move>
PathPiece Moved(const PathPiece& path, Move move) {
  if (path.kind() != PathPiece::Kind::kArc)
    return PathPiece::Line(move(path.tip_from()), move(path.tip_to()));
  const TipPose via = move(path.TipAt(0.5 * path.length()));
  return PathPiece::ArcThrough(move(path.tip_from()), via.tip, move(path.tip_to()))->path;
}

// Property 5: backwards, all /FLY, lines and arcs with a turning head: the same path. Where and how
// fast a bend begins depends on both sides alike.
RC_GTEST_PROP(PathProperty, BackwardsGoesTheSameWay, ()) {
  const Case drawn = DrawCase();
  const bool arcs = *rc::gen::arbitrary<bool>();
  std::vector<MoveCommand> there = RandomChain(
      drawn.seed, drawn.count, {.arcs = arcs, .head = !arcs, .all_fly = true, .shortest_mm = 0.1});
  for (MoveCommand& move : there) {
    move.overshoot_fraction = 1.0;
    move.speed_fraction = 0.2;
    move.acceleration_fraction = 0.7;
  }
  std::vector<MoveCommand> back;
  for (auto move = there.rbegin(); move != there.rend(); ++move) {
    MoveCommand turned = *move;
    turned.path = PathPiece::Line(move->path.tip_to(), move->path.tip_from());
    if (move->path.kind() == PathPiece::Kind::kArc) {
      turned.path =
          PathPiece::ArcThrough(move->path.tip_to(), move->path.At(0.5 * move->path.length()).point,
                                move->path.tip_from())
              ->path;
    }
    turned.tag = back.size();
    back.push_back(turned);
  }
  const std::vector<PlannedMotion> first = Plan(there), second = Plan(back);
  AssertSameWay(first, second, AsItIs, true);
  RC_ASSERT(std::abs(Duration(first) - Duration(second)) <= 1e-6 * std::max(1.0, Duration(first)));
}

// Property 6: shifted, lines and arcs and the head: the same time, the path shifted alike.
RC_GTEST_PROP(PathProperty, ShiftedGoesTheShiftedWay, ()) {
  const Case drawn = DrawCase();
  const std::vector<MoveCommand> chain = RandomChain(drawn.seed, drawn.count);
  std::vector<MoveCommand> shifted = chain;
  const auto shift = [](const TipPose& p) {
    return TipPose{p.tip + MachineVector{128.0, -64.0, 32.0}, p.a_rad, p.b_rad};
  };
  for (MoveCommand& move : shifted) move.path = Moved(move.path, shift);
  const std::vector<PlannedMotion> first = Plan(chain), second = Plan(shifted);
  AssertSameWay(first, second, shift);
  RC_ASSERT(std::abs(Duration(first) - Duration(second)) <= 1e-6 * std::max(1.0, Duration(first)));
}

// Property 6: with a steady head and axes as strong as the tip no axis limit binds, and the path
// may be turned by any angle about Z.
RC_GTEST_PROP(PathProperty, TurnedByAnyAngleGoesTheTurnedWay, ()) {
  const Case drawn = DrawCase();
  const double angle = *rc::gen::inRange(1, 6283) * 1e-3;
  const std::vector<MoveCommand> chain = RandomChain(drawn.seed, drawn.count, {.head = false});
  std::vector<MoveCommand> turned = chain;
  const auto turn = [c = std::cos(angle), s = std::sin(angle)](const TipPose& p) {
    return TipPose{{c * p.tip.x() - s * p.tip.y(), s * p.tip.x() + c * p.tip.y(), p.tip.z()},
                   p.a_rad,
                   p.b_rad};
  };
  for (MoveCommand& move : turned) move.path = Moved(move.path, turn);
  MachineLimits machine = StandardMachine();
  for (std::size_t i = 0; i < 3; ++i) {
    machine.axes.speed[i] *= 4.0;
    machine.axes.acceleration[i] *= 4.0;
    machine.axes.jerk[i] *= 4.0;
  }
  const std::vector<PlannedMotion> first = Plan(chain, machine), second = Plan(turned, machine);
  AssertSameWay(first, second, turn);
  RC_ASSERT(std::abs(Duration(first) - Duration(second)) <= 1e-6 * std::max(1.0, Duration(first)));
}

// Property 6: by a quarter turn with A turned alike, also where the axes bind: X and Y are equal.
RC_GTEST_PROP(PathProperty, TurnedByAQuarterWithTheHeadGoesTheTurnedWay, ()) {
  const Case drawn = DrawCase();
  const int quarters = *rc::gen::inRange(1, 4);
  const std::vector<MoveCommand> chain = RandomChain(drawn.seed, drawn.count);
  std::vector<MoveCommand> turned = chain;
  const auto turn = [quarters](TipPose p) {
    for (int k = 0; k < quarters; ++k) p.tip = {-p.tip.y(), p.tip.x(), p.tip.z()};
    p.a_rad += quarters * kPi / 2;
    return p;
  };
  for (MoveCommand& move : turned) move.path = Moved(move.path, turn);
  const std::vector<PlannedMotion> first = Plan(chain), second = Plan(turned);
  AssertSameWay(first, second, turn);
  RC_ASSERT(std::abs(Duration(first) - Duration(second)) <= 1e-6 * std::max(1.0, Duration(first)));
}

// Property 7: a point that changes nothing on a line moves nothing.
RC_GTEST_PROP(PathProperty, SplitLinesGoTheSameWay, ()) {
  const Case drawn = DrawCase(15);
  const std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.arcs = false, .head = false, .shortest_mm = 0.1});
  Dice dice(drawn.seed + 1);
  std::vector<MoveCommand> split;
  for (const MoveCommand& move : chain) {
    MoveCommand first = move, second = move;
    const TipPose middle = move.path.TipAt(move.path.length() * dice.Uniform(0.1, 0.9));
    first.path = PathPiece::Line(move.path.tip_from(), middle);
    second.path = PathPiece::Line(middle, move.path.tip_to());
    first.fly = true;
    first.overshoot_fraction = 1.0;
    first.tag = split.size();
    split.push_back(first);
    second.tag = split.size();
    split.push_back(second);
  }
  AssertSameWay(Plan(chain), Plan(split), AsItIs);
}

// Property 9: OVERSH 0 goes the way of moves without /FLY. OPT-2.39
RC_GTEST_PROP(PathProperty, OvershootZeroGoesTheSameWay, ()) {
  const Case drawn = DrawCase();
  std::vector<MoveCommand> passing = RandomChain(drawn.seed, drawn.count, {.all_fly = true});
  std::vector<MoveCommand> stopping = passing;
  for (MoveCommand& move : passing) move.overshoot_fraction = 0.0;
  for (MoveCommand& move : stopping) move.fly = false;
  AssertSameWay(Plan(passing), Plan(stopping), AsItIs);
}

// Property 8: a lower override (SPEED of every move alike) changes the path at corners only: what
// is left of a line lies on the line, and is no shorter. OPT-2.41
RC_GTEST_PROP(PathProperty, LowerOverrideChangesNothingBetweenCorners, ()) {
  const Case drawn = DrawCase();
  const std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.arcs = false, .head = false, .shortest_mm = 0.5});
  std::vector<MoveCommand> slow = chain;
  for (MoveCommand& move : slow) move.speed_fraction *= 0.4;
  for (const std::vector<MoveCommand>& each : {chain, slow}) {
    for (const PlannedMotion& motion : Plan(each)) {
      if (motion.path.kind() != PathPiece::Kind::kLine) continue;
      const PathPiece& whole = chain[static_cast<std::size_t>(motion.tag)].path;
      for (const PathPose& end : {motion.path.from(), motion.path.to()}) {
        const double along = (end.point - whole.from().point).dot(whole.Tangent(0.0));
        RC_ASSERT(along >= -1e-9);
        RC_ASSERT(along <= whole.length() + 1e-9);
        RC_ASSERT((whole.At(along).point - end.point).norm() <= 1e-9);
      }
    }
  }
}

// Property 10: a window that is never full changes not a bit, whatever its size.
RC_GTEST_PROP(PathProperty, WindowsThatAreNeverFullGiveTheSameBits, ()) {
  const Case drawn = DrawCase(200);
  const std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.all_fly = true, .longest_mm = 3.0});
  const std::vector<PlannedMotion> small = Plan(chain, StandardMachine(), 1024);
  const std::vector<PlannedMotion> large = Plan(chain);
  RC_ASSERT(small.size() == large.size());
  for (std::size_t k = 0; k < small.size(); ++k) {
    RC_ASSERT(small[k].path.from() == large[k].path.from());
    RC_ASSERT(small[k].path.length() == large[k].path.length());
    RC_ASSERT(small[k].speed.duration_s() == large[k].speed.duration_s());
    RC_ASSERT(small[k].speed.end().speed == large[k].speed.end().speed);
    RC_ASSERT(small[k].limits.speed == large[k].limits.speed);
  }
}

}  // namespace
}  // namespace rmlcell::motion
