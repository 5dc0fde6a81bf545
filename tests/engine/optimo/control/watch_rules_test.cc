#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// /START, /END, /TIME and /NEXT of one MOVE are over with it: nothing of them reaches the next one.
// New machines stand with the tip at (21.02, 2201.2, -350).
namespace rmlcell::optimo::testing::watch_rules {
namespace {

using machine::InputKind;
using machine::OutcomeKind;

constexpr double kTick_s = 0.048;
const double kRamp_s = 2.0 * std::sqrt(50.0 / 40000.0);  // from rest to 50 mm/s

// Steps 1 to 4: along X at 50 mm/s, errors go to 800; at 900 a subroutine that counts in VI[3].
std::string Program(const std::string& steps) {
  return "COORD ABSOL\nPATH LIN\nSPEED 10\nERR 800\n" + steps +
         "ENDTASK\n900 VI[3]=VI[3]+1\nRETURN\n800 VI[4]=VI[99]\n";
}
std::string MoveTo(double x_mm, const std::string& attributes) {
  return "MOVE (" + std::to_string(x_mm) + ",2201.2,-350.,0.,0.)" + attributes + "\n";
}
machine::InputChange Input(double at_s, int index, double value) {
  return {At(at_s), InputKind::kLogical, index, value};
}

// How a MOVE with all of it can end, from 21.02 on. IL[20] is on until 0.5 s, and again from 4 s to
// 6 s.
struct Way {
  std::string name;
  std::string steps;
  int gosubs = 0;
};
const std::vector<Way>& Ways() {
  static const std::vector<Way> ways = {
      {"target", MoveTo(71.02, "/TIME (9.,900)/END (IL[21])")},
      {"time", MoveTo(521.02, "/TIME (1.,900)/END (IL[21])"), 1},
      {"time of start", MoveTo(521.02, "/START (IL[21])/TIME (1.,900)"), 1},
      {"end", MoveTo(521.02, "/TIME (9.,900)/END (VR[0] < IA[0])")},
      {"true at once", MoveTo(521.02, "/TIME (1.,900)/END (IL[20])")},
      {"nowhere", MoveTo(21.02, "/TIME (1.,900)/END (IL[21])")},
      {"no motion", "SPEED 0\n" + MoveTo(521.02, "/TIME (1.,900)/END (IL[21])") + "SPEED 10\n", 1},
      {"no motion, ended",
       "SPEED 0\n" + MoveTo(521.02, "/TIME (9.,900)/END (NOT IL[20])") + "SPEED 10\n"},
      {"taken over",
       MoveTo(521.02, "/TIME (9.,900)/END (IL[21])/NEXT") + "DELAY 1\n" + MoveTo(21.02, "")},
      {"no motion, taken over", "SPEED 0\n" + MoveTo(521.02, "/TIME (9.,900)/END (IL[21])/NEXT") +
                                    "DELAY 1\nSPEED 10\n" + MoveTo(31.02, "")},
  };
  return ways;
}

Ran RunWay(const Way& way, const std::string& behind, const machine::InputScript& more = {}) {
  machine::InputScript script{{SimTime(0), InputKind::kLogical, 20, 1.0}, Input(0.5, 20, 0.0)};
  script.insert(script.end(), more.begin(), more.end());
  return RunText(Program("VR[0]=46.02\n" + way.steps + behind),
                 {.inputs = script, .variables = {"VI[3]", "VI[4]"}});
}

// OPT-2.55, OPT-2.57: the time of a MOVE that is over does not cut the wait of the next one for its
// /START.
TEST(WatchRules, TheTimeOfAMoveIsOverWithIt) {
  for (const Way& way : Ways()) {
    const Ran ran = RunWay(way, MoveTo(221.02, "/START (IL[22])"), {Input(30.0, 22, 1.0)});
    SCOPED_TRACE(way.name);
    EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
    EXPECT_EQ(ran.variables.at("VI[3]"), std::to_string(way.gosubs));
    EXPECT_NEAR(ran.end.tip.tip.x(), 221.02, 1e-4);
    EXPECT_GE(ran.time_s, 30.0);
  }
}

// OPT-2.54, OPT-2.58: nor does it end the motion of one that has an /END of its own; and its /END
// not that of one that has a /TIME.
TEST(WatchRules, TheEndOfAMoveIsOverWithIt) {
  for (const Way& way : Ways()) {
    SCOPED_TRACE(way.name);
    const Ran end = RunWay(way, MoveTo(921.02, "/END (IL[22])"), {Input(40.0, 21, 1.0)});
    EXPECT_EQ(end.variables.at("VI[3]"), std::to_string(way.gosubs));
    EXPECT_NEAR(end.end.tip.tip.x(), 921.02, 1e-4);
    const Ran time =
        RunWay(way, "DELAY 6\n" + MoveTo(921.02, "/TIME (99.,900)"), {Input(12.0, 21, 1.0)});
    EXPECT_EQ(time.variables.at("VI[3]"), std::to_string(way.gosubs));
    EXPECT_NEAR(time.end.tip.tip.x(), 921.02, 1e-4);
    EXPECT_EQ(time.variables.at("VI[4]"), "0");
  }
}

// OPT-2.54, OPT-B.30: a second MOVE has its whole time, from its own beginning.
TEST(WatchRules, EachMoveHasItsOwnTime) {
  for (const Way& way : Ways()) {
    SCOPED_TRACE(way.name);
    const Ran ran = RunWay(way, "DELAY 7\n" + MoveTo(1521.02, "/TIME (3.,900)") + "VI[5]=1\n");
    EXPECT_EQ(ran.variables.at("VI[3]"), std::to_string(way.gosubs + 1));
    ASSERT_FALSE(ran.parts.empty());
    const Ran::Part& last = ran.parts.back();
    ASSERT_GE(ran.parts.size(), 2U);
    // 63 ticks at 50 mm/s and the ramp to rest.
    const double way_mm = last.motion.path.At(last.done.travelled).point.x() -
                          ran.parts[ran.parts.size() - 2]
                              .motion.path.At(ran.parts[ran.parts.size() - 2].done.from)
                              .point.x();
    EXPECT_NEAR(way_mm, 50.0 * 63 * kTick_s, 1e-4);
  }
}

// OPT-2.55: RETURN goes on behind the MOVE whose time ran out, whatever it waited for.
TEST(WatchRules, ReturnGoesOnBehindTheMove) {
  for (const Way& way : Ways()) {
    const Ran ran = RunWay(way, "VI[4]=VI[3]\n");
    EXPECT_EQ(ran.variables.at("VI[4]"), std::to_string(way.gosubs)) << way.name;
  }
}

// OPT-2.56: without its label the error comes when the time runs out, and no earlier; it is caught.
TEST(WatchRules, AMissingLabelCountsWhenTheTimeRunsOut) {
  const Ran never = RunText(Program(MoveTo(71.02, "/TIME (9.,999)")), {.variables = {"VI[4]"}});
  EXPECT_EQ(never.variables.at("VI[4]"), "0");
  const Ran out = RunText(Program(MoveTo(521.02, "/TIME (2.,999)")), {.variables = {"VI[4]"}});
  EXPECT_EQ(out.variables.at("VI[4]"), "60");
  EXPECT_NEAR(out.time_s, 42 * kTick_s + kRamp_s, 1e-6);
  const Ran wait =
      RunText(Program(MoveTo(521.02, "/START (IL[20])/TIME (2.,999)")), {.variables = {"VI[4]"}});
  EXPECT_EQ(wait.variables.at("VI[4]"), "60");
  EXPECT_NEAR(wait.time_s, 42 * kTick_s, 1e-9);
}

// OPT-2.54: a MOVE that is over just before its time makes no GOSUB; the settling belongs to it.
TEST(WatchRules, TheTimeOfAMoveThatIsJustOver) {
  // 100 mm: at rest after 2.0707 s, settled after 2.1187 s; ticks at 2.064, 2.112 and 2.160 s.
  const auto gosubs = [](const std::string& seconds) {
    return RunText(Program(MoveTo(121.02, "/TIME (" + seconds + ",900)")), {.variables = {"VI[3]"}})
        .variables.at("VI[3]");
  };
  EXPECT_EQ(gosubs("2.13"), "0");
  EXPECT_EQ(gosubs("2.01"), "1");
}

// OPT-2.58, OPT-B.30: /END is tested at each whole cycle of the move's own clock, which begins with
// the move: behind a DELAY of 0.01 s at 0.01 + k x 0.048 s.
TEST(WatchRules, TheClockOfEndBeginsWithTheMove) {
  const Ran ran = RunText(Program("DELAY .01\n" + MoveTo(521.02, "/END (IL[20])")),
                          {.inputs = {Input(1.0, 20, 1.0)}});
  EXPECT_NEAR(ran.time_s, 0.01 + 21 * kTick_s + kRamp_s, 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02 + 50.0 * 21 * kTick_s, 1e-6);
  // An input that is gone again at the tick was not seen.
  const Ran missed = RunText(Program(MoveTo(521.02, "/END (IL[20])")),
                             {.inputs = {Input(1.01, 20, 1.0), Input(1.05, 20, 0.0)}});
  EXPECT_NEAR(missed.end.tip.tip.x(), 521.02, 1e-4);
}

// OPT-2.49, OPT-2.54: behind a /FLY passage the clock begins with the motion, not where the program
// ran ahead: 100 mm in one line are over after 2.0354 s.
TEST(WatchRules, BehindAPassageTheClockBeginsWithTheMotion) {
  const double begin = 2.0 + 0.5 * kRamp_s;
  const Ran time = RunText(Program(MoveTo(121.02, "/FLY") + MoveTo(521.02, "/TIME (3.,900)")),
                           {.variables = {"VI[3]"}});
  EXPECT_EQ(time.variables.at("VI[3]"), "1");
  EXPECT_NEAR(time.time_s, begin + 63 * kTick_s + kRamp_s, 1e-4);
  // /END of a variable that the program sets beside the motion, 2 s after its begin.
  const Ran end = RunText(Program("VL[3]=OFF\n" + MoveTo(121.02, "/FLY") +
                                  MoveTo(521.02, "/END (VL[3])/NEXT") + "DELAY 2\nVL[3]=ON\n"));
  EXPECT_NEAR(end.time_s, begin + 42 * kTick_s + kRamp_s, 1e-4);
}

// OPT-2.54, OPT-B.30: nor does a time run out that is shorter than the way to its motion: here 1 s,
// behind 2.0354 s.
TEST(WatchRules, ATimeShorterThanTheWayToItsMotion) {
  const Ran ran = RunText(Program(MoveTo(121.02, "/FLY") + MoveTo(521.02, "/TIME (1.,900)")),
                          {.variables = {"VI[3]"}});
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
  EXPECT_NEAR(ran.time_s, 2.0 + 0.5 * kRamp_s + 21 * kTick_s + kRamp_s, 1e-4);
}

// OPT-2.48, OPT-2.58: a MOVE that reads an input needs standstill: /FLY before it is cancelled, and
// its clock begins where the machine stands.
TEST(WatchRules, AMoveThatReadsAnInputNeedsStandstill) {
  const Ran ran = RunText(Program(MoveTo(121.02, "/FLY") + MoveTo(521.02, "/END (IL[20])")),
                          {.inputs = {Input(4.0, 20, 1.0)}});
  EXPECT_EQ(ran.Count("E7304"), 1);
  EXPECT_NEAR(ran.time_s, 2.0 + kRamp_s + 41 * kTick_s + kRamp_s, 1e-5);
}

// OPT-2.59, OPT-2.54: a MOVE of /NEXT has its time too: the GOSUB comes between two instructions.
TEST(WatchRules, TheTimeOfANextMove) {
  const Ran ran = RunText(Program(MoveTo(521.02, "/TIME (2.,900)/NEXT") +
                                  "DELAY 1\nVI[5]=VI[3]\nDELAY 2\nVI[6]=VI[3]\n"),
                          {.variables = {"VI[5]", "VI[6]"}});
  EXPECT_EQ(ran.variables.at("VI[5]") + ran.variables.at("VI[6]"), "01");
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02 + 50.0 * 42 * kTick_s, 1e-6);
}

// OPT-2.59, OPT-B.30: the next MOVE takes over at the next tick of the system's clock: the first
// comes to rest on its path and is told as over where it stands.
TEST(WatchRules, TakingOverAtATick) {
  const Ran ran =
      RunText(Program(MoveTo(521.02, "/NEXT") + "DELAY 1.001\nMOVE (21.02,2101.2,-350.,0.,0.)\n"));
  ASSERT_EQ(ran.moves.size(), 2U);
  EXPECT_NEAR(ToSeconds(ran.moves[0].at), 21 * kTick_s + kRamp_s, 1e-6);
  EXPECT_NEAR(ran.moves[0].tip.tip.x(), 21.02 + 50.0 * 21 * kTick_s, 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02, 1e-4);
  EXPECT_NEAR(ran.end.tip.tip.y(), 2101.2, 1e-4);
}

// OPT-2.58, OPT-B.20: an /END that is true when the target is reached has nothing left to end: 100
// mm at 100 mm/s take 1.1 s, eleven cycles here, and the machine settles as without it.
TEST(WatchRules, AnEndAtTheTarget) {
  const auto lasts = [](const std::string& end) {
    return RunText(kThere + "SPEED 20\nVR[0]=1099.99\nMOVE (1100.,1000.,-400.,0.,0.)" + end + "\n",
                   {.parameters = {{"CYCLE", "0.1"}}})
        .time_s;
  };
  EXPECT_EQ(lasts("/END (IA[0] > VR[0])"), lasts(""));
}

// OPT-2.54, OPT-2.58: /TIME and /END are of their own MOVE, also where the next one follows without
// a stop: 75 mm at 50 mm/s are over after 1.5 s, and 200 mm go on.
TEST(WatchRules, NothingIsWatchedBehindItsMove) {
  const auto run = [](const std::string& attributes, double at_s) {
    return RunText(kThere + "MOVE (1075.,1000.,-400.,0.,0.)" + attributes +
                       "\nMOVE (1275.,1000.,-400.,0.,0.)\nVI[3]=1\nENDTASK\n900 VI[2]=1\nRETURN\n",
                   {.inputs = {{At(at_s), machine::InputKind::kLogical, 20, 1.0}},
                    .variables = {"VI[2]", "VI[3]"}});
  };
  const double there_s = ToSeconds(run("", 0.0).parts[1].done.start);
  for (const std::string next : {"", "/FLY"}) {
    const Ran timed = run("/TIME (2.,900)" + next, 0.0);
    EXPECT_EQ(timed.variables.at("VI[2]") + timed.variables.at("VI[3]"), "01") << next;
    const Ran ended = run("/END (IL[20])" + next, there_s + 3.0);
    EXPECT_NEAR(ended.end.tip.tip.x(), 1275.0, 1e-6) << next;
    // Within its own MOVE each of them acts.
    EXPECT_EQ(run("/TIME (1.,900)" + next, 0.0).variables.at("VI[2]"), "1") << next;
    EXPECT_LT(run("/END (IL[20])" + next, there_s + 1.0).moves[1].tip.tip.x(), 1070.0) << next;
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::watch_rules
