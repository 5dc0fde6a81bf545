#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

// Variables, images and work offsets while a program runs.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;

constexpr double kReal = 1e-4;  // mm; values have seven digits

// OPT-7.62, OPT-B.39: a small value is shown as it is, in the form that reads back to it.
TEST(DataRules, ValuesAreShownWhole) {
  EXPECT_EQ(Value("VR[0]=0.0001234567\n", "VR[0]"), "0.0001234567");
  EXPECT_EQ(Value("VR[0]=2E-19\n", "VR[0]"), "2.0E-19");
  EXPECT_EQ(Value("VR[0]=1E18*2.\n", "VR[0]"), "2.0E18");
  EXPECT_EQ(Value("VR[0]=1E-15*1E-15\n", "VR[0]"), "0.0");
}

// OPT-1.16, OPT-1.17, OPT-7.63: variables are the machine's, not the program's: 0 when it is new,
// kept after.
TEST(DataRules, VariablesOutliveThePrograms) {
  EXPECT_EQ(Value("VL[0]=OFF\n", "VL[99]") + Value("VL[0]=OFF\n", "VR[0]"), "00.0");
  const Ran first = RunText("VR[5]=7.\nVI[2]=3\n");
  EXPECT_EQ(Value("VL[0]=ON\n", "VR[5]", {.machine_state = first.machine_state}), "7.0");
  EXPECT_EQ(Value("VI[3]=VI[2]\n", "VI[3]", {.machine_state = first.machine_state}), "3");
}

// OPT-7.59: what is on is ON, whatever group it is of, and one is as good as the other.
TEST(DataRules, LogicalValuesAreOnOrOff) {
  const auto taken = [](const std::string& condition) {
    return Value("VL[1]=ON\nOL[2]=ON\nVL[3]=OFF\nIF " + condition +
                     " THEN 10\nGOTO 20\n10 VI[1]=1\n20 VI[2]=2\n",
                 "VI[1]", {.inputs = {{SimTime(0), InputKind::kLogical, 5, 1.0}}});
  };
  for (const char* on : {"VL[1]", "OL[2]", "IL[5]"}) {
    EXPECT_EQ(taken(std::string(on) + " = ON"), "1") << on;
    EXPECT_EQ(taken(std::string(on) + " = VL[3]"), "0") << on;
    EXPECT_EQ(taken(std::string(on) + " = VL[1]"), "1") << on;
    EXPECT_EQ(taken(std::string(on) + " <> OFF"), "1") << on;
  }
  EXPECT_EQ(taken("VL[3] = OFF"), "1");
}

// OPT-7.61, OPT-7.78, OPT-B.47: 32767 fits, 32768 does not, and then nothing is assigned.
TEST(DataRules, IntegersAreOfSixteenBits) {
  const Ran ran =
      RunText("VI[2]=32767\nVI[3]=-32768\nERR 900\nVI[2]=VI[2]+1\nENDTASK\n900 VI[4]=VI[99]\n",
              {.variables = {"VI[2]", "VI[3]", "VI[4]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "32767");
  EXPECT_EQ(ran.variables.at("VI[3]"), "-32768");
  EXPECT_EQ(ran.variables.at("VI[4]"), "7203");
}

// OPT-7.64, OPT-7.69: OA is an image that can be read back; IA[3] and IA[4] are the head angles.
TEST(DataRules, AnalogueImages) {
  const Ran ran =
      RunText("OA[5]=2.5\nVR[0]=OA[5]\nMOVE (500.,600.,-50.,0.5,0.25)\nVR[3]=IA[3]\nVR[4]=IA[4]\n",
              {.variables = {"VR[0]", "VR[3]", "VR[4]"}});
  EXPECT_EQ(ran.variables.at("VR[0]"), "2.5");
  EXPECT_EQ(ran.variables.at("VR[3]"), "0.5");
  EXPECT_EQ(ran.variables.at("VR[4]"), "0.25");
  EXPECT_TRUE(ran.Told("OA[5] 2.5"));
}

// OPT-7.65: IA[0] to IA[2] are of the tip in COORD ABSOL, of the column else: 300 mm apart at B =
// 0.
TEST(DataRules, PositionIsOfTipOrColumn) {
  EXPECT_EQ(Value("COORD ROBOT\nVR[0]=IA[2]\nCOORD ABSOL\nVR[1]=VR[0]-IA[2]\n", "VR[1]"), "300.0");
}

// OPT-7.67, OPT-7.66: IL[16] is the START push-button, an input like any other.
TEST(DataRules, TheStartButtonIsAnInput) {
  const Ran ran =
      RunText("WAIT (IL[16])\nVI[2]=1\n",
              {.inputs = {{At(1.25), InputKind::kLogical, 16, 1.0}}, .variables = {"VI[2]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_NEAR(ran.time_s, 1.25, 1e-9);
}

// OPT-7.96: writing an output changes image and output at once, in the order written.
TEST(DataRules, AnOutputFollowsItsImage) {
  EXPECT_THAT(RunText("OL[16]=ON\nOL[11]=ON\nOL[16]=OFF\n").told,
              ElementsAre("compiling 1", "OL[16] 1", "OL[11] 1", "sensor on", "OL[16] 0"));
}

// OPT-7.97, OPT-7.98: an input is read when it is used, unless its group is not updated.
TEST(DataRules, AnInputIsReadWhenUsed) {
  const machine::InputScript script{{At(1.0), InputKind::kLogical, 20, 1.0}};
  const Ran ran = RunText("VL[0]=IL[20]\nDELAY 2\nVL[1]=IL[20]\n",
                          {.inputs = script, .variables = {"VL[0]", "VL[1]"}});
  EXPECT_EQ(ran.variables.at("VL[0]") + ran.variables.at("VL[1]"), "01");
  const Ran held =
      RunText("VL[0]=IL[20]\nUPDATE IL /OFF\nDELAY 2\nVL[1]=IL[20]\nUPDATE IL /ON\nVL[2]=IL[20]\n",
              {.inputs = script, .variables = {"VL[1]", "VL[2]"}});
  EXPECT_EQ(held.variables.at("VL[1]") + held.variables.at("VL[2]"), "01");
}

// OPT-7.99, OPT-B.53: all groups are updated at the start of each program, whatever the one before
// did.
TEST(DataRules, GroupsAreUpdatedAtTheStart) {
  const Ran ran = RunText("UPDATE OL /OFF\nCALL 46\nOL[17]=ON\n",
                          {.programs = {{46, "OL[16]=ON\nVR[0]=IA[0]\n"}}, .variables = {"VR[0]"}});
  EXPECT_TRUE(ran.Told("OL[16] 1"));
  EXPECT_FALSE(ran.Told("OL[17] 1"));
  EXPECT_EQ(ran.variables.at("VR[0]"), "21.02");
}

// OPT-7.100: IMAGE disconnects whatever UPDATE says; REAL reconnects, if UPDATE is ON.
TEST(DataRules, ImageAndReal) {
  EXPECT_THAT(RunText("IMAGE OL\nOL[16]=ON\nUPDATE OL /ON\nDELAY 1\nREAL OL\n").told,
              ElementsAre("compiling 1", "wait dwell 1.0", "OL[16] 1"));
  EXPECT_FALSE(RunText("UPDATE OL /OFF\nIMAGE\nOL[16]=ON\nREAL\n").Told("OL[16] 1"));
}

// OPT-7.30, OPT-7.35: offsets replace each other; SYSDEF without values cancels.
TEST(DataRules, OneWorkOffsetAtATime) {
  const Ran twice = RunText(
      "COORD ABSOL\nSYSDEF (1000.,1000.,-400.,0,0,0)\nSYSDEF (1000.,1000.,-400.,0,0,0)\nMOVE "
      "(10.,20.,0.,0.,0.)\n");
  EXPECT_NEAR(twice.end.tip.tip.x(), 1010.0, kReal);
  const Ran none = RunText(
      "COORD ABSOL\nSYSDEF (1000.,1000.,-400.,0,0,0)\nSYSDEF\nMOVE (10.,20.,-100.,0.,0.)\n");
  EXPECT_NEAR(none.end.tip.tip.x(), 10.0, kReal);
}

// OPT-7.31, OPT-7.32: values may be variables and analogue inputs; they are taken when SYSDEF is
// executed.
TEST(DataRules, OffsetValuesAreTakenAtOnce) {
  const Ran ran = RunText(
      "COORD ABSOL\nVR[86]=1000.\nSYSDEF (VR[86],IA[1],-400.,0.,0.,0.)\nVR[86]=5.\nMOVE "
      "(10.,-1000.,0.,0.,0.)\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 1010.0, kReal);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1201.2, kReal);
}

// OPT-7.33, OPT-7.34: ROBOT moves are not shifted, and the head does not turn with the system.
TEST(DataRules, OffsetsAreForTheTipOnly) {
  const Ran robot = RunText("SYSDEF (100.,100.,0.,0,0,0)\nCOORD ROBOT\nMOVE (0.,0.,0.,0.,0.)\n");
  EXPECT_NEAR(robot.end.axes.column.x(), 0.0, kReal);
  const Ran turned =
      RunText("COORD ABSOL\nSYSDEF (1000.,1000.,-400.,1.5708,0,0)\nMOVE (10.,0.,0.,0.,0.)\n");
  EXPECT_NEAR(turned.end.axes.a_rad, 0.0, 1e-9);
  EXPECT_NEAR(turned.end.tip.tip.y(), 1010.0, 1e-3);
}

// OPT-7.33: via point, centre and normal of a hole are shifted as well.
TEST(DataRules, OffsetsShiftTheHole) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSYSDEF (1000.,1000.,-400.,0,0,0)\nMOVE (130.,50.,10.,0.,0.)\nPATH "
      "HOLE (25.)\n"
      "MOVE (100.,50.,0.,0.,0.)/VIA (100.,50.,100.,0.,0.)\n");
  EXPECT_NEAR(ran.end.tip.tip.x(), 1125.0, kReal);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1050.0, kReal);
  EXPECT_LT(ran.DistanceTo({1100.0, 1075.0, -400.0}), kReal);
}

// OPT-7.36: the offset stays after the program, and over GO and CALL.
TEST(DataRules, OffsetsStay) {
  const Ran first =
      RunText("CALL 46\n", {.programs = {{46, "SYSDEF (1000.,1000.,-400.,0,0,0)\n"}}});
  const Ran second =
      RunText("GO 47\n", {.programs = {{47, "COORD ABSOL\nMOVE (10.,20.,0.,0.,0.)\n"}},
                          .machine_state = first.machine_state});
  EXPECT_NEAR(second.end.tip.tip.x(), 1010.0, kReal);
}

// OPT-7.40: IA stays in machine coordinates.
TEST(DataRules, PositionIsOfTheMachine) {
  EXPECT_EQ(
      Value("COORD ABSOL\nSYSDEF (1000.,1000.,-400.,0,0,0)\nMOVE (10.,20.,0.,0.,0.)\nVR[0]=IA[0]\n",
            "VR[0]"),
      "1010.0");
}

// OPT-4.67, OPT-4.69, OPT-B.05: TCP holds over programs, moves nothing, and lifts the tip along the
// beam.
TEST(DataRules, ToolOffsetsStay) {
  const Ran first =
      RunText("COORD ABSOL\nVR[0]=IA[2]\nTCP (0.,0.,3./0.,0.,-6.)\nVR[1]=IA[2]-VR[0]\n",
              {.variables = {"VR[1]"}});
  EXPECT_EQ(first.variables.at("VR[1]"), "3.0");
  EXPECT_TRUE(first.parts.empty());
  const Ran second = RunText("COORD ABSOL\nMOVE (100.,97.,-400.,0.,1.570796)\n",
                             {.machine_state = first.machine_state});
  EXPECT_NEAR(second.end.axes.column.y(), 97.0 - 297.0, 1e-2);
}

// What the run has not given its value is told as assumed, each with how it could be set; flags,
// VI[98] and VI[99], and OA[0] are the control's own.
TEST(DataRules, WhatIsAssumedIsTold) {
  class Assumptions final : public machine::RunObserver {
   public:
    void OnAssumed(const machine::Assumed& one) override {
      std::string text = std::string(one.group) + "[" + std::to_string(one.index) + "]";
      if (one.on_off) text += " on/off";
      if (one.input == InputKind::kLogical) text += " logical";
      if (one.input == InputKind::kAnalogue) text += " analogue";
      told.push_back(text + (one.value == 0.0 ? "" : " set"));
    }
    std::vector<std::string> told;
  } assumptions;
  std::string text;
  for (const char* read : {"IL[86]", "IL[87]", "IL[94]", "IL[95]", "IL[96]", "VL[1]", "OL[2]"})
    text += "VL[0]=" + std::string(read) + "\n";
  for (const char* read :
       {"IA[5]", "OA[0]", "OA[1]", "VR[3]", "VI[4]", "VI[98]", "VI[99]", "PAR[5]", "VR[0]"})
    text += "VR[0]=" + std::string(read) + "\n";
  Result<std::unique_ptr<machine::Run>> run =
      OptimoFamily().NewRun(SetupOf(text, {.inputs = {{SimTime(0), InputKind::kLogical, 96, 1.0},
                                                      {SimTime(0), InputKind::kAnalogue, 5, 2.5}}}),
                            assumptions);
  ASSERT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(At(1.0)), machine::RunPhase::kFinished);
  EXPECT_THAT(assumptions.told, ElementsAre("IL[86] on/off logical", "IL[96] on/off logical set",
                                            "VL[1] on/off", "OL[2] on/off", "IA[5] analogue set",
                                            "OA[1]", "VR[3]", "VI[4]", "PAR[5]"));
}

// OPT-3.37, OPT-7.68: the flags are no inputs from outside: they are read whatever UPDATE says.
TEST(DataRules, FlagsAreReadWhateverIsUpdated) {
  const Ran ran = RunText(
      "UPDATE IL/OFF\nWORKDEF 0,7\nWORK 0,0/ON\nWORK 0,7/ON\nVL[1]=IL[87]\nVL[2]=IL[94]\n"
      "WORK 0,0/OFF\nWORK 0,7/OFF\nMOVE (121.02,2201.2,-50.,0.,0.)/NEXT\nVL[3]=IL[95]\n"
      "VL[4]=IL[86]\nVL[5]=IL[96]\n",
      {.inputs = {{SimTime(0), InputKind::kLogical, 86, 1.0},
                  {SimTime(0), InputKind::kLogical, 96, 1.0}},
       .variables = {"VL[1]", "VL[2]", "VL[3]", "VL[4]", "VL[5]"}});
  std::string values;
  for (const auto& [name, value] : ran.variables) values += value;
  EXPECT_EQ(values, "11100");
}

// OPT-7.61, OPT-7.70: the executions that VI[98] counts end with the greatest INTEGER.
TEST(DataRules, ExecutionsAreCountedToTheGreatestInteger) {
  Result<MachineState> state = DecodeMachineState(RunText("VI[2]=1\n").machine_state);
  ASSERT_TRUE(bool(state));
  state->data.vi[98] = 32766.0F;
  const Ran last =
      RunText("VI[2]=1\n", {.variables = {"VI[98]"}, .machine_state = EncodeMachineState(*state)});
  EXPECT_EQ(last.variables.at("VI[98]"), "32767");
  EXPECT_EQ(Value("VI[2]=1\n", "VI[98]", {.machine_state = last.machine_state}), "32767");
}

// OPT-7.59 to 7.62: what a person may write, at both ends of what each group holds.
TEST(DataRules, WhatMayBeWritten) {
  machine::Parameters parameters(OptimoParameterTable());
  const auto written = [&](std::string_view name, double value) {
    const Result<float> made = Writable(*VariableNamed(name), value, Resolve(parameters));
    return made ? std::to_string(*made)
                : std::to_string(Lookup(made.error().code).number) + " " +
                      std::string(made.error().detail);
  };
  const std::string whole = "9003 VI[1] holds whole numbers from -32768 to 32767";
  EXPECT_EQ(written("VI[1]", 32767.0), "32767.000000");
  EXPECT_EQ(written("VI[1]", 32768.0), whole);
  EXPECT_EQ(written("VI[1]", -32768.0), "-32768.000000");
  EXPECT_EQ(written("VI[1]", -32769.0), whole);
  EXPECT_EQ(written("VI[1]", 0.5), whole);
  EXPECT_EQ(written("VI[97]", 1.0), "1.000000");
  for (const std::string name : {"VI[98]", "VI[99]", "OA[0]"})
    EXPECT_EQ(written(name, 1.0), "9003 " + name + " is written by the machine alone");
  for (const std::string name : {"IL[0]", "IA[99]"})
    EXPECT_EQ(written(name, 1.0), "9003 " + name + " is an input: set the input, not its image");
  for (const std::string name : {"VL[0]", "OL[99]"}) {
    EXPECT_EQ(written(name, 0.0), "0.000000");
    EXPECT_EQ(written(name, 1.0), "1.000000");
    EXPECT_EQ(written(name, 2.0), "9003 " + name + " is 0 or 1");
    EXPECT_EQ(written(name, 0.5), "9003 " + name + " is 0 or 1");
  }
  EXPECT_EQ(written("OL[9]", 0.0), "0.000000");
  EXPECT_EQ(written("OL[9]", 1.0), "931 ");
  EXPECT_EQ(written("VL[9]", 1.0), "1.000000");
  EXPECT_TRUE(parameters.Set("GAS_CHANNELS", 3.0).ok());
  EXPECT_EQ(written("OL[9]", 1.0), "1.000000");
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(*Writable(*VariableNamed("VR[1]"), sign * 0x1p63, Resolve(parameters)),
              sign * 0x1p63F);
    EXPECT_EQ(written("OA[1]", sign * 0x1.000002p63), "9003 OA[1] holds numbers up to 2^63");
    EXPECT_EQ(*Writable(*VariableNamed("VR[1]"), sign * 0x1p-64, Resolve(parameters)),
              sign * 0x1p-64F);
    EXPECT_EQ(written("VR[1]", sign * 0x1.fffffep-65), "0.000000");
  }
}

// The state of a machine is read back as it was written; one of the version before is read too.
TEST(DataRules, MachineStateOfTheVersionBeforeIsRead) {
  const Ran ran = RunText("VR[5]=7.\nBREAK 9, 45\nSIMUL 8, 46\n");
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  ASSERT_TRUE(bool(state));
  EXPECT_EQ(EncodeMachineState(*state), ran.machine_state);
  EXPECT_EQ(state->breakpoint->program, 45);
  EXPECT_EQ(state->simul->step, 8);
  constexpr std::size_t kNewer = 5 * sizeof(std::int32_t);  // counted program, BREAK, SIMUL
  std::string old = ran.machine_state.substr(0, ran.machine_state.size() - kNewer);
  old[8] = 1;
  const Result<MachineState> from_old = DecodeMachineState(old);
  ASSERT_TRUE(bool(from_old));
  EXPECT_EQ(from_old->data.vr[5], 7.0F);
  EXPECT_FALSE(from_old->breakpoint.has_value());
  for (std::size_t length = 0; length < ran.machine_state.size(); length += 97) {
    EXPECT_FALSE(bool(DecodeMachineState(ran.machine_state.substr(0, length))));
  }
}

// What the run itself has written is not assumed, by whatever instruction: only the input is.
TEST(DataRules, WhatTheRunHasWrittenIsNotAssumed) {
  class Assumptions final : public machine::RunObserver {
   public:
    void OnAssumed(const machine::Assumed& one) override {
      told.push_back(std::string(one.group) + "[" + std::to_string(one.index) + "]");
    }
    std::vector<std::string> told;
  } assumptions;
  const std::string text =
      "OL[16]=ON\nVL[1]=OL[16]\nASSIGN VL[20]=5 /3\nVL[2]=VL[20] AND VL[21]\nOA[5]=2.5\n"
      "VR[1]=OA[5]\nVR[2]=IA[40]\nVR[3]=VR[2]\n";
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(SetupOf(text), assumptions);
  ASSERT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(At(1.0)), machine::RunPhase::kFinished);
  EXPECT_THAT(assumptions.told, ElementsAre("IA[40]"));
}

}  // namespace
}  // namespace rmlcell::optimo::testing
