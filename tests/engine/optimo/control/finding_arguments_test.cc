#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/optimo/control/run_text.h"

// What errors and warnings of a run know besides their texts.
namespace rmlcell::optimo::testing {
namespace {

struct OutcomeRow {
  std::string program;
  int code;
  std::string detail;
  std::string arguments;
};

void ExpectOutcomes(const std::vector<OutcomeRow>& rows) {
  for (const OutcomeRow& row : rows) {
    const Ran ran = RunText(row.program);
    EXPECT_EQ(CodeOf(ran), row.code) << row.program;
    EXPECT_EQ(ran.outcome.detail, row.detail);
    EXPECT_EQ(ArgumentsText(ran.outcome.detail), row.arguments) << row.program;
    EXPECT_EQ(ArgumentsText(ran.Finding(row.code).detail), row.arguments) << row.program;
  }
}

TEST(RunArguments, NumbersOfInstructionsHaveTheirUnits) {
  ExpectOutcomes({
      {"VR[1] = 120\nSPEED VR[1]\n", 7205, "SPEED is 120, allowed are 0 to 100",
       "instruction='SPEED' value=120 %"},
      {"VR[1] = -1.5\nDELAY VR[1]\n", 7205, "DELAY is -1.5", "time=-1.5 s"},
      {"VR[1] = -2\nTIMER (VR[1], 10)\n10 ENDTASK\n", 7205, "TIMER is -2", "time=-2 s"},
      {"VR[1] = 120\nWORKDEF 1,1,(10,VR[1],1,50)\n", 7205, "power of WORKDEF is 120",
       "power=120 %"},
      {"VR[1] = 64\nWORKDEF 2,1,(VR[1])\n", 7403, "laser schedule is 64", "schedule=64"},
      {kAbsol + "PATH HOLE (0)\nMOVE (1000.,1000.,-400.,0.,0.)\n", 348, "radius is 0",
       "radius=0 mm"},
      {kThere + "SPEED 0\nMOVE (1000.5,1000.,-400.,0.,0.)\n", 7307, "SPEED is 0", ""},
      {kThere + "ACCEL 0\nMOVE (1000.5,1000.,-400.,0.,0.)\n", 7307, "ACCEL is below 0.1", ""},
  });
}

TEST(RunArguments, PlacesInPrograms) {
  ExpectOutcomes({
      {"GOTO 60\n", 60, "no sequence number 60", "label=60"},
      {"CALL 7\n", 7102, "program 7", "program=7"},
      {"VI[1] = 300\nASSIGN OL[40] = VI[1] / 4\n", 7206, "300 into 4 places from OL[40]",
       "value=300 places=4 variable='OL[40]'"},
      {"WORK 1,3/ON\n", 7401, "WORK 1,3 has no WORKDEF", "kind=1 process=3"},
  });
}

// X ends at 3600 mm and A at 12.6 rad.
TEST(RunArguments, AxesThatLeaveTheirTravelSayByHowMuch) {
  const Ran ran = RunText("COORD ROBOT\nMOVE (9000.,2201.2,-50.,13.,0.)\n");
  EXPECT_EQ(ran.outcome.detail,
            "X of the target leaves its travel by 5400.000 mm, A of the target by 0.400 rad");
  EXPECT_EQ(ArgumentsText(ran.outcome.detail), "axis='X' excess=5400 mm axis='A' excess=0.4 rad");
  const Ran forecast =
      RunText("COORD ROBOT\nMOVE (9000.,2201.2,-50.,0.,0.)\nMOVE (9100.,2201.2,-50.,0.,0.)\n",
              {.forecast = true});
  EXPECT_EQ(
      forecast.outcome.detail,
      "2 motions leave the travel; the first: X of the target leaves its travel by 5400.000 mm");
  EXPECT_EQ(ArgumentsText(forecast.outcome.detail), "count=2 axis='X' excess=5400 mm");
}

// B turns by 1 rad on a way of 10 mm and makes at most 0.5 rad/s: 5 mm/s of SPEED 10.
TEST(RunArguments, AnAxisThatHoldsAContourSaysAtWhatSpeed) {
  const Ran ran = RunText(kThere + "MOVE (1010.,1000.,-400.,0.,1.)\n",
                          {.parameters = {{"AXIS_SPEED_B", "0.5"}}});
  const Detail& detail = ran.Finding(7321).detail;
  EXPECT_EQ(detail.arguments()[0], (Argument{"axis", std::string("B"), ""}));
  EXPECT_EQ(detail.arguments()[1].name, "limit");
  EXPECT_EQ(detail.arguments()[1].unit, "mm/s");
  EXPECT_NEAR(std::get<double>(detail.arguments()[1].value), 5.0, 1e-3);
  EXPECT_EQ(detail.arguments()[2], (Argument{"feed_rate", 50.0, "mm/s"}));
  EXPECT_EQ(detail.arguments()[3].name, "speed");
  EXPECT_EQ(detail.arguments().size(), 4U);
}

TEST(RunArguments, BudgetsSayWhatTheyAre) {
  const Ran waits = RunText("10 DELAY 1\nGOTO 10\n",
                            {.budget = {.steps = 1000, .virtual_time = std::chrono::seconds(5)}});
  EXPECT_EQ(waits.outcome.detail, "the run takes longer than 5.0 s");
  EXPECT_EQ(ArgumentsText(waits.outcome.detail), "limit=5 s");
  const Ran turns =
      RunText("10 GOTO 10\n", {.budget = {.steps = 8, .virtual_time = std::chrono::seconds(5)}});
  EXPECT_EQ(turns.outcome.detail, "8 steps were executed");
  EXPECT_EQ(ArgumentsText(turns.outcome.detail), "steps=8");
}

TEST(RunArguments, ParametersThatDoNotFitAreNamedWithTheirUnits) {
  const auto made = machine::MakeParameters(OptimoFamily(), "", {{"TRAVEL_X_MIN", "4000"}});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().detail, "TRAVEL_X_MIN is 4000, above TRAVEL_X_MAX, which is 3600");
  EXPECT_EQ(ArgumentsText(made.error().detail),
            "name='TRAVEL_X_MIN' value=4000 mm limit_name='TRAVEL_X_MAX' limit=3600 mm");
}

}  // namespace
}  // namespace rmlcell::optimo::testing
