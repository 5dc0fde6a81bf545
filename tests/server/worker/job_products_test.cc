// What a job leaves: findings and reports, as far as its budget of output lets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "engine/families/families.h"
#include "proto/bridge/framing.h"
#include "tests/server/worker/runner_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class JobProducts : public JobRunnerTest {
 protected:
  static v1::WorkerAssignment CheckOf(const std::string& source) {
    return Assignment(v1::JOB_KIND_CHECK, source);
  }
  std::vector<std::string> Codes() {
    std::vector<std::string> codes;
    const v1::RunReport report = Report();
    for (const v1::Diagnostic& diagnostic : report.diagnostics())
      codes.push_back(diagnostic.code());
    return codes;
  }
};

// OPT-2.35 is a finding of the text, OPT-E7301 of the motion: both are found by one check.
TEST_F(JobProducts, ACheckFindsWhatTheMotionWouldMeet) {
  Work(CheckOf(
      "SYSDEF\nCOORD ABSOL\nPATH LIN\nMOVE (4000.,0.,0.,0.,0.)\nMOVE (4100.,0.,0.,0.,0.)\n"));
  EXPECT_THAT(Codes(), ElementsAre("OPT-E7301", "OPT-E7301"));
  EXPECT_EQ(Report().diagnostics(1).place().step(), 5);
  EXPECT_EQ(Report().diagnostics(1).place().line(), 5);
  EXPECT_GT(Report().diagnostics(1).virtual_time_ns(), 0);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(Outcome().code(), "OPT-E7301");
  EXPECT_EQ(Outcome().place().program(), 45);
  EXPECT_EQ(Outcome().place().step(), 4);
  EXPECT_EQ(Outcome().place().line(), 4);
  EXPECT_EQ(Report().motion_check(), "");
  ASSERT_EQ(Events().size(), 2U);
  EXPECT_EQ(Events()[0].virtual_time_ns(), 0);
  EXPECT_GT(Events()[1].virtual_time_ns(), 0);
}

// A thousand places of the motion are listed, and the others counted.
TEST_F(JobProducts, ACheckCountsWhatTheMotionMeetsBeyondThoseListed) {
  std::string source = "COORD ROBOT\n";
  for (int move = 0; move < 1'005; ++move)
    source += move % 2 == 0 ? "MOVE (4000.,0.,0.,0.,0.)\n" : "MOVE (4100.,0.,0.,0.,0.)\n";
  v1::WorkerAssignment assignment = CheckOf(source);
  for (const char* limit : {"OBJECT_LIMIT", "EXECUTABLE_LIMIT"})
    (*assignment.mutable_parameters())[limit] = "1000000";
  Work(assignment);
  const v1::RunReport report = Report();
  EXPECT_EQ(report.diagnostics_dropped(), 5);
  ASSERT_EQ(report.gathered_size(), 1);
  EXPECT_EQ(report.gathered(0).code(), "OPT-E7301");
  EXPECT_EQ(report.gathered(0).count(), 5);
  EXPECT_EQ(report.gathered(0).last().step(), 1'006);
}

// OPT-7.28: without a SYSDEF of its own where it goes hangs on the one before: a person should
// look.
TEST_F(JobProducts, ACheckThatHadToAssumeDoubts) {
  Work(CheckOf("COORD ABSOL\nMOVE (4000.,0.,0.,0.,0.)\n"));
  EXPECT_THAT(Codes(), ElementsAre("OPT-E7301"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_DOUBTFUL);
  ASSERT_EQ(Outcome().reasons_size(), 1);
  EXPECT_THAT(Outcome().reasons(0).message(), HasSubstr("if no SYSDEF is in force before"));
}

// Advice is told and ends nothing (OPT-2.16).
TEST_F(JobProducts, ACheckWithAdviceAloneIsGood) {
  Work(CheckOf(
      "COORD ABSOL\nPATH LIN\nMOVE (500.,500.,-400.,0.,1.)\nMOVE (500.,505.,-400.,0.,0.)\n"));
  EXPECT_THAT(Codes(), ElementsAre("OPT-E7321"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(Outcome().code(), "");
}

// A text that cannot be translated has no motion to look at.
TEST_F(JobProducts, AFaultOfTheTextIsTheOnlyOne) {
  Work(CheckOf("COORD ABSOL\nMOVE (9000.,0.,0.,0.,0.)\nSPEED 101\n"));
  EXPECT_THAT(Codes(), ElementsAre("OPT-E7004"));
}

// The inputs of the job are those of its check; without them the report says how far it looked.
TEST_F(JobProducts, ACheckTakesTheInputsOfTheJob) {
  v1::WorkerAssignment assignment =
      CheckOf("COORD ABSOL\nWAIT (IL[16])\nMOVE (9000.,0.,0.,0.,0.)\n");
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Report().motion_check(), HasSubstr("only up to step 2, line 2"));
  v1::ScriptedInput& input = *assignment.mutable_job()->mutable_simulation()->add_inputs();
  input.set_virtual_time_ns(5'000'000'000);
  v1::Variable& variable = *input.mutable_input()->mutable_from_outside()->mutable_input();
  variable.set_name("IL[16]");
  variable.mutable_value()->set_logical(true);
  Work(assignment);
  EXPECT_THAT(Codes(), ElementsAre("OPT-E7301"));
  EXPECT_EQ(Report().diagnostics(0).virtual_time_ns(), 5'000'000'000);
  EXPECT_EQ(Report().motion_check(), "");
}

// OPT-E.7102: a job has all programs of its machine; what it calls and is not there fails every
// run.
TEST_F(JobProducts, ACheckFailsWhereAProgramIsMissing) {
  Work(CheckOf("COORD ABSOL\nPATH LIN\nSPEED 10\nCALL 77\n"));
  EXPECT_THAT(Codes(), ElementsAre("OPT-E7102"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(Outcome().code(), "OPT-E7102");
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_BAD);
  EXPECT_EQ(Outcome().place().step(), 4);
  Work(CheckOf("IF IL[5] THEN 10\nCALL 77\n10 SPEED 10\n"));
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(Outcome().verdict(), v1::VERDICT_DOUBTFUL);
}

// Only the program of the job is checked; the others are there to be called.
TEST_F(JobProducts, ACheckLooksAtTheProgramOfTheJob) {
  v1::WorkerAssignment assignment = CheckOf("CALL 44\n");
  v1::AssignedProgram& called = *assignment.add_programs();
  called.set_slot(44);
  called.set_file_name("44.S");
  called.set_content("SPEED 101\n");
  called.set_size(10);
  called.set_is_source(true);
  Work(assignment);
  EXPECT_THAT(Codes(), ElementsAre());
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
}

// report.proto, TraceRecord: numbered from 1 without a gap; times are those at which a wait ended.
TEST_F(JobProducts, TheTraceTellsWhatHappenedInItsOrder) {
  v1::WorkerAssignment assignment =
      Assignment(v1::JOB_KIND_SIMULATE, "OL[20]=ON\nDELAY 1.5\nOL[20]=OFF\n");
  assignment.mutable_job()->mutable_simulation()->set_trace(true);
  Work(assignment);
  constexpr std::int64_t kThen = 1'500'000'000;
  const std::string bytes = Artifacts()["trace"];
  std::string_view rest = bytes;
  std::int64_t records = 0;
  v1::TraceRecord::Kind last = v1::TraceRecord::KIND_UNSPECIFIED;
  std::vector<std::pair<double, std::int64_t>> output;       // values of output 20 and their times
  std::vector<std::pair<std::int64_t, std::int64_t>> waits;  // durations, and when they ended
  while (const auto frame = bridge::TakeFrame(rest)) {
    v1::TraceRecord record;
    ASSERT_TRUE(record.ParseFromArray(frame->data(), static_cast<int>(frame->size())));
    EXPECT_EQ(record.number(), ++records);
    if (record.kind() == v1::TraceRecord::KIND_SIGNAL && record.index() == 20)
      output.emplace_back(record.value(), record.virtual_time_ns());
    if (record.kind() == v1::TraceRecord::KIND_WAIT)
      waits.emplace_back(record.duration_ns(), record.virtual_time_ns());
    last = record.kind();
  }
  EXPECT_EQ(rest, "");
  EXPECT_THAT(output, ElementsAre(std::pair(1.0, std::int64_t{0}), std::pair(0.0, kThen)));
  EXPECT_THAT(waits, ElementsAre(std::pair(kThen, kThen)));
  EXPECT_EQ(last, v1::TraceRecord::KIND_END);
}

// job.proto, SimulationOptions.series: 100 mm along X, then it stands for two seconds.
TEST_F(JobProducts, SeriesAreThereWhenTheyAreAskedFor) {
  v1::WorkerAssignment assignment =
      Assignment(v1::JOB_KIND_SIMULATE,
                 "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (121.02, 2201.2, -350, 0, 0)\nDELAY 2\n");
  assignment.mutable_job()->mutable_simulation()->set_series(true);
  Work(assignment);
  v1::SeriesTable table;
  ASSERT_TRUE(table.ParseFromString(Artifacts()["series"]));
  const v1::RunReport report = Report();
  EXPECT_NEAR(1e-9 * static_cast<double>(table.end_ns()), report.total().times().cycle_s(), 1e-6);
  ASSERT_EQ(table.columns_size(), 8);
  const v1::SeriesTable::Column& speed = table.columns(0);
  EXPECT_EQ(speed.signal(), "speed");
  ASSERT_GT(speed.high_size(), 100);
  EXPECT_NEAR(*std::ranges::max_element(speed.high()), report.axes(0).peak_speed(), 1e-3);
  EXPECT_GT(report.axes(0).peak_speed(), 50.0);
  EXPECT_EQ(speed.last(speed.last_size() - 1), 0.0F);
  const v1::SeriesTable::Column& x = table.columns(3);
  EXPECT_EQ(x.signal(), "axis.X");
  EXPECT_NEAR(x.last(0), 21.02, 0.1);
  EXPECT_NEAR(x.last(x.last_size() - 1), 121.02, 1e-3);
}

// job.proto, GetStepMapResponse: the texts that the job brought, and of all programs their objects.
TEST_F(JobProducts, TheStepsOfItsProgramsAreKept) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "; a part\nSPEED 5\n\nSTOP\n"));
  v1::GetStepMapResponse map;
  ASSERT_TRUE(map.ParseFromString(Artifacts()["steps"]));
  ASSERT_EQ(map.programs_size(), 1);
  EXPECT_EQ(map.programs(0).program(), 45);
  EXPECT_EQ(map.programs(0).object_sha256().size(), 64U);
  ASSERT_GE(map.programs(0).lines_size(), 2);
  EXPECT_EQ(map.programs(0).lines(0), 2);
  EXPECT_EQ(map.programs(0).lines(1), 4);
}

// framing.h: the toolpath is kept as frames, whole ones to the end.
TEST_F(JobProducts, TheToolpathIsASeriesOfFrames) {
  Work(Assignment(v1::JOB_KIND_SIMULATE, "PA;VS8;!MC1;PU1000,1000;Z1000,1000,-50;PU0,0;", "rml1"));
  const std::string bytes = Artifacts()["toolpath"];
  std::string_view rest = bytes;
  ASSERT_TRUE(bridge::TakeFrame(rest));
  while (bridge::TakeFrame(rest)) continue;
  EXPECT_EQ(rest, "");
}

// worker.proto, WorkerFinish.artifacts: what is small comes with the end, what is large by itself.
TEST_F(JobProducts, SmallOnesComeWithTheEnd) {
  const auto by_themselves = [&] {
    return std::ranges::count_if(heard_, [](const v1::WorkRequest& m) { return m.has_artifact(); });
  };
  Work(Assignment(v1::JOB_KIND_SIMULATE, "PA;VS8;!MC1;PU1000,1000;Z1000,1000,-50;PU0,0;", "rml1"));
  EXPECT_EQ(by_themselves(), 0);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
  std::string source = "PA;PA;VS8;!MC1;";
  for (int i = 0; i < 20'000; ++i)
    source += "Z" + std::to_string(i % 2 * 1000) + "," + std::to_string(i % 7 * 100) + ",-50;";
  Work(Assignment(v1::JOB_KIND_SIMULATE, source, "rml1"));
  EXPECT_GT(by_themselves(), 0);
  EXPECT_THAT(Names(), ElementsAre("picture.svg", "report", "toolpath"));
}

// Budget.output_bytes: so many bytes of output and not one more.
TEST_F(JobProducts, ABudgetOfOutputMayBeUsedUp) {
  v1::WorkerAssignment assignment = CheckOf("STOP\n");
  Work(assignment);
  const auto report_bytes = static_cast<std::int64_t>(Artifacts()["report"].size());
  ASSERT_GT(report_bytes, 0);
  assignment.mutable_budget()->set_output_bytes(report_bytes);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_THAT(Names(), ElementsAre("report"));
  assignment.mutable_budget()->set_output_bytes(report_bytes - 1);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
  EXPECT_EQ(Outcome().code(), "CELL-E9306");
  EXPECT_THAT(Names(), ElementsAre());
}

// Of several breakpoints the one whose condition holds first ends what nobody starts again.
TEST_F(JobProducts, ASimulationHaltsAtABreakpointWithItsCondition) {
  v1::WorkerAssignment assignment = Assignment(
      v1::JOB_KIND_SIMULATE, "VI[1] = 0\n10 VI[1] = VI[1] + 1\nDELAY 1\nIF VI[1] < 10 THEN 10\n");
  v1::SimulationOptions& options = *assignment.mutable_job()->mutable_simulation();
  options.add_variables("VI[1]");
  v1::Breakpoint& conditional = *options.add_breakpoints();
  conditional.mutable_step()->set_step(3);
  conditional.set_condition("VI[1] > 4");
  v1::Breakpoint& late = *options.add_breakpoints();
  late.mutable_step()->set_step(2);
  late.set_passes(9);
  Work(assignment);
  EXPECT_EQ(Outcome().kind(), v1::Outcome::KIND_STOPPED);
  ASSERT_EQ(Report().variables_size(), 1);
  EXPECT_EQ(Report().variables(0).value().integer(), 5);
  EXPECT_EQ(Report().variables(0).text(), "5");
}

}  // namespace
}  // namespace rmlcell::server
