// What is left of a run between two curves whose ends are ends of moves, and
// how long a run may be. motion.md 4.3, 5.5
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/motion/planner/motion_chain.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::span_places {
namespace {

using testing::HasSubstr;

struct Line {
  MachineVector way;
  double speed_fraction;
};

std::vector<MoveCommand> ChainOf(const std::vector<Line>& lines) {
  std::vector<MoveCommand> chain;
  MachinePoint at;
  for (const Line& line : lines) {
    MoveCommand move;
    move.path = PathPiece::Line({at}, {at + line.way});
    move.speed_fraction = line.speed_fraction;
    move.fly = chain.size() + 1 < lines.size();
    move.tag = chain.size();
    chain.push_back(move);
    at = at + line.way;
  }
  return chain;
}

std::string DumpOf(const std::vector<Line>& lines) {
  MotionChain chain(PlainMachine(), Planner::kWindow);
  for (const MoveCommand& move : ChainOf(lines)) chain.Append(move, chain.LimitsFor(move), true);
  return chain.Dump();
}

// Every motion is some way, and its profile goes that way; each begins where
// and as fast as the one before it ends.
void ExpectSeams(const std::vector<PlannedMotion>& motions) {
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const PlannedMotion& motion = motions[k];
    EXPECT_GT(motion.path.length(), 0.0) << k;
    EXPECT_NEAR(motion.speed.end().s, motion.path.length(), 1e-9) << k;
    const double before = k == 0 ? 0.0 : motions[k - 1].speed.end().speed;
    EXPECT_NEAR(motion.speed.At(0.0).speed, before, 1e-6) << k;
    if (k == 0) continue;
    EXPECT_LT((motion.path.from().point - motions[k - 1].path.to().point).norm(), 1e-9) << k;
  }
}

const MachineVector kEast{1.0, 0.0, 0.0};
const MachineVector kNorth{0.0, 1.0, 0.0};

// A curve that takes half of the run behind it, to the end of its first move:
// what is left begins with the second one, be they one leg or two.
TEST(SpanPlaces, ACurveThatEndsAtTheEndOfAMove) {
  for (const double second : {0.4, 0.5}) {
    const std::vector<Line> lines{{kEast * 10.0, 1.0}, {kNorth, 0.4}, {kNorth, second}};
    const std::string dump = DumpOf(lines);
    EXPECT_THAT(dump, HasSubstr("span 0: moves 0 from 0.000 to 0 at 9.000, length 9.000, BLEND"));
    EXPECT_THAT(dump, HasSubstr("span 1: moves 2 from 0.000 to 2 at 1.000, length 1.000, STOP"));
    ExpectSeams(Plan(ChainOf(lines), PlainMachine()));
  }
}

// And of the run before it, from the end of its first move on.
TEST(SpanPlaces, ACurveThatBeginsAtTheEndOfAMove) {
  for (const double second : {0.4, 0.5}) {
    const std::vector<Line> lines{{kEast, 0.4}, {kEast, second}, {kNorth * 10.0, 1.0}};
    const std::string dump = DumpOf(lines);
    EXPECT_THAT(dump, HasSubstr("span 0: moves 0 from 0.000 to 0 at 1.000, length 1.000, BLEND"));
    EXPECT_THAT(dump, HasSubstr("span 1: moves 2 from 1.000 to 2 at 10.000, length 9.000, STOP"));
    ExpectSeams(Plan(ChainOf(lines), PlainMachine()));
  }
}

// Two curves that meet there leave nothing between them.
TEST(SpanPlaces, CurvesThatMeetAtTheEndOfAMove) {
  const std::vector<Line> lines{
      {kEast * 10.0, 1.0}, {kNorth, 0.5}, {kNorth, 0.4}, {kEast * 10.0, 1.0}};
  const std::string dump = DumpOf(lines);
  EXPECT_THAT(dump, HasSubstr("span 1: moves 1 from 1.000 to 1 at 1.000, length 0.000, BLEND"));
  EXPECT_THAT(dump, HasSubstr("span 2: moves 3 from 1.000 to 3 at 10.000, length 9.000, STOP"));
  ExpectSeams(Plan(ChainOf(lines), PlainMachine()));
}

// However the lengths of moves add up to the last digit, a leg ends with its
// last move.
TEST(SpanPlaces, ALegEndsWithItsLastMove) {
  Dice dice(61);
  int less = 0;
  for (int round = 0; round < 100; ++round) {
    const MachineVector along = dice.Direction();
    const std::vector<Line> lines{{along * dice.Uniform(0.1, 1.0), 0.9},
                                  {along * dice.Uniform(0.1, 1.0), 0.8},
                                  {along * dice.Uniform(0.1, 1.0), 0.8}};
    const std::vector<MoveCommand> chain = ChainOf(lines);
    const double a = chain[0].path.length(), b = chain[1].path.length(), c = chain[2].path.length();
    if ((a + b) + c < a + (b + c)) ++less;
    EXPECT_THAT(DumpOf(lines), HasSubstr("span 1: moves 1 from 0.000 to 2 at "));
  }
  EXPECT_GT(less, 5);
}

// What comes behind a corner is not known while its line may still grow: the
// corner waits.
TEST(SpanPlaces, ACornerWaitsForTheEndOfWhatIsBehindIt) {
  MotionChain chain(PlainMachine(), Planner::kWindow);
  std::vector<MoveCommand> moves = ChainOf({{kEast * 10.0, 1.0}, {kNorth, 0.4}, {kNorth, 0.4}});
  moves.back().fly = true;
  for (const MoveCommand& move : moves) chain.Append(move, chain.LimitsFor(move), true);
  EXPECT_THAT(chain.Dump(), testing::Not(HasSubstr("span")));
  chain.Stop();
  EXPECT_THAT(chain.Dump(), HasSubstr("span 1: moves 2 from 0.000 to 2 at 1.000"));
}

// But where more is known to be behind it than its curve may take half of, it does not wait for
// the end of that: of 800 mm of lines at 90 mm/s and more here.
TEST(SpanPlaces, ACornerWaitsForNoMoreThanItTakes) {
  SpanStage spans(PlainMachine(), Planner::kWindow);
  LegStage& legs = spans.leg_stage();
  std::vector<Line> lines{{kEast * 60.0, 1.0}};
  for (int k = 0; k < 40; ++k) lines.push_back({kNorth * 20.0, k % 2 == 0 ? 0.9 : 1.0});
  std::vector<MoveCommand> moves = ChainOf(lines);
  moves.back().fly = true;
  for (const MoveCommand& move : moves) legs.Add(move, legs.LimitsFor(move), true);
  legs.Settle();
  ASSERT_TRUE(spans.Resolve(false));
  EXPECT_THAT(spans.Dump(), HasSubstr("span 0: moves 0 from 0.000 to 0 at "));
}

// A run holds half a window of legs, and the one that it ends with; where the
// curve before it takes more of them, as many as that takes, 33 here of the 66
// behind it.
TEST(SpanPlaces, ARunHoldsHalfAWindowOfLegs) {
  for (const bool curve : {false, true}) {
    SpanStage spans(PlainMachine(), 64);
    LegStage& legs = spans.leg_stage();
    std::vector<Line> lines;
    if (curve) lines.push_back({kEast * 30.0, 1.0});
    const int count = curve ? 66 : 80;
    for (int k = 0; k < count; ++k) lines.push_back({kNorth * 0.125, k % 2 == 0 ? 0.9 : 1.0});
    for (const MoveCommand& move : ChainOf(lines)) legs.Add(move, legs.LimitsFor(move), true);
    legs.Settle();
    if (curve) {
      ASSERT_TRUE(spans.Resolve(false));
    }
    for (int leg = 0; leg < 40; ++leg) {
      EXPECT_EQ(spans.starved(), leg <= 32 ? 0U : 1U) << leg << curve;
      ASSERT_TRUE(spans.Resolve(false));
    }
  }
}

// On a curve acceleration and jerk are the least of all moves that it touches, on either side, and
// those of a move that it does not reach are none of its. motion.md 5.4
TEST(SpanPlaces, ACurveKeepsTheLimitsOfAllThatItTouches) {
  for (const std::size_t weak : {std::size_t{0}, std::size_t{3}}) {
    LegStage legs(PlainMachine(), Planner::kWindow);
    const std::vector<MoveCommand> chain =
        ChainOf({{kEast * 2.0, 1.0}, {kEast, 1.0}, {kNorth, 1.0}, {kNorth * 2.0, 1.0}});
    for (std::size_t k = 0; k < chain.size(); ++k) {
      const bool weaker = k == weak;
      legs.Add(
          chain[k],
          {.speed = 50.0, .acceleration = weaker ? 100.0 : 400.0, .jerk = weaker ? 3000.0 : 5000.0},
          true);
    }
    for (const double within : {0.9, 1.0}) {  // also where it ends at the end of a move
      const PathLimits near = LimitsOnCurve(legs, 1, within);
      EXPECT_EQ(near.acceleration, 400.0) << weak << within;
      EXPECT_EQ(near.jerk, 5000.0) << weak << within;
    }
    const PathLimits far = LimitsOnCurve(legs, 1, 1.1);
    EXPECT_EQ(far.acceleration, 100.0) << weak;
    EXPECT_EQ(far.jerk, 3000.0) << weak;
  }
}

// At 47.5 mm/s, 0.95 of what it may be passed at, a curve that takes all that an axis has takes
// 0.9025 of it. Of 500 mm/s2 the rest is left for a speed that changes, of the jerk all; and at 50
// mm/s an axis of 100 mm/s moves 2 mm at most for each mm of the way. motion.md 5.4
TEST(SpanPlaces, ASpeedThatChangesLeavesAnAxisItsBend) {
  for (int axis = 0; axis < 5; ++axis) {
    MachineLimits machine = PlainMachine();
    machine.axes.speed.fill(100.0);
    machine.axes.acceleration[axis] = 500.0;
    machine.axes.jerk[axis] = 8000.0;
    LegStage legs(machine, Planner::kWindow);
    for (const MoveCommand& move : ChainOf({{kEast, 1.0}, {kNorth, 1.0}}))
      legs.Add(move, {.speed = 100.0, .acceleration = 400.0, .jerk = 5000.0}, true);
    Span span;
    span.corner_move = 0;
    span.report.cut_mm = 0.5;
    span.stretches.open = 47.5;
    const PathLimits limits = LimitsInStretches(legs, span);
    EXPECT_EQ(limits.speed, 47.5) << axis;
    EXPECT_NEAR(limits.acceleration, 0.0975 * 500.0 * (50.0 / 100.0), 1e-9) << axis;
    EXPECT_NEAR(limits.jerk, 8000.0 * (50.0 / 100.0), 1e-9) << axis;
    span.may_vary = true;  // the axes follow whatever the tip does
    EXPECT_EQ(LimitsInStretches(legs, span).acceleration, 400.0) << axis;
    EXPECT_EQ(LimitsInStretches(legs, span).jerk, 5000.0) << axis;
  }
}

// A point that lies 5e-11 mm behind the end of a curve is its end: nothing is left of its move.
TEST(SpanPlaces, APointJustBehindACurveIsItsEnd) {
  for (const double beside_mm : {-5e-11, 0.0, 5e-11}) {
    const double half = 1.0 - beside_mm;
    const std::vector<Line> lines{
        {kEast * 10.0, 1.0}, {kNorth, 0.5}, {kNorth * (2.0 * half - 1.0), 0.4}};
    const std::vector<PlannedMotion> motions = Plan(ChainOf(lines));
    ExpectSeams(motions);
    for (const PlannedMotion& motion : motions) EXPECT_GT(motion.path.length(), 1e-6) << beside_mm;
  }
}

// One that lies 1e-8 mm behind it is none: that much of its move is left, and nothing is missing
// between the curve and the next move.
TEST(SpanPlaces, APointBehindACurveByMoreThanRoundingIsNotItsEnd) {
  constexpr double kBehind_mm = 1e-8;
  const std::vector<Line> lines{
      {kEast * 10.0, 1.0}, {kNorth, 0.5}, {kNorth * (1.0 - 2.0 * kBehind_mm), 0.4}};
  const std::vector<PlannedMotion> motions = Plan(ChainOf(lines));
  ExpectSeams(motions);
  double left = 0.0;
  for (const PlannedMotion& motion : motions) {
    if (motion.tag == 1 && motion.path.kind() != PathPiece::Kind::kBlend)
      left += motion.path.length();
  }
  EXPECT_NEAR(left, kBehind_mm, 1e-12);
}

// A curve of 2.749 mm on both sides, with a point 0.4 mm from the corner on each: its parts belong
// to the moves as mirror images.
TEST(SpanPlaces, PartsOfACurveBelongToTheirMoves) {
  const std::vector<Line> lines{
      {kEast * 9.6, 0.4}, {kEast * 0.4, 0.4}, {kNorth * 0.4, 0.4}, {kNorth * 9.6, 0.4}};
  std::vector<double> parts;
  std::vector<std::uint64_t> tags;
  const std::vector<PlannedMotion> motions = Plan(ChainOf(lines), PlainMachine());
  ExpectSeams(motions);
  for (const PlannedMotion& motion : motions) {
    if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
    parts.push_back(motion.path.length());
    tags.push_back(motion.tag);
  }
  ASSERT_EQ(tags, (std::vector<std::uint64_t>{0, 1, 2, 3}));
  const double half = parts[0] + parts[1];
  EXPECT_NEAR(parts[1], half * 0.4 / 2.749, 1e-4);
  EXPECT_NEAR(parts[2], parts[1], 1e-9);
  EXPECT_NEAR(parts[3], parts[0], 1e-9);
}

// A point that asks for 4 mm/s and lies within a curve keeps it: all of the curve is as slow.
// motion.md 5.3
TEST(SpanPlaces, ASlowPointWithinACurveIsKept) {
  for (const double jerk : {HUGE_VAL, 40000.0, 40001.0}) {
    for (const bool before : {true, false}) {
      for (const double around : {0.9, 10.0}) {  // so short that the curve is capped, and not
        MachineLimits machine = PlainMachine();
        machine.tip_jerk_mm_s3 = jerk;
        machine.ramps_across_passages = jerk != 40001.0;  // of level 1, too
        const Line plain{before ? kNorth * around : kEast * around, 1.0};
        const Line near_corner{before ? kEast * 0.1 : kNorth * 0.1, 0.4};
        const Line other{before ? kEast * around : kNorth * around, 0.4};
        std::vector<MoveCommand> chain =
            before ? ChainOf({other, near_corner, plain}) : ChainOf({plain, near_corner, other});
        chain[before ? 0 : 1].overshoot_fraction = 0.1;
        int bends = 0;
        for (const PlannedMotion& motion : Plan(chain, machine)) {
          if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
          ++bends;
          EXPECT_LE(motion.speed.peak_speed(), 4.0 * (1.0 + 1e-9)) << before << around << jerk;
        }
        EXPECT_GT(bends, 1);
      }
    }
  }
}

// And so is one at the very end of a curve, which takes half of the 2 mm behind the corner.
TEST(SpanPlaces, ASlowPointAtTheEndOfACurveIsKept) {
  std::vector<MoveCommand> chain = ChainOf({{kEast * 10.0, 1.0}, {kNorth, 0.4}, {kNorth, 0.4}});
  chain[1].overshoot_fraction = 0.1;
  int bends = 0;
  double end = 0.0;
  for (const PlannedMotion& motion : Plan(chain, PlainMachine())) {
    if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
    ++bends;
    end = motion.path.to().point.y();
    EXPECT_LE(motion.speed.peak_speed(), 4.0 * (1.0 + 1e-9));
  }
  EXPECT_GT(bends, 1);
  EXPECT_NEAR(end, 1.0, 1e-9);
}

// Two moves that are one leg have each its own part of the ramps, however short the first one is.
TEST(SpanPlaces, EachMoveOfALegHasItsPart) {
  for (const double first : {0.5, 1.0, 2.0}) {
    const std::vector<PlannedMotion> motions =
        Plan(ChainOf({{kEast * first, 0.4}, {kEast * 9.0, 0.4}}), PlainMachine());
    ASSERT_EQ(motions.size(), 2U) << first;
    ExpectSeams(motions);
  }
}

// Speeds that differ by one part in 1e8 are two, those that differ by last digits one.
TEST(SpanPlaces, LastDigitsMakeNoLeg) {
  const auto dump_of = [](double more) {
    return DumpOf({{kEast, 0.4}, {kEast, 0.4 * (1.0 + more)}});
  };
  EXPECT_THAT(dump_of(1e-8), HasSubstr("span 1"));
  EXPECT_THAT(dump_of(1e-10), HasSubstr("span 0"));
  EXPECT_THAT(dump_of(1e-10), testing::Not(HasSubstr("span 1")));
}

}  // namespace
}  // namespace rmlcell::motion::span_places
