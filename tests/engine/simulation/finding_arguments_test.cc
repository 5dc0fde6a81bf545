#include <gtest/gtest.h>
#include <sys/mman.h>

#include <string>

#include "engine/families/families.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/stl_reader.h"
#include "engine/simulation/run/rehearsal.h"
#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/core/arguments_text.h"

// What verdicts, checks of motion and files of the simulation know besides their texts.
namespace rmlcell::simulation {
namespace {

CheckedProgram CheckOf(std::string_view text) {
  ProgramMemory memory{.family = families::FindFamily("optimo")};
  memory.programs.push_back({.slot = 45,
                             .file_name = "45.S",
                             .bytes = machine::Bytes::Of(std::string(text)),
                             .is_source = true});
  const auto check =
      CheckProgram(memory, machine::Parameters(memory.family->parameters()), 45, false, {});
  EXPECT_TRUE(check);
  return *check;
}

// X ends at 3600 mm; nobody told what VR[86] is.
TEST(CheckArguments, OfMotionThatHangsOnAVariable) {
  CheckedProgram check =
      CheckOf("SYSDEF (VR[86],0.,0.,0.,0.,0.)\nCOORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\n");
  ASSERT_EQ(check.motion.findings.size(), 1U);
  const std::string arguments = "axis='X' excess=400 mm assumed='VR[86]' assumed_value=0";
  EXPECT_EQ(check.motion.findings[0].detail,
            "X of the target leaves its travel by 400.000 mm, if VR[86] is 0");
  EXPECT_EQ(ArgumentsText(check.motion.findings[0].detail), arguments);
  const machine::Judgement judgement = JudgeCheck(check);
  ASSERT_FALSE(judgement.reasons.empty());
  EXPECT_EQ(ArgumentsText(judgement.reasons[0].said), arguments);
}

TEST(CheckArguments, OfWhatCutACheckShort) {
  CheckedProgram check = CheckOf("VR[2] = 1. / VR[1]\n");
  const machine::Judgement judgement = JudgeCheck(check);
  ASSERT_EQ(judgement.reasons.size(), 1U);
  EXPECT_EQ(judgement.reasons[0].said,
            "motion checked only up to step 1, line 1: OPT-E7201 division by zero, if VR[1] is 0");
  EXPECT_EQ(ArgumentsText(judgement.reasons[0].said),
            "step=1 line=1 code='OPT-E7201' assumed='VR[1]' assumed_value=0");
}

TEST(VerdictArguments, ReasonsKnowTheirFigures) {
  RunReport report;
  report.family = "optimo";
  report.violations.resize(2);
  report.violations_dropped = 1;
  const machine::Judgement judgement = Judge(report);
  ASSERT_FALSE(judgement.reasons.empty());
  EXPECT_EQ(judgement.reasons[0].said, "motions that leave the travel of an axis: 3");
  EXPECT_EQ(ArgumentsText(judgement.reasons[0].said), "travel_violations=3");
}

TEST(MaterialArguments, OfTools) {
  const auto made = ParseTool("flat:3:flutes=2:neck=2");
  ASSERT_FALSE(made);
  EXPECT_EQ(ArgumentsText(made.error().detail),
            "word='flat:3:flutes=2:neck=2' column=17 part='neck=2'");
  const auto low = ParseTool("ball:6:flute=2");
  ASSERT_FALSE(low);
  EXPECT_EQ(ArgumentsText(low.error().detail), "length=2 mm least=3 mm");
}

TEST(MaterialArguments, OfStlText) {
  const auto read = ReadStl("solid a\nfacet normal 0 0 1\nouter loop\nvertx 0 0 0\n");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kCellBadText);
  EXPECT_EQ(read.error().detail, "no STL: line 4: 'vertx'");
  EXPECT_EQ(ArgumentsText(read.error().detail), "line=4 word='vertx'");
}

// stl_reader.h: one triangle more than are taken. The bytes are pages that nobody has written.
TEST(MaterialArguments, OfAnStlThatIsTooLarge) {
  const std::size_t count = kStlTrianglesMax + 1, size = 84 + 50 * count;
  void* const pages = mmap(nullptr, size, PROT_READ | PROT_WRITE,
                           MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(pages, MAP_FAILED);
  char* const bytes = static_cast<char*>(pages);
  for (int k = 0; k < 4; ++k) bytes[80 + k] = static_cast<char>(count >> 8 * k & 0xFF);
  const auto read = ReadStl({bytes, size});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(ArgumentsText(read.error().detail), "most=16777216");
  munmap(pages, size);
}

}  // namespace
}  // namespace rmlcell::simulation
