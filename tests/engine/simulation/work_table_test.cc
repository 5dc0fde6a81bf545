#include "engine/simulation/work_table.h"

#include <gtest/gtest.h>

namespace rmlcell::simulation {
namespace {

WorkFigures Steps(std::uint64_t count, double cut_mm) {
  WorkFigures work;
  work.steps = count;
  work.cut_mm = cut_mm;
  return work;
}

// motion.md 8.2: figures by job, program and step.
TEST(WorkTable, AddsUpByProgramAndStep) {
  WorkTable table;
  table.Add({.program = 2, .step = 7, .line = 9}, Steps(1, 1.5));
  table.Add({.program = 1, .step = 3}, Steps(1, 2.0));
  table.Add({.program = 2, .step = 7}, Steps(1, 0.5));
  RunReport report;
  table.WriteTo(report);
  ASSERT_EQ(report.steps.size(), 2u);
  EXPECT_EQ(report.steps[0].program, 1);  // in order of program and step
  EXPECT_EQ(report.steps[1].step, 7);
  EXPECT_EQ(report.steps[1].line, 9);
  EXPECT_EQ(report.steps[1].figures.steps, 2u);
  EXPECT_EQ(report.steps[1].figures.cut_mm, 2.0);
  EXPECT_EQ(report.programs.at(1).total.cut_mm, 2.0);
  EXPECT_EQ(report.total.cut_mm, 4.0);
  EXPECT_EQ(report.rest.steps, 0u);
}

// Bounded: the first kReportedStepsMax steps are listed, the others added up; both sides of the
// limit.
TEST(WorkTable, StepsPastTheLimitAreTheRest) {
  WorkTable table;
  const int limit = static_cast<int>(kReportedStepsMax);
  for (int step = 1; step <= limit + 1; ++step) {
    table.Add({.program = 1, .step = step}, Steps(1, 1.0));
  }
  table.Add({.program = 1, .step = limit}, Steps(1, 1.0));      // listed
  table.Add({.program = 1, .step = limit + 1}, Steps(1, 1.0));  // not listed
  RunReport report;
  table.WriteTo(report);
  ASSERT_EQ(report.steps.size(), kReportedStepsMax);
  EXPECT_EQ(report.steps.back().figures.steps, 2u);
  EXPECT_EQ(report.rest.steps, 2u);
  EXPECT_EQ(report.rest.cut_mm, 2.0);
  EXPECT_EQ(report.total.steps, kReportedStepsMax + 3);
}

TEST(WorkTable, ProgramsPastTheLimitCountInTheTotalOnly) {
  WorkTable table;
  for (int program = 0; program <= static_cast<int>(kReportedProgramsMax); ++program) {
    table.Add({.program = program, .step = 1}, Steps(1, 1.0));
  }
  RunReport report;
  table.WriteTo(report);
  EXPECT_EQ(report.programs.size(), kReportedProgramsMax);
  EXPECT_EQ(report.total.steps, kReportedProgramsMax + 1);
}

// A million moves of 0.1 nm after one of 1 km: the sum is exact to the last digits, where a plain
// sum would be off by micrometres.
TEST(WorkTable, SmallLengthsAreNotLost) {
  WorkTable table;
  table.Add({.program = 1, .step = 1}, Steps(1, 1e6));
  for (int i = 0; i < 1'000'000; ++i) table.Add({.program = 1, .step = 2}, Steps(1, 1e-7));
  RunReport report;
  table.WriteTo(report);
  EXPECT_NEAR(report.total.cut_mm - 1e6, 0.1, 2e-10);
}

}  // namespace
}  // namespace rmlcell::simulation
