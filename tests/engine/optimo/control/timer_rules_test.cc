#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// TIMER and /TIME between the levels of a program, loops that read inputs, and how far a program
// runs ahead. A CYCLE is 0.048 s.
namespace rmlcell::optimo::testing::timer_rules {
namespace {

using machine::OutcomeKind;

const double kRamp_s = 2.0 * std::sqrt(50.0 / 40000.0);  // from rest to 50 mm/s
// Steps 1 to 3, and 500 mm along X at 50 mm/s.
const std::string kAlongX = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
const std::string kFar = "MOVE (521.02,2201.2,-350.,0.,0.)";

std::string ValuesOf(const Ran& ran) {
  std::string all;
  for (const auto& [name, value] : ran.variables) all += value;
  return all;
}

// OPT-B.59, OPT-B.30: what a repeated timer missed is not made up for: of 2 s, the first tick
// behind is 2.016 s; from a DELAY of 4 s on the next one is 4.016 s.
TEST(TimerRules, MissedPeriodsAreSkipped) {
  const Ran ran = RunText(
      "TIMER (2.,900)/AUTO\nDELAY 4\nVI[10]=VI[2]\nDELAY .01\nVI[11]=VI[2]\nDELAY "
      ".01\nVI[12]=VI[2]\n"
      "DELAY 1.99\nVI[13]=VI[2]\nDELAY .01\nVI[14]=VI[2]\nENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n",
      {.variables = {"VI[10]", "VI[11]", "VI[12]", "VI[13]", "VI[14]"}});
  EXPECT_EQ(ValuesOf(ran), "11223");
}

// OPT-B.59: due at the very end of an instruction it is made once behind it: 6 s are 125 cycles.
TEST(TimerRules, DueAtTheEndOfAnInstruction) {
  const Ran ran = RunText(
      "TIMER (6.,900)/AUTO\nDELAY 6\nVI[10]=VI[2]\nDELAY 5.5\nVI[11]=VI[2]\nDELAY .5\n"
      "VI[12]=VI[2]\nENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n",
      {.variables = {"VI[10]", "VI[11]", "VI[12]"}, .budget = {.steps = 1000}});
  EXPECT_EQ(ValuesOf(ran), "112");
}

// OPT-B.59: a GOSUB inside the handler does not end it.
TEST(TimerRules, AHandlerIsOneWholeWithItsSubroutines) {
  const Ran ran = RunText(
      "TIMER (1.,900)/AUTO\nDELAY 2\nTIMER /DIS\nENDTASK\n"
      "900 VI[2]=VI[2]+1\nGOSUB 950\nDELAY 3\nVI[3]=VI[2]\nRETURN\n950 DELAY 3\nRETURN\n",
      {.variables = {"VI[2]", "VI[3]"}});
  EXPECT_EQ(ValuesOf(ran), "11");
}

// OPT-B.59: set inside a subroutine, it belongs to the module all the same; the handler may be over
// and another begin.
TEST(TimerRules, SetInsideASubroutine) {
  const Ran ran = RunText(
      "GOSUB 100\nDELAY 1.5\nVI[3]=VI[2]\nDELAY 1\nVI[4]=VI[2]\nTIMER /DIS\nENDTASK\n"
      "100 TIMER (1.,900)/AUTO\nDELAY 1.5\nRETURN\n900 VI[2]=VI[2]+1\nRETURN\n",
      {.variables = {"VI[3]", "VI[4]"}});
  EXPECT_EQ(ValuesOf(ran), "23");
}

// OPT-B.59: a timer of a FUNCTION ends with it; the number 900 of the main module is another one.
TEST(TimerRules, ATimerEndsWithItsModule) {
  const Ran ran =
      RunText("FUNCTION 44\nDELAY 3\nVI[3]=VI[2]\nENDTASK\n900 VI[2]=9\nRETURN\n",
              {.programs = {{44, "TIMER (1.,900)/AUTO\nENDTASK\n900 VI[2]=5\nRETURN\n"}},
               .variables = {"VI[2]", "VI[3]"}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ValuesOf(ran), "00");
}

// OPT-B.89: over a CALL of 10 s what is left of the timer stays: of 3.024 s there are 2.024 after 1
// s.
TEST(TimerRules, ACallStopsTheTimer) {
  const Ran ran = RunText(
      "TIMER (3.,900)\nDELAY 1\nCALL 45\nDELAY 2.02\nVI[3]=VI[2]\nDELAY .01\nVI[4]=VI[2]\nENDTASK\n"
      "900 VI[2]=1\nRETURN\n",
      {.programs = {{45, "DELAY 10\n"}}, .variables = {"VI[3]", "VI[4]"}});
  EXPECT_EQ(ValuesOf(ran), "01");
}

// OPT-2.54, OPT-2.59: the GOSUB of a /NEXT move is one of the module that has the MOVE: it waits
// for a FUNCTION that runs meanwhile, and is dropped when its own is over.
TEST(TimerRules, TheGosubOfANextMoveBelongsToItsModule) {
  const Ran waits =
      RunText(kAlongX + kFar +
                  "/TIME (2.,900)/NEXT\nFUNCTION 44\nVI[5]=VI[3]\nENDTASK\n"
                  "900 VI[3]=VI[3]+1\nRETURN\n",
              {.programs = {{44, "DELAY 3\nVI[4]=VI[3]\nDELAY 1\nENDTASK\n900 VI[3]=7\nRETURN\n"}},
               .variables = {"VI[3]", "VI[4]", "VI[5]"}});
  EXPECT_EQ(ValuesOf(waits), "101");
  const Ran dropped = RunText(
      "FUNCTION 44\nDELAY 5\nVI[4]=VI[3]\nENDTASK\n900 VI[3]=9\nRETURN\n",
      {.programs = {{44, kAlongX + kFar + "/TIME (2.,900)/NEXT\nENDTASK\n900 VI[3]=7\nRETURN\n"}},
       .variables = {"VI[3]", "VI[4]"}});
  EXPECT_EQ(ValuesOf(dropped), "00");
  EXPECT_NEAR(dropped.end.tip.tip.x(), 21.02 + 50.0 * 42 * 0.048,
              1e-6);  // and yet its time was over
}

// OPT-3.55, OPT-2.55: an error goes on at its label, and not in the GOSUB of a MOVE whose time ran
// out before, while a FUNCTION did not let it be made.
TEST(TimerRules, AnErrorComesBeforeAGosubThatIsDue) {
  const Ran ran = RunText(
      kAlongX + "ERR 800\n" + kFar +
          "/TIME (2.,900)/NEXT\nFUNCTION 44\nENDTASK\n"
          "900 VI[3]=VI[3]+1\nRETURN\n800 VI[5]=1\nDELAY 1\nVI[6]=1\n",
      {.programs = {{44, "DELAY 3\nVR[0]=1./VR[9]\n"}}, .variables = {"VI[3]", "VI[5]", "VI[6]"}});
  EXPECT_EQ(ran.Count("E7201"), 1);
  EXPECT_EQ(ValuesOf(ran), "011");
  EXPECT_NEAR(ran.time_s, 4.0, 1e-9);
}

// OPT-7.97: a loop may read an input a thousand times in one instant; from then on each further
// time takes a CYCLE.
TEST(TimerRules, ALoopReadsAThousandTimesAtOnce) {
  const auto time = [](int reads) {
    return RunText("10 VI[2]=VI[2]+1\nIF IL[16] OR (VI[2] >= " + std::to_string(reads) +
                   ") THEN 20\nGOTO 10\n20 VI[3]=1\n")
        .time_s;
  };
  EXPECT_EQ(time(1000), 0.0);
  EXPECT_NEAR(time(1001), 0.048, 1e-9);
  EXPECT_NEAR(time(1010), 0.480, 1e-9);
  // A second loop has a thousand of its own.
  const Ran two = RunText(
      "10 VI[2]=VI[2]+1\nIF IL[16] OR (VI[2] >= 1005) THEN 20\nGOTO 10\n"
      "20 VI[3]=VI[3]+1\nIF IL[16] OR (VI[3] >= 900) THEN 30\nGOTO 20\n30 VI[4]=1\n");
  EXPECT_NEAR(two.time_s, 5 * 0.048, 1e-9);
}

// OPT-7.97: of a loop that reads two inputs the first one is counted; what was read before the loop
// and is not of it counts for nothing: behind a thousand others one of these takes its place, and
// has its own thousand from there.
TEST(TimerRules, OneReadOfALoopIsCounted) {
  const auto time = [](const std::string& before, const std::string& reads, int turns) {
    return RunText(before + "10 VI[2]=VI[2]+1\n" + reads + "IF VI[2] < " + std::to_string(turns) +
                   " THEN 10\n20 VI[3]=1\n")
        .time_s;
  };
  const std::string one = "VL[1]=IL[16]\n";
  const std::string two = one + "VL[2]=IL[17]\n";
  EXPECT_EQ(time("", two, 1000), 0.0);
  EXPECT_NEAR(time("", two, 1001), 0.048, 1e-9);
  EXPECT_NEAR(time("", two, 1010), 10 * 0.048, 1e-9);
  const std::string before = "IF IL[18] THEN 20\n";
  EXPECT_EQ(time(before, one, 1999), 0.0);
  EXPECT_NEAR(time(before, one, 2000), 0.048, 1e-9);
  EXPECT_NEAR(time(before, one, 2010), 11 * 0.048, 1e-9);
}

// OPT-7.97: the more inputs a loop reads, the longer it takes until one of them is counted: of 2100
// the first is not met again within a thousand others, nor the 1001st within two thousand; the
// 901st of the second turn is, and has its own thousand from there.
TEST(TimerRules, OneReadOfALongLoopIsCounted) {
  std::string text = "10 VI[2]=VI[2]+1\n";
  for (int n = 0; n < 2100; ++n) text += "VL[1]=IL[16]\n";
  EXPECT_EQ(RunText(text + "IF VI[2] < 1001 THEN 10\n20 VI[3]=1\n").time_s, 0.0);
}

// OPT-2.49: the program runs ahead of a passage by ten thousand instructions; one more, and the
// passage becomes a stop.
TEST(TimerRules, HowFarAProgramRunsAhead) {
  const auto cancelled = [](int turns) {
    return RunText(kAlongX + kFar + "/FLY\n10 VI[2]=VI[2]+1\nIF VI[2] < " + std::to_string(turns) +
                   " THEN 10\nMOVE (621.02,2201.2,-350.,0.,0.)\n")
        .Count("E7304");
  };
  EXPECT_EQ(cancelled(4999), 0);
  EXPECT_EQ(cancelled(5000), 1);
}

// OPT-B.55, OPT-2.59: an error beside a motion of /NEXT brings it to rest at once; then the handler
// goes on, there.
TEST(TimerRules, AnErrorBesideANextMove) {
  const Ran ran = RunText(kAlongX + "ERR 800\n" + kFar +
                              "/NEXT\nDELAY 1\nVR[5]=1/0\nENDTASK\n800 VR[0]=IA[0]\nOL[16]=ON\n",
                          {.variables = {"VR[0]"}});
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 1.0 + kRamp_s, 1e-6);
  EXPECT_NEAR(std::stod(ran.variables.at("VR[0]")), 71.02, 1e-3);
  EXPECT_EQ(ran.moves.size(), 1U);
}

// OPT-4.23, OPT-B.67: REPEAT of a program that lets no time pass ends with its budget of steps.
TEST(TimerRules, RepeatWithoutTimeEndsWithItsSteps) {
  const Ran ran =
      RunText("VI[2]=1\nVI[3]=1\n", {.mode = machine::Mode::kRepeat, .budget = {.steps = 50'000}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kBudgetExceeded);
  EXPECT_EQ(CodeOf(ran), 7901);
  EXPECT_EQ(ran.steps, 50'000U);
  EXPECT_EQ(ran.time_s, 0.0);
  EXPECT_EQ(ran.outcome.detail, "50000 steps were executed");
}

}  // namespace
}  // namespace rmlcell::optimo::testing::timer_rules
