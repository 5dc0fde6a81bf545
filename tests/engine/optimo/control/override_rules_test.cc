#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// The feed override changed while a chain of /FLY moves is under way: motion.md 6. The corners are
// those of the reference cases C01, C02 and C04 (90 degrees): cut and distance from the corner hang
// on the speed alone, so both tell with which override a corner was planned. A ramp over a change
// of speed v takes 2 sqrt(v / j), j = 40,000 mm/s3, and the mean of both speeds.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

constexpr double kJerk = 40000.0;
constexpr double kAt50 = 1.358847515;    // C01: distance from the corner at 50 mm/s
constexpr double kAt25 = 0.480425146;    // C02, 25 mm/s
constexpr double kAt72 = 2.372590175;    // C04, 72.5 mm/s
constexpr double kLoss25 = 0.507540572;  // C02: what a corner at 25 mm/s shortens the path by
constexpr double kLoss72 = 2.506500306;  // C04

// Three legs of 300 mm from home, at 50 mm/s.
const std::string kChain =
    "COORD ABSOL\nPATH LIN\nSPEED 10\n"
    "MOVE (321.02,2201.2,-350.,0.,0.)/FLY\n"
    "MOVE (321.02,1901.2,-350.,0.,0.)/FLY\n"
    "MOVE (621.02,1901.2,-350.,0.,0.)\n";
const motion::MachineVector kFirst{321.02, 2201.2, -350.0};
const motion::MachineVector kSecond{321.02, 1901.2, -350.0};

Ran ChangedAt(double time_s, double percent, const std::string& text = kChain) {
  return RunText(text, {.inputs = {{FromSeconds(time_s), InputKind::kOverride, 0, percent}}});
}

double RampTime(double from, double to) { return 2.0 * std::sqrt(std::abs(to - from) / kJerk); }
double RampLength(double from, double to) { return 0.5 * (from + to) * RampTime(from, to); }

// Where the machine is after `time_s` of a start from rest at 50 mm/s.
double Travelled(double time_s) { return 50.0 * (time_s - 0.5 * RampTime(0.0, 50.0)); }

// The tip's place and speed never jump, whatever was told in parts.
void ExpectSmooth(const Ran& ran) {
  for (std::size_t k = 1; k < ran.parts.size(); ++k) {
    const Ran::Part& before = ran.parts[k - 1];
    const Ran::Part& here = ran.parts[k];
    const motion::PathPose from = before.motion.path.At(before.done.travelled);
    const motion::PathPose to = here.motion.path.At(here.done.from);
    EXPECT_NEAR((from.point - to.point).norm(), 0.0, 1e-6) << k;
    EXPECT_NEAR(before.SpeedAt(before.duration_s()), here.SpeedAt(0.0), 1e-3) << k;
  }
}

// OPT-4.38: lower, in the middle of the first leg. Both corners are those of 25 mm/s.
TEST(OverrideRules, LowerOverrideActsOnTheMoveUnderWayAndOnTheCorners) {
  const Ran ran = ChangedAt(3.0, 50.0);
  EXPECT_NEAR(ran.DistanceTo(kFirst), kAt25, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kSecond), kAt25, 1e-4);
  const double left =
      900.0 - 2.0 * kLoss25 - Travelled(3.0) - RampLength(50.0, 25.0) - RampLength(25.0, 0.0);
  EXPECT_NEAR(ran.time_s,
              3.0 + RampTime(50.0, 25.0) + left / 25.0 + RampTime(25.0, 0.0) + kSettle_s, 1e-4);
  ExpectSmooth(ran);
}

// OPT-4.38: higher; the corners grow into the path that is still to come.
TEST(OverrideRules, HigherOverrideActsOnTheMoveUnderWayAndOnTheCorners) {
  const Ran ran = ChangedAt(3.0, 145.0);
  EXPECT_NEAR(ran.DistanceTo(kFirst), kAt72, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kSecond), kAt72, 1e-4);
  const double left =
      900.0 - 2.0 * kLoss72 - Travelled(3.0) - RampLength(50.0, 72.5) - RampLength(72.5, 0.0);
  EXPECT_NEAR(ran.time_s,
              3.0 + RampTime(50.0, 72.5) + left / 72.5 + RampTime(72.5, 0.0) + kSettle_s, 1e-4);
  ExpectSmooth(ran);
}

// motion.md 6: a bend in progress keeps its shape and speed, the next one is planned anew. The
// first bend is 4.05 mm before and behind 300 mm.
TEST(OverrideRules, ABendInProgressKeepsItsShape) {
  const double in_the_bend = 299.0 / 50.0 + 0.5 * RampTime(0.0, 50.0);
  const Ran ran = ChangedAt(in_the_bend, 50.0);
  EXPECT_NEAR(ran.DistanceTo(kFirst), kAt50, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kSecond), kAt25, 1e-4);
  ExpectSmooth(ran);
}

// One that is nearer than the way to slow down keeps its shape too: 0.5 mm before the bend.
TEST(OverrideRules, ABendTooNearKeepsItsShape) {
  const double before_the_bend = 295.4 / 50.0 + 0.5 * RampTime(0.0, 50.0);
  const Ran ran = ChangedAt(before_the_bend, 10.0);
  EXPECT_NEAR(ran.DistanceTo(kFirst), kAt50, 1e-4);
  EXPECT_LT(ran.DistanceTo(kSecond), kAt25);
  ExpectSmooth(ran);
}

// Property 12 of motion.md 10: 100 -> x -> 100 with no time between changes nothing.
TEST(OverrideRules, ThereAndBackAtOnceChangesNothing) {
  const Ran plain = RunText(kChain);
  for (const double at_s : {0.03, 3.0}) {  // speeding up, and at full speed
    const SimTime at = FromSeconds(at_s);
    const Ran ran = RunText(kChain, {.inputs = {{at, InputKind::kOverride, 0, 40.0},
                                                {at, InputKind::kOverride, 0, 100.0}}});
    EXPECT_NEAR(ran.time_s, plain.time_s, 1e-9);
    EXPECT_NEAR(ran.DistanceTo(kFirst), plain.DistanceTo(kFirst), 1e-9);
  }
}

// A contour has a feed rate, which goes with the override; axes by themselves have none.
TEST(OverrideRules, TheFeedRateThatIsTold) {
  const auto feeds = [](const std::string& start, const std::string& z) {
    const std::string end = "," + z + ",0.,0.)";
    std::vector<double> told;
    for (const machine::MoveDone& move :
         ChangedAt(1.0, 50.0,
                   start + "SPEED 10\nMOVE (321.02,2201.2" + end + "/FLY\nMOVE (321.02,1901.2" +
                       end + "/FLY\nMOVE (621.02,1901.2" + end + "\n")
             .moves)
      told.push_back(move.feed_mm_s);
    return told;
  };
  EXPECT_EQ(feeds("COORD ABSOL\nPATH LIN\n", "-350."), (std::vector{25.0, 25.0, 25.0}));
  EXPECT_EQ(feeds("COORD ROBOT\n", "-50."), (std::vector{0.0, 0.0, 0.0}));
}

// An override of nothing is none: the machine would stand for ever.
TEST(OverrideRules, NoOverrideIsZero) {
  EXPECT_EQ(ChangedAt(3.0, 0.0).time_s, RunText(kChain).time_s);
  EXPECT_EQ(ChangedAt(3.0, 0.0).end.override_percent, 100.0);
}

// motion.md 6: set while the machine stands on its way after a STOP, it counts for the rest of the
// move under way and for all that was planned behind it. 1000 mm at 50 mm/s, stopped after a good
// 4 s; 10 % of that for the rest, in a chain and by itself, on contours and in COORD ROBOT.
TEST(OverrideRules, ChangedDuringAStop) {
  const std::string contour = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
  for (const auto& [start, z] :
       {std::pair{contour, "-350."}, std::pair{std::string("COORD ROBOT\nSPEED 10\n"), "-50."}}) {
    for (const std::string fly : {"", "/FLY"}) {
      const std::string text = start + "MOVE (1021.02,2201.2," + z + ",0.,0.)" + fly +
                               "\nMOVE (1021.02,1701.2," + z + ",0.,0.)\n";
      const Ran ran = RunText(text, {.inputs = {{FromSeconds(4.0), InputKind::kStop, 0, 1.0},
                                                {FromSeconds(5.0), InputKind::kOverride, 0, 10.0},
                                                {FromSeconds(6.0), InputKind::kStart, 0, 1.0}}});
      ASSERT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted) << text;
      // About 1300 mm are left, at 5 mm/s.
      EXPECT_NEAR(ran.time_s, 6.0 + 1300.0 / 5.0, 3.0) << text;
    }
  }
}

// At any time, on long and on very short moves: nothing jumps, every program ends at its last
// target.
TEST(OverrideRules, AnyChangeAtAnyTimeIsSmooth) {
  std::string wave = "COORD ABSOL\nPATH LIN\nSPEED 20\n";
  for (int k = 1; k <= 60; ++k) {
    const double x = 21.02 + 3.0 * k;
    const double y = 2201.2 + 8.0 * std::sin(0.35 * k);
    wave += "MOVE (" + std::to_string(x) + "," + std::to_string(y) + ",-350.,0.,0.)" +
            (k < 60 ? "/FLY\n" : "\n");
  }
  for (const std::string& text : {kChain, wave}) {
    const Ran plain = RunText(text);
    for (int k = 0; k < 60; ++k) {
      const double first = plain.time_s * (k + 0.5) / 60.0;
      const double percent = 10.0 + 15.0 * (k % 10);
      const Ran ran = RunText(
          text,
          {.inputs = {{FromSeconds(first), InputKind::kOverride, 0, percent},
                      {FromSeconds(first + 0.07), InputKind::kOverride, 0, 145.0 - percent}}});
      SCOPED_TRACE(first);
      EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
      EXPECT_NEAR((ran.end.tip.tip - plain.end.tip.tip).norm(), 0.0, 1e-6);
      ExpectSmooth(ran);
    }
  }
}

// From (1000,1000,-400) on along a circle of 50 mm to the right, or straight on.
std::string ShortMoves(int count, double length_mm, bool straight) {
  std::string text = kThere;
  for (int k = 1; k <= count; ++k) {
    const double way = length_mm * k;
    const double x = straight ? way : 50.0 * std::sin(way / 50.0);
    const double y = straight ? 0.0 : 50.0 - 50.0 * std::cos(way / 50.0);
    text += "MOVE (" + std::to_string(1000.0 + x) + "," + std::to_string(1000.0 + y) +
            ",-400.,0.,0.)" + (k < count ? "/FLY\n" : "\n");
  }
  return text;
}
double BeginOfSecondMove(const std::string& text) {
  return ToSeconds(RunText(text).moves.front().at);
}
// When it moves slower than that for good, s after `from`.
double SlowFrom(const Ran& ran, double speed, double from) {
  double at = from;
  for (const Ran::Part& part : ran.parts) {
    for (int k = 0; k <= 20; ++k) {
      const double t = part.duration_s() * k / 20;
      if (part.SpeedAt(t) > speed * (1.0 + 1e-6)) at = ToSeconds(part.done.start) + t;
    }
  }
  return at - from;
}

// motion.md 6, OPT-4.38: the ramp of 1.875 mm is longer than any of the moves, and runs over them.
TEST(OverrideRules, LowerOverrideActsInAChainOfShortMoves) {
  const std::string text = ShortMoves(120, 0.55, true);
  const double begin = BeginOfSecondMove(text);
  const Ran ran = ChangedAt(begin + 0.3, 50.0, text);
  const double left = 120 * 0.55 - Travelled(0.3) - RampLength(50.0, 25.0) - RampLength(25.0, 0.0);
  EXPECT_NEAR(ran.time_s,
              begin + 0.3 + RampTime(50.0, 25.0) + left / 25.0 + RampTime(25.0, 0.0) + kSettle_s,
              1e-4);
  ExpectSmooth(ran);
  EXPECT_EQ(ran.moves.size(), 121U);
}

// The same where a circle is made of them: no jump, and the lower speed as soon as the ramp is over
// but for the rest of a move, with the path as near as it was.
TEST(OverrideRules, LowerOverrideActsWhereShortMovesTurn) {
  for (const double length : {0.3, 0.55, 1.2}) {
    const std::string text = ShortMoves(static_cast<int>(60.0 / length), length, false);
    const double change = BeginOfSecondMove(text) + 0.4;
    const Ran ran = ChangedAt(change, 50.0, text);
    SCOPED_TRACE(length);
    EXPECT_EQ(ran.moves.size(), 1U + static_cast<std::size_t>(60.0 / length));
    EXPECT_LE(SlowFrom(ran, 25.0, change), RampTime(50.0, 25.0) + 2.0 * length / 25.0);
    ExpectSmooth(ran);
    for (const Ran::Part& part : ran.parts) {
      if (part.done.start < ran.moves.front().at) continue;
      const motion::MachinePoint tip = part.motion.path.At(part.done.travelled).point;
      EXPECT_NEAR(std::hypot(tip.x() - 1000.0, tip.y() - 1050.0), 50.0, 0.01);
    }
  }
}

// The program is still being read then, and the ramp runs over 60 moves; down and up
// again and down.
TEST(OverrideRules, OverridesActInLongChainsOfShortMoves) {
  std::string text = ShortMoves(900, 0.24, true);
  text.insert(text.find("SPEED 10"), "SPEED 40\n");
  text.erase(text.find("SPEED 10"), std::string("SPEED 10\n").size());
  const double begin = BeginOfSecondMove(text);
  const Ran ran = RunText(text, {.inputs = {{At(begin + 0.25), InputKind::kOverride, 0, 50.0},
                                            {At(begin + 0.5), InputKind::kOverride, 0, 100.0},
                                            {At(begin + 0.75), InputKind::kOverride, 0, 25.0}}});
  ExpectSmooth(ran);
  EXPECT_EQ(ran.moves.size(), 901U);
  EXPECT_LE(SlowFrom(ran, 50.0, begin + 0.75), 0.2);
  const auto speed_at = [&](double time_s) {
    for (const Ran::Part& part : ran.parts)
      if (At(time_s) >= part.done.start && At(time_s) < part.done.end)
        return part.SpeedAt(time_s - ToSeconds(part.done.start));
    return 0.0;
  };
  EXPECT_NEAR(speed_at(begin + 0.24), 200.0, 1e-6);
  EXPECT_NEAR(speed_at(begin + 0.49), 100.0, 1e-6);
  EXPECT_NEAR(speed_at(begin + 0.74), 200.0, 1e-6);
}

// OPT-4.38: SPEED 100 at 120 % and at 110 % are both the full speed. On the 75 mm that it takes to
// get there, over moves too short to end the acceleration on one of them, nothing slows down.
TEST(OverrideRules, AnOverrideThatStaysTooHighChangesNothing) {
  std::string text = ShortMoves(300, 1.0, true);
  const std::string slow = "SPEED 10\n";
  text.replace(text.find(slow), slow.size(), "SPEED 100\n");
  const Ran plain = RunText(text, {.override_percent = 120.0});
  ASSERT_EQ(plain.moves.size(), 301U);
  const double begin = ToSeconds(plain.moves.front().at);
  for (const double change : {0.08, 0.12, 0.16, 0.2}) {
    const Ran ran = RunText(text, {.inputs = {{At(begin + change), InputKind::kOverride, 0, 110.0}},
                                   .override_percent = 120.0});
    EXPECT_EQ(ran.end.override_percent, 110.0);
    EXPECT_EQ(ran.moves.size(), plain.moves.size()) << change;
    EXPECT_NEAR(ran.time_s, plain.time_s, 1e-6) << change;
  }
}

// The corners to come ask for less than the new speed, with half of the overshoot.
TEST(OverrideRules, LowerOverrideActsWhereCornersAskForLess) {
  for (const double aside : {0.2, 0.5}) {
    std::string text = kThere + "OVERSH 50\n";
    for (int k = 1; k <= 80; ++k)
      text += "MOVE (" + std::to_string(1000.0 + 1.2 * k) + "," +
              std::to_string(1000.0 + (k % 2 == 1 ? aside : 0.0)) + ",-400.,0.,0.)" +
              (k < 80 ? "/FLY\n" : "\n");
    const double change = BeginOfSecondMove(text) + 0.5;
    const Ran ran = ChangedAt(change, 50.0, text);
    SCOPED_TRACE(aside);
    EXPECT_EQ(ran.moves.size(), 81U);
    EXPECT_LE(SlowFrom(ran, 25.0, change), 0.3);
    ExpectSmooth(ran);
  }
}

// OPT-4.18, OPT-4.38: lowered while a STOP halts a contour of short moves; START is heard with it.
TEST(OverrideRules, ALowerOverrideWhileAContourIsHalted) {
  const std::string text = ShortMoves(110, 0.55, false);
  const double begin = BeginOfSecondMove(text);
  for (const double stop : {0.2, 0.305, 0.41, 0.6}) {
    const Ran ran = RunText(text, {.inputs = {{At(begin + stop), InputKind::kStop},
                                              {At(begin + 2.0), InputKind::kOverride, 0, 50.0},
                                              {At(begin + 3.0), InputKind::kStart}}});
    SCOPED_TRACE(stop);
    EXPECT_EQ(ran.moves.size(), 111U);
    EXPECT_LE(SlowFrom(ran, 25.0, begin + 3.0), 0.3);
    ExpectSmooth(ran);
  }
}

// What stands between the moves comes in order and at its place, also where the ramp runs over it;
// a STOP on the ramp halts on the path, and START rides the rest of it.
TEST(OverrideRules, ALowerOverrideKeepsWhatStandsBetweenShortMoves) {
  std::string text = kThere;
  for (int k = 1; k <= 60; ++k)
    text += "MOVE (" + std::to_string(1000.0 + 0.5 * k) + ",1000.,-400.,0.,0.)" +
            (k < 60 ? "/FLY\nOL[11]=" + std::string(k % 2 == 1 ? "ON" : "OFF") + "\n" : "\n");
  const Ran plain = RunText(text);
  const double change = ToSeconds(plain.moves.front().at) + 0.2;
  for (const double stop : {0.0, 0.01, 0.03, 0.06}) {
    machine::InputScript inputs{{At(change), InputKind::kOverride, 0, 50.0}};
    if (stop > 0.0) {
      inputs.push_back({At(change + stop), InputKind::kStop});
      inputs.push_back({At(change + 5.0), InputKind::kStart});
    }
    const Ran ran = RunText(text, {.inputs = inputs});
    SCOPED_TRACE(stop);
    EXPECT_EQ(ran.Count("OL[11] 1"), plain.Count("OL[11] 1"));
    EXPECT_EQ(ran.Count("OL[11] 0"), plain.Count("OL[11] 0"));
    EXPECT_EQ(ran.moves.size(), plain.moves.size());
    ExpectSmooth(ran);
    double way = 0.0;
    for (const Ran::Part& part : ran.parts) way += part.done.travelled - part.done.from;
    double plain_way = 0.0;
    for (const Ran::Part& part : plain.parts) plain_way += part.done.travelled - part.done.from;
    EXPECT_NEAR(way, plain_way, 1e-6);
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing
