// Instructions put into an object and taken out of it.
#include "engine/optimo/language/step_edit.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/optimo/language/compiler.h"

namespace rmlcell::optimo {
namespace {

Compilation Compiled(const std::string& text) {
  Compilation made = Compile(text, {}, {.object_limit = 0, .advice = false});
  EXPECT_TRUE(made.ok) << text;
  return made;
}
std::string Inserted(const std::string& text, std::uint32_t place, const std::string& step) {
  const Result<std::string> object = InsertInstruction(Compiled(text).module, place, step);
  return object ? ObjectToSource(*object).value() : CodeText(object.error().code);
}
std::string Removed(const std::string& text, std::uint32_t place) {
  const Result<std::string> object = RemoveInstruction(Compiled(text).module, place);
  return object ? ObjectToSource(*object).value() : CodeText(object.error().code);
}
std::string Decompiled(const std::string& text) { return Decompile(Compiled(text).module); }

// OPT-6.39 OPT-6.40: what comes of it is what the compiler makes of the text with the step.
TEST(StepEdit, InsertsAnywhere) {
  const std::string text =
      "SPEED 5\nMOVE (1.,2.,3.,0.,0.)/VIA (4.,5.,6.,0.,0.)/FLY\nGOTO 10\n10 DELAY 1\n";
  EXPECT_EQ(Inserted(text, 0, "COORD ABSOL"), Decompiled("COORD ABSOL\n" + text));
  EXPECT_EQ(Inserted(text, 3, "IF VI[1] > 2 THEN 10 ELSE 10"),
            Decompiled("SPEED 5\nMOVE (1.,2.,3.,0.,0.)/VIA (4.,5.,6.,0.,0.)/FLY\nGOTO 10\n"
                       "IF VI[1] > 2 THEN 10 ELSE 10\n10 DELAY 1\n"));
  EXPECT_EQ(Inserted(text, 4, "ENDTASK"), Decompiled(text + "ENDTASK\n"));
  EXPECT_EQ(Inserted("", 0, "ENDTASK"), Decompiled("ENDTASK\n"));
}

// OPT-6.43 OPT-6.44: names and sequence numbers.
TEST(StepEdit, KeepsNamesAndNumbers) {
  const std::string text =
      "DECLARE A = VR[1]\nDECLARE B = 7\n10 A = 5.\n20 VR[B] = A\nGOTO 20\n30\n";
  EXPECT_EQ(Removed(text, 2),
            Decompiled("DECLARE A = VR[1]\nDECLARE B = 7\n10\n20 VR[B] = A\nGOTO 20\n30\n"));
  EXPECT_EQ(Removed(text, 4),
            Decompiled("DECLARE A = VR[1]\nDECLARE B = 7\n10 A = 5.\n20 VR[B] = A\n30\n"));
  EXPECT_EQ(
      Inserted(text, 3, "A = VR[B] + SIN(A)"),
      Decompiled("DECLARE A = VR[1]\nDECLARE B = 7\n10 A = 5.\nA = VR[B] + SIN(A)\n20 VR[B] = A\n"
                 "GOTO 20\n30\n"));
}

// LIVE-7.09: in and out again, at every place, byte for byte.
TEST(StepEdit, OutAndInAgainIsTheSame) {
  const std::string text =
      "DECLARE A = VR[1]\n10\n20 A = 5.\nDECLARE B = 7\nCONT 3\n30 MOVE (A,0.,0.,0.,0.)/START (IL[B])/TIME (2.,30)\n"
      "40 GOTO VI[1] (10,20,30)\nDECLARE HALF = PI\nTCP (0.,0.,3./0.,0.,-5.)\nDEFINE PAR[1] = INT\n"
      "VI[2] = PAR[1]\n50 ENDTASK\n60\n70\n";
  const Compilation made = Compiled(text);
  int done = 0;
  for (std::uint32_t place = 0; place < made.module.instructions.size(); ++place) {
    const Instruction& instruction = made.module.instructions[place];
    const Result<std::string> without = RemoveInstruction(made.module, place);
    if (!without) continue;  // a DECLARE or DEFINE that others need
    ++done;
    const Result<std::string> again = InsertInstruction(DecodeObject(*without).value(), place,
                                                        InstructionText(made.module, place));
    ASSERT_TRUE(again) << InstructionText(made.module, place) << again.error().detail;
    EXPECT_EQ(*again, made.object) << static_cast<int>(instruction.op);
  }
  EXPECT_GE(done, 8);
}

// OPT-6.38: what the program then is has errors.
TEST(StepEdit, WhatTheCompilerRefusesIsRefused) {
  EXPECT_EQ(Inserted("SPEED 5\n", 0, "SPEED 140"), "OPT-E7004");
  EXPECT_NE(Removed("DEFINE PAR[0] = LOGIC\nVL[1] = NOT PAR[0]\n", 0).find("OPT-E"),
            std::string::npos);
  EXPECT_EQ(Inserted("SPEED 5\n", 0, "SPEED 1\nSPEED 2"), "OPT-E7034");
  EXPECT_EQ(Inserted("SPEED 5\n", 0, "SPEE 1"), "OPT-E7034");
  EXPECT_EQ(Inserted("SPEED 5\n", 0, ""), "OPT-E7034");
  EXPECT_EQ(Inserted("SPEED 5\n", 2, "SPEED 1"), "OPT-E7034");
  EXPECT_EQ(Inserted("SPEED 5\n", 0, "10 SPEED 1"), "OPT-E7034");
  EXPECT_EQ(Inserted("SPEED 5\n", 0, "A = 1."), "OPT-E7034");
  EXPECT_EQ(Removed("SPEED 5\n", 1), "OPT-E7034");
}

// OPT-6.43 OPT-6.44: of the sequence numbers that stand there a step may bring the first ones.
TEST(StepEdit, BringsTheFirstNumbersOfItsPlace) {
  const std::string text = "10\n20 SPEED 5\n";
  EXPECT_EQ(Inserted(text, 0, "SPEED 1"), Decompiled("SPEED 1\n10\n20 SPEED 5\n"));
  EXPECT_EQ(Inserted(text, 0, "10 SPEED 1"), Decompiled("10 SPEED 1\n20 SPEED 5\n"));
  EXPECT_EQ(Inserted(text, 0, "10\n20 SPEED 1"), Decompiled("10\n20 SPEED 1\nSPEED 5\n"));
  EXPECT_EQ(Inserted("SPEED 5\n10\n", 1, "10 SPEED 1"), Decompiled("SPEED 5\n10 SPEED 1\n"));
  for (const char* step : {"20 SPEED 1", "30 SPEED 1", "20\n10 SPEED 1", "10\n20\n30 SPEED 1"}) {
    EXPECT_EQ(Inserted(text, 0, step), "OPT-E7034") << step;
  }
}

// OPT-6.38: why it is refused.
TEST(StepEdit, TellsWhyItRefuses) {
  const auto why = [](std::uint32_t place, const std::string& step) -> std::string {
    const Result<std::string> object =
        InsertInstruction(Compiled("10 SPEED 5\n").module, place, step);
    if (object) return "";
    return object.error().detail;
  };
  EXPECT_EQ(why(0, "10 SPEED 1"), "");
  EXPECT_EQ(why(0, "20 SPEED 1"), "its sequence numbers are not there");
  EXPECT_EQ(why(0, "SPEED 1\nSPEED 2"), "the text is not one instruction");
  EXPECT_EQ(why(0, "SPEED 1\n10"), "the text is not one instruction");
  EXPECT_EQ(why(0, "A = 1."), "it has a name that the program does not know");
  EXPECT_EQ(why(0, "SPEED 140"), "the value must be 0 to 100");
  EXPECT_EQ(why(1, "SPEED 1"), "");
  EXPECT_EQ(why(2, "SPEED 1"), "the program is shorter");
  const Result<std::string> removed = RemoveInstruction(Compiled("SPEED 5\n").module, 1);
  ASSERT_FALSE(removed);
  EXPECT_EQ(removed.error().detail, "the program is shorter");
}

// OPT-7.60, OPT-6.38: the name of an index is a name of the program as any other, and must be one.
TEST(StepEdit, KnowsTheNamesOfIndices) {
  const std::string text = "DECLARE A = VR[1]\nDECLARE B = 7\nA = VR[B]\n";
  EXPECT_EQ(Inserted(text, 2, "VR[B] = A"),
            Decompiled("DECLARE A = VR[1]\nDECLARE B = 7\nVR[B] = A\nA = VR[B]\n"));
  const auto why = [&](const std::string& step) -> std::string {
    const Result<std::string> object = InsertInstruction(Compiled(text).module, 2, step);
    return object ? std::string() : std::string(object.error().detail);
  };
  for (const char* step : {"VR[D] = 1.", "VR[1] = VR[D]", "VR[D] = A", "D = VR[B]"})
    EXPECT_EQ(why(step), "it has a name that the program does not know") << step;
}

// OPT-6.38: the names are those of the program; a DECLARE that comes in makes no new one.
TEST(StepEdit, RefusesADeclareOfANewName) {
  const Module module = Compiled("DECLARE A = VR[1]\nA = 1.\n").module;
  for (const std::uint32_t place : {0U, 1U, 2U}) {
    const Result<std::string> object = InsertInstruction(module, place, "DECLARE Q = 5");
    ASSERT_FALSE(object) << place;
    EXPECT_EQ(CodeText(object.error().code), "OPT-E7034") << place;
    EXPECT_EQ(object.error().detail, "it has a name that the program does not know") << place;
  }
}

// OPT-6.38: a step with a mistake of its own is no instruction, whatever comes of the program.
TEST(StepEdit, AMistypedStepIsNoInstruction) {
  const Module module = Compiled("10 SPEED 5\n").module;
  for (const char* step : {"SPEE 1", "SPEED", "SPEED 1 1", "10000 SPEED 1"}) {
    const Result<std::string> object = InsertInstruction(module, 0, step);
    ASSERT_FALSE(object) << step;
    EXPECT_EQ(object.error().code, ErrorCode::kObjectCorrupt) << step;
    EXPECT_EQ(object.error().detail, "the text is not one instruction") << step;
  }
}

}  // namespace
}  // namespace rmlcell::optimo
