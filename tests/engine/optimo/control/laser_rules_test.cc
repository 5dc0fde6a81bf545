#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// WORKDEF, WORK, shutter, power and gas while a program runs.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using ::testing::ElementsAre;
using ::testing::StartsWith;

const machine::InputChange kDoorOpensAtOnce{SimTime(0), InputKind::kDoor, 0, 1.0};

// What was told without compiling.
std::vector<std::string> Told(const Ran& ran) {
  std::vector<std::string> told = ran.told;
  std::erase_if(told, [](const std::string& what) { return what.starts_with("compiling"); });
  return told;
}

// OPT-3.16, OPT-3.28: the shutter opens with the beam and closes when the last step is over.
TEST(LaserRules, ShutterClosesAtTheEnd) {
  const Ran ran = RunText(
      kThere +
      "WORKDEF 0,0\nWORK 0,0 / ON\nMOVE (1100.,1000.,-400.,0.,0.)\nWORK 0,0 / OFF\nDELAY 1\n");
  EXPECT_THAT(Told(ran), ElementsAre("shutter open", "beam on 100.0", "beam off", "wait dwell 1.0",
                                     "shutter closed"));
  EXPECT_NEAR(ran.First("shutter closed").at_s, ran.time_s, 1e-9);
  EXPECT_NEAR(ran.BeamOnLength(), 100.0, 1e-6);
}

// OPT-3.17, OPT-3.62: the door opened while halted closes the shutter; START with the door closed
// again first opens the shutter, then the beam comes back.
TEST(LaserRules, TheDoorClosesTheShutter) {
  const Ran ran = RunText(kThere + "WORK 0,0/ON\nMOVE (1500.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\n",
                          {.inputs = {{At(6.0), InputKind::kStop},
                                      {At(7.0), InputKind::kDoor, 0, 1.0},
                                      {At(9.0), InputKind::kDoor, 0, 0.0},
                                      {At(10.0), InputKind::kStart}}});
  EXPECT_THAT(Told(ran), ElementsAre("shutter open", "beam on 100.0", "beam off", "halt STOP",
                                     "shutter closed", StartsWith("wait operator"), "shutter open",
                                     "beam on 100.0", "beam off", "shutter closed"));
  EXPECT_NEAR(ran.First("shutter closed").at_s, 7.0, 1e-9);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(ran.BeamOnLength(), 500.0, 3.0);  // less the ramp to rest, which is without beam
}

// OPT-3.17, OPT-B.56, OPT-E.7410: START with the door open, the beam to come back, is an alarm: it
// ends the run at the step that was halted, no ERR catches it, and nothing opens.
TEST(LaserRules, StartWithTheDoorOpenEndsTheRun) {
  const Ran ran = RunText("ERR 900\n" + kThere +
                              "WORK 0,0/ON\nMOVE (1500.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\nENDTASK\n"
                              "900 VI[2]=1\n",
                          {.inputs = {{At(6.0), InputKind::kStop},
                                      {At(7.0), InputKind::kDoor, 0, 1.0},
                                      {At(8.0), InputKind::kStart},
                                      {At(9.0), InputKind::kDoor, 0, 0.0},
                                      {At(10.0), InputKind::kStart}},
                           .variables = {"VI[2]", "VI[99]"}});
  EXPECT_THAT(Told(ran), ElementsAre("shutter open", "beam on 100.0", "beam off", "halt STOP",
                                     "shutter closed", "E7410", StartsWith("wait operator")));
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(CodeOf(ran), 7410);
  EXPECT_EQ(ran.outcome.place.step, 7);
  EXPECT_NEAR(ran.time_s, 8.0, 1e-9);
  EXPECT_EQ(ran.Finding(7410).severity, Severity::kAlarm);
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  EXPECT_EQ(ran.variables.at("VI[99]"), "7410");
}

// OPT-E.7410: without a beam to come back START goes on behind an open door.
TEST(LaserRules, StartWithTheDoorOpenAndNoBeamGoesOn) {
  const Ran ran = RunText(
      "DELAY 5\n", {.inputs = {{At(1.0), InputKind::kDoor, 0, 1.0}, {At(2.0), InputKind::kStart}}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(ran.time_s, 6.0, 1e-9);
}

// OPT-3.18, OPT-B.55: an error that is not caught switches the beam off and closes the shutter, at
// its step.
TEST(LaserRules, AnErrorSwitchesTheBeamOff) {
  const Ran ran =
      RunText("WORK 0,0/ON\nVR[0]=5.\nVI[2]=1\nDELAY 1\nVR[0]=1/0\n", {.variables = {"VR[0]"}});
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.First("beam off").step, 5);
  EXPECT_EQ(ran.First("shutter closed").step, 5);
  EXPECT_EQ(ran.variables.at("VR[0]"), "5.0");
  EXPECT_EQ(ran.outcome.place.step, 5);
}

// OPT-3.19: with the door open WORK ON is an alarm, and nothing opens.
TEST(LaserRules, TheShutterDoesNotOpenBehindAnOpenDoor) {
  const Ran ran = RunText("DELAY 1\nWORK 0,0/ON\n",
                          {.inputs = {kDoorOpensAtOnce, {At(1.0), InputKind::kStart}}});
  EXPECT_EQ(CodeOf(ran), 7410);
  EXPECT_EQ(ran.Count("shutter open"), 0);
  EXPECT_EQ(ran.outcome.place.step, 2);
}

// OPT-3.22, OPT-3.29: a WORKDEF 1 with a schedule activates that first; then the dwell at PEAK
// power.
TEST(LaserRules, PierceWithASchedule) {
  EXPECT_THAT(Told(RunText("WORKDEF 1,0 (8.,75.,1.,50.,12)\nWORK 1,0/ON\nWORK 1,0/OFF\n")),
              ElementsAre("schedule 12", "shutter open", "beam on 50.0", "wait pierce 1.0",
                          "beam off", "shutter closed"));
}

// OPT-3.23, OPT-3.26: WORK 2 ON selects its schedule and opens nothing; the schedule stays active
// after OFF and for the next program.
TEST(LaserRules, AScheduleStays) {
  const Ran first = RunText("WORKDEF 2,0 (11)\nWORK 2,0/ON\nWORK 2,0/OFF\n");
  EXPECT_THAT(Told(first), ElementsAre("schedule 11"));
  const Ran second = RunText("WORKDEF 2,1 (11)\nWORK 2,1/ON\nWORK 2,1/OFF\n",
                             {.machine_state = first.machine_state});
  EXPECT_THAT(Told(second), ElementsAre());  // it is active already
  std::vector<machine::LaserSchedule> schedules{{.number = 11, .power_percent = 40.0}};
  const Ran third = RunText("WORK 0,0/ON\nWORK 0,0/OFF\n",
                            {.machine_state = first.machine_state, .schedules = schedules});
  EXPECT_TRUE(third.Told("beam on 40.0"));
}

// OPT-3.24, OPT-3.25: WORK 2 OFF takes the beam away but not the process: WORK 0 ON brings it back,
// and at the end it has still to be turned off.
TEST(LaserRules, WorkStillCountsAsOnAfterScheduleOff) {
  const Ran ran =
      RunText("WORKDEF 2,5 (15)\nWORK 0,0/ON\nWORK 2,5/OFF\nVL[0]=IL[87]\nWORK 0,0/ON\n",
              {.variables = {"VL[0]"}});
  EXPECT_THAT(Told(ran), ElementsAre("shutter open", "beam on 100.0", "E7411", "beam off",
                                     "beam on 100.0", "E7408", "beam off", "shutter closed"));
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
}

// OPT-3.27: a second WORK 2 ON changes the schedule under the beam.
TEST(LaserRules, SchedulesChangeUnderTheBeam) {
  const Ran ran = RunText(
      "WORKDEF 2,0 (15)\nWORKDEF 2,1 (16)\nWORK 2,0/ON\nWORK 0,0/ON\nWORK 2,1/ON\nWORK 0,0/OFF\n"
      "WORK 2,0/OFF\nWORK 2,1/OFF\n");
  EXPECT_THAT(Told(ran), ElementsAre("schedule 15", "shutter open", "beam on 100.0", "schedule 16",
                                     "beam off", "shutter closed"));
}

// OPT-3.31: OFF of a process that is not ON does nothing.
TEST(LaserRules, OffOfWhatIsNotOn) {
  const Ran ran = RunText("WORK 0,3/OFF\nWORK 1,3/OFF\n");
  EXPECT_THAT(Told(ran), ElementsAre());
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
}

// OPT-3.32: with two processes ON the last decides the power, and any OFF takes the beam.
TEST(LaserRules, TheLastWorkOnDecides) {
  const Ran ran = RunText(kThere +
                              "WORKDEF 1,1 (20.,100.,0.,95.)\nWORK 0,0/ON\nWORK 1,1/ON\nMOVE "
                              "(1100.,1000.,-400.,0.,0.)\n"
                              "WORK 0,0/OFF\nVL[0]=IL[88]\nWORK 1,1/OFF\n",
                          {.variables = {"VL[0]"}});
  EXPECT_EQ(ran.Count("beam off"), 1);
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  ASSERT_EQ(ran.parts.size(), 2U);
  // 50 mm/s where 100 mm/s (20 %) are 100 %: not the 100 % of WORK 0.
  EXPECT_NEAR(ran.parts[1].PowerAt(1.0), 50.0, 1e-6);
}

// OPT-3.35: CALL and the return from it leave the shutter as it is; it closes once, at the end of
// all.
TEST(LaserRules, TheShutterStaysOpenOverACall) {
  const Ran ran =
      RunText("WORK 0,0/ON\nWORK 0,0/OFF\nCALL 2\nDELAY 1\n", {.programs = {{2, "DELAY 2\n"}}});
  EXPECT_EQ(ran.Count("shutter closed"), 1);
  EXPECT_NEAR(ran.First("shutter closed").at_s, 3.0, 1e-9);
  const Ran go = RunText("WORK 0,0/ON\nWORK 0,0/OFF\nGO 2\n", {.programs = {{2, "DELAY 2\n"}}});
  EXPECT_NEAR(go.First("shutter closed").at_s, 0.0, 1e-9);
}

// OPT-3.34: a CALLed program that ends with a process ON: beam off, 7408, and the caller goes on.
TEST(LaserRules, ACalledProgramEndsWithWorkOn) {
  const Ran ran =
      RunText("CALL 2\nVI[2]=1\n", {.programs = {{2, "WORK 0,0/ON\n"}}, .variables = {"VI[2]"}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.First("E7408").program, 2);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_EQ(ran.Count("beam off"), 1);
}

// OPT-3.37, OPT-7.68: IL[87 + p] shows that a process p is on, whatever its kind; 8 and 9 have no
// flag.
TEST(LaserRules, WorkFlags) {
  const Ran ran = RunText(
      "WORKDEF 1,2 (8.,75.,0.,50.)\nWORKDEF 0,8\nWORK 1,2/ON\nWORK "
      "0,8/ON\nVL[0]=IL[89]\nVL[1]=IL[95]\n"
      "VL[2]=IL[96]\nWORK 1,2/OFF\nVL[3]=IL[89]\nWORK 0,8/OFF\n",
      {.variables = {"VL[0]", "VL[1]", "VL[2]", "VL[3]"}});
  EXPECT_EQ(ran.variables.at("VL[0]"), "1");
  EXPECT_EQ(ran.variables.at("VL[1]"), "0");
  EXPECT_EQ(ran.variables.at("VL[2]"), "0");
  EXPECT_EQ(ran.variables.at("VL[3]"), "0");
}

// OPT-3.38: /START delays the switching, and the program with it.
TEST(LaserRules, WorkWaitsForStart) {
  const Ran ran = RunText("WORK 0,0/ON /START (IL[16])\nOL[16]=ON\nWORK 0,0/OFF\n",
                          {.inputs = {{At(2.5), InputKind::kLogical, 16, 1.0}}});
  EXPECT_NEAR(ran.First("beam on 100.0").at_s, 2.5, 1e-9);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 2.5, 1e-9);
}

// OPT-3.38: with /NEXT the program does not wait for the START condition. The switching is told at
// the step of the WORK.
TEST(LaserRules, WorkNextWaitsInTheBackground) {
  const Ran ran = RunText(
      "WORK 0,0/ON /START (IL[16]) /NEXT\nOL[16]=ON\nVL[0]=IL[87]\nDELAY 4\nVL[1]=IL[87]\nWORK "
      "0,0/OFF\n",
      {.inputs = {{At(2.5), InputKind::kLogical, 16, 1.0}}, .variables = {"VL[0]", "VL[1]"}});
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 0.0, 1e-9);
  EXPECT_NEAR(ran.First("beam on 100.0").at_s, 2.5, 1e-9);
  EXPECT_EQ(ran.First("beam on 100.0").step, 1);
  EXPECT_EQ(ran.variables.at("VL[0]") + ran.variables.at("VL[1]"), "01");
}

// OPT-3.38, OPT-3.21: with /NEXT the program does not wait for the dwell: it goes on at PEAK power
// for the delay, and then with the ramp.
TEST(LaserRules, WorkNextDwellsInTheBackground) {
  const Ran ran = RunText("WORKDEF 1,0 (10.,60.,1.5,95.)\n" + kThere +
                          "WORK 1,0/ON /NEXT\nMOVE (1200.,1000.,-400.,0.,0.)\nWORK 1,0/OFF\n");
  EXPECT_EQ(ran.Count("wait pierce 1.5"), 0);
  ASSERT_EQ(ran.parts.size(), 3U);  // there; with peak power; with the ramp
  EXPECT_NEAR(ran.parts[1].duration_s(), 1.5, 1e-9);
  EXPECT_NEAR(ran.parts[1].PowerAt(1.0), 95.0, 1e-9);
  EXPECT_NEAR(ran.parts[2].PowerAt(1.0), 60.0, 1e-9);  // 50 mm/s are 10 %: POWER
  EXPECT_NEAR(ran.BeamOnLength(), 200.0, 1e-6);
}

// OPT-3.38, OPT-B.30: /END switches off in the background, at the first cycle after its condition
// is true: from the WORK on 1.0 s are over at 21 x 0.048 s. What it was told at is the step of the
// WORK.
TEST(LaserRules, WorkEndSwitchesOff) {
  const Ran ran =
      RunText("WORK 0,0/ON /END (IL[20])\nDELAY 2\nVL[0]=IL[87]\n",
              {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}, .variables = {"VL[0]"}});
  EXPECT_NEAR(ran.First("beam off").at_s, 21 * 0.048, 1e-9);
  EXPECT_EQ(ran.First("beam off").step, 1);
  EXPECT_EQ(ran.variables.at("VL[0]"), "0");
  EXPECT_EQ(ran.Count("E7408"), 0);
  // The dwell is told in two parts: with the beam, and without it.
  ASSERT_EQ(ran.waits.size(), 2U);
  EXPECT_TRUE(ran.waits[0].beam_on);
  EXPECT_FALSE(ran.waits[1].beam_on);
  EXPECT_NEAR(ToSeconds(ran.waits[1].end - ran.waits[0].start), 2.0, 1e-9);
}

// OPT-3.38: /END acts during a motion too, at the place where the tip then is.
TEST(LaserRules, WorkEndActsDuringAMove) {
  const Ran ran =
      RunText(kThere + "VL[3]=OFF\nWORK 0,0/ON /END (IL[20])\nMOVE (1500.,1000.,-400.,0.,0.)\n",
              {.inputs = {{At(8.0), InputKind::kLogical, 20, 1.0}}});
  ASSERT_EQ(ran.parts.size(), 3U);
  EXPECT_TRUE(ran.parts[1].done.beam_on);
  EXPECT_FALSE(ran.parts[2].done.beam_on);
  EXPECT_GE(ToSeconds(ran.parts[2].done.start), 8.0);
  EXPECT_LT(ToSeconds(ran.parts[2].done.start), 8.0 + 0.048);
  EXPECT_EQ(ran.Count("E7408"), 0);
}

// OPT-3.38: an OFF by the program is the end of the WORK and of its conditions.
TEST(LaserRules, OffDropsTheConditionsOfWork) {
  const Ran ran = RunText("WORK 0,0/ON /START (IL[16]) /NEXT\nDELAY 1\nWORK 0,0/OFF\nDELAY 4\n",
                          {.inputs = {{At(2.5), InputKind::kLogical, 16, 1.0}}});
  EXPECT_EQ(ran.Count("beam on 100.0"), 0);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
}

// OPT-3.39, OPT-3.40, OPT-3.41: power follows the real tip speed: 75 % at 8 % (40 mm/s); at half of
// it 37.5; at an override of 55 % the speed is 22 mm/s and the power 41.25 %; at standstill 0, with
// the beam on.
TEST(LaserRules, PowerFollowsTheTipSpeed) {
  const std::string text = "WORKDEF 1,00 (8.,75.,1.,50.)\n" + kThere +
                           "WORK 1,0/ON\nSPEED 8\nMOVE (1100.,1000.,-400.,0.,0.)\n"
                           "SPEED 20\nMOVE (1200.,1000.,-400.,0.,0.)\nWORK 1,0/OFF\n";
  const Ran full = RunText(text);
  ASSERT_EQ(full.parts.size(), 3U);
  EXPECT_NEAR(full.parts[1].PowerAt(full.parts[1].duration_s() / 2), 75.0, 1e-6);
  EXPECT_NEAR(full.parts[1].PowerAt(std::sqrt(40.0 / 40000.0)), 37.5,
              1e-6);  // half way through the ramp
  EXPECT_NEAR(full.parts[2].PowerAt(full.parts[2].duration_s() / 2), 100.0,
              1e-6);  // 100 mm/s: limited
  EXPECT_NEAR(full.parts[1].PowerAt(full.parts[1].duration_s()), 0.0, 1e-6);
  EXPECT_EQ(full.Count("beam off"), 1);
  const Ran slow = RunText(text, {.override_percent = 55.0});
  EXPECT_NEAR(slow.parts[1].PowerAt(slow.parts[1].duration_s() / 2), 41.25, 1e-6);
}

// OPT-3.42: the power control of the EFA-51 needs its modulation outputs off; an ARROW has none.
TEST(LaserRules, RampIsBlockedByModulation) {
  const std::string text = "WORKDEF 1,0 (8.,75.,0.,50.)\nOL[13]=ON\nWORK 1,0/ON\nWORK 1,0/OFF\n";
  EXPECT_EQ(CodeOf(RunText(text, {.parameters = {{"LASER", "EFA51"}}})), 7406);
  EXPECT_EQ(CodeOf(RunText(text)), 0);
}

// OPT-3.43: the EFA-51 has no schedules, neither for WORK 2 nor as fifth value of WORKDEF 1.
TEST(LaserRules, NoSchedulesOnTheEfa51) {
  const RunOptions efa{.profile = "efa-51"};
  EXPECT_EQ(CodeOf(RunText("WORK 2,0/ON\n", efa)), 7405);  // with or without WORKDEF
  EXPECT_EQ(CodeOf(RunText("WORKDEF 2,0 (11)\nWORK 2,0/ON\n", efa)), 7405);
  EXPECT_EQ(CodeOf(RunText("WORKDEF 1,0 (8.,75.,0.,50.,12)\nWORK 1,0/ON\n", efa)), 7405);
}

// OPT-3.44: a schedule that is not stored cannot be selected.
TEST(LaserRules, ASelectedScheduleMustBeStored) {
  const auto code = [](int number, std::vector<machine::LaserSchedule> stored) {
    const std::string text =
        "WORKDEF 2,0 (" + std::to_string(number) + ")\nWORK 2,0/ON\nWORK 2,0/OFF\n";
    return CodeOf(RunText(text, {.parameters = {{"SCHEDULES", "11"}}, .schedules = stored}));
  };
  EXPECT_EQ(code(12, {}), 7404);
  EXPECT_EQ(code(11, {}), 0);
  EXPECT_EQ(code(12, {{.number = 12}}), 0);
  EXPECT_EQ(code(13, {{.number = 12}}), 7404);
}

// OPT-3.44, SCHEDULES: one that is stored takes the place of its number; the others stay.
TEST(LaserRules, AStoredScheduleLeavesTheOthers) {
  const RunOptions options{.schedules = {{.number = 12, .power_percent = 40.0}}};
  const auto beam = [&](int number) {
    return RunText("WORKDEF 2,0 (" + std::to_string(number) +
                       ")\nWORK 2,0/ON\nWORK 0,0/ON\nWORK 0,0/OFF\nWORK 2,0/OFF\n",
                   options);
  };
  EXPECT_TRUE(beam(12).Told("beam on 40.0"));
  for (const int number : {1, 11, 13, 63}) {
    EXPECT_EQ(CodeOf(beam(number)), 0) << number;
    EXPECT_TRUE(beam(number).Told("beam on 100.0")) << number;
  }
}

// OPT-3.63: no set-up is needed before WORK 1.
TEST(LaserRules, WorkOneNeedsNoSetUp) {
  EXPECT_EQ(CodeOf(RunText("WORKDEF 1,0 (8.,75.,0.,50.)\nWORK 1,0/ON\nWORK 1,0/OFF\n")), 0);
}

// OPT-3.58: a caught error takes the beam and all processes, not the shutter; nothing is left to
// warn of.
TEST(LaserRules, ACaughtErrorLeavesTheShutterOpen) {
  const Ran ran = RunText("ERR 900\nWORK 0,0/ON\nVR[0]=1/0\nENDTASK\n900 DELAY 1\nVL[0]=IL[87]\n",
                          {.variables = {"VL[0]"}});
  EXPECT_THAT(Told(ran), ElementsAre("shutter open", "beam on 100.0", "beam off", "E7201",
                                     "wait dwell 1.0", "shutter closed"));
  EXPECT_EQ(ran.variables.at("VL[0]"), "0");
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
}

// OPT-3.36, OPT-3.12, OPT-9.16: a FUNCTION may be used with a process ON, and shares the WORKDEFs.
TEST(LaserRules, AFunctionSharesTheProcesses) {
  const Ran ran = RunText("WORKDEF 1,0 (8.,75.,0.,50.)\nWORK 0,0/ON\nFUNCTION 44\nWORK 0,0/OFF\n",
                          {.programs = {{44, "WORK 1,0/ON\nWORK 1,0/OFF\n"}}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.Count("E7408"), 0);
}

// OPT-5.51, OPT-5.39, OPT-5.42: the gas changes under the beam; without OL[8] and OL[9] it is
// gas 1.
TEST(LaserRules, TheGasChangesUnderTheBeam) {
  const Ran ran = RunText("WORK 0,0/ON\nOL[8]=ON\nOL[8]=OFF\nWORK 0,0/OFF\n");
  EXPECT_THAT(Told(ran), ElementsAre("shutter open", "beam on 100.0", "OL[8] 1", "gas 2", "OL[8] 0",
                                     "gas 1", "beam off", "shutter closed"));
}

// OPT-3.49, OPT-3.51, OPT-3.52: PAUSE and STOP do the same.
TEST(LaserRules, PauseAndStopDoTheSame) {
  const auto trace = [](const std::string& word) {
    Ran ran = RunText("WORK 0,0/ON\n" + word + "\nDELAY 1\nWORK 0,0/OFF\n",
                      {.inputs = {{At(4.0), InputKind::kStart}}});
    for (std::string& what : ran.told) {
      if (what == "halt " + word) what = "halt";
    }
    return ran.told;
  };
  EXPECT_EQ(trace("PAUSE"), trace("STOP"));
  EXPECT_EQ(trace("STOP").size(), 10U);
}

// OPT-9.17, OPT-9.18: the rectangle of program 44: from the pierce point (2060,770,-550) over
// (2070,780), (2070,680), (2020,680) to (2020,780): 14.142 + 100 + 50 + 100 mm with the beam on;
// both users cut the same.
TEST(LaserRules, TheRectangleIsCutTwiceAlike) {
  const std::string rectangle =
      "SPEED 30\nMOVE (2060.,770.,-530.,0.,0.)\nOL[11]=ON\nSPEED 10\nPATH LIN\nMOVE "
      "(2060.,770.,-550.,0.,0.)\n"
      "WORK 0,0/ON\nMOVE (2070.,780.,-550.,0.,0.)\nMOVE (2070.,680.,-550.,0.,0.)\nMOVE "
      "(2020.,680.,-550.,0.,0.)\n"
      "MOVE (2020.,780.,-550.,0.,0.)\nWORK 0,0/OFF\nMOVE (2070.,780.,-530.,0.,0.)\n";
  const RunOptions with_44{.programs = {{44, rectangle}}};
  const Ran first = RunText("COORD ABSOL\nFUNCTION 44\n", with_44);
  const Ran second = RunText("COORD ABSOL\nSPEED 50\nPATH LIN\nFUNCTION 44\nDELAY 1\n", with_44);
  const double length = 10.0 * std::sqrt(2.0) + 250.0;
  EXPECT_NEAR(first.BeamOnLength(), length, 1e-6);
  EXPECT_NEAR(second.BeamOnLength(), length, 1e-6);
  EXPECT_LT(second.DistanceTo({2070.0, 680.0, -550.0}), 1e-9);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
