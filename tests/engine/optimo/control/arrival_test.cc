#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "tests/engine/optimo/control/measured.h"
#include "tests/engine/optimo/control/run_text.h"

// What happens at the very instant when a motion ends, and what ends motions before their end.
namespace rmlcell::optimo::testing::arrival {
namespace {

using machine::InputKind;

machine::InputChange Key(SimTime at, InputKind kind) { return {at, kind}; }

std::string Move(double x_mm, double y_mm, const std::string& attributes = "") {
  return "MOVE (" + std::to_string(x_mm) + "," + std::to_string(y_mm) + ",-400.,0.,0.)" +
         attributes + "\n";
}

// Steps 1 to 4, which bring the tip to (100,1000); at 5 mm/s per percent from there on.
std::string From100(int speed_percent) {
  return "COORD ABSOL\nPATH LIN\nSPEED " + std::to_string(speed_percent) + "\n" + Move(100, 1000);
}

// The move to a point ends there, or the point lies on a bend: whichever is nearer.
void ExpectAt(const Ran& ran, const std::string& what, double x_mm, double y_mm) {
  ASSERT_TRUE(ran.Told(what)) << what;
  const double at_s = ran.First(what).at_s;
  for (const Ran::Part& part : ran.parts) {
    const double start = ToSeconds(part.done.start);
    if (at_s < start - 1e-9 || at_s > start + part.duration_s() + 1e-9) continue;
    const double t_s = std::clamp(at_s - start, 0.0, part.motion.speed.duration_s());
    const auto tip = part.motion.path.TipAt(part.motion.speed.At(t_s).s).tip;
    if (std::hypot(tip.x() - x_mm, tip.y() - y_mm) < 1e-3) return;
  }
  ADD_FAILURE() << what << " was not told at " << x_mm << ", " << y_mm;
}

// OPT-2.49, motion.md 8.2: a bend that takes half of two lines of one length ends at the point
// between them, where an output and the beam change; the move to it is told there, too.
TEST(Arrival, ABendEndsAtAPoint) {
  for (const double length : {10.0, 2.0, 0.7, 1.0 / 3.0}) {
    SCOPED_TRACE(length);
    const std::string text = "WORKDEF 1,1 (50.,50.,0.,50.)\n" + From100(100) + "WORK 1,1/ON\n" +
                             Move(120, 1000, "/FLY") + Move(120, 1000 + length, "/FLY") +
                             "OL[12]=ON\nWORK 1,1/OFF\n" + Move(120, 1000 + 2 * length);
    const Ran ran = RunText(text);
    ASSERT_EQ(ran.moves.size(), 4U);
    EXPECT_NEAR(ran.moves[2].tip.tip.y(), 1000 + length, 1e-3);
    ExpectAt(ran, "OL[12] 1", 120, 1000 + length);
    ExpectAt(ran, "beam off", 120, 1000 + length);
  }
}

// The same where two bends meet at the point, and behind a circle and in the axes.
TEST(Arrival, BendsMeetAtAPoint) {
  const Ran lines = RunText(From100(50) + Move(120, 1000, "/FLY") + Move(120, 1010, "/FLY") +
                            "OL[12]=ON\n" + Move(120, 1020, "/FLY") + Move(170, 1020));
  EXPECT_EQ(lines.moves.size(), 5U);
  ExpectAt(lines, "OL[12] 1", 120, 1010);
  const Ran circle = RunText(From100(100) +
                             "PATH CIR\nMOVE (110.,1010.,-400.,0.,0.)/VIA "
                             "(108.,1004.,-400.,0.,0.)/FLY\nPATH LIN\n" +
                             Move(112, 1010, "/FLY") + "OL[12]=ON\n" + Move(114, 1010));
  EXPECT_EQ(circle.moves.size(), 4U);
  ExpectAt(circle, "OL[12] 1", 112, 1010);
}

// motion.md 6: a MOVE that takes over from one of /NEXT, and /TIME, in the second half of a bend:
// the machine brakes as it can, over as many motions as that takes.
TEST(Arrival, EndsOnABend) {
  const std::string bend = From100(100) + Move(110, 1000, "/FLY");
  const std::string after = Move(120, 1010, "/NEXT");
  const Ran ran = RunText(bend + after + Move(120, 1012));
  ASSERT_EQ(ran.moves.size(), 4U);
  ExpectWithinLimits(ran, true, "take-over on a bend");
  EXPECT_NEAR(ran.moves.back().tip.tip.y(), 1012, 1e-4);
}

TEST(Arrival, TimeRunsOutOnABend) {
  const std::string text = From100(100) + Move(110, 1000, "/FLY") +
                           "MOVE (140.,1030.,-400.,0.,0.)/TIME (0.01,7)\nENDTASK\n7 " +
                           Move(120, 1012);
  const Ran ran = RunText(text);
  ExpectWithinLimits(ran, true, "/TIME on a bend");
  EXPECT_NEAR(ran.moves.back().tip.tip.y(), 1012, 1e-4);
}

// OPT-4.18, motion.md 9: STOP in the instant of the arrival, and the nanoseconds before it, where
// no way is left: the move is told all the same, and the warning of its corner.
TEST(Arrival, StopAtTheArrival) {
  const std::string text = From100(100) + Move(120, 1000, "/FLY") + "OL[12]=ON\n" + Move(110, 1000);
  const Ran whole = RunText(text);
  ASSERT_EQ(whole.moves.size(), 3U);
  const SimTime arrival = whole.moves[1].at;
  for (const int before_ns : {0, 1, 40, 200}) {
    SCOPED_TRACE(before_ns);
    const Ran ran = RunText(text, {.inputs = {Key(arrival - SimTime(before_ns), InputKind::kStop),
                                              Key(arrival + At(3.0), InputKind::kStart)}});
    EXPECT_EQ(ran.moves.size(), 3U);
    EXPECT_EQ(ran.Count("OL[12] 1"), 1);
    EXPECT_EQ(ran.Count("halt STOP"), 1);
    EXPECT_EQ(ran.Finding(7316).step, whole.Finding(7316).step);
    EXPECT_NEAR(ran.moves.back().tip.tip.x(), 110, 1e-4);
  }
}

// OPT-4.18: the same while it settles: the move is over once.
TEST(Arrival, StopWhileItSettles) {
  const std::string text = From100(10) + Move(130, 1000);
  const SimTime over = RunText(text).moves.back().at;
  const Ran ran = RunText(
      text,
      {.inputs = {Key(over - At(0.03), InputKind::kStop), Key(over + At(1.0), InputKind::kStart),
                  Key(over + At(1.01), InputKind::kStop), Key(over + At(2.0), InputKind::kStart)}});
  EXPECT_EQ(ran.Count("halt STOP"), 2);
  ASSERT_EQ(ran.moves.size(), 2U);
  EXPECT_NEAR(ran.moves.back().tip.tip.x(), 130, 1e-9);
  EXPECT_EQ(std::ranges::count_if(ran.parts,
                                  [](const Ran::Part& part) {
                                    return part.motion.ends_move &&
                                           part.done.travelled >= part.motion.path.length();
                                  }),
            2);
  EXPECT_NEAR(ran.time_s, ToSeconds(over) + 2.0 + kSettle_s, 1e-6);
}

// OPT-6.31: START at the very instant of a halt is for that halt: behind a step of SINGLE, a STOP
// on the way, and a HOLD.
TEST(Arrival, StartAtTheInstantOfAHalt) {
  const std::string text = From100(10) + Move(130, 1000);
  RunOptions options{.mode = machine::Mode::kSingle};
  for (int halts = 1; halts < 5; ++halts) {
    const Ran ran = RunText(text, options);
    ASSERT_EQ(ran.Count("halt SINGLE"), halts);
    options.inputs.push_back(Key(At(ran.events.back().at_s), InputKind::kStart));
  }
  EXPECT_EQ(RunText(text, options).outcome.kind, machine::OutcomeKind::kCompleted);

  const SimTime begin = RunText(text).moves.front().at;
  options = {.inputs = {Key(begin + At(0.3), InputKind::kStop)}};
  options.inputs.push_back(
      Key(At(RunText(text, options).First("halt STOP").at_s), InputKind::kStart));
  EXPECT_EQ(RunText(text, options).outcome.kind, machine::OutcomeKind::kCompleted);
}

// OPT-B.55, OPT-3.18: an error of what goes on beside a motion ends that at once, and the beam
// before.
TEST(Arrival, AnErrorBesideAMotion) {
  const std::string text =
      From100(10) + "WORKDEF 1,2 (50.,50.,0.,50.)\nWORK 1,2/ON\nWORK 1,1/ON/START (IL[20])/NEXT\n" +
      Move(300, 1000) + "OL[21]=ON\n";
  const double at = ToSeconds(RunText(text).moves.front().at) + 1.0;
  const Ran ran = RunText(text, {.inputs = {{At(at), InputKind::kLogical, 20, 1.0}}});
  EXPECT_EQ(CodeOf(ran), 7401);
  EXPECT_NEAR(ran.First("beam off").at_s, at, 1e-6);
  EXPECT_EQ(ran.First("beam off").step, 7);
  EXPECT_FALSE(ran.Told("OL[21] 1"));
  // 50 mm/s: 0.05 s at 1000 mm/s2 or less, and the time that the jerk takes.
  EXPECT_LT(ran.time_s, at + 0.2);
  ExpectWithinLimits(ran, true, "an error of a WORK");
}

// OPT-4.18, OPT-B.30: what waits in the background for its /START does not begin between STOP and
// START; a key is no input.
TEST(Arrival, NothingBeginsBetweenStopAndStart) {
  const std::string text = From100(10) +
                           "WORKDEF 1,1 (50.,50.,0.,50.)\nWORK 1,1/ON/START (IL[20])/NEXT\n" +
                           Move(300, 1000);
  const SimTime begin = RunText(text).moves.front().at;
  const SimTime stop = begin + At(1.0);
  const Ran ran = RunText(text, {.inputs = {Key(stop, InputKind::kStop),
                                            {stop + At(0.01), InputKind::kLogical, 20, 1.0},
                                            Key(stop + At(5.0), InputKind::kStart)}});
  const auto on = std::ranges::find_if(
      ran.events, [](const Ran::Event& event) { return event.what.starts_with("beam on"); });
  ASSERT_NE(on, ran.events.end());
  EXPECT_GE(on->at_s, ToSeconds(stop) + 5.0);
}

// Lines of a few lengths with corners, most of them passed, and outputs and the beam between.
std::string RandomProgram(unsigned seed) {
  std::mt19937 dice(seed);
  const auto one_of = [&dice](const auto& choices) {
    return choices[std::uniform_int_distribution<std::size_t>(0, choices.size() - 1)(dice)];
  };
  std::string text = "WORKDEF 1,1 (20.,50.,0.,80.)\nOVERSH " +
                     std::to_string(one_of(std::array{0, 30, 100})) + "\n" +
                     From100(one_of(std::array{4, 20, 100}));
  double x = 100.0;
  double y = 1000.0;
  int output = 20;
  for (int k = 0; k < 8; ++k) {
    switch (one_of(std::array{0, 0, 0, 1, 2, 3})) {
      case 1:
        text += "OL[" + std::to_string(++output) + "]=ON\n";
        break;
      case 2:
        text += one_of(std::array{"WORK 1,1/ON\n", "WORK 1,1/OFF\n"});
        break;
      case 3:
        text += "SPEED " + std::to_string(one_of(std::array{2, 10, 50})) + "\n";
        break;
      default: {
        const double length = one_of(std::array{1.0, 5.0, 10.0, 10.0, 30.0});
        const auto way =
            one_of(std::array<std::pair<int, int>, 5>{{{1, 0}, {0, 1}, {-1, 0}, {1, 1}, {0, -1}}});
        x += length * way.first;
        y += length * way.second;
        text += Move(x, y, one_of(std::array{"", "/FLY", "/FLY", "/FLY"}));
      }
    }
  }
  return text + "WORK 1,1/OFF\n";
}

// OPT-4.18, OPT-2.49: STOP at the instant of whatever arrival, or a little before it, and START
// change nothing but the time: each move is told once and each output comes once.
TEST(Arrival, StopAtAnyArrivalLosesNothing) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const std::string text = RandomProgram(seed);
    const Ran whole = RunText(text);
    for (const machine::MoveDone& move : whole.moves) {
      for (const int before_ns : {0, 1, 150, 20'000'000}) {
        const SimTime stop = move.at - SimTime(before_ns);
        const Ran ran = RunText(text, {.inputs = {Key(stop, InputKind::kStop),
                                                  Key(stop + At(10.0), InputKind::kStart)}});
        ASSERT_EQ(ran.moves.size(), whole.moves.size()) << text << ToSeconds(stop);
        for (std::size_t k = 0; k < ran.moves.size(); ++k) {
          EXPECT_LT((ran.moves[k].tip.tip - whole.moves[k].tip.tip).norm(), 1e-6)
              << text << ToSeconds(stop) << " move " << k;
        }
        for (int output = 21; output <= 28; ++output) {
          const std::string on = "OL[" + std::to_string(output) + "] 1";
          EXPECT_EQ(ran.Count(on), whole.Count(on)) << text << ToSeconds(stop) << on;
        }
        EXPECT_EQ(ran.findings.size(), whole.findings.size()) << text << ToSeconds(stop);
      }
    }
  }
}

// OPT-4.17, OPT-4.38: HOLD and another override at the instant at which one motion goes over into
// the next act as they do 1 ns later.
TEST(Arrival, KeysAtTheBoundaryOfMotions) {
  const std::string text =
      From100(40) + Move(200, 1000, "/FLY") + Move(400, 1000, "/FLY") + Move(700, 1000);
  const SimTime boundary = RunText(text).moves[1].at;
  const auto end_of = [&](SimTime at, InputKind kind) {
    return RunText(text, {.inputs = {{at, kind, 0, 50.0}, Key(at + At(30.0), InputKind::kStart)}});
  };
  for (const InputKind kind : {InputKind::kHold, InputKind::kOverride}) {
    const Ran there = end_of(boundary, kind);
    const Ran behind = end_of(boundary + SimTime(1), kind);
    EXPECT_NEAR(there.time_s, behind.time_s, 1e-6);
    EXPECT_EQ(there.Count("halt HOLD"), kind == InputKind::kHold ? 1 : 0);
  }
}

// OPT-3.58, OPT-B.55: HOLD while an error beside the motion brings it to rest: nothing of the
// passages that were to come is ridden any more.
TEST(Arrival, HoldWhileAnErrorEndsTheMotion) {
  const std::string text = From100(40) + "WORK 1,5/ON/START (IL[20])/NEXT\n" +
                           Move(300, 1000, "/FLY") + Move(500, 1000, "/FLY") + Move(700, 1000);
  const SimTime at = RunText(text).moves.front().at + At(0.3);
  const Ran ran = RunText(text, {.inputs = {{at, InputKind::kLogical, 20, 1.0},
                                            Key(at + At(0.05), InputKind::kHold),
                                            Key(at + At(5.0), InputKind::kStart)}});
  EXPECT_EQ(CodeOf(ran), 7401);
  EXPECT_LT(ran.end.tip.tip.x(), 300.0);
}

// OPT-3.58: what the program has switched on ahead of the machine stays off while an error brings
// it to rest: the ramp leads over the place where the beam was to come on.
TEST(Arrival, TheBeamStaysOffOnTheWayToRest) {
  const std::string text = From100(40) + "WORKDEF 1,1 (50.,50.,0.,50.)\n" +
                           "WORK 1,5/ON/START (IL[20])/NEXT\n" + Move(215, 1000, "/FLY") +
                           "WORK 1,1/ON\n" + Move(400, 1000, "/FLY") + Move(600, 1000);
  const Ran whole = RunText(text, {.inputs = {}});
  const auto is_on = [](const Ran::Event& event) { return event.what.starts_with("beam on"); };
  const auto on = std::ranges::find_if(whole.events, is_on);
  ASSERT_NE(on, whole.events.end());
  const Ran ran = RunText(text, {.inputs = {{At(on->at_s - 0.03), InputKind::kLogical, 20, 1.0}}});
  EXPECT_EQ(CodeOf(ran), 7401);
  EXPECT_GT(ran.end.tip.tip.x(), 215.0);
  EXPECT_TRUE(std::ranges::none_of(ran.events, is_on));
}

// OPT-4.18: nor does anything begin behind a STOP that waits until the ramp of /END is over.
TEST(Arrival, NothingBeginsBehindAStopThatWaits) {
  const std::string text = From100(40) + "WORKDEF 1,1 (50.,50.,0.,50.)\n" +
                           "WORK 1,1/ON/START (IL[20])/NEXT\n" +
                           "MOVE (500.,1000.,-400.,0.,0.)/END (IL[21])\n" + Move(700, 1000);
  const SimTime at = RunText(text).moves.front().at + At(0.5);
  const SimTime start = at + At(5.0);
  const Ran ran = RunText(text, {.inputs = {{at, InputKind::kLogical, 21, 1.0},
                                            Key(at + At(0.06), InputKind::kStop),
                                            {at + At(0.07), InputKind::kLogical, 20, 1.0},
                                            Key(start, InputKind::kStart)}});
  EXPECT_EQ(ran.Count("halt STOP"), 1);
  const auto on = std::ranges::find_if(
      ran.events, [](const Ran::Event& event) { return event.what.starts_with("beam on"); });
  ASSERT_NE(on, ran.events.end());
  EXPECT_GE(on->at_s, ToSeconds(start));
}

}  // namespace
}  // namespace rmlcell::optimo::testing::arrival
