// What may stand between a /FLY move and the next MOVE, for every instruction of the language:
// OPT-2.48 and OPT-2.49, motion.md 3.6. The machine and the static check must say the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "engine/optimo/language/compiler.h"
#include "tests/conformance/optimo_machine.h"

namespace rmlcell::optimo::testing {
namespace {

enum class Corner {
  kPassed,   // blended
  kStopped,  // 7304, and the target is reached
  kFatal,    // 7303
};
// What is known without running: whether the tip moves with a TCP is not, nor what a FUNCTION does.
enum class Checked { kAlike, kSilent };

struct Row {
  const char* name;
  Corner corner;
  std::string between;      // what stands between the MOVEs
  std::string before = {};  // what it needs, ahead of both
  std::string behind = {};  // subroutines, behind an ENDTASK
  Checked checked = Checked::kAlike;

  friend void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }
};

const std::string kFlyThere = "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n";

// The tip comes to (1000,1000,-400), flies to (1100,1000,-400), and goes on at a right angle.
std::string ProgramOf(const Row& row,
                      const std::string& next = "MOVE (1100.,1100.,-400.,0.,0.)\n") {
  std::string text = kAbsolSlowly + row.before + "MOVE (1000.,1000.,-400.,0.,0.)\n" + kFlyThere +
                     row.between + next;
  if (!row.behind.empty()) text += "ENDTASK\n" + row.behind;
  return text;
}

int StepOfFly(const Row& row) {
  const Compilation compiled = Compile(ProgramOf(row), "", {.advice = false});
  for (const Instruction& i : compiled.module.instructions) {
    if (i.Has(kFly)) return static_cast<int>(i.step);
  }
  return 0;
}

const std::vector<Row>& Rows() {
  using enum Corner;
  static const std::vector<Row> rows = {
      // OPT-2.49
      {"nothing", kPassed, ""},
      {"speed", kPassed, "SPEED 8\n"},
      {"accel", kPassed, "ACCEL 50\n"},
      {"oversh", kPassed, "OVERSH 50\n"},
      {"path", kPassed, "PATH LIN\n"},
      {"sysdef", kPassed, "SYSDEF (1.,0.,0.,0.,0.,0.)\n"},
      {"workdef", kPassed, "WORKDEF 1,0 (8.,75.,1.,50.)\n"},
      {"let_real", kPassed, "VR[0]=VR[1]+2.\n"},
      {"let_integer", kPassed, "VI[2]=VI[2]+1\n"},
      {"let_output", kPassed, "OL[22]=ON\n"},
      {"let_analogue", kPassed, "OA[1]=5\n"},
      {"reads_output", kPassed, "VL[0]=OL[22]\n"},
      {"reads_other_analogue", kPassed, "VR[0]=OA[1]\n"},
      {"assign", kPassed, "ASSIGN OL[22]=3 /4\n"},
      {"assign_variable", kPassed, "ASSIGN OL[22]=VI[2] /4\n"},
      {"work_0_on", kPassed, "WORK 0,0/ON\n", "WORK 0,0/OFF\n", "WORK 0,0/OFF\n"},
      {"work_0_off", kPassed, "WORK 0,0/OFF\n"},
      {"work_1_without_delay", kPassed, "WORK 1,0/ON\n", "WORKDEF 1,0 (8.,75.,0.,50.)\n"},
      {"work_1_off", kPassed, "WORK 1,0/OFF\n", "WORKDEF 1,0 (8.,75.,1.,50.)\n"},
      {"work_2_on", kPassed, "WORK 2,5/ON\n", "WORKDEF 2,5 (15)\n"},
      {"work_2_off", kPassed, "WORK 2,5/OFF\n", "WORKDEF 2,5 (15)\n"},
      {"tcp_the_same", kPassed, "TCP (0.,0.,3./0.,0.,-5.)\n", "TCP (0.,0.,3./0.,0.,-5.)\n", "",
       Checked::kSilent},
      {"tcp_another_axis", kPassed, "TCP (0.,0.,3./0.,0.,-6.)\n", "TCP (0.,0.,3./0.,0.,-5.)\n", "",
       Checked::kSilent},
      {"goto", kPassed, "GOTO 10\nDELAY 1\n10\n"},
      {"goto_table", kPassed, "GOTO VI[2] (20,10)\n20 DELAY 1\n10\n", "VI[2]=2\n", "",
       Checked::kSilent},
      {"if", kPassed, "IF VR[1]<5. THEN 10\n10\n"},
      {"gosub_return", kPassed, "GOSUB 50\n", "", "50 SPEED 8\nRETURN\n"},
      {"function", kPassed, "FUNCTION 44\n", "", "", Checked::kSilent},
      {"define", kPassed, "DEFINE PAR[0]=INT\n"},
      {"declare", kPassed, "DECLARE X=VR[1]\n"},
      {"task", kPassed, "TASK 2\n"},
      // OPT-2.48
      {"delay", kStopped, "DELAY 1\n"},
      {"wait", kStopped, "WAIT 1\n"},
      {"pause", kStopped, "PAUSE\n"},
      {"stop", kStopped, "STOP\n"},
      {"zero", kStopped, "ZERO\n"},
      {"work_1_with_delay", kStopped, "WORK 1,0/ON\n", "WORKDEF 1,0 (8.,75.,1.,50.)\n"},
      {"work_1_with_a_short_delay", kStopped, "WORK 1,0/ON\n", "WORKDEF 1,0 (8.,75.,.1,50.)\n"},
      {"tcp_another", kStopped, "TCP (0.,0.,4./0.,0.,-5.)\n", "TCP (0.,0.,3./0.,0.,-5.)\n", "",
       Checked::kSilent},
      {"reads_il", kStopped, "VL[0]=IL[20]\n"},
      {"reads_ia", kStopped, "VR[0]=IA[0]\n"},
      {"reads_another_ia", kStopped, "VR[0]=1.+IA[7]\n"},
      {"reads_oa_0", kStopped, "VR[0]=OA[0]\n"},
      {"reads_by_a_name", kStopped, "DECLARE HERE=IA[1]\nVR[0]=HERE\n"},
      {"output_from_il", kStopped, "OL[22]=IL[20]\n"},
      {"if_il", kStopped, "IF IL[20] THEN 10\n10\n"},
      {"assign_from_ia", kStopped, "ASSIGN OL[22]=IA[7] /4\n"},
      {"speed_of_ia", kStopped, "SPEED 8.+0.*IA[0]\n"},
      {"err", kStopped, "ERR 900\n", "", "900 RETURN\n"},
      {"noerr", kStopped, "NOERR\n"},
      {"seterr", kStopped, "SETERR 5\n"},
      {"update", kStopped, "UPDATE OL/ON\n"},
      {"image", kStopped, "IMAGE OL\n"},
      {"real", kStopped, "REAL OL\n"},
      {"timer", kStopped, "TIMER (900.,900)\n", "", "900 RETURN\n"},
      {"timer_dis", kStopped, "TIMER /DIS\n"},
      {"break", kStopped, "BREAK 99\n"},
      {"simul", kStopped, "SIMUL 99\n"},
      {"ignored", kStopped, "CONT 3\n"},
      // OPT-2.47: "calls" that interrupt are CALL and GO.
      {"call", kStopped, "CALL 45\n"},
      {"go", kStopped, "GO 45\n"},
      {"endtask", kStopped, "ENDTASK\n"},
      // OPT-2.46, OPT-2.45
      {"coord_again", kStopped, "COORD ABSOL\n"},
      {"coord_changed", kFatal, "COORD ROBOT\n"},
  };
  return rows;
}

std::string NameOf(const ::testing::TestParamInfo<Row>& row) { return row.param.name; }

// Halts at PAUSE and STOP are left by START.
Ran RunOf(const std::string& text) {
  OptimoMachine machine;
  machine.Store(44, "SPEED 8\nVR[5]=2.\n").Store(45, "VI[3]=7\n");
  return machine.Run(text, {.inputs = {{At(100), machine::InputKind::kStart}}});
}

class BetweenFlyAndMove : public ::testing::TestWithParam<Row> {};

TEST_P(BetweenFlyAndMove, TheMachineStopsOrPasses) {
  const Row& row = GetParam();
  const Ran ran = RunOf(ProgramOf(row));
  const double beside = ran.NearestTo({1100.0, 1000.0, -400.0});
  EXPECT_EQ(ran.code(), row.corner == Corner::kFatal ? 7303 : 0);
  EXPECT_EQ(ran.Count("E7304"), row.corner == Corner::kStopped ? 1 : 0);
  if (row.corner == Corner::kPassed) {
    EXPECT_GT(beside, 0.1);
  } else {
    EXPECT_LT(beside, 0.001);
  }
  if (row.corner == Corner::kStopped) {
    EXPECT_EQ(ran.Find("E7304")->step, StepOfFly(row) + 1);  // at what needs the standstill
  }
}

TEST_P(BetweenFlyAndMove, TheCheckSaysTheSame) {
  const Row& row = GetParam();
  int found = 0, step = 0;
  const std::string text = ProgramOf(row);
  for (const Diagnostic& d : Compile(text, "", {}).diagnostics) {
    const int number = Lookup(d.code).number;
    ASSERT_FALSE(IsError(d.severity)) << FormatDiagnostic(d, text);
    if (number != 7032 && number != 7303) continue;
    EXPECT_EQ(found, 0) << "told twice";
    found = number;
    step = d.step;
  }
  const bool silent = row.checked == Checked::kSilent;
  const int stopped = row.corner == Corner::kFatal ? 7303 : 7032;
  EXPECT_EQ(found, row.corner == Corner::kPassed || silent ? 0 : stopped);
  EXPECT_EQ(step, found == 0 ? 0 : StepOfFly(row));
}

INSTANTIATE_TEST_SUITE_P(EveryInstruction, BetweenFlyAndMove, ::testing::ValuesIn(Rows()), NameOf);

// OPT-2.48, OPT-2.49: none is forgotten.
TEST(BetweenFlyAndMove, EveryInstructionHasARow) {
  std::set<std::string_view> seen;
  for (const Row& row : Rows()) {
    for (const Instruction& i : Compile(ProgramOf(row), "", {}).module.instructions)
      seen.insert(i.op == Op::kIgnored ? "ignored" : Describe(i.op).name);
  }
  for (int op = 1; op < kOpCount; ++op) {
    const InstructionInfo& row = Describe(static_cast<Op>(op));
    EXPECT_TRUE(seen.contains(row.op == Op::kIgnored ? "ignored" : row.name)) << row.name;
  }
}

// OPT-2.48: the next MOVE itself, when it waits for its /START; not for its other attributes.
TEST(FlyIntoAMove, StopsForItsStartOnly) {
  const Row bare{"bare", Corner::kPassed, ""};
  const auto into = [&](const std::string& attribute) {
    return RunOf(ProgramOf(bare, "MOVE (1100.,1100.,-400.,0.,0.)" + attribute + "\n"));
  };
  EXPECT_EQ(into("/START (NOT IL[20])").Count("E7304"), 1);
  EXPECT_LT(into("/START (NOT IL[20])").NearestTo({1100.0, 1000.0, -400.0}), 0.001);
  EXPECT_EQ(into("").Count("E7304"), 0);
  EXPECT_GT(into("").NearestTo({1100.0, 1000.0, -400.0}), 0.1);
}

// OPT-2.47: the end of the program, with and without ENDTASK, and that of a FUNCTION is none.
TEST(FlyIntoAnEnd, StopsAtTheEndOfTheProgram) {
  const Ran end = RunOf(kAbsolSlowly + "MOVE (1000.,1000.,-400.,0.,0.)\n" + kFlyThere);
  EXPECT_EQ(end.Count("E7304"), 1);
  EXPECT_LT(end.NearestTo({1100.0, 1000.0, -400.0}), 0.001);
  OptimoMachine machine;
  machine.Store(44, "TASK 1\n" + kFlyThere + "RETURN\n");
  const Ran function = machine.Run(kAbsolSlowly + "MOVE (1000.,1000.,-400.,0.,0.)\nFUNCTION 44\n" +
                                   "MOVE (1100.,1100.,-400.,0.,0.)\n");
  EXPECT_EQ(function.Count("E7304"), 0);
  EXPECT_GT(function.NearestTo({1100.0, 1000.0, -400.0}), 0.1);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
