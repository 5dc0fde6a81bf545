#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// OPT-2.43: attributes come out in one order, whatever their order in the text.
TEST(Module, AttributesAreFoundByKind) {
  const Compilation compiled = MustCompile(
      "900 MOVE (1.,2.,3.,4.,5.) /TIME (2.5, 900) /END (IL[20]) /VIA (6.,7.,8.,9.,10.) /START "
      "(IL[16]) /FLY\n");
  const Module& module = compiled.module;
  const Instruction& move = module.instructions[0];
  EXPECT_EQ(module.Value(move, 4)[0].number, 5.0F);
  EXPECT_EQ(module.Via(move, 0)[0].number, 6.0F);
  EXPECT_EQ(module.Via(move, 4)[0].number, 10.0F);
  EXPECT_EQ(module.Start(move)[0].variable(), (Variable{VariableGroup::kIl, 16}));
  EXPECT_EQ(module.End(move)[0].variable(), (Variable{VariableGroup::kIl, 20}));
  EXPECT_EQ(module.Time(move)[0].number, 2.5F);
  EXPECT_EQ(module.TimeLabel(move), 900);
  EXPECT_TRUE(module.Targets(move).empty());
  EXPECT_TRUE(move.Has(kFly));
  EXPECT_FALSE(move.Has(kNext));
}

// OPT-2.48: reads of IL, IA and OA[0] need standstill; writing and other variables do not.
TEST(Module, KnowsWhatReadsTheMachine) {
  const Compilation compiled = MustCompile(
      "VR[0] = IA[0]\nVR[0] = OA[0]\nVR[0] = OA[5]\nOL[11] = ON\nVL[1] = IL[3]\nSPEED VR[1]\n");
  std::vector<bool> reads;
  for (const Instruction& i : compiled.module.instructions) reads.push_back(i.reads_machine);
  EXPECT_EQ(reads, (std::vector<bool>{true, true, false, false, true, false}));
}

// OPT-9.12, OPT-6.43
TEST(ModuleIndex, StartsAtTaskOneOrTheFirstInstruction) {
  const Compilation task = MustCompile("VI[2] = 1\nTASK 1\nVI[3] = 1\n");
  EXPECT_EQ(ModuleIndex(task.module).entry(), 1U);
  const Compilation plain = MustCompile("DECLARE X = VR[1]\nX = 1.\n");
  EXPECT_EQ(ModuleIndex(plain.module).entry(), 1U);
  EXPECT_EQ(ModuleIndex(plain.module).FindStep(1), 1U);
  EXPECT_EQ(ModuleIndex(plain.module).FindStep(2), std::nullopt);
}

// OPT-9.12: of several TASKs the first TASK 1, whatever else has a 1 before it.
TEST(ModuleIndex, TheFirstTaskOneCounts) {
  const Compilation compiled = MustCompile("WORKDEF 1,0 (8.,75.,1.,50.)\nTASK 2\nTASK 1\nTASK 1\n");
  EXPECT_EQ(ModuleIndex(compiled.module).entry(), 2U);
}

// OPT-1.23, OPT-6.01
TEST(ModuleIndex, KnowsNumbersAndStepsAtBothEnds) {
  const Compilation compiled = MustCompile("0 SPEED 5\nDECLARE X = VR[1]\n9999 X = 1.\n");
  const ModuleIndex index(compiled.module);
  EXPECT_EQ(index.FindLabel(0), 0U);
  EXPECT_EQ(index.FindLabel(9999), 2U);
  for (const int label : {-1, 1, 9998, 10000}) EXPECT_FALSE(index.FindLabel(label)) << label;
  EXPECT_EQ(index.FindStep(1), 0U);
  EXPECT_EQ(index.FindStep(2), 2U);
  EXPECT_FALSE(index.FindStep(0));
  EXPECT_FALSE(index.FindStep(3));
}

// OPT-7.17, OPT-7.23
TEST(Module, KeepsTheTargetsOfJumps) {
  const Compilation compiled =
      MustCompile("20 GOTO VI[2] (20,30,40)\n30 IF VL[1] THEN 20 ELSE 40\n40\n");
  const Module& module = compiled.module;
  const auto table = module.Targets(module.instructions[0]);
  EXPECT_EQ(std::vector<int>(table.begin(), table.end()), (std::vector<int>{20, 30, 40}));
  const auto branches = module.Targets(module.instructions[1]);
  EXPECT_EQ(std::vector<int>(branches.begin(), branches.end()), (std::vector<int>{20, 40}));
}

// OPT-9.22, OPT-9.30
TEST(Module, ParametersHaveTheirTypes) {
  const Compilation compiled = MustCompile("DEFINE PAR[1] = LOGIC\nDEFINE PAR[2] = INT\n");
  EXPECT_EQ(compiled.module.parameter_types[0], ValueType::kReal);
  EXPECT_EQ(compiled.module.parameter_types[1], ValueType::kLogical);
  EXPECT_EQ(compiled.module.parameter_types[2], ValueType::kInteger);
}

// OPT-2.43: the values of the attributes of one move are those of no other one.
TEST(Module, EachMoveHasItsOwnAttributes) {
  const Compilation compiled = MustCompile(
      "MOVE (1,2,3,4,5)/START (VL[1])\nMOVE (1,2,3,4,5)/VIA (6,7,8,9,10)/TIME (1.,5)\n5\n");
  EXPECT_EQ(Decompile(compiled.module),
            "     MOVE (1, 2, 3, 4, 5) /START (VL[1])\n"
            "     MOVE (1, 2, 3, 4, 5) /VIA (6, 7, 8, 9, 10) /TIME (1.0, 5)\n5\n");
}

// OPT-2.48, OPT-7.41, OPT-7.60: by a name as by itself, and each instruction for itself.
TEST(Module, KnowsWhatReadsTheMachineByName) {
  const Compilation compiled = MustCompile(
      "DECLARE X1 = IL[3]\nDECLARE N0 = 0\nDECLARE N5 = 5\nVL[0] = X1\nVR[0] = OA[N0]\n"
      "VR[0] = OA[N5]\nVL[0] = VL[1]\nWAIT NOT X1\n");
  std::vector<bool> reads;
  for (const Instruction& i : compiled.module.instructions) {
    if (i.op != Op::kDeclare) reads.push_back(i.reads_machine);
  }
  EXPECT_EQ(reads, (std::vector<bool>{true, true, false, false, true}));
}

}  // namespace
}  // namespace rmlcell::optimo
