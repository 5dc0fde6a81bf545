#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/optimo/machine/machine_state.h"
#include "tests/engine/optimo/control/run_text.h"

// Outputs, inputs and their images: what the program writes and what the machine follows.
namespace rmlcell::optimo::testing::output_rules {
namespace {

using machine::InputKind;
using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

std::vector<std::string> Told(const Ran& ran) {
  std::vector<std::string> told = ran.told;
  std::erase_if(told, [](const std::string& what) { return what.starts_with("compiling"); });
  return told;
}

MachineState StateOf(const Ran& ran) {
  const Result<MachineState> state = DecodeMachineState(ran.machine_state);
  EXPECT_TRUE(bool(state));
  return state ? *state : MachineState{};
}

const RunOptions kThreeGases{.parameters = {{"GAS_CHANNELS", "3"}}};

// OPT-5.38, OPT-5.40, OPT-E.7409: a refused output keeps its image, and the machine does not
// follow: the gas stays as it is, whichever of the two is on.
TEST(OutputRules, ARefusedOutputKeepsItsImage) {
  for (const auto& [first, second, gas] :
       {std::tuple{"8", "9", "gas 2"}, std::tuple{"9", "8", "gas 3"}}) {
    RunOptions options = kThreeGases;
    options.variables = {"OL[8]", "OL[9]"};
    const std::string one(first), two(second);
    const Ran ran = RunText("OL[" + one + "]=ON\nOL[" + two + "]=ON\n", options);
    EXPECT_THAT(Told(ran), ElementsAre("OL[" + one + "] 1", gas, "E7409"));
    EXPECT_EQ(ran.variables.at("OL[8]") + ran.variables.at("OL[9]"), "11");
    const MachineState state = StateOf(ran);
    EXPECT_EQ(state.outputs.logical[8], one == "8");
    EXPECT_EQ(state.outputs.logical[9], one == "9");
  }
}

// OPT-5.40: off is never refused, and when the first is off the second may come.
TEST(OutputRules, OneGasAfterTheOther) {
  EXPECT_THAT(
      Told(RunText("OL[8]=ON\nOL[8]=OFF\nOL[9]=ON\nOL[8]=OFF\nOL[9]=OFF\n", kThreeGases)),
      ElementsAre("OL[8] 1", "gas 2", "OL[8] 0", "gas 1", "OL[9] 1", "gas 3", "OL[9] 0", "gas 1"));
}

// OPT-5.40, OPT-5.38: it is the output that counts, not the image: a gas that was refused is not
// on, and one that is on already is no second one.
TEST(OutputRules, ARefusedGasIsNotOn) {
  EXPECT_THAT(Told(RunText("OL[8]=ON\nOL[9]=ON\nOL[8]=ON\nOL[8]=OFF\nOL[8]=ON\n", kThreeGases)),
              ElementsAre("OL[8] 1", "gas 2", "E7409", "OL[8] 0", "gas 1", "OL[8] 1", "gas 2"));
  EXPECT_THAT(Told(RunText("OL[9]=ON\nOL[8]=ON\nOL[9]=OFF\nOL[9]=ON\n", kThreeGases)),
              ElementsAre("OL[9] 1", "gas 3", "E7409", "OL[9] 0", "gas 1", "OL[9] 1", "gas 3"));
}

// OPT-5.40, OPT-7.98, OPT-6.24: where outputs follow their images again, one of two gases comes,
// the first, and the other is refused; one that is on makes way when its image says so.
TEST(OutputRules, GasesFromTheirImages) {
  const std::string both = "OL[8]=ON\nOL[9]=ON\n";
  EXPECT_THAT(Told(RunText("UPDATE OL/OFF\n" + both + "UPDATE OL/ON\n", kThreeGases)),
              ElementsAre("OL[8] 1", "gas 2", "E7409"));
  RunOptions dry = kThreeGases;
  dry.simul = machine::ProgramStep{.program = 1, .step = 3};
  EXPECT_THAT(Told(RunText(both + "VI[2]=1\n", dry)), ElementsAre("OL[8] 1", "gas 2", "E7409"));
  EXPECT_THAT(Told(RunText("OL[8]=ON\nIMAGE OL\nOL[8]=OFF\nOL[9]=ON\nREAL OL\n", kThreeGases)),
              ElementsAre("OL[8] 1", "gas 2", "OL[8] 0", "gas 1", "OL[9] 1", "gas 3"));
  EXPECT_THAT(Told(RunText("OL[9]=ON\nIMAGE OL\nOL[9]=OFF\nOL[8]=ON\nREAL OL\n", kThreeGases)),
              ElementsAre("OL[9] 1", "gas 3", "OL[9] 0", "gas 1", "OL[8] 1", "gas 2"));
}

// OPT-5.40, OPT-2.49: between two /FLY moves it is the passage that counts: there the first gas is
// off when the second comes. A refusal is told there too, at its own step.
TEST(OutputRules, GasesOfAPassage) {
  const std::string way = "OL[8]=ON\n" + kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n";
  const std::string end = "MOVE (1200.,1000.,-400.,0.,0.)\n";
  EXPECT_THAT(Told(RunText(way + "OL[8]=OFF\nOL[9]=ON\n" + end, kThreeGases)),
              ElementsAre("OL[8] 1", "gas 2", "OL[8] 0", "gas 1", "OL[9] 1", "gas 3"));
  const Ran refused = RunText(way + "OL[9]=ON\n" + end, kThreeGases);
  EXPECT_EQ(refused.First("E7409").step, 7);
  EXPECT_GT(refused.First("E7409").at_s, ToSeconds(refused.moves.front().at) + 2.0);
}

// OPT-5.42, OPT-B.54: a gas outlives its run, and the next one tells that gas 1 is back.
TEST(OutputRules, AGasOutlivesItsRun) {
  RunOptions next = kThreeGases;
  next.machine_state = RunText("OL[8]=ON\n", kThreeGases).machine_state;
  EXPECT_THAT(Told(RunText("OL[9]=ON\nOL[8]=OFF\n", next)),
              ElementsAre("E7409", "OL[8] 0", "gas 1"));
}

// OPT-5.41, OPT-E.931: with two channels OL[9] ON is alarm 931, also behind UPDATE; OFF is not.
// With three it is an output. Its image stays set.
TEST(OutputRules, TheThirdGasNeedsItsChannel) {
  const Ran ran = RunText("OL[9]=OFF\nOL[9]=ON\nVI[2]=1\n", {.variables = {"OL[9]", "VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 931);
  EXPECT_EQ(ran.variables.at("OL[9]") + ran.variables.at("VI[2]"), "10");
  EXPECT_FALSE(StateOf(ran).outputs.logical[9]);
  EXPECT_EQ(CodeOf(RunText("UPDATE OL/OFF\nOL[9]=ON\nUPDATE OL/ON\n")), 931);
  EXPECT_EQ(CodeOf(RunText("OL[9]=ON\n", kThreeGases)), 0);
  // The alarm switches beam and shutter off.
  const Ran cutting = RunText("WORK 0,0/ON\nOL[9]=ON\n");
  EXPECT_THAT(Told(cutting),
              ElementsAre("shutter open", "beam on 100.0", "beam off", "E931", "shutter closed"));
}

// OPT-5.39, OPT-B.07, OPT-5.42: 8 and 9 are gas, 11 is the sensor, the others are outputs and no
// more. What does not change is not told.
TEST(OutputRules, WhatEachOutputIs) {
  for (const int plain : {0, 7, 10, 12, 16, 99}) {
    const std::string name = "OL[" + std::to_string(plain) + "]";
    EXPECT_THAT(Told(RunText(name + "=ON\n" + name + "=ON\n" + name + "=OFF\n")),
                ElementsAre(name + " 1", name + " 0"));
  }
  EXPECT_THAT(Told(RunText("OL[11]=ON\nOL[11]=OFF\n")),
              ElementsAre("OL[11] 1", "sensor on", "OL[11] 0", "sensor off"));
}

// OPT-7.58, OPT-7.96: ON, TRUE, YES and 1 switch on; OFF, FALSE, NO and 0 off.
TEST(OutputRules, EveryLogicalConstant) {
  for (const std::string on : {"ON", "TRUE", "YES", "1"}) {
    EXPECT_THAT(Told(RunText("OL[16]=" + on + "\n")), ElementsAre("OL[16] 1")) << on;
  }
  for (const std::string off : {"OFF", "FALSE", "NO", "0"}) {
    EXPECT_THAT(Told(RunText("OL[16]=ON\nOL[16]=" + off + "\n")),
                ElementsAre("OL[16] 1", "OL[16] 0"));
  }
}

// OPT-7.106, OPT-E.7412: an output that the system uses is warned of by the check, and switched all
// the same.
TEST(OutputRules, SystemOutputsAreSwitched) {
  EXPECT_THAT(Told(RunText("OL[20]=ON\n")), ElementsAre("OL[20] 1"));
}

// OPT-7.96, OPT-7.64: analogue outputs follow their images too; each index is its own, and a value
// that is there already is not told.
TEST(OutputRules, AnalogueOutputs) {
  EXPECT_THAT(Told(RunText("OA[1]=1.5\nOA[99]=2.5\nOA[1]=1.5\nOA[1]=-0.5\n")),
              ElementsAre("OA[1] 1.5", "OA[99] 2.5", "OA[1] -0.5"));
}

// OPT-7.98, OPT-7.101, OPT-B.61: UPDATE disconnects each group that it names, and no other.
TEST(OutputRules, EachGroupIsUpdatedByItself) {
  const std::string outputs = "OL[16]=ON\nOA[5]=2.5\n";
  EXPECT_THAT(Told(RunText("UPDATE OL/OFF\n" + outputs)), ElementsAre("OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("UPDATE OA/OFF\n" + outputs)), ElementsAre("OL[16] 1"));
  EXPECT_THAT(Told(RunText("UPDATE IL,IA/OFF\n" + outputs)), ElementsAre("OL[16] 1", "OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("UPDATE OL, OA /OFF\n" + outputs)), ElementsAre());
  EXPECT_THAT(Told(RunText("UPDATE OL,OA/OFF\n" + outputs + "DELAY 1\nUPDATE OL,OA/ON\n")),
              UnorderedElementsAre("wait dwell 1.0", "OL[16] 1", "OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("UPDATE OL,OA/OFF\n" + outputs + "UPDATE OL/ON\n")),
              ElementsAre("OL[16] 1"));
  EXPECT_THAT(Told(RunText("UPDATE OL,OA/OFF\n" + outputs + "UPDATE OA/ON\n")),
              ElementsAre("OA[5] 2.5"));
}

// OPT-7.100, OPT-B.61: IMAGE and REAL: the groups named, or all four.
TEST(OutputRules, EachGroupIsSimulatedByItself) {
  const std::string outputs = "OL[16]=ON\nOA[5]=2.5\n";
  EXPECT_THAT(Told(RunText("IMAGE OL\n" + outputs)), ElementsAre("OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("IMAGE OA\n" + outputs)), ElementsAre("OL[16] 1"));
  EXPECT_THAT(Told(RunText("IMAGE\n" + outputs)), ElementsAre());
  EXPECT_THAT(Told(RunText("IMAGE OL, OA\n" + outputs + "REAL OA\n")), ElementsAre("OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("IMAGE\n" + outputs + "REAL OL\n")), ElementsAre("OL[16] 1"));
  EXPECT_THAT(Told(RunText("IMAGE\n" + outputs + "REAL\n")),
              UnorderedElementsAre("OL[16] 1", "OA[5] 2.5"));
  // REAL of a group that UPDATE holds back sets nothing, and of the inputs neither.
  EXPECT_THAT(Told(RunText("UPDATE OL/OFF\nIMAGE OL\n" + outputs + "REAL OL\n")),
              ElementsAre("OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("IMAGE OL\n" + outputs + "REAL IL,IA\n")), ElementsAre("OA[5] 2.5"));
}

// OPT-7.100, OPT-7.98: a group comes back by itself, whatever the other is; the other one is not
// touched: a gas that was refused is not tried again.
TEST(OutputRules, EachGroupComesBackByItself) {
  const std::string outputs = "OL[16]=ON\nOA[5]=2.5\n";
  EXPECT_THAT(Told(RunText("IMAGE OA\n" + outputs + "REAL OA\n")),
              ElementsAre("OL[16] 1", "OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("IMAGE OL\n" + outputs + "REAL OL\n")),
              ElementsAre("OA[5] 2.5", "OL[16] 1"));
  EXPECT_THAT(Told(RunText("UPDATE OA/OFF\n" + outputs + "UPDATE OA/ON\n")),
              ElementsAre("OL[16] 1", "OA[5] 2.5"));
  EXPECT_THAT(Told(RunText("IMAGE\n" + outputs + "REAL IL\nREAL OA\n")), ElementsAre("OA[5] 2.5"));
  const std::string refused = "OL[8]=ON\nOL[9]=ON\n";
  EXPECT_EQ(RunText(refused + "UPDATE OA/ON\nREAL OA\nREAL IL,IA\n", kThreeGases).Count("E7409"),
            1);
  EXPECT_EQ(RunText(refused + "UPDATE OL/ON\n", kThreeGases).Count("E7409"), 2);
}

// OPT-7.97, OPT-7.98, OPT-7.100: inputs of a group that is off keep their images; the other group
// is read on.
TEST(OutputRules, InputsOfEachGroup) {
  const auto read = [](const std::string& before) {
    const Ran ran = RunText(before + "DELAY 1\nVL[0]=IL[20]\nVR[0]=IA[40]\n",
                            {.inputs = {{At(0.5), InputKind::kLogical, 20, 1.0},
                                        {At(0.5), InputKind::kAnalogue, 40, 1.5}},
                             .variables = {"VL[0]", "VR[0]"}});
    return ran.variables.at("VL[0]") + " " + ran.variables.at("VR[0]");
  };
  EXPECT_EQ(read(""), "1 1.5");
  EXPECT_EQ(read("UPDATE IL/OFF\n"), "0 1.5");
  EXPECT_EQ(read("UPDATE IA/OFF\n"), "1 0.0");
  EXPECT_EQ(read("UPDATE IL, IA /OFF\n"), "0 0.0");
  EXPECT_EQ(read("UPDATE IL,IA/OFF\nUPDATE IA/ON\n"), "0 1.5");
  EXPECT_EQ(read("IMAGE IL\n"), "0 1.5");
  EXPECT_EQ(read("IMAGE IA\n"), "1 0.0");
  EXPECT_EQ(read("IMAGE IA,IL\nREAL IL\n"), "1 0.0");
  EXPECT_EQ(read("UPDATE OL,OA/OFF\n"), "1 1.5");
}

// OPT-7.64, OPT-7.65: IA[0] to IA[4] are the five axes in their order, whatever comes from outside;
// from 5 on it is the input.
TEST(OutputRules, PositionsAreReadInTheirOrder) {
  machine::InputScript script;
  for (int n = 0; n < 6; ++n) script.push_back({At(0.0), InputKind::kAnalogue, n, 77.0});
  const Ran ran = RunText(
      "MOVE (1001.,1002.,-103.,0.25,0.5)\nVR[0]=IA[0]\nVR[1]=IA[1]\nVR[2]=IA[2]\nVR[3]=IA[3]\nVR[4]=IA[4]\n"
      "VR[5]=IA[5]\n",
      {.inputs = script, .variables = {"VR[0]", "VR[1]", "VR[2]", "VR[3]", "VR[4]", "VR[5]"}});
  const char* wanted[] = {"1001.0", "1002.0", "-103.0", "0.25", "0.5", "77.0"};
  for (int n = 0; n < 6; ++n) {
    EXPECT_EQ(ran.variables.at("VR[" + std::to_string(n) + "]"), wanted[n]);
  }
}

// OPT-7.65, OPT-2.59: during a motion positions are those of the moment: 50 mm/s for one second of
// a /NEXT move, less half a ramp of 0.0707 s.
TEST(OutputRules, PositionsOnTheWay) {
  const std::string text =
      "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nDELAY 1\nVR[0]=IA[0]\nVR[2]=IA[2]\n";
  const Ran tip = RunText("COORD ABSOL\nPATH LIN\n" + text, {.variables = {"VR[0]", "VR[2]"}});
  EXPECT_NEAR(std::stod(tip.variables.at("VR[0]")), 21.02 + 50.0 - 1.767767, 1e-3);
  EXPECT_EQ(tip.variables.at("VR[2]"), "-350.0");
}

// OPT-7.59: every index from 0 to 99 is a variable of its own, in every group that can be written.
TEST(OutputRules, FirstAndLastVariable) {
  const Ran ran = RunText(
      "VR[0]=1.5\nVR[99]=2.5\nVI[0]=3\nVI[97]=4\nVL[0]=ON\nVL[99]=ON\nOL[0]=ON\nOL[99]=ON\nOA[1]=5.5\n"
      "OA[99]=6.5\nVR[07]=7.5\n",
      {.variables = {"VR[0]", "VR[99]", "VI[0]", "VI[97]", "VL[0]", "VL[99]", "VL[98]", "OL[0]",
                     "OL[99]", "OL[98]", "OA[1]", "OA[99]", "VR[7]", "VR[98]"}});
  const std::map<std::string, std::string> wanted = {
      {"VR[0]", "1.5"}, {"VR[99]", "2.5"}, {"VI[0]", "3"},   {"VI[97]", "4"},  {"VL[0]", "1"},
      {"VL[99]", "1"},  {"VL[98]", "0"},   {"OL[0]", "1"},   {"OL[99]", "1"},  {"OL[98]", "0"},
      {"OA[1]", "5.5"}, {"OA[99]", "6.5"}, {"VR[7]", "7.5"}, {"VR[98]", "0.0"}};
  EXPECT_EQ(ran.variables, wanted);
}

// OPT-7.59: a variable is read by its name from outside, in either case; what is none is refused.
TEST(OutputRules, VariablesByName) {
  DataArea data;
  data.vr[5] = 7.5F;
  data.vi[99] = -3.0F;
  data.vl[1] = data.il[2] = data.ol[3] = true;
  data.ia[4] = 1.25F;
  data.oa[0] = 2.5F;
  EXPECT_EQ(ReadByName(data, "VR[5]"),
            (machine::VariableValue{machine::VariableKind::kReal, "7.5"}));
  EXPECT_EQ(ReadByName(data, "vi[99]"),
            (machine::VariableValue{machine::VariableKind::kInteger, "-3"}));
  EXPECT_EQ(ReadByName(data, "VL[1]"),
            (machine::VariableValue{machine::VariableKind::kLogical, "1"}));
  EXPECT_EQ(ReadByName(data, "Il[2]"),
            (machine::VariableValue{machine::VariableKind::kLogical, "1"}));
  EXPECT_EQ(ReadByName(data, "oL[3]"),
            (machine::VariableValue{machine::VariableKind::kLogical, "1"}));
  EXPECT_EQ(ReadByName(data, "OL[2]"),
            (machine::VariableValue{machine::VariableKind::kLogical, "0"}));
  EXPECT_EQ(ReadByName(data, "VL[0]"),
            (machine::VariableValue{machine::VariableKind::kLogical, "0"}));
  EXPECT_EQ(ReadByName(data, "IL[0]"),
            (machine::VariableValue{machine::VariableKind::kLogical, "0"}));
  EXPECT_EQ(ReadByName(data, "IA[4]"),
            (machine::VariableValue{machine::VariableKind::kReal, "1.25"}));
  EXPECT_EQ(ReadByName(data, "OA[0]"),
            (machine::VariableValue{machine::VariableKind::kReal, "2.5"}));
  for (const char* none : {"VR", "VR[", "VR[5", "VR5]", "VR[100]", "VR[-1]", "VR[x]", "VR[]",
                           "XR[5]", "VX[5]", "V[5]", "VRR[5]", "[5]", ""}) {
    EXPECT_EQ(ReadByName(data, none), std::nullopt) << none;
  }
}

// OPT-7.101, OPT-B.54: all images and outputs are kept from run to run.
TEST(OutputRules, ImagesAreKept) {
  const Ran first = RunText("OL[16]=ON\nOA[5]=2.5\nUPDATE OL,OA/OFF\nOL[17]=ON\nOA[6]=3.5\n");
  const MachineState state = StateOf(first);
  EXPECT_TRUE(state.outputs.logical[16] && state.data.ol[17] && !state.outputs.logical[17]);
  EXPECT_EQ(state.outputs.analogue[5], 2.5F);
  EXPECT_EQ(state.data.oa[6], 3.5F);
  EXPECT_EQ(state.outputs.analogue[6], 0.0F);
  const Ran second =
      RunText("VL[0]=OL[17]\nVR[0]=OA[6]\nUPDATE OL,OA/ON\n",
              {.variables = {"VL[0]", "VR[0]"}, .machine_state = first.machine_state});
  EXPECT_EQ(second.variables.at("VL[0]") + second.variables.at("VR[0]"), "13.5");
  EXPECT_THAT(Told(second), UnorderedElementsAre("OL[17] 1", "OA[6] 3.5"));
}

}  // namespace
}  // namespace rmlcell::optimo::testing::output_rules
