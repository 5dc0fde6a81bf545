// Instants that belong to what follows, parts of a motion without a way, and what a run takes over
// from the memory of its machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/families/families.h"
#include "engine/simulation/report/report_recorder.h"
#include "engine/simulation/report/samples.h"
#include "engine/simulation/run/rehearsal.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

using machine::WaitKind;

// Up to 10 mm/s within a second, and to rest within another: 10 mm in 2 s.
constexpr motion::PathLimits kTwoSeconds{.speed = 10.0, .acceleration = 10.0};

// motion.md 9: a line of an instant at which one thing ends and another begins is that of the
// other: its step, its power.
TEST(BoundaryTimes, ASampleBelongsToWhatBegins) {
  std::string text;
  SampleRecorder recorder({}, 2.0, [&](std::string_view lines) {
    text += lines;
    return true;
  });
  Script script;
  script.Step(3, 1).Motion(Planned(LineFrom({}, {10, 0, 0}), kTwoSeconds),
                           {.beam_on = true, .power = {.constant_percent = 50.0}});
  script.Step(3, 2).Wait(WaitKind::kDwell, 1.0, true, 25.0);
  script.Step(3, 3).Motion(Planned(LineFrom({10, 0, 0}, {0, 0, 0}), kTwoSeconds));
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish(run.state().time);
  EXPECT_EQ(recorder.lines() + 1, static_cast<std::uint64_t>(std::ranges::count(text, '\n')));
  const auto has = [&](const std::string& line) { return text.find(line) != std::string::npos; };
  const std::string still = ",0.000000000,0.000000000,";
  EXPECT_TRUE(has("\n1.500000000,8.750000,0.000000,0.000000" + still +
                  "8.750000,0.000000,0.000000,5.000000,50.0000,3,1,\n"))
      << text;
  EXPECT_TRUE(has("\n2.000000000,10.000000,0.000000,0.000000" + still +
                  "10.000000,0.000000,0.000000,0.000000,25.0000,3,2,\n"))
      << text;
  EXPECT_TRUE(has("\n3.000000000,10.000000,0.000000,0.000000" + still +
                  "10.000000,0.000000,0.000000,0.000000,0.0000,3,3,\n"))
      << text;
  EXPECT_TRUE(has("\n3.500000000,8.750000,0.000000,0.000000" + still +
                  "8.750000,0.000000,0.000000,5.000000,0.0000,3,3,\n"))
      << text;
}

// A part of a motion that is told of before it came anywhere has time, and the energy of that: 4 ms
// at half of 1500 W.
TEST(BoundaryTimes, APartWithoutAWayHasItsEnergy) {
  const auto planned = Planned(LineFrom({}, {100, 0, 0}));
  Script script;
  script.Step(1, 1).Part(planned,
                         {.from = 50.0,
                          .travelled = 50.0,
                          .profile_start_s = 1.0,
                          .programmed_mm_s = 50.0,
                          .beam_on = true,
                          .power = {.constant_percent = 50.0}},
                         FromSeconds(0.004));
  ReportRecorder recorder(Laser());
  FakeRun run(script, recorder);
  EXPECT_EQ(run.Advance(kForever), machine::RunPhase::kFinished);
  recorder.Finish(run.state().time);
  const RunReport report = recorder.Report(run);
  EXPECT_NEAR(report.total.cut_energy_j, 0.5 * 1500.0 * 0.004, 1e-9);
  EXPECT_EQ(report.total.beam_on, FromSeconds(0.004));
  EXPECT_EQ(report.beam.by_speed[0], FromSeconds(0.004));  // the tip went nowhere: it stood
  EXPECT_EQ(report.total.tip_path_mm, 0.0);
}

ProgramMemory SomeMemory() {
  return {.family = families::FindFamily("rml1"),
          .profile = "t1",
          .programs = {{.slot = 3,
                        .file_name = "a.rml",
                        .bytes = machine::Bytes::Of("PD100,100;"),
                        .is_source = true}},
          .deleted_programs = {5, 9},
          .machine_state = "state"};
}

// What was deleted is empty in the run, too, and is not what it never was.
TEST(BoundaryTimes, ARunKnowsWhatWasDeleted) {
  const auto prepared = PrepareRun(SomeMemory(), {.main_program = 3});
  ASSERT_TRUE(prepared);
  ASSERT_TRUE(prepared->setup);
  EXPECT_EQ(prepared->setup->deleted_programs, (decltype(prepared->setup->deleted_programs){5, 9}));
  EXPECT_EQ(prepared->setup->machine_state, "state");
  EXPECT_EQ(prepared->setup->main_program, 3);
}

// Of all programs together a thousand findings are told, the others counted.
TEST(BoundaryTimes, AThousandFindingsOfAllPrograms) {
  std::string wrong;
  for (int k = 0; k < 600; ++k) wrong += "NOSUCHWORD 1\n";
  ProgramMemory memory{.family = families::FindFamily("optimo")};
  for (const int slot : {1, 2}) {
    memory.programs.push_back(
        {.slot = slot, .file_name = "a.S", .bytes = machine::Bytes::Of(wrong), .is_source = true});
  }
  const auto both = PrepareRun(memory, {.main_program = 1});
  ASSERT_TRUE(both);
  memory.programs.resize(1);
  const auto alone = PrepareRun(memory, {.main_program = 1});
  ASSERT_TRUE(alone);
  EXPECT_FALSE(alone->setup);
  EXPECT_GE(alone->diagnostics.size(), 600U);
  EXPECT_EQ(both->diagnostics.size(), machine::kDiagnosticsMax);
  EXPECT_EQ(both->diagnostics.size() + both->diagnostics_dropped.count(),
            2 * (alone->diagnostics.size() + alone->diagnostics_dropped.count()));
}

// The error that holds the run back is told, though a program before it fills the list.
TEST(BoundaryTimes, TheFirstErrorOfAllPrograms) {
  std::string idle;
  for (int k = 0; k < 1000; ++k) idle += "CONT X\n";
  ProgramMemory memory{.family = families::FindFamily("optimo")};
  memory.programs.push_back(
      {.slot = 1, .file_name = "a.S", .bytes = machine::Bytes::Of(idle), .is_source = true});
  memory.programs.push_back({.slot = 2,
                             .file_name = "b.S",
                             .bytes = machine::Bytes::Of("VR[1] = NOBODY\n"),
                             .is_source = true});
  const auto prepared = PrepareRun(memory, {.main_program = 1});
  ASSERT_TRUE(prepared);
  EXPECT_FALSE(prepared->setup);
  ASSERT_EQ(prepared->diagnostics.size(), machine::kDiagnosticsMax);
  EXPECT_EQ(prepared->diagnostics.back().code, ErrorCode::kNameUndeclared);
  EXPECT_EQ(prepared->diagnostics.back().program, 2);
}

}  // namespace
}  // namespace rmlcell::simulation
