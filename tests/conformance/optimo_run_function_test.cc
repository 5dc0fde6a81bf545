// Chapters 9 and 10: FUNCTION, parameters, the sample and special programs on the virtual machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/house_programs.h"
#include "tests/conformance/optimo_machine.h"

namespace rmlcell::optimo::testing {
namespace {

using ::testing::ElementsAre;

constexpr double kRadPerDegree = M_PI / 180.0;

void StoreHousePrograms(OptimoMachine& machine) {
  for (const machine::SpecialProgram& program : HousePrograms())
    machine.Store(program.slot, std::string(program.source));
}

// OPT-9.09: CALL levels and FUNCTION levels are counted apart, the latter anew in each program.
TEST(OptimoRunFunction, LevelsAreCountedApart) {
  OptimoMachine machine;
  machine.Store(41, "FUNCTION 42\n").Store(42, "CALL 50\n").Store(50, "FUNCTION 51\n");
  machine.Store(51, "FUNCTION 52\n").Store(52, "FUNCTION 53\n").Store(53, "FUNCTION 54\n");
  machine.Store(54, "VI[2]=1\n");
  const Ran ran = machine.Run("FUNCTION 41\n");
  EXPECT_TRUE(ran.completed());
  EXPECT_EQ(ran.Var("VI[2]"), "1");
  machine.Store(54, "FUNCTION 55\n").Store(55, "VI[2]=2\n").Store(50, "FUNCTION 51\n");
  EXPECT_EQ(machine.Run("FUNCTION 41\n").code(), 7502);  // OPT-E.7502
}

// OPT-9.13, OPT-1.13, OPT-9.14: the old code runs, with a warning, until the program is linked
// again.
TEST(OptimoRunFunction, AnAlteredFunctionIsLinkedAgainByItsCallers) {
  OptimoMachine machine;
  machine.Store(44, "VI[2]=1\n").Store(32, "FUNCTION 44\n");
  EXPECT_EQ(machine.Run(32).Var("VI[2]"), "1");
  machine.Store(44, "VI[2]=2\n");
  const Ran old = machine.Run(32);
  EXPECT_EQ(old.Var("VI[2]"), "1");
  EXPECT_TRUE(old.Has("E7110"));
  EXPECT_EQ(machine.Run(44).Var("VI[2]"), "2");  // by itself it is the new one
  machine.Store(32, "FUNCTION 44\n");
  const Ran linked = machine.Run(32);
  EXPECT_EQ(linked.Var("VI[2]"), "2");
  EXPECT_FALSE(linked.Has("E7110"));
}

// OPT-1.13: deleting a FUNCTION counts as altering it. The old code runs, with the warning.
TEST(OptimoRunFunction, ADeletedFunctionRunsOnInItsCallers) {
  OptimoMachine machine;
  machine.Store(44, "VI[2]=1\n").Store(32, "FUNCTION 44\n");
  machine.Run(32);
  machine.Delete(44);
  const Ran old = machine.Run(32);
  EXPECT_TRUE(old.completed());
  EXPECT_EQ(old.Var("VI[2]"), "1");
  EXPECT_TRUE(old.Has("E7110"));
  machine.Store(44, "VI[2]=1\n");  // the same object again: nothing is older
  EXPECT_FALSE(machine.Run(32).Has("E7110"));
}

// OPT-1.15: an executable that was linked off-line works without object 44, which was never here:
// nothing is older than what is stored, so nothing is warned of.
TEST(OptimoRunFunction, AnExecutableLinkedElsewhereNeedsNoFunction) {
  OptimoMachine office;
  office.Store(44, "VI[2]=1\n").Store(32, "FUNCTION 44\n");
  office.Run(32);
  OptimoMachine machine;
  machine.Store(32, "FUNCTION 44\n").StoreExecutable(32, office.Executable(32));
  const Ran ran = machine.Run(32);
  EXPECT_TRUE(ran.completed());
  EXPECT_EQ(ran.Var("VI[2]"), "1");
  EXPECT_FALSE(ran.Has("E7110"));
}

// OPT-1.15, OPT-E.7110: n + 100 is the executable of object n. Another one is refused when it is
// stored, and told of when it is there all the same.
TEST(OptimoRunFunction, TheExecutableOfAnotherProgramIsNoneOfThisOne) {
  OptimoMachine office;
  office.Store(21, "VI[2]=1\n");
  office.Run(21);
  const std::string foreign = office.Executable(21);
  EXPECT_TRUE(OptimoFamily().CheckExecutable(foreign, 21));
  const Status refused = OptimoFamily().CheckExecutable(foreign, 20);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().detail.find("program 21"), std::string::npos);
  OptimoMachine machine;
  machine.Store(20, "VI[2]=2\n").StoreExecutable(20, foreign);
  EXPECT_TRUE(machine.Run(20).Has("E7110"));
}

// OPT-9.15, OPT-7.52: sequence numbers and names belong to their module.
TEST(OptimoRunFunction, LabelsAndNamesAreLocal) {
  OptimoMachine machine;
  machine.Store(44, "DECLARE X = VI[3]\nGOTO 10\nX = 7\n10 X = 8\n");
  const Ran ran = machine.Run("DECLARE X = VI[2]\nGOTO 10\nX = 5\n10 FUNCTION 44\nX = X + 1\n");
  EXPECT_EQ(ran.Var("VI[2]"), "1");
  EXPECT_EQ(ran.Var("VI[3]"), "8");
}

// OPT-9.16: modal values are common to an executable.
TEST(OptimoRunFunction, ModalValuesAreShared) {
  OptimoMachine machine;
  machine.Store(44, "PATH LIN\nSPEED 30\nMOVE (521.02,2201.2,-350.,0.,0.)\n");
  const Ran ran = machine.Run("COORD ABSOL\nFUNCTION 44\nMOVE (621.02,2201.2,-350.,0.,0.)\n");
  ASSERT_EQ(ran.moves.size(), 2U);
  EXPECT_EQ(ran.moves[1].path, "LIN");
  EXPECT_NEAR(ran.moves[1].feed_mm_s, 150.0, 1e-9);
  EXPECT_NEAR(ran.run().state().tip.tip.x(), 621.02, 1e-3);
}

// OPT-9.26, OPT-9.21: copies in, nothing back; every activation has its own.
TEST(OptimoRunFunction, ParametersAreLocalToEachActivation) {
  OptimoMachine machine;
  machine.Store(44,
                "PAR[0]=PAR[0]-1.\nIF PAR[0] < 1. THEN 10\nFUNCTION 44 (PAR[0])\n"
                "10 VR[5]=VR[5]*10.+PAR[0]\n");
  const Ran ran = machine.Run("VR[1]=3.\nFUNCTION 44 (VR[1])\n");
  EXPECT_EQ(ran.Var("VR[1]"), "3.0");
  EXPECT_EQ(ran.Var("VR[5]"), "12.0");  // 0, then 1, then 2
}

// OPT-9.31, OPT-9.30: the manual's two examples.
TEST(OptimoRunFunction, TheExamplesOfParameters) {
  if (CorpusProgram("ch09-formal.S").empty()) GTEST_SKIP() << "the shared corpus is not here";
  OptimoMachine machine;
  machine.Store(44, CorpusProgram("ch09-param-function44.S"));
  const Ran ran = machine.Run(CorpusProgram("ch09-param-caller.S"));
  EXPECT_EQ(ran.Var("VI[30]"), "17");
  EXPECT_EQ(ran.Var("VI[31]"), "17");
  machine.Store(45, CorpusProgram("ch09-formal.S"));
  EXPECT_EQ(machine.Run("FUNCTION 45 (12.5, ON, 3)\n").Var("VR[5]"), "12.5");
}

// OPT-9.17, OPT-9.18: the rectangle as listed: 10 sqrt 2 + 100 + 50 + 100 mm under the beam, in
// both.
TEST(OptimoRunFunction, TheRectangle) {
  if (CorpusProgram("ch09-program44.S").empty()) GTEST_SKIP() << "the shared corpus is not here";
  for (const std::string main : {"ch09-program32.S", "ch09-program68.S"}) {
    OptimoMachine machine;
    machine.Store(44, CorpusProgram("ch09-program44.S")).Store(2, "SYSDEF\n");
    const Ran ran = machine.Run(CorpusProgram(main));
    double rectangle = 0.0;
    for (const Ran::Motion& motion : ran.motions) rectangle += motion.beam ? motion.length_mm : 0.0;
    EXPECT_NEAR(rectangle, 264.142, 2e-3) << main;
    EXPECT_LT(ran.NearestTo({2060, 770, -550}), 1e-3) << main;
  }
}

// OPT-10.02, OPT-10.03, OPT-10.01: sample 1. The hole is entered from its own centre: its first
// point is C + r X, and it goes round the axis (0,-1,0), by right hand: upwards next.
TEST(OptimoRunSamples, SampleOne) {
  if (CorpusProgram("sample1.S").empty()) GTEST_SKIP() << "the shared corpus is not here";
  const Ran ran = OptimoMachine().Run(CorpusProgram("sample1.S"));
  EXPECT_TRUE(ran.completed());
  EXPECT_THAT(ran.Events(), ElementsAre("schedule 11", "shutter open", "beam on 100.0", "beam off",
                                        "beam on 100.0", "wait dwell 0.5", "E7408", "beam off",
                                        "shutter closed"));
  EXPECT_LT(ran.NearestTo({1034.7706, 1427.226, 458.978}), 0.02);
  EXPECT_NEAR(ran.BeamLength(), 12.7 + 2 * M_PI * 12.7, 1e-2);
  ASSERT_GE(ran.moves.size(), 3U);
  EXPECT_NEAR(ran.moves[2].tip.tip.x(), 1047.4706, 1e-3);
  EXPECT_NEAR(ran.moves[2].tip.tip.y(), 1427.226, 1e-3);
  EXPECT_NEAR(ran.moves[2].tip.tip.z(), 446.278, 1e-3);
  const machine::RunState end = ran.run().state();
  EXPECT_NEAR(end.tip.tip.x(), 1034.7706, 1e-3);
  EXPECT_NEAR(end.tip.tip.z(), -569.722, 1e-3);
  EXPECT_NEAR(end.axes.column.x(), 1114.776, 2e-3);
  EXPECT_NEAR(end.axes.column.y(), 1138.091, 2e-3);
}

// OPT-10.05, OPT-10.06, OPT-10.07, OPT-10.08: sample 2 cuts three contours in a cylinder of radius
// 139.7 with the head radial.
TEST(OptimoRunSamples, SampleTwo) {
  const std::string source = CorpusProgram("sample2-cylind.S");
  if (source.empty()) GTEST_SKIP() << "the shared corpus is not here";
  OptimoMachine machine;
  StoreHousePrograms(machine);
  const Ran ran = machine.Run(source);
  EXPECT_TRUE(ran.completed());
  int on = 0;
  for (const std::string& event : ran.Events()) on += event.starts_with("beam on") ? 1 : 0;
  EXPECT_EQ(on, 3);
  EXPECT_EQ(ran.Count("beam off"), 3);
  // The programmed points on the cylinder: the head along the outward radius, within 0.65 degrees.
  double worst = 0.0;
  const double x0 = 1262.139, y0 = 719.940;
  for (const machine::MoveDone& move : ran.moves) {
    const motion::MachineVector radial{move.program_point.x(), move.program_point.y(), 0.0};
    if (std::fabs(radial.norm() - 139.7) > 0.1) continue;
    const motion::MachineVector u = motion::ToolDirection(move.rotary_a, M_PI / 2);
    worst = std::fmax(worst, std::acos(u.dot(radial) / radial.norm()));
  }
  EXPECT_GT(worst, 0.0);
  EXPECT_LT(worst, 0.65 * kRadPerDegree);
  // The trim: A goes down from 3.1416 through 0 to -3.1416; at (+-139.7, 0) it is +-1.5708.
  bool right = false, left = false;
  for (const Ran::Motion& motion : ran.motions) {
    for (const motion::TipPose& pose : motion.poses) {
      if (!motion.beam || std::fabs(pose.tip.y() - y0) > 0.5) continue;
      if (pose.tip.x() > x0 + 139 && std::fabs(pose.a_rad - 1.5708) < 0.005) right = true;
      if (pose.tip.x() < x0 - 139 && std::fabs(pose.a_rad + 1.5708) < 0.005) left = true;
    }
  }
  EXPECT_TRUE(right && left);
  // The pierce points; the trim has an offset of its own in Z.
  EXPECT_LT(ran.NearestTo({x0 + 70.222, y0 - 120.772, 190.5 - 832.697}), 0.01);
  EXPECT_LT(ran.NearestTo({x0 - 52.962, y0 + 129.275, 242.290 - 832.697}), 0.01);
  EXPECT_LT(ran.NearestTo({x0, y0 + 139.7, 354.584 - 832.443}), 0.01);
  // It ends in CALL 2.
  EXPECT_NEAR(ran.run().state().axes.column.z(), -50.0, 1e-6);
  EXPECT_NEAR(ran.run().state().axes.b_rad, 0.0, 1e-9);
}

// OPT-10.04, OPT-2.39: the contours as programmed are 1886.232 mm long; OVERSH 0 rounds no corner.
TEST(OptimoRunSamples, SampleTwoCutsItsWholeLength) {
  const std::string source = CorpusProgram("sample2-cylind.S");
  if (source.empty()) GTEST_SKIP() << "the shared corpus is not here";
  OptimoMachine machine;
  StoreHousePrograms(machine);
  EXPECT_NEAR(machine.Run("OVERSH 0\n" + source).BeamLength(), 1886.232, 1e-3);
}

// What program 1 leaves behind a program 2 that counts in VI[3] and moves the coordinates, and a
// move to (1000, 1000, -400).
void ExpectCalibrated(const Ran& ran) {
  EXPECT_TRUE(ran.completed());
  EXPECT_EQ(ran.Var("VI[3]"), "1");
  const std::pair<int, double> values[] = {{43, -105.5}, {44, 2217.2}, {45, -962.0}, {46, 0.0},
                                           {47, 0.0},    {48, -942.0}, {49, -600.0}};
  for (const auto& [variable, wanted] : values)
    EXPECT_NEAR(ran.Number("VR[" + std::to_string(variable) + "]"), wanted, 1e-4) << variable;
  const motion::MachinePoint tip = ran.run().state().tip.tip;
  EXPECT_NEAR((tip - motion::MachinePoint(1000.0, 1000.0, -400.0)).norm(), 0.0, 1e-4);
}

// OPT-10.12: program 1 runs program 2, here one that moves the coordinates, and goes on in tip
// coordinates of the machine: 350 mm below, where the column stands at -50.
TEST(OptimoRunSamples, SensorCalibration) {
  const std::string source = CorpusProgram("special-1.S");
  if (source.empty()) GTEST_SKIP() << "the shared corpus is not here";
  OptimoMachine machine;
  machine.Store(2, "SYSDEF (10.,20.,30.,0.,0.,0.)\nVI[3]=VI[3]+1\n");
  const Ran ran = machine.Run(source + "VR[1] = IA[2]\nMOVE (1000.,1000.,-400.,0.,0.)\n");
  ExpectCalibrated(ran);
  EXPECT_NEAR(ran.Number("VR[1]"), -350.0, 1e-4);
}

// OPT-10.12, OPT-B.82: ours calls whatever 2 is, assigns what the listed one does in as many steps,
// and leaves no offset.
TEST(OptimoRunSamples, OurSensorCalibration) {
  const std::string source(HousePrograms().front().source);
  const Compilation compiled = Compile(source, "1.S", {});
  ASSERT_TRUE(compiled.ok);
  EXPECT_EQ(compiled.module.step_count, 10U);
  const auto first = std::ranges::find_if(
      compiled.module.instructions,
      [](const Instruction& instruction) { return instruction.op != Op::kDeclare; });
  ASSERT_NE(first, compiled.module.instructions.end());
  EXPECT_EQ(first->op, Op::kCall);
  OptimoMachine machine;
  machine.Store(2, "SYSDEF (10.,20.,30.,0.,0.,0.)\nVI[3]=VI[3]+1\n");
  const Ran ran = machine.Run(source + "MOVE (1000.,1000.,-400.,0.,0.)\n");
  ExpectCalibrated(ran);
}

// OPT-10.12, OPT-10.13: behind it the head is up, and the tip comes to the same place with another
// focus height: 3 mm of it are 3 mm of the column. All of it within the travel of a new machine.
TEST(OptimoRunSamples, OurSensorCalibrationCorrectsTheFocusHeight) {
  const std::string source(HousePrograms().front().source);
  for (const auto& [tool, column_z] :
       {std::pair{"TCP (0,0,0/0,0,-5)\n", -662.0}, {"TCP (0,0,3/0,0,-5)\n", -665.0}}) {
    OptimoMachine machine;
    StoreHousePrograms(machine);
    machine.Store(90, tool);
    const Ran ran = machine.Run("MOVE (1000.,1000.,-600.,0.8,0.5)\n" + source +
                                "MOVE (XBLOCK,YBLOCK,ZBLOCK,ABLOCK,BBLOCK)\n");
    EXPECT_TRUE(ran.completed());
    ASSERT_EQ(ran.moves.size(), 4U);
    EXPECT_NEAR(ran.moves[2].axes.column.z(), -50.0, 1e-6);
    EXPECT_NEAR(ran.moves[3].axes.column.x(), -105.5, 1e-3);
    EXPECT_NEAR(ran.moves[3].axes.column.y(), 2217.2, 1e-3);
    EXPECT_NEAR(ran.moves[3].axes.column.z(), column_z, 1e-3);
  }
}

// OPT-10.11, OPT-8.11: moves under compensation are written with five decimals, all their numbers.
TEST(OptimoRunSamples, SampleThreeGoesOnInFiveDecimals) {
  const std::string source = CorpusProgram("sample3.S");
  if (source.empty()) GTEST_SKIP() << "the shared corpus is not here";
  const Compensation compensated =
      Compensate(source +
                 "WORK 0,0/OFF\n;$right\nPATH LIN\nMOVE (0.0,0.0,0.0,0.0,0.0)\n"
                 "WORK 0,0/ON\n20 MOVE (25.4,0.0,0.0,0.0,0.0)/fly\nWORK 0,0/OFF\n");
  ASSERT_TRUE(compensated.ok);
  // The diameter of sample 3 is 0.508 mm: to the right of +X is -Y.
  EXPECT_NE(compensated.text.find("20 MOVE (25.40000,-0.25400,0.00000,0.00000,0.00000)/fly\n"),
            std::string::npos);
}

// OPT-10.13, OPT-10.14, OPT-10.16, OPT-B.83: Z-UP from anywhere: first Z and B, then A; outputs
// off, no offset, the tool of program 90.
TEST(OptimoRunSamples, ZUp) {
  OptimoMachine machine;
  StoreHousePrograms(machine);
  machine.Store(90, "TCP (0,0,3/0,0,-5)\n");
  const Ran ran = machine.Run(
      "SYSDEF (10.,20.,30.,0.,0.,0.)\nOL[22]=ON\nOL[29]=ON\nOL[12]=ON\nOL[15]=ON\nOL[8]=ON\n"
      "OL[11]=ON\nMOVE (1000.,1000.,-600.,0.8,0.5)\nCALL 2\n");
  EXPECT_TRUE(ran.completed());
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_NEAR(ran.moves[1].axes.column.z(), -50.0, 1e-6);
  EXPECT_NEAR(ran.moves[1].axes.b_rad, 0.0, 1e-9);
  EXPECT_NEAR(ran.moves[1].axes.a_rad, 0.8, 1e-6);
  EXPECT_NEAR(ran.moves[2].axes.a_rad, 0.0, 1e-9);
  EXPECT_NEAR(ran.run().state().axes.column.x(), 1000.0, 1e-4);
  for (const int output : {8, 9, 11, 12, 13, 14, 15, 22, 23, 24, 25, 26, 27, 28, 29})
    EXPECT_EQ(ran.Var("OL[" + std::to_string(output) + "]"), "0") << output;
  // The tool of 90: the tip is 297 mm below the column, and no offset moves it.
  EXPECT_NEAR(ran.run().state().tip.tip.z(), -50.0 - 297.0, 1e-6);
  const Ran next = machine.Run("COORD ABSOL\nMOVE (1000.,1000.,-400.,0.,0.)\n");
  EXPECT_NEAR(next.run().state().axes.column.x(), 1000.0, 1e-4);
}

// OPT-10.15, OPT-10.18, OPT-B.82, OPT-B.84: home return from anywhere, Z first.
TEST(OptimoRunSamples, HomeReturn) {
  OptimoMachine machine;
  StoreHousePrograms(machine);
  const Ran ran = machine.Run("MOVE (1500.,300.,-700.,1.,-0.7)\nCALL 4\n");
  EXPECT_TRUE(ran.completed());
  ASSERT_GE(ran.moves.size(), 4U);
  EXPECT_NEAR(ran.moves[1].axes.column.z(), -50.0, 1e-6);
  EXPECT_NEAR(ran.moves[1].axes.column.x(), 1500.0, 1e-3);
  const motion::AxisPose home = ran.run().state().axes;
  EXPECT_NEAR(home.column.x(), 21.02, 1e-4);
  EXPECT_NEAR(home.column.y(), 2201.2, 1e-3);
  EXPECT_NEAR(home.column.z(), -50.0, 1e-6);
  EXPECT_NEAR(home.a_rad, 0.0, 1e-9);
  EXPECT_NEAR(home.b_rad, 0.0, 1e-9);
  // The listed one of the manual does the same with it.
  if (CorpusProgram("special-4.S").empty()) return;
  machine.Store(4, CorpusProgram("special-4.S"));
  EXPECT_NEAR(machine.Run("CALL 4\n").run().state().axes.column.x(), 21.02, 1e-4);
}

// OPT-B.82: the programs of the house need no comment by the checker.
TEST(OptimoRunSamples, HouseProgramsAreClean) {
  ASSERT_EQ(HousePrograms().size(), 4U);
  for (const machine::SpecialProgram& program : HousePrograms()) {
    const Compilation compiled = Compile(program.source, program.name, {});
    EXPECT_TRUE(compiled.ok);
    for (const Diagnostic& d : compiled.diagnostics)
      ADD_FAILURE() << FormatDiagnostic(d, program.source);
  }
}

// OPT-10.17: 1 to 7 are reserved for programs like these, which nobody is warned of; any other text
// there is a customer's.
TEST(OptimoRunSamples, OurNumbersAreReservedForOthers) {
  const machine::MachineFamily& family = OptimoFamily();
  for (const machine::SpecialProgram& program : family.special_programs()) {
    EXPECT_TRUE(family.CheckSlot(program.slot, program.source).empty()) << program.slot;
    const std::string changed = std::string(program.source) + "DELAY 1\n";
    EXPECT_EQ(family.CheckSlot(program.slot, changed).size(), program.slot <= 7 ? 1U : 0U);
  }
  EXPECT_EQ(family.CheckSlot(5, HousePrograms().front().source).size(), 1U);
}

// OPT-B.57: an error that climbs out of two FUNCTIONs leaves no level behind: four fit again.
TEST(OptimoRunFunction, ACaughtErrorDropsTheLevels) {
  OptimoMachine machine;
  machine.Store(44, "FUNCTION 45\n").Store(45, "VR[0]=1/0\n").Store(41, "FUNCTION 42\n");
  machine.Store(42, "FUNCTION 43\n").Store(43, "FUNCTION 46\n").Store(46, "VI[3]=1\n");
  const Ran ran = machine.Run(
      "ERR 900\nGOSUB 10\nVI[4]=VI[4]+1\nENDTASK\n10 FUNCTION 44\nENDTASK\n"
      "900 VI[2]=1\nFUNCTION 41\nRETURN\n");
  EXPECT_TRUE(ran.completed());
  EXPECT_EQ(ran.Var("VI[3]"), "1");
  EXPECT_EQ(ran.Var("VI[4]"), "1");  // the GOSUB of the catching module still returns
}

}  // namespace
}  // namespace rmlcell::optimo::testing
