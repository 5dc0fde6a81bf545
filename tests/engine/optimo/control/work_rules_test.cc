#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/engine/optimo/control/run_text.h"

// WORK step by step: which process, which power, what goes on beside the program, and when.
// OPT-3.13 to 3.44
namespace rmlcell::optimo::testing::work_rules {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;

std::vector<std::string> Told(const Ran& ran) {
  std::vector<std::string> told = ran.told;
  std::erase_if(told, [](const std::string& what) { return what.starts_with("compiling"); });
  return told;
}

machine::InputChange Input(double at_s, int index, double value) {
  return {At(at_s), InputKind::kLogical, index, value};
}

// OPT-3.37: each process from 0 to 7 has its flag, whatever its kind, and only that; OFF of another
// kind with the same number leaves it.
TEST(WorkRules, FlagsOfAllProcesses) {
  for (int p = 0; p <= 7; ++p) {
    const std::string n = std::to_string(p);
    for (const std::string& definition :
         {"WORKDEF 0," + n + "\nWORK 0,", "WORKDEF 1," + n + " (5.,80.,0.,90.)\nWORK 1,",
          "WORKDEF 2," + n + " (15)\nWORK 2,"}) {
      const Ran ran = RunText(definition + n + "/ON\nVL[0]=IL[" + std::to_string(87 + p) +
                                  "]\nVL[1]=IL[" + std::to_string(p == 0 ? 94 : 86 + p) + "]\n",
                              {.variables = {"VL[0]", "VL[1]"}});
      EXPECT_EQ(ran.variables.at("VL[0]") + ran.variables.at("VL[1]"), "10") << definition;
      EXPECT_EQ(ran.Count("E7408"), 1) << definition;
    }
  }
  EXPECT_EQ(
      Value(
          "WORKDEF 2,0 (15)\nWORK 2,0/ON\nWORK 0,0/ON\nWORK 2,0/OFF\nVL[0]=IL[87]\nWORK 0,0/OFF\n",
          "VL[0]"),
      "1");
}

// OPT-3.15: on an EFA-51 shutter and beam are one: whatever takes the beam closes it, and its
// return opens it.
TEST(WorkRules, TheShutterOfAnEfa51) {
  RunOptions efa{.inputs = {{At(1.0), InputKind::kStop}, {At(3.0), InputKind::kStart}},
                 .parameters = {{"LASER", "EFA51"}}};
  EXPECT_THAT(Told(RunText("WORK 0,0/ON\nDELAY 2\nWORK 0,0/OFF\n", efa)),
              ElementsAre("shutter open", "beam on 100.0", "wait dwell 1.0", "beam off",
                          "shutter closed", "halt STOP", "wait operator 2.0", "shutter open",
                          "beam on 100.0", "wait dwell 1.0", "beam off", "shutter closed"));
  EXPECT_THAT(Told(RunText("ERR 9\nWORK 0,0/ON\nVR[0]=1/0\n9 DELAY 1\n",
                           {.parameters = {{"LASER", "EFA51"}}})),
              ElementsAre("shutter open", "beam on 100.0", "beam off", "shutter closed", "E7201",
                          "wait dwell 1.0"));
}

// OPT-3.42, OPT-E.7406: OL[2] and OL[12] to OL[15] block the ramp of an EFA-51, their neighbours
// and WORK 0 do not; no channel does on an ARROW.
TEST(WorkRules, EachModulationOutputBlocksTheRamp) {
  const auto code = [](int output, const std::string& work, const std::string& laser) {
    return CodeOf(
        RunText("WORKDEF 1,0 (8.,75.,0.,50.)\nOL[" + std::to_string(output) + "]=ON\n" + work,
                {.parameters = {{"LASER", laser}}}));
  };
  const std::string ramp = "WORK 1,0/ON\nWORK 1,0/OFF\n";
  for (const int output : {2, 12, 13, 14, 15}) {
    EXPECT_EQ(code(output, ramp, "EFA51"), 7406) << output;
    EXPECT_EQ(code(output, "WORK 0,0/ON\nWORK 0,0/OFF\n", "EFA51"), 0) << output;
    EXPECT_EQ(code(output, ramp, "ARROW"), 0) << output;
  }
  for (const int output : {1, 3, 10, 11, 16}) EXPECT_EQ(code(output, ramp, "EFA51"), 0) << output;
}

// OPT-3.20, OPT-3.26: WORK 0 has the power of the schedule that is active, 100 % without one.
TEST(WorkRules, ThePowerOfTheSchedule) {
  const std::vector<machine::LaserSchedule> schedules{{.number = 11, .power_percent = 40.0},
                                                      {.number = 12, .power_percent = 60.0}};
  const RunOptions options{.schedules = schedules};
  EXPECT_TRUE(RunText("WORK 0,0/ON\nWORK 0,0/OFF\n", options).Told("beam on 100.0"));
  EXPECT_TRUE(
      RunText("WORKDEF 2,0 (12)\nWORK 2,0/ON\nWORK 0,0/ON\nWORK 0,0/OFF\nWORK 2,0/OFF\n", options)
          .Told("beam on 60.0"));
  EXPECT_TRUE(
      RunText("WORKDEF 2,0 (11)\nWORK 2,0/ON\nWORK 0,0/ON\nWORK 0,0/OFF\nWORK 2,0/OFF\n", options)
          .Told("beam on 40.0"));
}

// OPT-3.26: a schedule that is selected already is not selected again.
TEST(WorkRules, AScheduleIsSelectedOnce) {
  const std::string work = "WORK 2,0/ON\nWORK 2,0/OFF\n";
  EXPECT_EQ(RunText("WORKDEF 2,0 (12)\n" + work + work).Count("schedule 12"), 1);
}

// OPT-2.48, OPT-3.21: between /FLY moves WORK 1 comes on at the passage, unless it has to dwell.
TEST(WorkRules, OnlyADwellCancelsAPassage) {
  const auto cancelled = [](const std::string& delay) {
    return RunText("WORKDEF 1,0 (10.,60.," + delay + ",95.)\n" + kThere +
                   "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nWORK 1,0/ON\n"
                   "MOVE (1100.,1100.,-400.,0.,0.)\nWORK 1,0/OFF\n")
        .Count("E7304");
  };
  EXPECT_TRUE(RunText("WORKDEF 1,0 (10.,60.,.001,95.)\nWORK 1,0/ON\nWORK 1,0/OFF\n")
                  .Told("wait pierce 0.001"));
  EXPECT_EQ(cancelled("0."), 0);
  EXPECT_EQ(cancelled("0.001"), 1);
}

// OPT-3.24, OPT-E.7411: the warning is for a beam that a WORK 0 or 1 wants, and that is on.
TEST(WorkRules, WhenScheduleOffIsWarnedOf) {
  const std::string definitions = "WORKDEF 2,5 (15)\nWORKDEF 1,1 (8.,75.,0.,50.)\n";
  EXPECT_EQ(RunText(definitions + "WORK 0,0/ON\nWORK 2,5/OFF\nWORK 0,0/OFF\n").Count("E7411"), 1);
  EXPECT_EQ(RunText(definitions + "WORK 1,1/ON\nWORK 2,5/OFF\nWORK 1,1/OFF\n").Count("E7411"), 1);
  EXPECT_EQ(RunText(definitions + "WORK 2,5/ON\nWORK 2,5/OFF\n").Count("E7411"), 0);
  EXPECT_EQ(RunText(definitions + "WORK 0,0/ON\nWORK 2,5/OFF\nWORK 2,5/OFF\nWORK 0,0/OFF\n")
                .Count("E7411"),
            1);
}

// OPT-3.33, OPT-E.7407: any process holds GO and CALL back, also one of kind 2 or with number 9.
TEST(WorkRules, AnyProcessHoldsACallBack) {
  const RunOptions options{.programs = {{2, "VI[2]=1\n"}}, .variables = {"VI[2]"}};
  for (const std::string work : {"WORKDEF 2,9 (15)\nWORK 2,9/ON\n", "WORKDEF 0,9\nWORK 0,9/ON\n",
                                 "WORKDEF 1,0 (8.,75.,0.,50.)\nWORK 1,0/ON\n"}) {
    for (const std::string word : {"CALL 2\n", "GO 2\n"}) {
      const Ran ran = RunText(work + word, options);
      EXPECT_EQ(CodeOf(ran), 7407) << work << word;
      EXPECT_EQ(ran.variables.at("VI[2]"), "0");
    }
  }
}

// OPT-3.12, OPT-3.35: WORKDEFs are not passed to a CALLed program, and come back with the caller;
// the shutter stays as it is over the CALL, and closes at GO.
TEST(WorkRules, DefinitionsAndShutterOverCalls) {
  const std::string define = "WORKDEF 1,0 (8.,75.,0.,50.)\n";
  EXPECT_EQ(CodeOf(RunText(define + "CALL 50\n", {.programs = {{50, "WORK 1,0/ON\n"}}})), 7401);
  const Ran ran =
      RunText(define + "WORK 1,0/ON\nWORK 1,0/OFF\nCALL 50\nWORK 1,0/ON\nWORK 1,0/OFF\n",
              {.programs = {{50, "WORKDEF 1,1 (8.,75.,0.,50.)\nDELAY 1\n"}}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.Count("shutter open"), 1);
  EXPECT_EQ(ran.Count("shutter closed"), 1);
  EXPECT_EQ(CodeOf(RunText("CALL 50\nWORK 1,1/ON\n",
                           {.programs = {{50, "WORKDEF 1,1 (8.,75.,0.,50.)\n"}}})),
            7401);
  const Ran go = RunText("WORK 0,0/ON\nWORK 0,0/OFF\nGO 50\n", {.programs = {{50, "DELAY 1\n"}}});
  EXPECT_NEAR(go.First("shutter closed").at_s, 0.0, 1e-9);
}

// OPT-3.11: a process keeps the values that it was turned ON with until the next ON.
TEST(WorkRules, ANewDefinitionIsForTheNextOn) {
  const Ran ran = RunText(
      kThere +
      "WORKDEF 1,0 (10.,60.,0.,50.)\nWORK 1,0/ON\nWORKDEF 1,0 (10.,30.,0.,50.)\n"
      "MOVE (1100.,1000.,-400.,0.,0.)\nWORK 1,0/ON\nMOVE (1200.,1000.,-400.,0.,0.)\nWORK 1,0/OFF\n");
  ASSERT_EQ(ran.parts.size(), 3U);
  EXPECT_NEAR(ran.parts[1].PowerAt(1.0), 60.0, 1e-9);
  EXPECT_NEAR(ran.parts[2].PowerAt(1.0), 30.0, 1e-9);
}

// OPT-3.38, OPT-B.30: /START with /NEXT is looked at with each input and each CYCLE, here for a
// variable that the program sets: 1 s is over at 21 cycles.
TEST(WorkRules, AConditionInTheBackgroundSeesVariables) {
  const Ran ran = RunText(
      "VL[3]=OFF\nWORK 0,0/ON/START (VL[3])/NEXT\nDELAY 1\nVL[3]=ON\nDELAY 1\nWORK 0,0/OFF\n");
  EXPECT_NEAR(ran.First("beam on 100.0").at_s, 21 * 0.048, 1e-9);
  EXPECT_EQ(ran.First("beam on 100.0").step, 2);
  const Ran off = RunText("VL[3]=OFF\nWORK 0,0/ON/END (VL[3])\nDELAY 1\nVL[3]=ON\nDELAY 1\n");
  EXPECT_NEAR(off.First("beam off").at_s, 21 * 0.048, 1e-9);
}

// OPT-3.38: one that is true at once switches at once; the time of its own clock begins with the
// instruction.
TEST(WorkRules, ConditionsThatAreTrueAtOnce) {
  const Ran start = RunText("DELAY .01\nWORK 0,0/ON/START (1 > 0)/NEXT\nDELAY 1\nWORK 0,0/OFF\n");
  EXPECT_NEAR(start.First("beam on 100.0").at_s, 0.01, 1e-9);
  // /END is looked at for the first time one CYCLE behind the WORK.
  const Ran end = RunText("DELAY .01\nWORK 0,0/ON/END (1 > 0)\nDELAY 1\n");
  EXPECT_NEAR(end.First("beam off").at_s, 0.058, 1e-9);
}

// OPT-3.38: an OFF may wait for its /START as well.
TEST(WorkRules, OffMayWaitToo) {
  const Ran ran = RunText("WORK 0,0/ON\nWORK 0,0/OFF/START (IL[20])/NEXT\nDELAY 2\n",
                          {.inputs = {Input(1.25, 20, 1.0)}});
  EXPECT_NEAR(ran.First("beam off").at_s, 1.25, 1e-9);
  EXPECT_EQ(ran.Count("E7408"), 0);
}

// OPT-3.38, OPT-3.11: a WORK of the same process takes the place of the one that waits; of another
// process it does not.
TEST(WorkRules, ANewWorkOfTheSameProcessReplacesTheOneThatWaits) {
  const machine::InputScript script{Input(1.0, 20, 1.0)};
  const std::string waits = "WORKDEF 0,1\nWORK 0,1/ON/START (IL[20])/NEXT\n";
  const Ran replaced = RunText(waits + "WORK 0,1/OFF\nDELAY 2\n", {.inputs = script});
  EXPECT_EQ(replaced.Count("beam on 100.0"), 0);
  const Ran stays = RunText(waits + "WORK 0,0/OFF\nDELAY 2\nWORK 0,1/OFF\n", {.inputs = script});
  EXPECT_NEAR(stays.First("beam on 100.0").at_s, 1.0, 1e-9);
  const Ran other_kind = RunText(
      "WORKDEF 2,1 (15)\n" + waits + "WORK 2,1/OFF\nDELAY 2\nWORK 0,1/OFF\n", {.inputs = script});
  EXPECT_NEAR(other_kind.First("beam on 100.0").at_s, 1.0, 1e-9);
}

// OPT-3.38, OPT-3.32: a dwell in the background is over when another WORK 0 or 1, or WORK 2 OFF,
// has decided about the beam.
TEST(WorkRules, ADwellEndsWithTheBeam) {
  const std::string dwell = "WORKDEF 1,0 (10.,60.,1.5,95.)\nWORKDEF 2,0 (15)\nWORKDEF 2,1 (16)\n" +
                            kThere + "WORK 1,0/ON/NEXT\n";
  const std::string move = "MOVE (1200.,1000.,-400.,0.,0.)\nWORK 1,0/OFF\nWORK 0,0/OFF\n";
  const auto power = [&](const std::string& between, double at_s) {
    const Ran ran = RunText(dwell + between + move);
    double t = ToSeconds(ran.parts[1].done.start) + at_s;
    for (const Ran::Part& part : ran.parts) {
      if (ToSeconds(part.done.start) <= t && t < ToSeconds(part.done.end))
        return part.PowerAt(t - ToSeconds(part.done.start));
    }
    return -1.0;
  };
  EXPECT_NEAR(power("", 1.0), 95.0, 1e-9);
  EXPECT_NEAR(power("", 2.0), 60.0, 1e-9);  // the ramp at 50 mm/s
  EXPECT_NEAR(power("WORK 0,0/ON\n", 1.0), 100.0, 1e-9);
  EXPECT_NEAR(power("WORK 0,0/ON\n", 2.0), 100.0, 1e-9);
  EXPECT_NEAR(power("WORK 2,0/OFF\n", 2.0), 0.0, 1e-9);
  EXPECT_NEAR(power("WORK 2,1/ON\n", 1.0), 95.0, 1e-9);  // a schedule leaves the dwell alone
  EXPECT_NEAR(power("WORK 2,1/ON\n", 2.0), 60.0, 1e-9);
}

// OPT-3.38, OPT-3.45: a DELAY beside which the beam comes on is told in two parts: without it, and
// with it.
TEST(WorkRules, ADelayBesideAWorkThatBegins) {
  const Ran ran = RunText("WORK 0,0/ON/START (IL[20])/NEXT\nDELAY 4\nWORK 0,0/OFF\n",
                          {.inputs = {Input(1.0, 20, 1.0)}});
  ASSERT_EQ(ran.waits.size(), 2U);
  EXPECT_FALSE(ran.waits[0].beam_on);
  EXPECT_EQ(ran.waits[0].power_percent, 0.0);
  EXPECT_NEAR(ToSeconds(ran.waits[0].end), 1.0, 1e-9);
  EXPECT_TRUE(ran.waits[1].beam_on);
  EXPECT_EQ(ran.waits[1].power_percent, 100.0);
  EXPECT_EQ(ran.waits[1].start, ran.waits[0].end);
  EXPECT_NEAR(ToSeconds(ran.waits[1].end), 4.0, 1e-9);
}

// OPT-3.38: what goes on beside a program ends with it, and stands still while a CALLed one runs.
TEST(WorkRules, BackgroundWorkBelongsToItsProgram) {
  const Ran ended = RunText(
      "CALL 45\nDELAY 2\n",
      {.programs = {{45, "WORK 0,0/ON/START (IL[20])/NEXT\n"}}, .inputs = {Input(1.0, 20, 1.0)}});
  EXPECT_EQ(ended.Count("beam on 100.0"), 0);
  const Ran waits = RunText("WORK 0,0/ON/START (IL[20])/NEXT\nCALL 45\nDELAY 1\nWORK 0,0/OFF\n",
                            {.programs = {{45, "DELAY 2\n"}}, .inputs = {Input(1.0, 20, 1.0)}});
  EXPECT_GE(waits.First("beam on 100.0").at_s, 2.0);
  EXPECT_LE(waits.First("beam on 100.0").at_s, 2.0 + 0.048);
}

// OPT-3.38, OPT-3.53: an error of a condition in the background is one of the WORK, and is caught.
TEST(WorkRules, AnErrorOfABackgroundCondition) {
  const std::string text =
      "VI[5]=1\nWORK 0,0/ON/END (1/VI[5] > 2)\nVI[5]=0\nDELAY 1\nENDTASK\n900 VI[2]=VI[99]\n";
  const Ran ran = RunText(text);
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.outcome.place.step, 2);
  EXPECT_NEAR(ran.time_s, 0.048, 1e-9);
  EXPECT_EQ(Value("ERR 900\n" + text, "VI[2]"), "7201");
}

// OPT-3.38, OPT-B.34: a STOP holds the dwell in the background up: the rest of it comes with START.
TEST(WorkRules, AStopHoldsABackgroundDwellUp) {
  const Ran ran = RunText("WORKDEF 1,0 (10.,60.,2.,95.)\nWORK 1,0/ON/NEXT\nDELAY 6\nWORK 1,0/OFF\n",
                          {.inputs = {{At(1.0), InputKind::kStop}, {At(4.0), InputKind::kStart}}});
  // Of the DELAY: 1 s at peak, the halt, 1 s at peak, and the rest at the power of standstill.
  ASSERT_EQ(ran.waits.size(), 4U);
  EXPECT_NEAR(ToSeconds(ran.waits[2].end), 5.0, 1e-9);
  EXPECT_EQ(ran.waits[0].power_percent, 95.0);
  EXPECT_EQ(ran.waits[2].power_percent, 95.0);
  EXPECT_EQ(ran.waits[3].power_percent, 0.0);
  EXPECT_NEAR(ran.time_s, 9.0, 1e-9);
}

// OPT-3.19, OPT-E.7410: with the door open no WORK 0 or 1 comes on, also one from the background; a
// schedule may be selected.
TEST(WorkRules, BehindAnOpenDoor) {
  const machine::InputScript open{{SimTime(0), InputKind::kDoor, 0, 1.0},
                                  {At(1.0), InputKind::kStart}};
  EXPECT_EQ(
      CodeOf(RunText("DELAY 1\nWORKDEF 1,0 (8.,75.,0.,50.)\nWORK 1,0/ON\n", {.inputs = open})),
      7410);
  EXPECT_EQ(
      CodeOf(RunText("DELAY 1\nWORKDEF 2,0 (15)\nWORK 2,0/ON\nWORK 2,0/OFF\n", {.inputs = open})),
      0);
}

// OPT-3.17, OPT-B.56: START with the door open is an alarm when the beam would return or the
// shutter would open again, and the door closed afterwards helps no more; else the program goes on.
TEST(WorkRules, StartWithTheDoorOpen) {
  const machine::InputScript script{{At(1.0), InputKind::kDoor, 0, 1.0},
                                    {At(2.0), InputKind::kStart},
                                    {At(3.0), InputKind::kDoor, 0, 0.0},
                                    {At(4.0), InputKind::kStart}};
  EXPECT_NEAR(RunText("DELAY 2\n", {.inputs = script}).time_s, 3.0, 1e-9);
  for (const char* text : {"WORK 0,0/ON\nDELAY 2\n", "WORK 0,0/ON\nWORK 0,0/OFF\nDELAY 2\n"}) {
    const Ran ran = RunText(text, {.inputs = script});
    EXPECT_EQ(CodeOf(ran), 7410) << text;
    EXPECT_EQ(ran.Count("E7410"), 1) << text;
    EXPECT_EQ(ran.Count("shutter open"), 1) << text;
    EXPECT_EQ(ran.Count("wait dwell 1.0"), 1) << text;  // time stood still for it since
    EXPECT_NEAR(ran.time_s, 2.0, 1e-9) << text;
  }
}

// OPT-3.38, OPT-B.30: what a step changes is seen at the next CYCLE, also where the program waits
// behind it: 1 s is over at 21 cycles. A plain step and one that switches an output.
TEST(WorkRules, AConditionInTheBackgroundSeesTheStepBeforeAWait) {
  for (const std::string variable : {"VL[3]", "OL[16]"}) {
    const Ran ran = RunText("WORK 0,0/ON/START (" + variable + ")/NEXT\nDELAY 1\n" + variable +
                                "=ON\nWAIT IL[21]\nWORK 0,0/OFF\n",
                            {.inputs = {Input(3.0, 21, 1.0)}});
    EXPECT_NEAR(ran.First("beam on 100.0").at_s, 21 * 0.048, 1e-9) << variable;
  }
}

// OPT-3.38, OPT-7.68: the end of a motion is seen, too: 100 mm at 50 mm/s are over after 2.0707 s,
// the tick behind that is 2.112 s. What the DELAY waits is told from the end of the motion on.
TEST(WorkRules, AConditionInTheBackgroundSeesTheEndOfAMotion) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)/NEXT\n"
      "WORK 0,0/ON/END (NOT IL[95])\nDELAY 9\n",
      {.parameters = {{"SETTLE", "0"}}});
  EXPECT_NEAR(ran.First("beam off").at_s, 44 * 0.048, 1e-9);
  EXPECT_EQ(ran.Count("E7408"), 0);
  ASSERT_FALSE(ran.waits.empty());
  EXPECT_NEAR(ToSeconds(ran.waits.front().start), 2.0707107, 1e-5);
}

// OPT-3.22, OPT-3.26: schedule 1 is one like any other; a WORK whose WORKDEF names none leaves the
// one that is selected.
TEST(WorkRules, AScheduleIsSelectedWhereOneIsNamed) {
  const Ran named = RunText(
      "WORKDEF 2,0 (1)\nWORKDEF 1,0 (8.,75.,0.,50.)\nWORK 2,0/ON\nWORK 1,0/ON\nWORK 1,0/OFF\n"
      "WORK 0,0/ON\nWORK 0,0/OFF\nWORK 2,0/OFF\n");
  EXPECT_EQ(named.Count("schedule 1"), 1);
  EXPECT_EQ(named.Count("schedule 0"), 0);
  EXPECT_TRUE(
      RunText("WORKDEF 1,0 (8.,75.,0.,50.,1)\nWORK 1,0/ON\nWORK 1,0/OFF\n").Told("schedule 1"));
  // OPT-3.43: on an EFA-51 it is refused like the others.
  EXPECT_EQ(CodeOf(RunText("WORKDEF 1,0 (8.,75.,0.,50.,1)\nWORK 1,0/ON\n", {.profile = "efa-51"})),
            7405);
}

// OPT-6.26: the end of a dry run selects the schedule that was asked for, and only then one.
TEST(WorkRules, AScheduleOfADryRun) {
  const auto until = [](int step) { return machine::ProgramStep{.program = 1, .step = step}; };
  const std::string select = "WORKDEF 2,0 (1)\nWORK 2,0/ON\n";
  EXPECT_TRUE(RunText(select + "VI[2]=1\n", {.simul = until(3)}).Told("schedule 1"));
  const Ran first = RunText("WORKDEF 2,0 (12)\nWORK 2,0/ON\nWORK 2,0/OFF\n");
  const Ran none =
      RunText("VI[2]=1\nVI[2]=2\n", {.simul = until(2), .machine_state = first.machine_state});
  EXPECT_EQ(none.Count("schedule 0"), 0);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::work_rules
