#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

// TCP, and the zero procedure. New machines stand at home: column (21.02, 2201.2, -50), head down.
namespace rmlcell::optimo::testing::tool_rules {
namespace {

using machine::InputKind;
using machine::Mode;
using ::testing::ElementsAre;

constexpr double kReal_mm = 1e-4;  // literals have seven digits

MachineState StateAfter(const std::string& text) {
  const Result<MachineState> state = DecodeMachineState(RunText(text).machine_state);
  EXPECT_TRUE(bool(state));
  return state ? *state : MachineState{};
}

void ExpectTip(const std::string& text, const motion::MachinePoint& tip) {
  const Ran ran = RunText(text);
  EXPECT_NEAR(ran.end.tip.tip.x(), tip.x(), kReal_mm) << text;
  EXPECT_NEAR(ran.end.tip.tip.y(), tip.y(), kReal_mm) << text;
  EXPECT_NEAR(ran.end.tip.tip.z(), tip.z(), kReal_mm) << text;
}

// The warnings of TCP, in order.
std::vector<std::string> WarningsOf(const std::string& values) {
  std::vector<std::string> told = RunText("TCP (" + values + ")\n").told;
  std::erase(told, "compiling 1");
  return told;
}

std::string NotZeroed() {
  MachineState state = NewMachine(Resolve(machine::Parameters(OptimoParameterTable())));
  state.zeroed = false;
  return EncodeMachineState(state);
}

// OPT-4.64: with a slash or with six commas it is the same; the first three values are the offset
// of the tip, the second three the reference point.
TEST(ToolRules, TwoFormsOfTcp) {
  for (const char* values : {"1.,2.,3. / 4.,5.,-6.", "1.,2.,3.,4.,5.,-6."}) {
    const MachineState state = StateAfter("TCP (" + std::string(values) + ")\n");
    EXPECT_EQ(state.tool.offset, (motion::ToolOffset{1.0, 2.0, 3.0})) << values;
    EXPECT_THAT(state.tool.reference, ElementsAre(4.0, 5.0, -6.0)) << values;
  }
}

// OPT-4.65, OPT-4.68: the tip is L - Z0 below the column: at Z 0 at -300 after power-up, at -297
// with Z0 = 3. OPT-B.02: the calibrated tool is that of a new machine.
TEST(ToolRules, TheTipMovesTowardsTheLens) {
  ExpectTip("MOVE (500.,600.,0.,0.,0.)\n", {500.0, 600.0, -300.0});
  ExpectTip("TCP (0.,0.,3./0.,0.,-6.)\nMOVE (500.,600.,0.,0.,0.)\n", {500.0, 600.0, -297.0});
  const MachineState fresh = StateAfter("VI[2]=1\n");
  EXPECT_EQ(fresh.tool.offset, (motion::ToolOffset{0.0, 0.0, 0.0}));
  EXPECT_THAT(fresh.tool.reference, ElementsAre(0.0, 0.0, -5.0));
}

// OPT-4.66: the calibrated tip is 0.8 mm below the nozzle: the description of the machine says so.
TEST(ToolRules, TheDescriptionTellsTheNozzleDistance) {
  for (const machine::ParameterInfo& info : OptimoParameterTable()) {
    if (info.name != "HEAD_LENGTH") continue;
    EXPECT_NE(info.text.find("0.8 mm below the nozzle"), std::string_view::npos) << info.text;
    return;
  }
  FAIL() << "no HEAD_LENGTH";
}

// OPT-4.70, OPT-B.04: X0 and Y0 are applied along ex and ey of the head, which turn with it.
TEST(ToolRules, AnOffsetBesideTheAxisTurnsWithTheHead) {
  const std::string tcp = "TCP (8.,5.,1./0.,0.,-5.)\n";
  ExpectTip(tcp + "MOVE (500.,600.,0.,0.,0.)\n", {508.0, 605.0, -299.0});
  // A quarter turn: ex = (0,1,0), ey = (-1,0,0).
  ExpectTip(tcp + "MOVE (500.,600.,0.,1.570796327,0.)\n", {495.0, 608.0, -299.0});
  // B a quarter turn: u = (0,-1,0), ey = (0,0,1).
  ExpectTip(tcp + "MOVE (500.,600.,0.,0.,1.570796327)\n", {508.0, 899.0, 5.0});
}

// OPT-4.70, OPT-4.71, OPT-4.55, OPT-B.90: which warning for which values, and no other.
TEST(ToolRules, EachWarningOfTcpByItself) {
  EXPECT_THAT(WarningsOf("0.,0.,0./0.,0.,-5."), ElementsAre());
  EXPECT_THAT(WarningsOf("0.,0.,5./0.,0.,4.5"), ElementsAre());
  for (const char* beside : {"1.,0.,0./0.,0.,-5.", "0.,1.,0./0.,0.,-5.", "0.,0.,0./1.,0.,-5.",
                             "0.,0.,0./0.,1.,-5.", "0.,0.,3./0.,1.,3.", "0.,0.,3./1.,0.,3."}) {
    EXPECT_THAT(WarningsOf(beside), ElementsAre("E7313")) << beside;
  }
  EXPECT_THAT(WarningsOf("0.,0.,0./0.,0.,0."), ElementsAre("E7312"));
  EXPECT_THAT(WarningsOf("0.,0.,2./0.,0.,2."), ElementsAre("E7312"));
  EXPECT_THAT(WarningsOf("1.,2.,3./1.,2.,3."), ElementsAre("E7312", "E7313"));
  EXPECT_THAT(WarningsOf("0.,0.,0./0.,0.,5."), ElementsAre("E7315"));
  EXPECT_THAT(WarningsOf("0.,0.,1./0.,2.,5."), ElementsAre("E7315", "E7313"));
}

// OPT-4.71: equal points give no axis, but the offset counts.
TEST(ToolRules, EqualPointsStillMoveTheTip) {
  ExpectTip("TCP (0.,0.,2./0.,0.,2.)\nMOVE (500.,600.,0.,0.,0.)\n", {500.0, 600.0, -298.0});
}

// OPT-4.69: the column stays where it is; IA in ABSOL shows the other tip at once.
TEST(ToolRules, TcpMovesNothing) {
  const Ran ran = RunText(
      "VR[0]=IA[2]\nCOORD ABSOL\nVR[1]=IA[2]\nTCP (0.,0.,3./0.,0.,-6.)\nVR[2]=IA[2]\n"
      "COORD ROBOT\nVR[3]=IA[2]\n",
      {.variables = {"VR[0]", "VR[1]", "VR[2]", "VR[3]"}});
  EXPECT_EQ(ran.variables.at("VR[0]"), "-50.0");
  EXPECT_EQ(ran.variables.at("VR[1]"), "-350.0");
  EXPECT_EQ(ran.variables.at("VR[2]"), "-347.0");
  EXPECT_EQ(ran.variables.at("VR[3]"), "-50.0");
  EXPECT_TRUE(ran.parts.empty());
}

// OPT-4.67: until another TCP, over CALL, GO and the end of the program, in ABSOL moves.
TEST(ToolRules, TheLastTcpHolds) {
  const Ran called =
      RunText("TCP (0.,0.,9./0.,0.,-5.)\nCALL 90\nCOORD ABSOL\nMOVE (500.,600.,-300.,0.,0.)\n",
              {.programs = {{90, "TCP (0.,0.,3./0.,0.,-6.)\n"}}});
  EXPECT_NEAR(called.end.axes.column.z(), -3.0, kReal_mm);
  const Ran later =
      RunText("GO 46\n", {.programs = {{46, "COORD ABSOL\nMOVE (500.,600.,-300.,0.,0.)\n"}},
                          .machine_state = called.machine_state});
  EXPECT_NEAR(later.end.axes.column.z(), -3.0, kReal_mm);
  const Ran other = RunText("TCP (0.,0.,0./0.,0.,-5.)\nCOORD ABSOL\nMOVE (500.,600.,-300.,0.,0.)\n",
                            {.machine_state = later.machine_state});
  EXPECT_NEAR(other.end.axes.column.z(), 0.0, kReal_mm);
}

// OPT-B.55, OPT-4.72: a TCP whose values cannot be had changes nothing, whichever of the six it is.
TEST(ToolRules, AFailingTcpChangesNothing) {
  for (int n = 0; n < 6; ++n) {
    std::string values;
    for (int k = 0; k < 6; ++k) {
      values += (k == 0 ? "" : k == 3 ? " / " : ",");
      values += k == n ? "(1./VR[0])" : std::to_string(k + 1) + ".";
    }
    const Ran ran = RunText("TCP (" + values + ")\n");
    EXPECT_EQ(CodeOf(ran), 7201) << values;
    const Result<MachineState> state = DecodeMachineState(ran.machine_state);
    ASSERT_TRUE(bool(state));
    EXPECT_EQ(state->tool.offset, (motion::ToolOffset{0.0, 0.0, 0.0}));
  }
}

// OPT-2.48, OPT-2.49: between /FLY moves a TCP that leaves the tip where it is cancels no passage,
// one that changes any of its three values does.
TEST(ToolRules, OnlyATcpThatMovesTheTipCancelsAPassage) {
  const auto chain = [](const std::string& values) {
    return RunText(kThere + "TCP (0.,0.,1./0.,0.,-5.)\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\nTCP (" +
                   values + ")\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  };
  const motion::MachinePoint corner{1100.0, 1000.0, -400.0};
  for (const char* same : {"0.,0.,1./0.,0.,-5.", "0.,0.,1./0.,0.,-6."}) {
    const Ran ran = chain(same);
    EXPECT_EQ(ran.Count("E7304"), 0) << same;
    EXPECT_NEAR(ran.DistanceTo(corner), 1.358847515, 1e-5) << same;  // case C01
  }
  for (const char* other : {"0.5,0.,1./0.,0.,-5.", "0.,0.5,1./0.,0.,-5.", "0.,0.,1.5/0.,0.,-5."}) {
    const Ran ran = chain(other);
    EXPECT_EQ(ran.Count("E7304"), 1) << other;
    EXPECT_EQ(ran.Finding(7304).step, 7);
    EXPECT_LT(ran.DistanceTo(corner), kReal_mm) << other;
  }
}

// OPT-4.48: an axis system that is not zeroed lets a program run to its first MOVE, and no further;
// ZERO makes it ready.
TEST(ToolRules, NotZeroed) {
  const RunOptions cold{
      .mode = Mode::kRemote, .variables = {"VI[2]"}, .machine_state = NotZeroed()};
  const Ran refused = RunText("VI[2]=1\nMOVE (10.,0.,0.,0.,0.)\nVI[2]=2\n", cold);
  EXPECT_EQ(CodeOf(refused), 7310);
  EXPECT_EQ(refused.outcome.place.step, 2);
  EXPECT_EQ(refused.variables.at("VI[2]"), "1");
  EXPECT_TRUE(refused.parts.empty());
  EXPECT_EQ(RunText("ZERO\nMOVE (10.,0.,0.,0.,0.)\n", cold).outcome.kind,
            machine::OutcomeKind::kCompleted);
  EXPECT_TRUE(StateAfter("VI[2]=1\n").zeroed);  // OPT-B.02
}

std::vector<std::string_view> Groups(const Ran& ran) {
  std::vector<std::string_view> paths;
  for (const machine::MoveDone& move : ran.moves) paths.push_back(move.path);
  return paths;
}

// OPT-4.49, OPT-4.51, OPT-B.60: Z, then A and B, then X and Y, in the same time at every override,
// set before or on the way.
TEST(ToolRules, TheOverrideHasNoEffectOnTheZeroProcedure) {
  const Ran plain = RunText("ZERO\n");
  EXPECT_THAT(Groups(plain), ElementsAre("ZERO_Z", "ZERO_AB", "ZERO_XY"));
  for (const double percent : {10.0, 55.0, 145.0}) {
    const Ran ran = RunText("ZERO\n", {.override_percent = percent});
    EXPECT_EQ(ran.time_s, plain.time_s) << percent;
    EXPECT_EQ(ran.Count("E7320"), 0);
    for (const double at : {0.01, 0.5, 20.0}) {
      const Ran changed =
          RunText("ZERO\n", {.inputs = {{At(at), InputKind::kOverride, 0, percent}}});
      EXPECT_EQ(changed.time_s, plain.time_s) << percent << " at " << at;
    }
  }
  // It counts again for what comes behind it.
  const std::string behind = "ZERO\nSPEED 10\nMOVE (100.,0.,0.,0.,0.)\n";
  const Ran half = RunText(behind, {.override_percent = 55.0});
  EXPECT_NEAR(half.parts.back().duration_s(),
              100.0 / 27.5 + 2.0 * std::sqrt(27.5 / 40000.0) + kSettle_s, 1e-6);
}

// OPT-4.49: SPEED and ACCEL of the program are none of its business either, nor its COORD.
TEST(ToolRules, TheZeroProcedureHasItsOwnSpeed) {
  const double plain_s = RunText("ZERO\n").time_s;
  EXPECT_EQ(RunText("SPEED 1\nACCEL 1\nZERO\n").time_s, plain_s);
  EXPECT_EQ(RunText("SPEED 0\nCOORD ABSOL\nPATH LIN\nZERO\n").time_s, plain_s);
}

// OPT-B.60: it ends at MECH_ZERO, each axis at its own, and the axes of the other groups stand
// meanwhile.
TEST(ToolRules, EachGroupGoesToItsMechanicalZero) {
  const Ran ran = RunText("ZERO\n", {.parameters = {{"MECH_ZERO_X", "10"},
                                                    {"MECH_ZERO_Y", "20"},
                                                    {"MECH_ZERO_Z", "30"},
                                                    {"MECH_ZERO_A", "0.4"},
                                                    {"MECH_ZERO_B", "0.5"}}});
  ASSERT_EQ(ran.moves.size(), 3U);
  const auto axes = [&](std::size_t n) {
    const motion::AxisPose& at = ran.moves[n].axes;
    return std::vector<double>{at.column.x(), at.column.y(), at.column.z(), at.a_rad, at.b_rad};
  };
  using Axes = std::vector<double>;
  const auto are = [](const Axes& wanted) {
    return ::testing::Pointwise(::testing::DoubleNear(1e-9), wanted);
  };
  EXPECT_THAT(axes(0), are({21.02, 2201.2, 30.0, 0.0, 0.0}));
  EXPECT_THAT(axes(1), are({21.02, 2201.2, 30.0, 0.4, 0.5}));
  EXPECT_THAT(axes(2), are({10.0, 20.0, 30.0, 0.4, 0.5}));
  EXPECT_LT(
      (ran.moves[2].program_point.from_origin() - motion::ProgramVector{10.0, 20.0, 30.0}).norm(),
      1e-9);
  EXPECT_NEAR(ran.moves[2].rotary_a, 0.4, 1e-9);
  EXPECT_NEAR(ran.end.axes.column.x(), 10.0, 1e-9);
}

// OPT-4.50: what the console starts: the zero procedure, and then program 4. Without a program 4
// that is 7102.
TEST(ToolRules, ZeroFromTheConsoleGoesOnWithProgramFour) {
  RunOptions options{.programs = {{4, "VI[2]=1\nMOVE (21.02,2201.2,-50.,0.,0.)\n"}},
                     .mode = Mode::kRemote,
                     .variables = {"VI[2]"},
                     .machine_state = NotZeroed()};
  const Ran ran = RunText("ZERO\nGO 4\n", options);
  EXPECT_THAT(Groups(ran), ElementsAre("ZERO_Z", "ZERO_AB", "ZERO_XY", "PTP"));
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_NEAR(ran.First("go 4").at_s, ToSeconds(ran.moves[2].at), 1e-9);
  EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
  options.programs.clear();
  const Ran without = RunText("ZERO\nGO 4\n", options);
  EXPECT_EQ(CodeOf(without), 7102);
  EXPECT_THAT(Groups(without), ElementsAre("ZERO_Z", "ZERO_AB", "ZERO_XY"));
  EXPECT_NEAR(without.end.axes.column.y(), 0.0, 1e-9);
}

// OPT-4.51, OPT-6.42: moved by hand in the midst of it, the zero procedure goes on from there, by
// no override and to whatever zero its axes have.
TEST(ToolRules, MovedByHandDuringTheZeroProcedure) {
  machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(
      SetupOf("ZERO\nVI[2]=1\n",
              {.parameters = {{"MECH_ZERO_Z", "1200"}}, .override_percent = 55.0}),
      nobody);
  ASSERT_TRUE(bool(run));
  (*run)->Advance(At(0.5));
  (*run)->Apply({At(0.5), InputKind::kStop});
  EXPECT_EQ((*run)->Advance(At(2.0)), machine::RunPhase::kHalted);
  motion::AxisPose moved = (*run)->state().axes;
  moved.column.z() -= 5.0;
  ASSERT_TRUE((*run)->may_be_moved());
  (*run)->MoveTo(moved);
  (*run)->Apply({(*run)->state().time, InputKind::kStart});
  EXPECT_EQ((*run)->Advance(At(1000.0)), machine::RunPhase::kFinished);
  EXPECT_EQ((*run)->outcome().kind, machine::OutcomeKind::kCompleted);
  EXPECT_TRUE((*run)->state().zeroed);
  const motion::AxisPose end = (*run)->state().axes;
  EXPECT_LT((end.column - motion::MachineVector{0.0, 0.0, 1200.0}).norm(), 1e-9);
}

// OPT-4.18, OPT-4.49: STOP halts the zero procedure, START finishes it.
TEST(ToolRules, StopDuringTheZeroProcedure) {
  const Ran plain = RunText("ZERO\nVI[2]=1\n");
  const Ran ran = RunText(
      "ZERO\nVI[2]=1\n", {.inputs = {{At(10.0), InputKind::kStop}, {At(20.0), InputKind::kStart}}});
  EXPECT_EQ(ran.First("halt STOP").step, 1);
  EXPECT_THAT(Groups(ran), ElementsAre("ZERO_Z", "ZERO_AB", "ZERO_XY"));
  EXPECT_NEAR(ran.end.axes.column.x(), 0.0, 1e-9);
  EXPECT_GT(ran.time_s, plain.time_s + 9.9);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::tool_rules
