#include "engine/optimo/language/compiler.h"

#include <gtest/gtest.h>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// OPT-1.03
TEST(Compiler, LineEndsAreEqualAndDosEndsTheText) {
  const std::string unix_object = MustCompile("SPEED 20\nMOVE (1.,2.,\n3.,0.,0.)\n").object;
  EXPECT_EQ(MustCompile("SPEED 20\r\nMOVE (1.,2.,\r\n3.,0.,0.)\r\n").object, unix_object);
  EXPECT_EQ(MustCompile("SPEED 20\nMOVE (1.,2.,\n3.,0.,0.)\n\x1A garbage {{{\n").object,
            unix_object);
  EXPECT_EQ(MustCompile("SPEED 20\nMOVE (1.,2.,\n3.,0.,0.)").object, unix_object);
}

// OPT-1.04, OPT-1.20, OPT-6.01
TEST(Compiler, CommentsAndBlankLinesAreNoSteps) {
  const Compilation compiled = MustCompile("; one\nSPEED 5\n\nSPEED 6 ; two\n;three\nSPEED 7\n");
  EXPECT_EQ(compiled.module.instructions.size(), 3U);
  EXPECT_EQ(compiled.module.step_count, 3U);
}

// OPT-6.01, OPT-6.03, OPT-7.51
TEST(Compiler, DeclareIsNoStepAndDefineIsOne) {
  const Compilation compiled =
      MustCompile("DECLARE X = VR[0]\n; text\n10\nDEFINE PAR[0] = INT\n500 X = 1.\nENDTASK\n");
  std::vector<std::uint32_t> steps;
  for (const Instruction& i : compiled.module.instructions) steps.push_back(i.step);
  EXPECT_EQ(steps, (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

// OPT-1.07: the decompiler adds no ENDTASK and drops none.
TEST(Compiler, EndtaskStaysAsItWas) {
  EXPECT_EQ(Decompile(MustCompile("SPEED 5\nSPEED 6\n").module), "     SPEED 5\n     SPEED 6\n");
  EXPECT_EQ(Decompile(MustCompile("ENDTASK\n").module), "     ENDTASK\n");
}

// OPT-1.27
TEST(Compiler, LoneNumbersReachTheNextInstruction) {
  const Compilation compiled = MustCompile("15 ;$cleft\n16 MOVE (1.,2.,3.,0.,0.)\n17\n");
  const ModuleIndex index(compiled.module);
  EXPECT_EQ(index.FindLabel(15), 0U);
  EXPECT_EQ(index.FindLabel(16), 0U);
  EXPECT_EQ(index.FindLabel(17), 1U);  // the implied ENDTASK
  EXPECT_EQ(index.FindLabel(18), std::nullopt);
  EXPECT_EQ(Decompile(compiled.module), "15\n16   MOVE (1.0, 2.0, 3.0, 0.0, 0.0)\n17\n");
}

// OPT-2.04, OPT-E.7030
TEST(Compiler, InchSourcesAreRefused) {
  const Compilation compiled = Compile("SPEED 5\n", "part.SI", {.inch = true});
  EXPECT_FALSE(compiled.ok);
  ASSERT_EQ(compiled.diagnostics.size(), 1U);
  EXPECT_EQ(compiled.diagnostics[0].code, ErrorCode::kSourceIsInch);
}

// OPT-1.08, OPT-E.7031
TEST(Compiler, ObjectsOverTheLimitAreRefused) {
  std::string text;
  for (int i = 0; i < 40; ++i) text += "SPEED 5\n";
  const std::uint32_t size = static_cast<std::uint32_t>(MustCompile(text).object.size());
  EXPECT_TRUE(Compile(text, "", {.object_limit = size}).ok);
  const Compilation refused = Compile(text, "", {.object_limit = size - 1});
  EXPECT_FALSE(refused.ok);
  EXPECT_TRUE(refused.object.empty());
  EXPECT_EQ(refused.diagnostics.at(0).code, ErrorCode::kObjectTooLong);
  EXPECT_EQ(CompileOptions{}.object_limit, 34000U);
}

// OPT-1.33
TEST(Compiler, EveryFindingHasItsPlace) {
  const std::string text = "SPEED 20\n  SPEED 101 ; no\nMOVE (1.,2.,3.,0.)\n";
  const Compilation compiled = Compile(text, "part.S", {});
  ASSERT_EQ(compiled.diagnostics.size(), 2U);
  const Diagnostic& speed = compiled.diagnostics[0];
  EXPECT_EQ(speed.code, ErrorCode::kLiteralRange);
  EXPECT_EQ(speed.where, (SourceSpan{2, 9, 3, 17}));
  EXPECT_EQ(speed.step, 2);
  EXPECT_EQ(speed.file, "part.S");
  EXPECT_EQ(speed.rule, "OPT-2.35");
  const Diagnostic& move = compiled.diagnostics[1];
  EXPECT_EQ(move.where.line, 3);
  EXPECT_EQ(move.step, 3);
  EXPECT_TRUE(compiled.object.empty());
}

// OPT-1.23, OPT-1.25, OPT-1.27, OPT-1.33: a sequence number belongs to the instruction behind it,
// and so does what is wrong with it.
TEST(Compiler, ABadSequenceNumberIsOfItsInstruction) {
  const auto step_of = [](std::string_view text) {
    const Compilation compiled = Compile(text, "", {.advice = false});
    return compiled.diagnostics.size() == 1 ? compiled.diagnostics[0].step : -1;
  };
  EXPECT_EQ(step_of("VI[1]=1\n10000 SPEED 5\n"), 2);
  EXPECT_EQ(step_of("10 VI[1]=1\n10 SPEED 5\n"), 2);
  EXPECT_EQ(step_of("VI[1]=1\n10000\n; alone\nSPEED 5\n"), 2);
  EXPECT_EQ(step_of("VI[1]=1\n10000 DECLARE X = VR[1]\nX = 1.\n"), 0);
}

// OPT-E.7206, OPT-E.7403, OPT-B.36: what the compiler refuses is an error of the compiler, also
// where the same computed value is a program error.
TEST(Compiler, LiteralsOutOfRangeAreErrorsOfTheCompiler) {
  for (const char* text : {"ASSIGN OL[12]=16 /4\n", "ASSIGN OL[95]=0 /8\n", "WORKDEF 2,0 (64)\n"}) {
    const Compilation compiled = Compile(text, "", {.advice = false});
    ASSERT_EQ(compiled.diagnostics.size(), 1U) << text;
    EXPECT_EQ(compiled.diagnostics[0].severity, Severity::kCompile) << text;
  }
}

// OPT-7.91, OPT-E.7011
TEST(Compiler, MistypedWordsGetAProposal) {
  const Compilation compiled = Compile("SPED 20\nDECLARE XHOME = VR[1]\nVR[2] = XHOMF\n", "", {});
  ASSERT_EQ(compiled.diagnostics.size(), 2U);
  EXPECT_NE(compiled.diagnostics[0].detail.find("SPEED"), std::string::npos);
  EXPECT_EQ(compiled.diagnostics[0].fixes, (std::vector<Fix>{{0, 4, "SPEED"}}));
  EXPECT_NE(compiled.diagnostics[1].detail.find("XHOME"), std::string::npos);
  EXPECT_TRUE(compiled.diagnostics[1].fixes.empty());  // XHOMF may be meant
}

// OPT-1.33, OPT-6.01: an error of a sequence number belongs to the step that it leads to.
TEST(Compiler, SequenceNumbersNameTheirOwnStep) {
  const Compilation compiled = Compile(
      "SPEED 5\n10 SPEED 6\n10 SPEED 7\n10000 SPEED 8\n10\nDECLARE X = VR[1]\nX = 1.\n", "", {});
  std::vector<std::pair<ErrorCode, int>> found;
  for (const Diagnostic& d : compiled.diagnostics) found.emplace_back(d.code, d.step);
  EXPECT_EQ(found, (std::vector<std::pair<ErrorCode, int>>{{ErrorCode::kLabelDuplicate, 3},
                                                           {ErrorCode::kLabelRange, 4},
                                                           {ErrorCode::kLabelDuplicate, 5}}));
}

// What others have to say is asked of good programs, and by those who want advice.
TEST(Compiler, OthersAreAskedAboutGoodProgramsOnly) {
  const auto asked = [](std::string_view text, bool advice) {
    int times = 0;
    const Compilation compiled =
        Compile(text, "",
                {.advice = advice, .further_advice = [&](const ParsedProgram& program, Findings&) {
                   EXPECT_EQ(program.text, text);
                   ++times;
                 }});
    EXPECT_EQ(compiled.diagnostics.size(), compiled.ok ? 0U : 1U);
    return times;
  };
  EXPECT_EQ(asked("SPEED 5\n", true), 1);
  EXPECT_EQ(asked("SPEED 5\n", false), 0);
  EXPECT_EQ(asked("SPEED 101\n", true), 0);
}

// Findings are bounded; the rest is counted.
TEST(Compiler, TenThousandErrorsAreCountedNotListed) {
  std::string text;
  for (int i = 0; i < 10'000; ++i) text += "FOO 3\n";
  const Compilation compiled = Compile(text, "", {.diagnostics_max = 1000});
  EXPECT_EQ(compiled.diagnostics.size(), 1000U);
  EXPECT_EQ(compiled.diagnostics_dropped.count(), 9000U);
}

// Bytes that are no text are errors with a place, not a crash.
TEST(Compiler, BinaryFilesAreRefused) {
  std::string bytes;
  for (int i = 0; i < 256 * 40; ++i)
    bytes += static_cast<char>(i * 37 % 256 == 0x1A ? 1 : i * 37 % 256);
  const Compilation compiled = Compile(bytes, "", {});
  EXPECT_FALSE(compiled.ok);
  EXPECT_FALSE(compiled.diagnostics.empty());
}

TEST(Compiler, AnEmptyProgramIsAProgram) {
  const Compilation compiled = MustCompile("; nothing but a comment\n");
  EXPECT_TRUE(compiled.ok);
  EXPECT_EQ(compiled.module.step_count, 0U);
}

// OPT-1.05, OPT-1.06: a program without instructions has a source, too.
TEST(Compiler, AnEmptyProgramHasASource) {
  const std::string object = MustCompile("; nothing but a comment\n").object;
  const Result<std::string> source = ObjectToSource(object);
  ASSERT_TRUE(source);
  EXPECT_EQ(*source, "\n");
  EXPECT_EQ(MustCompile(*source).object, object);
}

// compiler.h: 0 is no limit, and 1 is one.
TEST(Compiler, TheLeastLimitOfAnObject) {
  EXPECT_TRUE(Compile("SPEED 5\n", "", {.object_limit = 0}).ok);
  const Compilation refused = Compile("SPEED 5\n", "", {.object_limit = 1});
  ASSERT_EQ(refused.diagnostics.size(), 1U);
  EXPECT_EQ(refused.diagnostics[0].code, ErrorCode::kObjectTooLong);
}

}  // namespace
}  // namespace rmlcell::optimo
