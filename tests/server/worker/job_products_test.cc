// What a job leaves: findings and reports, as far as its budget of output lets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "proto/bridge/framing.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "server/worker/replayed_products.h"
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

// What a machine that lived recorded of a run, made into the products of that run. LIVE-3.41
class ReplayedProducts : public testing::Test {
 protected:
  ReplayedProducts() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ReplayedProducts() override { std::filesystem::remove_all(folder_); }

  // A mill that is to run this stream from its beginning, up to a time at which nothing happens.
  static recording::Recording RecordingOf(const std::string& stream, std::chrono::seconds until) {
    const machine::MachineFamily& family = *families::FindFamily("rml1");
    machine::RunObserver nobody;
    machine::MachineMemory memory;
    memory.programs[5] = {.name = "part", .object = machine::Bytes::Of(stream)};
    recording::Recording made;
    made.head.set_machine("machines/mill-1");
    made.head.set_family("rml1");
    made.head.set_profile("srm-20");
    recording::SetMemory(memory, made.head);
    const auto machine = machine::Machine::Make(
        family, *machine::MakeParameters(family, "srm-20", {}), memory, "", nobody);
    EXPECT_TRUE(machine);
    v1::JournalEntry& mark = made.entries.emplace_back();
    mark.set_sequence(1);
    mark.mutable_mark()->set_state((*machine)->Save());
    mark.mutable_mark()->set_state_sha256(*BytesOfHex(bridge::Sha256Hex(mark.mark().state())));
    v1::JournalEntry& start = made.entries.emplace_back();
    start.set_sequence(2);
    *start.mutable_applied()->mutable_input() = bridge::AppliedOf(machine::StartRun{.program = 5});
    // Two entries that tell nothing: time goes on up to the first, and behind it.
    for (const int further : {0, 1}) {
      v1::JournalEntry& entry = made.entries.emplace_back();
      entry.set_sequence(3 + further);
      entry.set_virtual_time_ns(
          std::chrono::nanoseconds(until + std::chrono::seconds(further)).count());
    }
    return made;
  }
  Status Make(const recording::Recording& recording) const {
    std::ofstream(folder_ + "/recording", std::ios::binary) << recording::FileOf(recording);
    return MakeProducts(folder_ + "/recording", folder_);
  }
  std::string Product(const std::string& name) const {
    std::ifstream file(folder_ + "/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  v1::RunReport Report() const {
    v1::RunReport report;
    EXPECT_TRUE(report.ParseFromString(Product("report")));
    return report;
  }
  // Why nothing is made of it.
  std::string Refused(const recording::Recording& recording) const {
    const Status made = Make(recording);
    return made ? "" : CodeText(made.error().code) + " " + std::string(made.error().detail);
  }

  const std::string folder_ = testing::TempDir() + "/replayed_products";
};

constexpr const char* kThereAndBack = "PA;PA;VS10;PU200,0;PU0,0;";

TEST_F(ReplayedProducts, AreThoseOfTheRun) {
  const Status made = Make(RecordingOf(kThereAndBack, std::chrono::hours(1)));
  ASSERT_TRUE(made) << made.error().detail;
  const v1::RunReport report = Report();
  EXPECT_EQ(report.family(), "rml1");
  EXPECT_EQ(report.profile(), "srm-20");
  EXPECT_EQ(report.outcome().kind(), v1::Outcome::KIND_COMPLETED);
  EXPECT_GT(report.total().times().cycle_s(), 0.0);
  EXPECT_TRUE(report.inputs().contains("program"));
  EXPECT_THAT(Product("picture.svg"), HasSubstr("<svg"));
  const std::string toolpath = Product("toolpath");
  std::string_view rest = toolpath;
  EXPECT_TRUE(bridge::TakeFrame(rest));
  while (bridge::TakeFrame(rest)) continue;
  EXPECT_TRUE(rest.empty());
}

// The program that was brought is the one that ran, whatever the slot had.
TEST_F(ReplayedProducts, HaveTheProgramThatWasBrought) {
  ASSERT_TRUE(Make(RecordingOf(kThereAndBack, std::chrono::hours(1))));
  const v1::RunReport stored = Report();
  recording::Recording brought = RecordingOf(kThereAndBack, std::chrono::hours(1));
  brought.head.mutable_brought()->set_file_name("other.rml");
  brought.head.mutable_brought()->set_content("PA;PA;VS10;PU2000,0;PU0,0;");
  ASSERT_TRUE(Make(brought));
  EXPECT_GT(Report().total().times().cycle_s(), stored.total().times().cycle_s());
  EXPECT_NE(Report().inputs().at("program"), stored.inputs().at("program"));
}

// Cut off by the end of its host: its outcome is that of the job, and no part is good.
TEST_F(ReplayedProducts, OfARunThatWasCutOff) {
  for (const char* code : {"CELL-E9432", "CELL-E9411"}) {
    recording::Recording recording = RecordingOf(kThereAndBack, std::chrono::seconds(3));
    v1::Outcome& outcome = *recording.entries[2].mutable_run_over()->mutable_outcome();
    outcome.set_kind(v1::Outcome::KIND_INTERRUPTED);
    outcome.set_code(code);
    outcome.set_message("as the host said");
    const Status made = Make(recording);
    ASSERT_TRUE(made) << made.error().detail;
    const v1::RunReport report = Report();
    EXPECT_EQ(report.outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
    EXPECT_EQ(report.outcome().code(), code);
    EXPECT_EQ(report.outcome().message(), "as the host said");
    EXPECT_EQ(report.outcome().verdict(), v1::VERDICT_BAD);
    std::vector<std::string> reasons;
    for (const v1::VerdictReason& reason : report.outcome().reasons())
      reasons.push_back(reason.code());
    EXPECT_THAT(reasons, testing::Contains(code));
    EXPECT_THAT(Product("picture.svg"), HasSubstr("<svg"));
  }
}

TEST_F(ReplayedProducts, NothingIsMadeOfWhatIsNoWholeRun) {
  EXPECT_THAT(Refused(RecordingOf(kThereAndBack, std::chrono::seconds(1))),
              HasSubstr("CELL-E9015 the recording ends before the run does"));
  recording::Recording other = RecordingOf(kThereAndBack, std::chrono::hours(1));
  other.entries[0].mutable_mark()->set_state_sha256("another");
  EXPECT_THAT(Refused(other), HasSubstr("CELL-E9436 entry 1, mark.state_sha256: recorded "));
  other = RecordingOf(kThereAndBack, std::chrono::hours(1));
  other.head.set_family("lathe");
  EXPECT_EQ(Refused(other), "CELL-E9008 lathe");
  EXPECT_EQ(MakeProducts(folder_ + "/none", folder_).error().code, ErrorCode::kCellFileUnreadable);
  ASSERT_TRUE(Make(RecordingOf(kThereAndBack, std::chrono::hours(1))));
  EXPECT_EQ(MakeProducts(folder_ + "/recording", folder_ + "/no/folder").error().code,
            ErrorCode::kCellFileUnwritable);
}

}  // namespace
}  // namespace rmlcell::server
