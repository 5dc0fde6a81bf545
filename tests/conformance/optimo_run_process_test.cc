// Chapter 3: laser, shutter, halts and errors on the virtual machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/conformance/optimo_machine.h"

namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string kRamp = "WORKDEF 1,0 (8.,75.,1.,50.)\n";
const std::string kAway = "MOVE (521.02,2201.2,-350.,0.,0.)\n";

// OPT-3.28, OPT-3.16: example 1 of the manual; the shutter closes at the end.
TEST(OptimoRunProcess, TheFirstExample) {
  const Ran ran = OptimoMachine().Run(kAbsol + "WORKDEF 0,0\nWORK 0,0 / ON\n" + kAway +
                                      "WORK 0,0 / OFF\nDELAY 1\n");
  EXPECT_THAT(ran.Events(), ElementsAre("shutter open", "beam on 100.0", "beam off",
                                        "wait dwell 1.0", "shutter closed"));
  EXPECT_NEAR(ran.Find("shutter closed")->at_s, ran.time_s(), 1e-9);
}

// OPT-3.29, OPT-3.39: pierce 1.5 s at 95 %, then 80 % at 6.5 % of 500 mm/s.
TEST(OptimoRunProcess, TheSecondExample) {
  const Ran ran = OptimoMachine().Run(
      kAbsol + "SPEED 6.5\nWORKDEF 1,0 (6.5,80.,1.5,95)\nWORK 1,0/ON\n" + kAway + "WORK 1,0/OFF\n");
  EXPECT_THAT(ran.Events(), ElementsAre("shutter open", "beam on 95.0", "wait pierce 1.5",
                                        "beam off", "shutter closed"));
  ASSERT_EQ(ran.motions.size(), 1U);
  EXPECT_NEAR(ran.motions[0].power.percent_per_mm_s * 32.5, 80.0, 1e-9);
  EXPECT_NEAR(ran.motions[0].start_s, 1.5, 1e-9);
}

// OPT-3.39, OPT-3.40, OPT-3.41: proportional to the tip speed, nothing at standstill; at an
// override of 55 % the tip has 22 mm/s and the beam 41.25 %.
TEST(OptimoRunProcess, PowerFollowsTheTipSpeed) {
  const Ran ran =
      OptimoMachine().Run(kAbsol + "SPEED 8\n" + kRamp + "WORK 1,0/ON\n" + kAway + "WORK 1,0/OFF\n",
                          {.override_percent = 55.0});
  ASSERT_EQ(ran.motions.size(), 1U);
  const Ran::Motion& cut = ran.motions[0];
  EXPECT_TRUE(cut.beam);
  EXPECT_EQ(cut.power.constant_percent, 0.0);
  EXPECT_NEAR(cut.power.percent_per_mm_s * 40.0, 75.0, 1e-9);
  EXPECT_NEAR(cut.power.percent_per_mm_s * 20.0, 37.5, 1e-9);
  EXPECT_NEAR(cut.programmed_mm_s, 22.0, 1e-9);
  EXPECT_NEAR(cut.power.percent_per_mm_s * cut.programmed_mm_s, 41.25, 1e-9);
}

// OPT-3.22, OPT-3.63: the fifth parameter selects a schedule before the beam goes on; nothing else
// has to be set up.
TEST(OptimoRunProcess, AScheduleComesBeforeTheBeam) {
  EXPECT_THAT(
      OptimoMachine().Run("WORKDEF 1,0 (8.,75.,1.,50.,12)\nWORK 1,0/ON\nWORK 1,0/OFF\n").Events(),
      ElementsAre("schedule 12", "shutter open", "beam on 50.0", "wait pierce 1.0", "beam off",
                  "shutter closed"));
}

// OPT-3.23, OPT-3.31: WORK 2 opens no shutter; OFF of what is not ON is no error.
TEST(OptimoRunProcess, SchedulesSwitchNoBeamOn) {
  EXPECT_THAT(OptimoMachine().Run("WORKDEF 2,0 (11)\nWORK 2,0/ON\nWORK 2,0/OFF\n").Events(),
              ElementsAre("schedule 11"));
  EXPECT_THAT(OptimoMachine().Run("WORK 0,3/OFF\n").Events(), IsEmpty());
}

// OPT-3.24, OPT-3.25: after WORK 2 OFF the flag of 0,0 stays; a new ON brings the beam back.
TEST(OptimoRunProcess, AScheduleOffLeavesTheProcessOn) {
  const Ran ran = OptimoMachine().Run(
      "WORKDEF 2,5 (15)\nWORK 0,0/ON\nWORK 2,5/OFF\nVL[0]=IL[87]\nWORK 0,0/ON\nWORK 0,0/OFF\n"
      "VL[1]=IL[87]\n");
  EXPECT_THAT(ran.Events(), ElementsAre("shutter open", "beam on 100.0", "E7411", "beam off",
                                        "beam on 100.0", "beam off", "shutter closed"));
  EXPECT_EQ(ran.Var("VL[0]"), "1");
  EXPECT_EQ(ran.Var("VL[1]"), "0");
}

// OPT-3.26, OPT-3.20: the schedule stays after OFF and after the program; WORK 0 uses its power.
TEST(OptimoRunProcess, AScheduleStaysSelected) {
  OptimoMachine machine;
  machine.Schedules({{.number = 15, .power_percent = 60.0}});
  EXPECT_TRUE(machine.Run("WORKDEF 2,5 (15)\nWORK 2,5/ON\nWORK 2,5/OFF\n").Has("schedule 15"));
  EXPECT_TRUE(machine.Run("WORK 0,0/ON\nWORK 0,0/OFF\n").Has("beam on 60.0"));
}

// OPT-3.27, OPT-3.44: another schedule under the beam; one that is not stored.
TEST(OptimoRunProcess, SchedulesChangeUnderTheBeam) {
  const std::string program =
      "WORKDEF 2,5 (15)\nWORKDEF 2,6 (16)\nWORK 2,5/ON\nWORK 0,0/ON\nDELAY .5\nWORK 2,6/ON\n"
      "DELAY .5\nWORK 0,0/OFF\nWORK 2,5/OFF\nWORK 2,6/OFF\n";
  const Ran ran = OptimoMachine().Run(program);
  EXPECT_EQ(ran.Count("beam on 100.0"), 1);
  EXPECT_EQ(ran.Count("beam off"), 1);
  EXPECT_NEAR(ran.Find("schedule 16")->at_s, 0.5, 1e-9);
  OptimoMachine lacks_it;
  lacks_it.Set("SCHEDULES", "15");
  const Ran missing = lacks_it.Run(program);
  EXPECT_EQ(missing.code(), 7404);  // OPT-E.7404
}

// OPT-3.32: the last ON decides the power, any OFF of a beam process ends the beam.
TEST(OptimoRunProcess, SeveralProcesses) {
  const Ran ran = OptimoMachine().Run(kAbsol +
                                      "SPEED 8\nWORKDEF 1,1 (8.,75.,0.,50.)\nWORK 0,0/ON\n"
                                      "WORK 1,1/ON\n" +
                                      kAway +
                                      "WORK 0,0/OFF\nVL[0]=IL[88]\n"
                                      "WORK 1,1/OFF\n");
  ASSERT_EQ(ran.motions.size(), 1U);
  EXPECT_NEAR(ran.motions[0].power.percent_per_mm_s, 75.0 / 40.0, 1e-9);
  EXPECT_EQ(ran.Count("beam off"), 1);
  EXPECT_EQ(ran.Find("beam off")->step, 8);
  EXPECT_EQ(ran.Var("VL[0]"), "1");
}

// OPT-3.35: CALL leaves the shutter as it is, GO closes it.
TEST(OptimoRunProcess, TheShutterAtCallAndGo) {
  OptimoMachine machine;
  machine.Store(2, "DELAY 1\n");
  const std::string on_off = "WORK 0,0/ON\nWORK 0,0/OFF\n";
  const Ran call = machine.Run(on_off + "CALL 2\nDELAY 2\n");
  EXPECT_EQ(call.Count("shutter closed"), 1);
  EXPECT_NEAR(call.Find("shutter closed")->at_s, 3.0, 1e-9);
  const Ran go = machine.Run(on_off + "GO 2\n");
  EXPECT_EQ(go.Count("shutter closed"), 1);
  EXPECT_NEAR(go.Find("shutter closed")->at_s, 0.0, 1e-9);
  EXPECT_NEAR(go.time_s(), 1.0, 1e-9);
}

// OPT-3.37: a flag for each process number up to 7.
TEST(OptimoRunProcess, FlagsOfProcesses) {
  const Ran ran = OptimoMachine().Run(
      "WORKDEF 1,2 (8.,75.,0.,50.)\nWORKDEF 2,2 (5)\nWORKDEF 2,8 (5)\nWORK 1,2/ON\nWORK 2,2/ON\n"
      "VL[0]=IL[89]\nVL[1]=IL[87]\nWORK 1,2/OFF\nVL[2]=IL[89]\nWORK 2,2/OFF\nVL[3]=IL[89]\n"
      "WORK 2,8/ON\nVL[4]=IL[95]\nWORK 2,8/OFF\n");
  EXPECT_EQ(
      ran.Var("VL[0]") + ran.Var("VL[1]") + ran.Var("VL[2]") + ran.Var("VL[3]") + ran.Var("VL[4]"),
      "10100");
}

// OPT-3.42, OPT-3.43, OPT-E.7405, OPT-E.7406
TEST(OptimoRunProcess, WhatTheEfa51Refuses) {
  const auto code = [](const std::string& laser, const std::string& program) {
    return OptimoMachine().Set("LASER", laser).Run(program).code();
  };
  const std::string blocked = kRamp + "OL[13]=ON\nWORK 1,0/ON\nWORK 1,0/OFF\n";
  EXPECT_EQ(code("EFA51", blocked), 7406);
  EXPECT_EQ(code("ARROW", blocked), 0);
  EXPECT_EQ(code("EFA51", kRamp + "WORK 1,0/ON\nWORK 1,0/OFF\n"), 0);
  EXPECT_EQ(code("EFA51", "WORKDEF 2,0 (5)\nWORK 2,0/ON\n"), 7405);
  EXPECT_EQ(code("EFA51", "WORKDEF 1,0 (8.,75.,1.,50.,12)\nWORK 1,0/ON\n"), 7405);
}

// OPT-3.18, OPT-B.55: an error that nobody catches switches the beam off and closes the shutter, at
// its step, and has no effect itself.
TEST(OptimoRunProcess, ErrorsCloseTheShutter) {
  const Ran ran = OptimoMachine().Run("VR[0]=7.\nWORK 0,0/ON\nDELAY 1\nSPEED 5\nVR[0]=1/0\n");
  EXPECT_EQ(ran.code(), 7201);
  EXPECT_EQ(ran.Var("VR[0]"), "7.0");
  EXPECT_THAT(ran.Events(), ::testing::IsSupersetOf({"beam off", "shutter closed"}));
  EXPECT_EQ(ran.Find("beam off")->step, 5);
  EXPECT_EQ(ran.Find("shutter closed")->step, 5);
  const Ran jump = OptimoMachine().Run("WORK 0,0/ON\nGOTO 99\n");
  EXPECT_EQ(jump.code(), 60);  // OPT-E.60
  EXPECT_EQ(jump.Find("shutter closed")->step, 2);
}

// OPT-3.58: a caught error leaves the shutter open and all processes off.
TEST(OptimoRunProcess, CaughtErrorsLeaveTheShutter) {
  const Ran ran = OptimoMachine().Run(
      "ERR 900\nWORK 0,0/ON\nVR[0]=1/0\nENDTASK\n900 DELAY 1\nVL[0]=IL[87]\nDELAY 1\n");
  EXPECT_TRUE(ran.completed());
  EXPECT_NEAR(ran.Find("beam off")->at_s, 0.0, 1e-9);
  EXPECT_NEAR(ran.Find("shutter closed")->at_s, 2.0, 1e-9);
  EXPECT_EQ(ran.Var("VL[0]"), "0");
  EXPECT_FALSE(ran.Has("E7408"));
}

// OPT-3.17, OPT-3.62: the door closes the shutter; with the door closed START opens it, then the
// beam returns.
TEST(OptimoRunProcess, TheDoorClosesTheShutter) {
  const std::string program = kAbsol + "SPEED 10\nWORK 0,0/ON\n" + kAway + "WORK 0,0/OFF\n";
  const Ran ran = OptimoMachine().Run(program, {.inputs = {{At(2.0), InputKind::kHold},
                                                           {At(3.0), InputKind::kDoor, 0, 1.0},
                                                           {At(4.0), InputKind::kDoor, 0, 0.0},
                                                           {At(5.0), InputKind::kStart}}});
  EXPECT_TRUE(ran.completed());
  std::vector<std::string> seen;
  for (const std::string& event : ran.Events()) {
    if (event.starts_with("beam") || event.starts_with("shutter")) seen.push_back(event);
  }
  EXPECT_THAT(seen, ElementsAre("shutter open", "beam on 100.0", "beam off", "shutter closed",
                                "shutter open", "beam on 100.0", "beam off", "shutter closed"));
  const Ran open = OptimoMachine().Run(program, {.inputs = {{At(2.0), InputKind::kHold},
                                                            {At(3.0), InputKind::kDoor, 0, 1.0},
                                                            {At(5.0), InputKind::kStart}}});
  EXPECT_TRUE(open.Has("E7410"));  // OPT-E.7410
  EXPECT_EQ(open.Count("shutter open"), 1);
  EXPECT_FALSE(open.completed());
}

// OPT-3.19: with the door open WORK ON opens nothing.
TEST(OptimoRunProcess, AnOpenDoorKeepsTheShutterClosed) {
  const Ran ran = OptimoMachine().Run(
      "DELAY 5\nWORK 0,0/ON\n",
      {.inputs = {{At(1.0), InputKind::kDoor, 0, 1.0}, {At(2.0), InputKind::kStart}}});
  EXPECT_FALSE(ran.Has("shutter open"));
  EXPECT_FALSE(ran.Has("beam on 100.0"));
  EXPECT_TRUE(ran.Has("E7410") || ran.code() == 7410);
}

// OPT-3.46: a written ENDTASK at the end changes nothing.
TEST(OptimoRunProcess, EndtaskIsOptional) {
  const std::string program = kAbsol + "SPEED 10\nOL[16]=ON\n" + kAway;
  OptimoMachine without, with;
  const Ran a = without.Run(program), b = with.Run(program + "ENDTASK\n");
  EXPECT_EQ(a.Events(), b.Events());
  EXPECT_EQ(a.time_s(), b.time_s());
  EXPECT_TRUE(a.completed() && b.completed());
}

// OPT-3.51: PAUSE and STOP are one, in CYCLE and in REMOTE.
TEST(OptimoRunProcess, PauseIsStop) {
  const auto run = [](const std::string& word, machine::Mode mode) {
    return OptimoMachine().Run("WORK 0,0/ON\n" + word + "\nVI[2]=1\nWORK 0,0/OFF\n",
                               {.mode = mode, .inputs = {{At(4.0), InputKind::kStart}}});
  };
  for (const machine::Mode mode : {machine::Mode::kCycle, machine::Mode::kRemote}) {
    const Ran stop = run("STOP", mode), pause = run("PAUSE", mode);
    ASSERT_EQ(stop.told.size(), pause.told.size());
    for (std::size_t n = 0; n < stop.told.size(); ++n) {
      EXPECT_EQ(stop.told[n].at_s, pause.told[n].at_s);
      if (stop.told[n].what.find("STOP") != std::string::npos) continue;
      EXPECT_EQ(stop.told[n].what, pause.told[n].what);
    }
    EXPECT_EQ(stop.Var("VI[2]"), pause.Var("VI[2]"));
  }
  EXPECT_EQ(run("PAUSE", machine::Mode::kCycle).Var("VI[2]"), "1");
  EXPECT_TRUE(run("PAUSE", machine::Mode::kRemote).Has("E7507"));  // OPT-E.7507
}

// OPT-3.56
TEST(OptimoRunProcess, NoerrCancelsErr) {
  const Ran ran = OptimoMachine().Run("ERR 900\nNOERR\nVR[0]=1/0\nENDTASK\n900 VI[2]=1\n");
  EXPECT_EQ(ran.code(), 7201);
  EXPECT_EQ(ran.Var("VI[2]"), "0");
}

// OPT-3.60, OPT-3.61, OPT-E.7505: a text on the display, nothing else.
TEST(OptimoRunProcess, SeterrOnlyShowsItsNumber) {
  const Ran ran = OptimoMachine().Run(
      "ERR 900\nWORK 0,0/ON\nSETERR 1234\nVI[2]=1\nWORK 0,0/OFF\nENDTASK\n900 VI[3]=1\n");
  EXPECT_TRUE(ran.Has("ERROR 1234"));
  EXPECT_EQ(ran.Var("VI[2]") + ran.Var("VI[3]") + ran.Var("VI[99]"), "100");
  EXPECT_EQ(ran.Count("beam off"), 1);
  EXPECT_EQ(OptimoMachine().Run("VR[1]=10000.\nSETERR VR[1]\n").code(), 7505);
}

// OPT-B.07: the sensor is shown and moves nothing.
TEST(OptimoRunProcess, TheSensorMovesNothing) {
  const Ran ran = OptimoMachine().Run("OL[11]=ON\nDELAY 1\nOL[11]=OFF\n");
  EXPECT_THAT(ran.Events(),
              ElementsAre("OL[11] 1", "sensor 1", "wait dwell 1.0", "OL[11] 0", "sensor 0"));
  EXPECT_TRUE(ran.motions.empty());
}

// OPT-5.41, OPT-E.931: an alarm: ERR is not taken, the shutter closes, the image stays set.
TEST(OptimoRunProcess, TheThirdGasIsAnAlarm) {
  const Ran ran =
      OptimoMachine().Run("ERR 900\nWORK 0,0/ON\nDELAY 1\nOL[9]=ON\nENDTASK\n900 VI[2]=1\n");
  EXPECT_EQ(ran.code(), 931);
  EXPECT_EQ(ran.Var("VI[2]"), "0");
  EXPECT_EQ(ran.Var("OL[9]"), "1");
  EXPECT_TRUE(ran.Has("shutter closed"));
  EXPECT_FALSE(ran.Has("gas 3"));
}

// OPT-B.67, OPT-E.7901, OPT-E.7902, OPT-E.7610: what ends a run from outside.
TEST(OptimoRunProcess, BudgetsAndTheEmergencyStop) {
  const std::string loop = "WORK 0,0/ON\n10 DELAY 1\nGOTO 10\n";
  const Ran steps = OptimoMachine().Run(loop, {.budget = {.steps = 50}});
  EXPECT_EQ(steps.code(), 7901);
  EXPECT_TRUE(steps.Has("beam off"));
  EXPECT_TRUE(steps.Has("shutter closed"));
  const Ran time = OptimoMachine().Run(
      loop, {.budget = {.steps = 1000, .virtual_time = std::chrono::seconds(5)}});
  EXPECT_EQ(time.code(), 7902);
  EXPECT_NEAR(time.time_s(), 5.0, 1e-6);
  const Ran stop =
      OptimoMachine().Run(loop, {.inputs = {{At(2.5), InputKind::kEmergencyStop, 0, 1.0}}});
  EXPECT_EQ(stop.code(), 7610);
  EXPECT_NEAR(stop.Find("beam off")->at_s, 2.5, 1e-6);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
