// Invariants and metamorphic properties of the planner over random chains: motion.md section 10.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "engine/core/units.h"
#include "tests/engine/motion/plan_check.h"
#include "tests/engine/motion/random_chain.h"
#include "tests/engine/motion/whole_planner.h"

namespace rmlcell::motion {
namespace {

struct Drawn {
  std::uint64_t seed;
  int count;
};
Drawn Draw(int most = 40) {
  return {*rc::gen::noShrink(rc::gen::arbitrary<std::uint64_t>()), *rc::gen::inRange(1, most)};
}

double Length(const std::vector<PlannedMotion>& motions) {
  LongSum sum;
  for (const PlannedMotion& motion : motions) sum.Add(motion.path.length());
  return sum.value();
}
std::vector<CornerReport> Corners(const std::vector<PlannedMotion>& motions) {
  std::vector<CornerReport> corners;
  for (const PlannedMotion& motion : motions) {
    if (motion.ends_move) corners.push_back(motion.corner);
  }
  return corners;
}

void ExpectNoViolation(const std::vector<MoveCommand>& chain, const MachineLimits& machine,
                       bool arcs = true) {
  const std::vector<PlannedMotion> motions = Plan(chain, machine);
  const PlanCheck check{chain, motions, machine, 3, arcs};
  const std::vector<std::string> violations = check.Violations();
  if (!violations.empty()) RC_FAIL(violations[0]);
}

// Properties 1 to 4.
RC_GTEST_PROP(PlannerProperty, KeepsEveryLimitAndMeetsEveryTarget, ()) {
  const Drawn drawn = Draw();
  ExpectNoViolation(RandomChain(drawn.seed, drawn.count), StandardMachine());
}

RC_GTEST_PROP(PlannerProperty, KeepsEveryLimitWithoutTheHead, ()) {
  const Drawn drawn = Draw();
  ExpectNoViolation(RandomChain(drawn.seed, drawn.count, {.arcs = false, .head = false}),
                    StandardMachine(), false);
}

RC_GTEST_PROP(PlannerProperty, KeepsEveryLimitOfTrapezoids, ()) {
  const Drawn drawn = Draw();
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  ExpectNoViolation(RandomChain(drawn.seed, drawn.count, {.head = false}), machine);
}

// Axes weaker than the tip: they bind on lines and in bends.
RC_GTEST_PROP(PlannerProperty, KeepsEveryLimitOfWeakAxes, ()) {
  const Drawn drawn = Draw();
  MachineLimits machine = StandardMachine();
  machine.axes.speed = {200, 300, 100, 1.0, 0.5};
  machine.axes.acceleration = {700, 1500, 300, 5, 3};
  machine.axes.jerk = {10000, 30000, 5000, 80, 60};
  ExpectNoViolation(RandomChain(drawn.seed, drawn.count), machine);
}

// Property 5: backwards, all /FLY: same time, same corners in reverse.
RC_GTEST_PROP(PlannerProperty, BackwardsTakesTheSameTime, ()) {
  const Drawn drawn = Draw();
  std::vector<MoveCommand> there =
      RandomChain(drawn.seed, drawn.count, {.arcs = false, .all_fly = true});
  for (MoveCommand& move : there) {
    move.overshoot_fraction = 1.0;
    move.speed_fraction = 0.2;
    move.acceleration_fraction = 0.7;
  }
  std::vector<MoveCommand> back;
  for (auto move = there.rbegin(); move != there.rend(); ++move) {
    MoveCommand turned = *move;
    turned.path = PathPiece::Line(move->path.tip_to(), move->path.tip_from());
    turned.tag = back.size();
    back.push_back(turned);
  }
  const std::vector<PlannedMotion> first = Plan(there), second = Plan(back);
  RC_ASSERT(std::abs(Duration(first) - Duration(second)) <= 1e-8 * std::max(1.0, Duration(first)));
  RC_ASSERT(std::abs(Length(first) - Length(second)) <= 1e-9 * std::max(1.0, Length(first)));
}

// Property 6: turned about Z by a quarter, with A alike, and shifted.
RC_GTEST_PROP(PlannerProperty, TurnedAndShiftedTakesTheSameTime, ()) {
  const Drawn drawn = Draw();
  std::vector<MoveCommand> chain = RandomChain(drawn.seed, drawn.count, {.arcs = false});
  std::vector<MoveCommand> turned = chain;
  const auto turn = [](const TipPose& p) {
    return TipPose{
        {100.0 - p.tip.y(), p.tip.x() - 70.0, p.tip.z() + 12.0}, p.a_rad + kPi / 2, p.b_rad};
  };
  for (MoveCommand& move : turned)
    move.path = PathPiece::Line(turn(move.path.tip_from()), turn(move.path.tip_to()));
  const double before = Duration(Plan(chain)), after = Duration(Plan(turned));
  RC_ASSERT(std::abs(before - after) <= 1e-7 * std::max(1.0, before));
}

// Property 6: everything with a length in it scaled by c: same times.
RC_GTEST_PROP(PlannerProperty, ScaledTakesTheSameTime, ()) {
  const Drawn drawn = Draw();
  std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.arcs = false, .shortest_mm = 0.1});
  const double c = 1.7;
  std::vector<MoveCommand> scaled = chain;
  for (MoveCommand& move : scaled) {
    const auto grow = [c](TipPose p) {
      p.tip = p.tip * c;
      return p;
    };
    move.path = PathPiece::Line(grow(move.path.tip_from()), grow(move.path.tip_to()));
    move.head = GantryHead{.length_mm = GantryHead{}.length_mm * c};
  }
  MachineLimits machine = StandardMachine();
  machine.tip_speed_mm_s *= c;
  machine.tip_acceleration_mm_s2 *= c;
  machine.tip_jerk_mm_s3 *= c;
  for (std::size_t i = 0; i < 3; ++i) {
    machine.axes.speed[i] *= c;
    machine.axes.acceleration[i] *= c;
    machine.axes.jerk[i] *= c;
  }
  const std::vector<PlannedMotion> plain = Plan(chain), grown = Plan(scaled, machine);
  // The smallest curve, 1e-4 mm, is the same for both: a smaller one is a stop (motion.md 1).
  const std::vector<CornerReport> corners = Corners(plain), grown_corners = Corners(grown);
  for (std::size_t k = 0; k < corners.size(); ++k)
    RC_PRE(corners[k].passage == grown_corners[k].passage);
  RC_ASSERT(std::abs(Duration(plain) - Duration(grown)) <= 1e-7 * std::max(1.0, Duration(plain)));
}

// Property 7: lines split in two by a point that changes nothing: same path, same time.
RC_GTEST_PROP(PlannerProperty, SplitLinesTakeTheSameTime, ()) {
  const Drawn drawn = Draw(20);
  const std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.arcs = false, .head = false, .shortest_mm = 0.1});
  Dice dice(drawn.seed + 1);
  std::vector<MoveCommand> split;
  for (const MoveCommand& move : chain) {
    const MachineVector a = move.path.from().point, b = move.path.to().point;
    MoveCommand first = move, second = move;
    const TipPose middle{a + (b - a) * dice.Uniform(0.1, 0.9), move.path.to().a_rad,
                         move.path.to().b_rad};
    first.path = PathPiece::Line(move.path.tip_from(), middle);
    second.path = PathPiece::Line(middle, move.path.tip_to());
    first.fly = true;
    first.overshoot_fraction = 1.0;
    first.tag = split.size();
    split.push_back(first);
    second.tag = split.size();
    split.push_back(second);
  }
  const std::vector<PlannedMotion> one = Plan(chain), two = Plan(split);
  RC_ASSERT(std::abs(Duration(one) - Duration(two)) <= 1e-8 * std::max(1.0, Duration(one)));
  RC_ASSERT(std::abs(Length(one) - Length(two)) <= 1e-9 * std::max(1.0, Length(one)));
}

// Property 8: lower SPEED, OVERSH or ACCEL, and no corner is cut more. OPT-2.41. Without a limit on
// jerk that holds always. With one, who arrives slower may leave faster (ReachMinimum), by up to 6
// % in chains of short moves: there a corner is cut more only when its running speed is higher.
RC_GTEST_PROP(PlannerProperty, SlowerComesCloserToEveryCorner, ()) {
  const Drawn drawn = Draw();
  const bool trapezoid = *rc::gen::arbitrary<bool>();
  MachineLimits machine = StandardMachine();
  if (trapezoid) machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  const std::vector<MoveCommand> chain = RandomChain(drawn.seed, drawn.count, {.head = false});
  const std::vector<CornerReport> fast = Corners(Plan(chain, machine));
  const int what = *rc::gen::inRange(0, 3);
  std::vector<MoveCommand> slow = chain;
  for (MoveCommand& move : slow) {
    if (what == 0) move.speed_fraction *= 0.6;
    if (what == 1) move.acceleration_fraction *= 0.5;
    if (what == 2) move.overshoot_fraction *= 0.7;
  }
  const std::vector<CornerReport> slower = Corners(Plan(slow, machine));
  RC_ASSERT(fast.size() == slower.size());
  for (std::size_t k = 0; k < fast.size(); ++k) {
    if (fast[k].passage == Passage::kThrough) continue;
    if (trapezoid) RC_ASSERT(slower[k].wanted_speed <= fast[k].wanted_speed * (1 + 1e-12));
    RC_ASSERT(slower[k].wanted_speed <= fast[k].wanted_speed * 1.07);
    if (slower[k].wanted_speed > fast[k].wanted_speed) continue;
    RC_ASSERT(slower[k].cut_mm <= fast[k].cut_mm + 1e-12);
  }
}

// Property 9: OVERSH 0 against no /FLY: same path, faster by one settling per corner. OPT-2.39
RC_GTEST_PROP(PlannerProperty, OvershootZeroSavesTheSettling, ()) {
  const Drawn drawn = Draw();
  std::vector<MoveCommand> passing = RandomChain(drawn.seed, drawn.count, {.all_fly = true});
  std::vector<MoveCommand> stopping = passing;
  for (MoveCommand& move : passing) move.overshoot_fraction = 0.0;
  for (MoveCommand& move : stopping) move.fly = false;
  const double saved = Duration(Plan(stopping)) - Duration(Plan(passing));
  RC_ASSERT(std::abs(saved - 0.048 * (drawn.count - 1)) <= 1e-9);
}

// Property 10: when the output is taken changes nothing, bit for bit.
RC_GTEST_PROP(PlannerProperty, OutputDoesNotDependOnBatches, ()) {
  const Drawn drawn = Draw(300);
  const std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.all_fly = true, .longest_mm = 3.0});
  Planner planner(StandardMachine());
  for (const MoveCommand& move : chain) RC_ASSERT(planner.Append(move).ok());
  planner.Stop();
  const std::vector<PlannedMotion> streamed = Plan(chain);
  for (const PlannedMotion& motion : streamed) {
    const std::optional<PlannedItem> item = planner.Next();
    RC_ASSERT(item.has_value());
    const auto& other = std::get<PlannedMotion>(*item);
    RC_ASSERT(other.path.from() == motion.path.from());
    RC_ASSERT(other.path.length() == motion.path.length());
    RC_ASSERT(other.speed.duration_s() == motion.speed.duration_s());
    RC_ASSERT(other.speed.end().speed == motion.speed.end().speed);
  }
  RC_ASSERT(!planner.Next().has_value());
}

// A window of 64 knots is legal everywhere, at most slower; one that is never full changes nothing.
RC_GTEST_PROP(PlannerProperty, SmallWindowIsLegal, ()) {
  const Drawn drawn = Draw(400);
  const std::vector<MoveCommand> chain =
      RandomChain(drawn.seed, drawn.count, {.all_fly = true, .longest_mm = 0.1});
  const MachineLimits machine = StandardMachine();
  const std::vector<PlannedMotion> small = Plan(chain, machine, 64);
  const PlanCheck check{chain, small, machine};
  const std::vector<std::string> violations = check.Violations();
  if (!violations.empty()) RC_FAIL(violations[0]);
}

}  // namespace
}  // namespace rmlcell::motion
