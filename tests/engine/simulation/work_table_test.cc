#include "engine/simulation/report/work_table.h"

#include <gtest/gtest.h>

#include <iterator>

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

// Every figure adds up for itself: of two of each its double.
TEST(WorkTable, EveryFigureAddsUp) {
  WorkFigures work{.steps = 1,
                   .time = {.motion = SimTime(1),
                            .settling = SimTime(2),
                            .dwell = SimTime(3),
                            .pierce = SimTime(4),
                            .condition = SimTime(5),
                            .operator_wait = SimTime(6),
                            .spin_up = SimTime(7),
                            .load = SimTime(8),
                            .standstill = SimTime(9)},
                   .tip_path_mm = 10.0,
                   .cut_mm = 11.0,
                   .travel_mm = 12.0,
                   .plunge_mm = 13.0,
                   .beam_on = SimTime(14),
                   .beam_switches = 15,
                   .pierces = 16,
                   .plunges = 17,
                   .shutter_open = SimTime(18),
                   .cut_energy_j = 22.0,
                   .pierce_energy_j = 20.0};
  EXPECT_EQ(work.time.total(), SimTime(45));
  EXPECT_EQ(work.energy_j(), 42.0);
  EXPECT_EQ(work.energy_j_per_mm(), 2.0);
  const WorkFigures twice{.steps = 2,
                          .time = {.motion = SimTime(2),
                                   .settling = SimTime(4),
                                   .dwell = SimTime(6),
                                   .pierce = SimTime(8),
                                   .condition = SimTime(10),
                                   .operator_wait = SimTime(12),
                                   .spin_up = SimTime(14),
                                   .load = SimTime(16),
                                   .standstill = SimTime(18)},
                          .tip_path_mm = 20.0,
                          .cut_mm = 22.0,
                          .travel_mm = 24.0,
                          .plunge_mm = 26.0,
                          .beam_on = SimTime(28),
                          .beam_switches = 30,
                          .pierces = 32,
                          .plunges = 34,
                          .shutter_open = SimTime(36),
                          .cut_energy_j = 44.0,
                          .pierce_energy_j = 40.0,
                          .energy_j_per_mm_max = 2.0};
  WorkTable table;
  table.Add({.program = 1, .step = 1}, work);
  table.Add({.program = 1, .step = 1}, work);
  RunReport report;
  table.WriteTo(report);
  EXPECT_EQ(report.total, twice);
  EXPECT_EQ(report.programs.at(1).total, twice);
  ASSERT_EQ(report.steps.size(), 1u);
  EXPECT_EQ(report.steps[0].figures, twice);
}

// One figure alone is kept, whichever it is, and though it is no more than 1.
TEST(WorkTable, EachFigureIsKeptByItself) {
  using Change = void (*)(WorkFigures&);
  const Change changes[] = {
      [](WorkFigures& work) { work.steps = 1; },
      [](WorkFigures& work) { work.time.motion = SimTime(1); },
      [](WorkFigures& work) { work.time.settling = SimTime(1); },
      [](WorkFigures& work) { work.time.dwell = SimTime(1); },
      [](WorkFigures& work) { work.time.pierce = SimTime(1); },
      [](WorkFigures& work) { work.time.condition = SimTime(1); },
      [](WorkFigures& work) { work.time.operator_wait = SimTime(1); },
      [](WorkFigures& work) { work.time.spin_up = SimTime(1); },
      [](WorkFigures& work) { work.time.load = SimTime(1); },
      [](WorkFigures& work) { work.time.standstill = SimTime(1); },
      [](WorkFigures& work) { work.tip_path_mm = 1.0; },
      [](WorkFigures& work) { work.cut_mm = 1.0; },
      [](WorkFigures& work) { work.travel_mm = 1.0; },
      [](WorkFigures& work) { work.plunge_mm = 1.0; },
      [](WorkFigures& work) { work.beam_on = SimTime(1); },
      [](WorkFigures& work) { work.beam_switches = 1; },
      [](WorkFigures& work) { work.pierces = 1; },
      [](WorkFigures& work) { work.plunges = 1; },
      [](WorkFigures& work) { work.shutter_open = SimTime(1); },
      [](WorkFigures& work) { work.cut_energy_j = 1.0; },
      [](WorkFigures& work) { work.pierce_energy_j = 1.0; },
  };
  for (std::size_t k = 0; k < std::size(changes); ++k) {
    WorkFigures work;
    changes[k](work);
    WorkTable table;
    table.Add({.program = 1, .step = 1}, work);
    RunReport report;
    table.WriteTo(report);
    EXPECT_EQ(report.total, work) << k;
    EXPECT_EQ(report.programs.at(1).total, work) << k;
    EXPECT_EQ(report.steps.at(0).figures, work) << k;
  }
}

WorkFigures Cut(double length_mm, double energy_j) {
  WorkFigures work;
  work.cut_mm = length_mm;
  work.cut_energy_j = energy_j;
  return work;
}

// motion.md 8.2: the highest energy by length: of a step over its motions, of a program and of the
// job over the means of the steps. A scrap of a motion, below a micrometre, says nothing.
TEST(WorkTable, HighestEnergyByLength) {
  WorkTable table;
  table.Add({.program = 1, .step = 1}, Cut(10.0, 20.0));  // 2 J/mm
  table.Add({.program = 1, .step = 1}, Cut(10.0, 60.0));  // 6 J/mm; the step 4 J/mm
  table.Add({.program = 1, .step = 1}, Cut(0.0009, 9.0));
  table.Add({.program = 1, .step = 2}, Cut(10.0, 30.0));
  table.Add({.program = 2, .step = 1}, Cut(0.001, 0.005));  // 5 J/mm: long enough
  RunReport report;
  table.WriteTo(report);
  EXPECT_NEAR(report.steps[0].figures.energy_j_per_mm_max, 6.0, 1e-12);
  EXPECT_NEAR(report.steps[1].figures.energy_j_per_mm_max, 3.0, 1e-12);
  EXPECT_NEAR(report.steps[2].figures.energy_j_per_mm_max, 5.0, 1e-12);
  EXPECT_NEAR(report.programs.at(1).total.energy_j_per_mm_max, 89.0 / 20.0009, 1e-12);
  EXPECT_NEAR(report.programs.at(2).total.energy_j_per_mm_max, 5.0, 1e-12);
  EXPECT_NEAR(report.total.energy_j_per_mm_max, 5.0, 1e-12);
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
  table.Add({.program = 1, .step = 1}, Steps(1, 1.0));          // listed long ago
  RunReport report;
  table.WriteTo(report);
  ASSERT_EQ(report.steps.size(), kReportedStepsMax);
  EXPECT_EQ(report.steps.front().figures.steps, 2u);
  EXPECT_EQ(report.steps.back().figures.steps, 2u);
  EXPECT_EQ(report.rest.steps, 2u);
  EXPECT_EQ(report.rest.cut_mm, 2.0);
  EXPECT_EQ(report.total.steps, kReportedStepsMax + 4);
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
