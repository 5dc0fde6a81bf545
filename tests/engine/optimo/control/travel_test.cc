#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// Motions that leave the travel of an axis, or ask too much speed of it. The travel of the standard
// machine: X -600..3600, Y -600..3100, Z -1300..1100 mm, A +-12.6, B +-2.4 rad.
namespace rmlcell::optimo::testing {
namespace {

using machine::OutcomeKind;

std::vector<int> StepsOf(const Ran& ran, int code) {
  std::vector<int> steps;
  for (const Diagnostic& finding : ran.findings) {
    if (Lookup(finding.code).number == code) steps.push_back(finding.step);
  }
  return steps;
}

// X alone from rest to rest at SPEED 70: D/V + V/a + a/j, and SETTLE.
double RobotTime(double distance_mm) { return distance_mm / 350.0 + 0.175 + 0.05 + 0.048; }

// OPT-E.7301, OPT-B.08: a forecast tells every motion that leaves the travel, with step, line, time
// and excess, goes on behind it, and ends as failed at the first.
TEST(Travel, AForecastTellsAllViolationsOfARun) {
  const Ran ran = RunText(
      "COORD ROBOT\n"
      "MOVE (9000.,2201.2,-50.,0.,0.)\n"
      "MOVE (1000.,2201.2,-50.,0.,0.)\n"
      "MOVE (1000.,2201.2,-50.,13.,2.5)\n"
      "MOVE (1000.,2201.2,-50.,0.,0.)\n",
      {.forecast = true});
  EXPECT_EQ(StepsOf(ran, 7301), (std::vector{2, 4}));  // 3 and 5 only come back
  ASSERT_EQ(ran.violations.size(), 3U);
  EXPECT_EQ(ran.violations[0].axis, 0);
  EXPECT_NEAR(ran.violations[0].excess, 5400.0, 1e-9);
  EXPECT_TRUE(ran.violations[0].at_target);
  EXPECT_EQ(ran.violations[0].at, SimTime(0));
  EXPECT_NEAR(ran.violations[0].axes.column.x(), 9000.0, 1e-9);
  EXPECT_NEAR(ran.violations[0].tip.tip.z(), -350.0, 1e-9);
  EXPECT_EQ(ran.violations[1].axis, 3);
  EXPECT_NEAR(ran.violations[1].excess, 0.4, 1e-9);
  EXPECT_EQ(ran.violations[2].axis, 4);
  EXPECT_NEAR(ran.violations[2].excess, 0.1, 1e-9);
  EXPECT_NEAR(ToSeconds(ran.violations[1].at), RobotTime(9000.0 - 21.02) + RobotTime(8000.0), 1e-6);
  const Diagnostic& first = ran.findings.front();
  EXPECT_EQ(first.severity, Severity::kProgram);
  EXPECT_EQ(first.detail, "X of the target leaves its travel by 5400.000 mm");
  EXPECT_EQ(first.at, SimTime(0));
  EXPECT_EQ(ran.findings[1].detail,
            "A of the target leaves its travel by 0.400 rad, B of the target by 0.100 rad");
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_EQ(ran.outcome.place.step, 2);
  EXPECT_NEAR(ran.end.axes.column.x(), 1000.0, 1e-9);
}

// OPT-B.08: in RUN it is an alarm at its place, and nothing moves.
TEST(Travel, ARunStopsAtTheFirstBeforeItMoves) {
  const Ran ran =
      RunText("COORD ROBOT\nMOVE (9000.,1000.,-300.,13.,0.)\nMOVE (-900.,0.,0.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_EQ(StepsOf(ran, 7301), std::vector{2});
  EXPECT_TRUE(ran.moves.empty());
  EXPECT_EQ(ran.findings.front().severity, Severity::kAlarm);
  EXPECT_EQ(ran.violations.size(), 2U);
}

// OPT-B.08: the circle through (3500,1000), (3650,1150) and (3500,1300) has its centre at
// (3500,1150): its quadrant point is 50 mm beyond the end of X, its target is not.
TEST(Travel, AnArcLeavesItOnTheWay) {
  const std::string program = std::string(kAbsol) +
                              "MOVE (3500.,1000.,-400.,0.,0.)\nPATH CIR\n"
                              "MOVE (3500.,1300.,-400.,0.,0.)/VIA (3650.,1150.,-400.,0.,0.)\n";
  const Ran ran = RunText(program, {.forecast = true});
  ASSERT_EQ(ran.violations.size(), 1U);
  EXPECT_NEAR(ran.violations[0].excess, 50.0, 1e-6);
  EXPECT_FALSE(ran.violations[0].at_target);
  EXPECT_NEAR(ran.violations[0].tip.tip.y(), 1150.0, 1e-6);
  EXPECT_EQ(ran.findings.front().detail, "X on the way leaves its travel by 50.000 mm");
  EXPECT_EQ(CodeOf(RunText(program)), 7301);
}

// OPT-B.08: both ends are inside, the head bent along Y; half way it points along X, the column
// 300 sin(1) off the tip: to one side out of the travel. A way with the head steady stays inside.
TEST(Travel, AHeadThatTurnsLeavesItOnTheWay) {
  std::vector<machine::TravelViolation> violations;
  for (const std::string a : {"3.14159", "-3.14159"}) {
    const Ran ran = RunText(kAbsol + "MOVE (3550.,1000.,-400.,0.,1.)\nMOVE (3550.,1000.,-400.," +
                                a + ",1.)\nMOVE (3550.,1500.,-400.," + a + ",1.)\n",
                            {.forecast = true});
    violations.insert(violations.end(), ran.violations.begin(), ran.violations.end());
  }
  ASSERT_EQ(violations.size(), 1U);
  EXPECT_EQ(violations[0].axis, 0);
  EXPECT_FALSE(violations[0].at_target);
  EXPECT_EQ(violations[0].place.step, 4);
  EXPECT_NEAR(violations[0].excess, 3550.0 + 300.0 * std::sin(1.0) - 3600.0, 0.1);
}

// OPT-B.08: bent to either side, the head has its column 300 cos(1) above the tip, inside; upright
// half way between the two it is 100 mm too high.
TEST(Travel, AHeadThatBendsLeavesItOnTheWay) {
  const Ran ran =
      RunText(kAbsol + "MOVE (1000.,1000.,900.,0.,-1.)\nMOVE (1000.,1500.,900.,0.,1.)\n",
              {.forecast = true});
  ASSERT_EQ(ran.violations.size(), 1U);
  EXPECT_EQ(ran.violations[0].axis, 2);
  EXPECT_FALSE(ran.violations[0].at_target);
  EXPECT_EQ(ran.violations[0].place.step, 4);
  EXPECT_NEAR(ran.violations[0].excess, 100.0, 0.1);
}

// OPT-B.37: 12.6 is 4e-7 more in the REAL arithmetic of the control. The end of a travel is inside.
TEST(Travel, TheVeryEndOfItIsInside) {
  const Ran ran = RunText(
      "COORD ROBOT\nMOVE (3600.,3100.,1100.,12.6,2.4)\nMOVE (-600.,-600.,-1300.,-12.6,-2.4)\n");
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(CodeOf(RunText("COORD ROBOT\nMOVE (3600.01,0.,0.,0.,0.)\n")), 7301);
}

// OPT-B.08, OPT-B.37: how much counts as rounding: 1e-6, and what a number of 24 bits leaves of the
// limit, which is 0.00043 mm at 3600 mm: one step of such a number, not two.
TEST(Travel, RoundingIsNoViolation) {
  const auto code = [](const std::string& target, const RunOptions& options = {}) {
    return CodeOf(RunText("MOVE (" + target + ")\n", options));
  };
  const RunOptions clamped{.parameters = {{"TRAVEL_A_MIN", "0"}, {"TRAVEL_A_MAX", "0"}}};
  for (const std::string sign : {"", "-"}) {
    EXPECT_EQ(code("121.02,2201.2,-50.," + sign + "0.0000009,0.", clamped), 0);
    EXPECT_EQ(code("121.02,2201.2,-50.," + sign + "0.0000015,0.", clamped), 7301);
  }
  EXPECT_EQ(code("3600.00025,2201.2,-50.,0.,0."), 0);
  EXPECT_EQ(code("3600.0005,2201.2,-50.,0.,0."), 7301);
}

// OPT-B.08: the target is looked at first, and the way to it only where that is inside: here Y ends
// at least 148 mm outside, and X, to one of the two sides, is 202 mm outside half way. A forecast
// tells both.
TEST(Travel, TheWayCountsWhereTheTargetIsInside) {
  std::size_t forecast = 0;
  for (const std::string a : {"3.14159", "-3.14159"}) {
    const std::string text = kAbsol +
                             "MOVE (3550.,1000.,-400.,0.,1.)\n"
                             "MOVE (3550.,3500.,-400.," +
                             a + ",1.)\n";
    const Ran ran = RunText(text);
    EXPECT_EQ(CodeOf(ran), 7301);
    const std::string detail(ran.outcome.detail);
    EXPECT_TRUE(detail.starts_with("Y of the target leaves its travel by ")) << detail;
    EXPECT_EQ(detail.find("on the way"), std::string::npos) << detail;
    ASSERT_EQ(ran.violations.size(), 1U);
    EXPECT_EQ(ran.violations[0].axis, 1);
    forecast += RunText(text, {.forecast = true}).violations.size();
  }
  EXPECT_EQ(forecast, 3U);
}

// OPT-2.49: the program runs ahead of /FLY moves; a finding has the time at which its own begins,
// half way through the bend of case C01: 2.021 s after the chain.
TEST(Travel, InAChainEachHasTheTimeOfItsOwnMotion) {
  const Ran ran = RunText(std::string(kAbsol) +
                              "SPEED 10\nMOVE (3550.,1000.,-400.,0.,0.)\n"
                              "MOVE (3550.,1100.,-400.,0.,0.)/FLY\n"
                              "MOVE (3650.,1100.,-400.,0.,0.)\n",
                          {.forecast = true});
  ASSERT_EQ(ran.violations.size(), 1U);
  EXPECT_NEAR(ran.violations[0].excess, 50.0, 1e-3);
  const double chain_s = ToSeconds(ran.moves.front().at);
  EXPECT_NEAR(ToSeconds(ran.violations[0].at), chain_s + (4.08999984769 - 0.048) / 2.0, 1e-6);
}

// OPT-E.7301: a target that no machine of any size has is told, and left out.
TEST(Travel, ATargetBeyondAllMeasureIsLeftOut) {
  const Ran ran = RunText("COORD ROBOT\nMOVE (1.E15,0.,0.,0.,0.)\nMOVE (50.,2201.2,-50.,0.,0.)\n",
                          {.forecast = true});
  EXPECT_EQ(StepsOf(ran, 7301), std::vector{2});
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_NEAR(ran.end.axes.column.x(), 50.0, 1e-9);
}

// OPT-B.15, OPT-B.08: both parts of a hole are looked at; the circle of radius 50 round (3580,1000)
// reaches 30 mm beyond the end of X.
TEST(Travel, AHoleAtTheEdge) {
  const Ran ran = RunText(std::string(kAbsol) +
                              "MOVE (3530.,1000.,-400.,0.,0.)\nPATH HOLE (50.)\n"
                              "MOVE (3580.,1000.,-400.,0.,0.)/VIA (3580.,1000.,-300.,0.,0.)\n",
                          {.forecast = true});
  ASSERT_EQ(ran.violations.size(), 1U);
  EXPECT_NEAR(ran.violations[0].excess, 30.0, 1e-6);
}

// OPT-B.08, OPT-B.15: in RUN a hole whose circle reaches beyond the end of X is refused before its
// lead, up to (3530,1000), begins: nothing of it is ridden, and it is told once.
TEST(Travel, AHoleIsLookedAtBeforeItsLead) {
  const Ran ran = RunText(std::string(kAbsol) +
                          "MOVE (3000.,1000.,-400.,0.,0.)\nPATH HOLE (50.)\n"
                          "MOVE (3580.,1000.,-400.,0.,0.)/VIA (3580.,1000.,-300.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_EQ(ran.outcome.place.step, 5);
  EXPECT_EQ(ran.outcome.detail, "X on the way leaves its travel by 30.000 mm");
  EXPECT_EQ(ran.violations.size(), 1U);
  EXPECT_EQ(ran.moves.size(), 1U);
  EXPECT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.end.axes.column.x(), 3000.0, 1e-9);
}

// OPT-6.31: a forecast that stops for a key and found violations is a failed one, too.
TEST(Travel, AHaltDoesNotHideThem) {
  const Ran ran =
      RunText("COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\nSTOP\n",
              {.inputs = {{std::chrono::hours(1), machine::InputKind::kStart}}, .forecast = true});
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_EQ(ran.outcome.detail, "X of the target leaves its travel by 5400.000 mm");
}

// OPT-B.08: a machine that stands outside to begin with was brought there by no motion of the run:
// the way back is told like any other.
TEST(Travel, AMachineThatStandsOutside) {
  const std::string back = "COORD ROBOT\nMOVE (3000.,2201.2,-50.,0.,0.)\n";
  RunOptions options{.parameters = {{"HOME_X", "4000"}}};
  const Ran ran = RunText(back, options);
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_EQ(ran.outcome.detail, "X on the way leaves its travel by 400.000 mm");
  options.forecast = true;
  EXPECT_EQ(RunText(back, options).violations.size(), 1U);
  EXPECT_EQ(RunText(back, {.parameters = {{"HOME_X", "-1000"}}}).outcome.detail,
            "X on the way leaves its travel by 400.000 mm");
}

// OPT-B.08: a MOVE to the place outside where the machine stands anyway is told, though nothing
// moves for it.
TEST(Travel, ATargetOutsideWhereItStands) {
  const std::string stay = "COORD ROBOT\nMOVE (4000.,2200.,-50.,0.,0.)\n";
  RunOptions options{.parameters = {{"HOME_X", "4000"}, {"HOME_Y", "2200"}}};
  EXPECT_EQ(CodeOf(RunText(stay, options)), 7301);
  options.forecast = true;
  const Ran ran = RunText(stay, options);
  EXPECT_EQ(CodeOf(ran), 7301);
  EXPECT_EQ(StepsOf(ran, 7301), std::vector{2});
  ASSERT_EQ(ran.violations.size(), 1U);
  EXPECT_EQ(ran.violations[0].axis, 0);
  EXPECT_NEAR(ran.violations[0].excess, 400.0, 1e-9);
  EXPECT_TRUE(ran.violations[0].at_target);
  EXPECT_TRUE(ran.parts.empty());
}

// OPT-7.28: SYSDEF moves the tip, so X, Y and Z of a target in COORD ABSOL, and no angle.
TEST(Travel, WhatHangsOnTheWorkOffset) {
  const auto by_offset = [](const std::string& coord, const std::string& target) {
    std::string text;
    for (const machine::TravelViolation& one :
         RunText("COORD " + coord + "\nMOVE (" + target + ")\n", {.forecast = true}).violations)
      text += std::to_string(one.axis) + (one.by_work_offset ? "+ " : "- ");
    return text;
  };
  EXPECT_EQ(by_offset("ABSOL", "9000.,9000.,9000.,13.,0."), "0+ 1+ 2+ 3- ");
  EXPECT_EQ(by_offset("ROBOT", "9000.,9000.,9000.,13.,2.5"), "0- 1- 2- 3- 4- ");
}

// OPT-2.49: a chain without an end never begins to move before the steps run out; what it would do
// is told.
TEST(Travel, AnEndlessChainTellsThemToo) {
  const Ran ran = RunText(std::string(kAbsol) +
                              "10 MOVE (1000.,1000.,-400.,0.,0.)/FLY\n"
                              "MOVE (3700.,1000.,-400.,0.,0.)/FLY\nGOTO 10\n",
                          {.budget = {.steps = 100}, .forecast = true});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kBudgetExceeded);
  ASSERT_FALSE(ran.violations.empty());
  EXPECT_EQ(ran.violations.front().place.step, 4);
  EXPECT_NEAR(ran.violations.front().excess, 100.0, 1e-3);
}

// OPT-2.16: case L01: at A 0 the column goes 4 mm for each mm of the tip, so X allows 125 mm/s of
// the 150. Told once for the step, however often it runs.
TEST(Travel, AnAxisThatHoldsAContourBackIsToldOnce) {
  const Ran ran = RunText(std::string(kAbsol) +
                          "SPEED 30\nVI[2]=0\n"
                          "10 MOVE (1000.,1000.,-400.,0.,1.570796)\n"
                          "MOVE (1100.,1000.,-400.,1.,1.570796)\n"
                          "VI[2]=VI[2]+1\nIF (VI[2]<3) THEN 10\n");
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.Finding(7321).detail,
            "axis X allows 125.000 mm/s of 150.000; reached 125.000 mm/s");
  EXPECT_EQ(ran.Finding(7321).severity, Severity::kAdvice);
  EXPECT_EQ(std::ranges::count(StepsOf(ran, 7321), ran.Finding(7321).step), 1);
}

// OPT-2.16: a little is told, too; rounding is not: 100 mm/s along X.
TEST(Travel, AnAxisThatHoldsALittleBackIsTold) {
  const auto told = [](const std::string& speed_of_x) {
    return RunText(kAbsol + "SPEED 20\nMOVE (521.02,2201.2,-350.,0.,0.)\n",
                   {.parameters = {{"AXIS_SPEED_X", speed_of_x}}})
        .Count("E7321");
  };
  EXPECT_EQ(told("99.99"), 1);
  EXPECT_EQ(told("99.99999"), 0);
  EXPECT_EQ(told("100"), 0);
}

// motion.md 5.1: neither a small radius nor a short way is an axis.
TEST(Travel, ARadiusIsNoAxis) {
  const Ran ran =
      RunText(std::string(kAbsol) +
              "SPEED 100\nMOVE (1000.,1000.,-400.,0.,0.)\nMOVE (1001.,1000.,-400.,0.,0.)\n"
              "PATH CIR\nMOVE (1003.,1000.,-400.,0.,0.)/VIA (1002.,1001.,-400.,0.,0.)\n");
  EXPECT_FALSE(ran.Told("E7321"));
}

// OPT-2.49: a chain that never began to move tells at the end of the steps what it would have done;
// when the time runs out, what would have come later is not told.
TEST(Travel, OnlyTheEndOfTheStepsTellsWhatWouldCome) {
  const Ran steps = RunText(kAbsol +
                                "10 MOVE (1000.,1000.,-400.,0.,0.)/FLY\n"
                                "MOVE (3700.,1000.,-400.,0.,0.)/FLY\nGOTO 10\n",
                            {.budget = {.steps = 5}, .forecast = true});
  EXPECT_EQ(CodeOf(steps), 7901);
  EXPECT_TRUE(steps.parts.empty());
  ASSERT_EQ(steps.violations.size(), 1U);
  EXPECT_EQ(steps.violations[0].place.step, 4);
  EXPECT_NEAR(steps.violations[0].excess, 100.0, 1e-3);
  const Ran time = RunText(kAbsol +
                               "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/FLY\n"
                               "MOVE (3700.,2201.2,-350.,0.,0.)\n",
                           {.budget = {.virtual_time = At(1.0)}, .forecast = true});
  EXPECT_EQ(CodeOf(time), 7902);
  EXPECT_EQ(time.parts.size(), 1U);
  EXPECT_TRUE(time.violations.empty());
}

// OPT-2.49, OPT-2.59: a hole round (3580,1000) whose circle leaves the travel and whose lead, up to
// (3530,1000), does not. A MOVE that takes over on the lead drops the circle: it is none of what
// would have come when the steps run out.
TEST(Travel, WhatWasDroppedIsNotToldAtTheEndOfTheSteps) {
  const std::string hole = kAbsol +
                           "MOVE (3000.,1000.,-400.,0.,0.)\nPATH HOLE (50.)\n"
                           "MOVE (3580.,1000.,-400.,0.,0.)/VIA (3580.,1000.,-300.,0.,0.)/NEXT\n";
  EXPECT_EQ(RunText(hole, {.forecast = true}).violations.size(), 1U);
  const Ran ran = RunText(hole + "PATH LIN\nMOVE (3000.,1000.,-400.,0.,0.)\n20 GOTO 20\n",
                          {.budget = {.steps = 100}, .forecast = true});
  EXPECT_EQ(CodeOf(ran), 7901);
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_LT(ran.moves[1].tip.tip.x(), 3530.0);
  EXPECT_NEAR(ran.end.axes.column.x(), 3000.0, 1e-6);
  EXPECT_TRUE(ran.violations.empty());
}

}  // namespace
}  // namespace rmlcell::optimo::testing
