// What is under way, to come, interrupted and held, by the table of path_ride.h. motion.md section
// 6
#include "engine/motion/ride/path_ride.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/engine/motion/plan_check.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

constexpr SimTime kBegin = std::chrono::seconds(5);

// Three lines of 100 mm straight on, passed at 50 mm/s, with the tags 1 to 3.
std::vector<PlannedMotion> StraightOn() {
  std::vector<MoveCommand> chain(3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double from_mm = 100.0 * static_cast<double>(k);
    chain[k].path = PathPiece::Line({{from_mm, 0, 0}}, {{from_mm + 100.0, 0, 0}});
    chain[k].speed_fraction = 0.1;
    chain[k].fly = k < 2;
    chain[k].tag = k + 1;
  }
  return Plan(chain);
}

// Behind each of the lines comes a mark: tags 11 to 13.
PathRide RideOver(const std::vector<PlannedMotion>& motions) {
  PathRide ride(HoldRamp::kStays);
  for (const PlannedMotion& motion : motions) {
    ride.Plan(motion);
    if (motion.ends_move) ride.Plan(PlannedMark{motion.tag + 10});
  }
  return ride;
}

// "1 m11 2": the tags of what is to come.
std::string TagsToCome(const PathRide& ride) {
  std::string tags;
  for (const PlannedItem& item : ride.to_come()) {
    const auto* motion = std::get_if<PlannedMotion>(&item);
    tags += tags.empty() ? "" : " ";
    tags += motion != nullptr ? std::to_string(motion->tag)
                              : "m" + std::to_string(std::get<PlannedMark>(item).tag);
  }
  return tags;
}

double LengthToCome(const PathRide& ride) {
  double sum_mm = 0.0;
  for (const PlannedItem& item : ride.to_come()) {
    if (const auto* motion = std::get_if<PlannedMotion>(&item)) sum_mm += motion->path.length();
  }
  return sum_mm;
}

TEST(PathRide, BeginsOneMotionAfterTheOther) {
  const std::vector<PlannedMotion> motions = StraightOn();
  ASSERT_EQ(motions.size(), 3u);
  PathRide ride = RideOver(motions);
  EXPECT_TRUE(ride.waits_to_begin());
  EXPECT_EQ(ride.under_way(), nullptr);

  ride.Begin(kBegin);
  ASSERT_NE(ride.under_way(), nullptr);
  EXPECT_FALSE(ride.waits_to_begin());
  EXPECT_EQ(TagsToCome(ride), "m11 2 m12 3 m13");
  const MotionUnderWay& first = *ride.under_way();
  EXPECT_EQ(first.motion.tag, 1u);
  EXPECT_EQ(first.start, kBegin);
  EXPECT_EQ(first.arrival, kBegin + FromSeconds(motions[0].speed.duration_s()));
  EXPECT_EQ(first.end, first.arrival);  // it passes on: no standstill behind it
  EXPECT_EQ(first.PlaceAt(kBegin), 0.0);
  EXPECT_EQ(first.PlaceAt(first.arrival), 100.0);
  EXPECT_NEAR(first.TipSpeedAt(first.arrival), 50.0, 1e-6);

  ride.Leave();
  EXPECT_EQ(ride.under_way(), nullptr);
  EXPECT_TRUE(ride.busy());
}

// The last one stands: its end is that much later than its arrival.
TEST(PathRide, CountsTheStandstillBehindAMotion) {
  PathRide ride(HoldRamp::kStays);
  PlannedMotion last = StraightOn().back();
  last.settling_s = 0.25;
  ride.Plan(last);
  const MotionUnderWay& active = ride.Begin(kBegin);
  EXPECT_EQ(active.end - active.arrival, std::chrono::milliseconds(250));
  EXPECT_EQ(active.TipAt(active.arrival).tip.x(), 300.0);
}

// At 50 mm/s it takes more than 1 mm to come to rest, and less than 50: a STOP 1 mm before the end
// of the first line rests on the second. The mark between them is on the ramp, that behind the
// second waits with what is left of it.
TEST(PathRide, StopLeavesTheRestForStart) {
  const std::vector<PlannedMotion> motions = StraightOn();
  PathRide ride = RideOver(motions);
  const SimTime now = ride.Begin(kBegin).start + FromSeconds(motions[0].speed.TimeAt(99.0));
  const AxisLimits axes = StandardMachine().axes;
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->rests_on, 2u);
  EXPECT_NE(ride.under_way(), nullptr);  // a plan changes nothing

  ride.Stop(*plan, axes);
  EXPECT_EQ(ride.under_way(), nullptr);
  EXPECT_TRUE(ride.protocol().comes_to_rest());
  EXPECT_EQ(TagsToCome(ride), "1 m11 2");
  const double ramp_mm = LengthToCome(ride);
  EXPECT_GT(ramp_mm, 1.0);
  EXPECT_LT(ramp_mm, 50.0);

  ride.ReplaceToCome({});  // ridden
  EXPECT_TRUE(ride.TakeUpInterrupted());
  EXPECT_EQ(TagsToCome(ride), "2 m12 3 m13");
  EXPECT_NEAR(ramp_mm + LengthToCome(ride), 201.0, 1e-6);
  EXPECT_FALSE(ride.TakeUpInterrupted());
}

// STOP at the very middle of a bend that is too tight to brake in, at the time of the mark there:
// it is still passed, whichever way that time is rounded.
TEST(PathRide, StopAtTheTimeOfAMarkKeepsIt) {
  const MachineLimits machine = StandardMachine();
  std::set<std::string> marked;
  for (int length_mm = 50; length_mm < 80; ++length_mm) {
    MoveCommand first;
    MoveCommand second;
    const double at_mm = length_mm;
    first.path = PathPiece::Line({{0, 0, 0}}, {{at_mm, 0, 0}});
    second.path = PathPiece::Line({{at_mm, 0, 0}}, {{at_mm, at_mm, 0}});
    first.tag = 1;
    first.fly = true;
    second.tag = 2;
    Planner planner(machine);
    ASSERT_TRUE(planner.Append(first));
    planner.Mark(11);
    ASSERT_TRUE(planner.Append(second));
    planner.Stop();
    PathRide ride(HoldRamp::kStays);
    while (const std::optional<PlannedItem> item = planner.Next()) ride.Plan(*item);
    SimTime now = kBegin;
    while (!std::holds_alternative<PlannedMark>(ride.to_come()[1])) {
      now = ride.Begin(now).arrival;
      ride.Leave();
    }
    now = ride.Begin(now).arrival;
    const std::optional<PathRide::StopPlan> plan = ride.PlanStop(now, machine.axes);
    ASSERT_TRUE(plan);
    ride.Stop(*plan, machine.axes);
    marked.insert(TagsToCome(ride));
  }
  EXPECT_EQ(marked, (std::set<std::string>{"1 m11 2", "m11 2"}));
}

// A move that is ended on its way takes all with it that would follow, of what a STOP interrupted,
// too.
TEST(PathRide, AnEndedMoveLeavesNoRest) {
  const std::vector<PlannedMotion> motions = StraightOn();
  PathRide ride(HoldRamp::kStays);
  ride.ReplaceToCome({motions.begin(), motions.end()});
  const SimTime now = ride.Begin(kBegin).start + FromSeconds(motions[0].speed.TimeAt(99.0));
  const auto plan = ride.PlanStop(now, StandardMachine().axes);
  ASSERT_TRUE(plan.has_value());
  ride.Stop(*plan, StandardMachine().axes);
  ride.DropRest();
  EXPECT_TRUE(ride.to_come().empty());
  EXPECT_FALSE(ride.TakeUpInterrupted());
}

// What follows the first line is not planned yet, and 1 mm is too little to come to rest.
TEST(PathRide, DoesNotStopWhereNotEnoughIsPlanned) {
  const std::vector<PlannedMotion> motions = StraightOn();
  PathRide ride(HoldRamp::kStays);
  ride.Plan(motions[0]);
  const SimTime now = ride.Begin(kBegin).start + FromSeconds(motions[0].speed.TimeAt(99.0));
  EXPECT_FALSE(ride.PlanStop(now, StandardMachine().axes).has_value());
  EXPECT_TRUE(ride.protocol().goes());
}

// STOP in the last ramp of a move: it comes to rest at its end, where it only has to settle then;
// its move is over once.
TEST(PathRide, StopInTheLastRampLeavesTheSettling) {
  const PlannedMotion last = StraightOn().back();
  PathRide ride(HoldRamp::kStays);
  ride.Plan(last);
  ride.Plan(PlannedMark{13});
  const SimTime now = ride.Begin(kBegin).arrival - std::chrono::milliseconds(10);
  const AxisLimits axes = StandardMachine().axes;
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->rests_on, 3u);
  ride.Stop(*plan, axes);
  ASSERT_EQ(TagsToCome(ride), "3");
  EXPECT_TRUE(std::get<PlannedMotion>(ride.to_come()[0]).ends_move);
  ASSERT_EQ(ride.interrupted().size(), 2u);
  const auto& settling = std::get<PlannedMotion>(ride.interrupted()[0]);
  EXPECT_FALSE(settling.ends_move);
  EXPECT_EQ(settling.path.length(), 0.0);
  EXPECT_EQ(settling.settling_s, 0.048);
  EXPECT_EQ(std::get<PlannedMark>(ride.interrupted()[1]).tag, 13u);
}

// Where there is nothing to settle the rest begins with the next move, and that is over where it
// ends, however short it is.
TEST(PathRide, StopInTheLastRampLeavesTheNextMoveWhole) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
  chain[1].path = PathPiece::Line({{100, 0, 0}}, {{100, 0.8, 0}});
  chain[0].fly = true;
  chain[0].overshoot_fraction = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    chain[k].speed_fraction = 0.1;
    chain[k].tag = k + 1;
  }
  PathRide ride(HoldRamp::kStays);
  for (const PlannedMotion& motion : Plan(chain)) ride.Plan(motion);
  const SimTime now = ride.Begin(kBegin).arrival - std::chrono::milliseconds(10);
  const AxisLimits axes = StandardMachine().axes;
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->rests_on, 1u);
  ride.Stop(*plan, axes);
  ASSERT_EQ(ride.interrupted().size(), 1u);
  const auto& next = std::get<PlannedMotion>(ride.interrupted()[0]);
  EXPECT_EQ(next.tag, 2u);
  EXPECT_NEAR(next.path.length(), 0.8, 1e-9);
  EXPECT_TRUE(next.ends_move);
}

// Moved while it stood: its commands from one on are others, and held back with those that were.
TEST(PathRide, WhatItWasMovedAwayFromIsHeldBack) {
  const std::vector<PlannedMotion> motions = StraightOn();
  PathRide ride = RideOver(motions);
  for (const std::uint64_t tag : {1u, 2u, 3u}) ride.Append({.tag = tag, .move = MoveCommand{}});
  const SimTime now = ride.Begin(kBegin).start + FromSeconds(motions[0].speed.TimeAt(50.0));
  const AxisLimits axes = StandardMachine().axes;
  ride.Stop(*ride.PlanStop(now, axes), axes);
  ASSERT_FALSE(ride.interrupted().empty());
  ride.HoldBack(2, {{.tag = 8, .move = MoveCommand{}}, {.tag = 9, .move = std::nullopt}});
  EXPECT_TRUE(ride.interrupted().empty());
  ASSERT_EQ(ride.appended().size(), 1u);
  EXPECT_EQ(ride.appended()[0].tag, 1u);
  ASSERT_EQ(ride.held().size(), 2u);
  EXPECT_EQ(ride.held()[0].tag, 8u);
  EXPECT_EQ(ride.held()[1].tag, 9u);
}

// Once it has arrived it is at the end exactly, at 50 mm/s, although the time is rounded to
// nanoseconds.
TEST(MotionUnderWay, ArrivesAtTheEnd) {
  for (int k = 1; k <= 40; ++k) {
    const TipPose end{{10.0 + k / 7.0, 0, 0}};
    MoveCommand move, next;
    move.path = PathPiece::Line({}, end);
    next.path = PathPiece::Line(end, {{100, 0, 0}});
    move.speed_fraction = next.speed_fraction = 0.1;
    next.acceleration_fraction = 0.5;
    move.fly = true;
    MotionUnderWay active;
    active.motion = Plan({move, next})[0];
    ASSERT_EQ(active.motion.path.to().point, end.tip);
    active.Begin(kBegin);
    const double length_mm = active.motion.path.length();
    EXPECT_EQ(active.PlaceAt(active.arrival), length_mm);
    EXPECT_EQ(active.PlaceAt(active.end), length_mm);
    EXPECT_LT(active.PlaceAt(active.arrival - std::chrono::microseconds(1000)), length_mm);
    EXPECT_EQ(active.told, kBegin);
  }
}

// A motion that turns the head about its tip does not move the tip, which stays where it is.
TEST(MotionUnderWay, TheTipOfATurnStands) {
  MoveCommand turn;
  turn.path = PathPiece::Line({{1, 2, 3}, 0.0, 0.0}, {{1, 2, 3}, 0.0, 1.0});
  MotionUnderWay active;
  active.motion = Plan({turn})[0];
  active.Begin(kBegin);
  const SimTime middle = kBegin + (active.arrival - kBegin) / 2;
  EXPECT_EQ(active.TipSpeedAt(middle), 0.0);
  EXPECT_EQ(active.TipAt(middle).tip, (MachineVector{1, 2, 3}));
  EXPECT_NEAR(active.AxesAt(middle).b_rad, 0.5, 1e-6);
}

TEST(PathRide, HoldKeepsTheCommandsBehindItsTarget) {
  PathRide ride(HoldRamp::kStays);
  for (const std::uint64_t tag : {1u, 2u, 4u}) {
    ride.Append({.tag = tag, .move = MoveCommand{}});
  }
  ride.Append({.tag = 5, .move = std::nullopt});
  EXPECT_NE(ride.Appended(4), nullptr);
  EXPECT_EQ(ride.Appended(5), nullptr);  // a mark
  ride.ForgetBefore(2);
  EXPECT_EQ(ride.Appended(1), nullptr);

  ride.HoldBehind(2);
  EXPECT_EQ(ride.protocol().intent(), RideIntent::kHold);
  EXPECT_NE(ride.Appended(2), nullptr);
  EXPECT_EQ(ride.Appended(4), nullptr);
  ASSERT_EQ(ride.held().size(), 2u);
  EXPECT_EQ(ride.held()[0].tag, 4u);
  EXPECT_EQ(ride.held()[1].tag, 5u);
}

// START: what a HOLD kept is planned anew, with what has changed meanwhile.
TEST(PathRide, WhatIsHeldIsChangedAndTaken) {
  PathRide ride(HoldRamp::kStays);
  for (const std::uint64_t tag : {1u, 2u, 4u}) ride.Append({.tag = tag, .move = MoveCommand{}});
  ride.HoldBehind(1);
  ride.ChangeHeld([](AppendedCommand& command) { command.move->speed_fraction = 0.25; });
  const std::deque<AppendedCommand> taken = ride.TakeHeld();
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[1].tag, 4u);
  EXPECT_EQ(taken[1].move->speed_fraction, 0.25);
  EXPECT_TRUE(ride.held().empty());
  EXPECT_EQ(ride.appended().size(), 1u);
}

TEST(PathRide, CommandsFromOneOnAreReplaced) {
  PathRide ride(HoldRamp::kStays);
  for (const std::uint64_t tag : {1u, 2u, 4u}) ride.Append({.tag = tag, .move = MoveCommand{}});
  const std::vector<AppendedCommand> others = {{.tag = 7, .move = std::nullopt},
                                               {.tag = 8, .move = std::nullopt}};
  ride.ReplaceAppended(1, others);
  std::vector<std::uint64_t> tags;
  for (const AppendedCommand& command : ride.appended()) tags.push_back(command.tag);
  EXPECT_EQ(tags, (std::vector<std::uint64_t>{1, 7, 8}));
  EXPECT_DEATH(ride.ReplaceAppended(2, others), "appended_.size");
}

// A mark is passed where it is first to come; a motion is not.
TEST(PathRide, MarksArePassedOneByOne) {
  PathRide ride(HoldRamp::kStays);
  EXPECT_EQ(ride.PassMark(), std::nullopt);
  ride.ReplaceToCome({PlannedMark{3}, StraightOn()[0], PlannedMark{5}});
  EXPECT_EQ(ride.PassMark(), 3u);
  EXPECT_EQ(ride.PassMark(), std::nullopt);
  EXPECT_EQ(ride.to_come().size(), 2u);
  ride.DropRest();
  EXPECT_FALSE(ride.busy());
}

// Half the measure: half the length. What is planned by its tip stays as it is.
TEST(PathRide, WhatIsPlannedInTheAxesIsMeasuredAnew) {
  PathRide ride(HoldRamp::kStays);
  const PlannedMotion by_tip = StraightOn()[0];
  PlannedMotion in_axes = by_tip;
  in_axes.path = PathPiece::Joint({{0, 0, 0}}, {{10, 0, 0}});
  in_axes.path.MeasureBy(4.0);
  ride.ReplaceToCome({in_axes, by_tip, in_axes});
  ride.Begin(kBegin);
  ride.MeasureInAxesBy(0.5);
  EXPECT_EQ(ride.under_way()->motion.path.length(), 2.0);
  EXPECT_EQ(std::get<PlannedMotion>(ride.to_come()[0]).path.length(), by_tip.path.length());
  EXPECT_EQ(std::get<PlannedMotion>(ride.to_come()[1]).path.length(), 2.0);
}

// Nor is what is under way by its tip.
TEST(PathRide, WhatIsUnderWayByItsTipKeepsItsMeasure) {
  PathRide ride(HoldRamp::kStays);
  const PlannedMotion by_tip = StraightOn()[0];
  ride.Plan(by_tip);
  ride.Begin(kBegin);
  ride.MeasureInAxesBy(0.5);
  ASSERT_NE(ride.under_way(), nullptr);
  const PlannedMotion& motion = ride.under_way()->motion;
  EXPECT_EQ(motion.path.length(), by_tip.path.length());
  EXPECT_EQ(motion.limits.speed, by_tip.limits.speed);
  EXPECT_EQ(motion.speed.duration_s(), by_tip.speed.duration_s());
}

TEST(PathRide, FinishLeavesNothingToRide) {
  const std::vector<PlannedMotion> motions = StraightOn();
  PathRide ride = RideOver(motions);
  ride.Append({.tag = 3, .move = MoveCommand{}});
  const SimTime now = ride.Begin(kBegin).start + FromSeconds(motions[0].speed.TimeAt(99.0));
  const AxisLimits axes = StandardMachine().axes;
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan.has_value());
  const PathRide kept = ride;  // a snapshot goes on by itself
  ride.Stop(*plan, axes);
  ride.Finish();
  EXPECT_FALSE(ride.busy());
  EXPECT_FALSE(ride.TakeUpInterrupted());
  EXPECT_TRUE(ride.protocol().goes());
  EXPECT_TRUE(kept.busy());
  EXPECT_EQ(TagsToCome(kept), "m11 2 m12 3 m13");
}

// A machine that plans its path anew has nothing to come: it fills the place, and says until when.
TEST(PathRide, BeginsInPlaceUntilTheTimeOfTheMachine) {
  PathRide ride(HoldRamp::kPlannedAnew);
  ride.place().motion = StraightOn().front();
  EXPECT_EQ(ride.under_way(), nullptr);
  ride.BeginInPlace(kBegin, kBegin + std::chrono::seconds(2));
  ASSERT_NE(ride.under_way(), nullptr);
  EXPECT_EQ(ride.under_way()->end, std::chrono::seconds(7));
  ride.Leave();
  EXPECT_FALSE(ride.busy());
  EXPECT_EQ(ride.place().motion.tag, 1u);
}

// path_ride.h: ended for good, 1 mm before the end of the first line: the ramp ends the move at no
// corner, and nothing is interrupted or held. What begins then is known to be ended, and what comes
// behind it is not.
TEST(PathRide, EndByLeavesTheRampAlone) {
  const std::vector<PlannedMotion> motions = StraightOn();
  const AxisLimits axes = StandardMachine().axes;
  PathRide ride = RideOver(motions);
  const SimTime now = ride.Begin(kBegin).start + FromSeconds(motions[0].speed.TimeAt(99.0));
  EXPECT_FALSE(ride.under_way()->ended);
  ride.HoldBack(2, {{.tag = 8, .move = MoveCommand{}}});
  ASSERT_EQ(ride.held().size(), 1u);
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan.has_value());
  ride.EndBy(*plan);
  EXPECT_EQ(ride.under_way(), nullptr);
  EXPECT_EQ(TagsToCome(ride), "1 m11 2");
  EXPECT_TRUE(ride.held().empty());
  const auto& last = std::get<PlannedMotion>(ride.to_come().back());
  EXPECT_TRUE(last.ends_move);
  EXPECT_EQ(last.corner.passage, Passage::kStop);
  EXPECT_EQ(last.corner.speed, 0.0);
  EXPECT_TRUE(ride.Begin(now).ended);
  ride.Leave();
  ride.DropRest();
  ride.Plan(motions[0]);
  EXPECT_FALSE(ride.Begin(now).ended);

  PathRide stopped = RideOver(motions);
  stopped.Begin(kBegin);
  stopped.Stop(*plan, axes);
  ASSERT_FALSE(stopped.interrupted().empty());
  stopped.EndBy(*plan);
  EXPECT_TRUE(stopped.interrupted().empty());
}

// While it settles it stands already: its move is over at once.
TEST(PathRide, EndByWhileItSettles) {
  PlannedMotion last = StraightOn().back();
  last.settling_s = 0.25;
  PathRide ride(HoldRamp::kStays);
  ride.Plan(last);
  const SimTime now = ride.Begin(kBegin).arrival + std::chrono::milliseconds(100);
  const auto plan = ride.PlanStop(now, StandardMachine().axes);
  ASSERT_TRUE(plan.has_value());
  ride.EndBy(*plan);
  ASSERT_EQ(TagsToCome(ride), "3");
  const auto& standing = std::get<PlannedMotion>(ride.to_come()[0]);
  EXPECT_TRUE(standing.ends_move);
  EXPECT_EQ(standing.duration_s(), 0.0);
  EXPECT_EQ(standing.path.length(), 0.0);
  EXPECT_EQ(standing.path.to().point, last.path.to().point);
}

}  // namespace
}  // namespace rmlcell::motion
