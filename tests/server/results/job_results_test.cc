// What is asked about jobs that have ended (proto/rmlcell/v1/job.proto, JobService).
#include "server/results/job_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class JobResultsTest : public testing::Test {
 protected:
  v1::Job Job(const std::string& source, const std::string& machine = "optimo-1") {
    v1::Job job;
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/" + machine);
    job.mutable_inline_program()->set_file_name(machine == "mill-1" ? "part.rml" : "part.S");
    job.mutable_inline_program()->set_content(source);
    return job;
  }
  v1::Job Stored(int slot) {
    v1::Job job;
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/optimo-1");
    job.set_program("machines/optimo-1/programs/" + std::to_string(slot));
    return job;
  }

  // A job that has ended with these products.
  std::string Ended(const v1::Job& job, const v1::RunReport& report,
                    std::vector<storage::NewArtifact> more = {}) {
    v1::SubmitJobRequest request;
    *request.mutable_job() = job;
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    const std::string name = Must(answer.get_future().get()).name();
    const storage::Lease lease = bed.Lease("SIMULATE");
    more.push_back({"report", "application/x-protobuf", report.SerializeAsString(), {}});
    Must(bed.store().Finish(lease,
                            {.outcome = {}, .artifacts = more, .executables = {}, .events = {}}));
    return name;
  }
  static void AddFinding(v1::RunReport& report, const std::string& code, int program, int step,
                         v1::Severity severity = v1::SEVERITY_WARNING,
                         v1::Verdict verdict = v1::VERDICT_UNSPECIFIED) {
    v1::Diagnostic& finding = *report.add_diagnostics();
    finding.set_code(code);
    finding.set_severity(severity);
    finding.set_verdict(verdict);
    finding.mutable_place()->set_program(program);
    finding.mutable_place()->set_step(step);
  }

  Result<v1::ListJobFindingsResponse> Findings(const std::string& job,
                                               const std::string& filter = {}, int size = 0,
                                               const std::string& token = {}) {
    v1::ListJobFindingsRequest request;
    request.set_name(job);
    request.set_filter(filter);
    request.set_page_size(size);
    request.set_page_token(token);
    return results.Findings(request);
  }
  std::vector<int> Steps(const std::string& job, const std::string& filter) {
    std::vector<int> steps;
    const auto found = Must(Findings(job, filter));
    for (const v1::Diagnostic& one : found.findings()) steps.push_back(one.place().step());
    return steps;
  }
  Result<v1::CompareJobsResponse> Compare(const std::string& before, const std::string& after) {
    v1::CompareJobsRequest request;
    request.set_before(before);
    request.set_after(after);
    return results.Compare(request);
  }
  Result<v1::GetStepMapResponse> Map(const std::string& job) {
    v1::GetStepMapRequest request;
    request.set_name(job);
    return results.StepMap(request);
  }
  storage::NewArtifact StepsArtifact(const v1::GetStepMapResponse& map) {
    return {"steps", "application/x-protobuf", map.SerializeAsString(), {}};
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
  JobResults results{bed.store(), book, tools};
};

TEST_F(JobResultsTest, FindingsComeInPages) {
  v1::RunReport report;
  for (int step = 1; step <= 1000; ++step) AddFinding(report, "OPT-E7304", 1, step);
  report.add_gathered()->set_code("OPT-E7304");
  const std::string job = Ended(Job("STOP\n"), report);
  const auto first = Must(Findings(job));
  EXPECT_EQ(first.findings_size(), 100);
  EXPECT_EQ(first.total_size(), 1000);
  EXPECT_EQ(first.gathered_size(), 1);
  EXPECT_EQ(Must(Findings(job, {}, 2000)).findings_size(), 1000);
  std::vector<int> steps;
  std::string token;
  do {
    const auto page = Must(Findings(job, {}, 300, token));
    for (const v1::Diagnostic& one : page.findings()) steps.push_back(one.place().step());
    token = page.next_page_token();
  } while (!token.empty());
  ASSERT_EQ(steps.size(), 1000U);
  for (int step = 1; step <= 1000; ++step)
    EXPECT_EQ(steps[static_cast<std::size_t>(step) - 1], step);
  EXPECT_EQ(Must(Findings(job, {}, 500, "500")).next_page_token(), "");
  for (const std::string wrong : {"0", "-1", "x"})
    EXPECT_EQ(Findings(job, {}, 0, wrong).error().code, ErrorCode::kCellBadPageToken) << wrong;
}

TEST_F(JobResultsTest, FindingsCanBeChosen) {
  v1::RunReport report;
  AddFinding(report, "OPT-E7304", 1, 1);
  AddFinding(report, "OPT-E7301", 1, 2, v1::SEVERITY_ALARM, v1::VERDICT_BAD);
  AddFinding(report, "OPT-E7304", 44, 3, v1::SEVERITY_WARNING, v1::VERDICT_DOUBTFUL);
  report.add_gathered()->set_code("OPT-E7304");
  report.mutable_gathered(0)->set_severity(v1::SEVERITY_WARNING);
  const std::string job = Ended(Job("STOP\n"), report);
  EXPECT_THAT(Steps(job, ""), ElementsAre(1, 2, 3));
  EXPECT_THAT(Steps(job, "code = opt-e7304"), ElementsAre(1, 3));
  EXPECT_THAT(Steps(job, "severity = alarm"), ElementsAre(2));
  EXPECT_THAT(Steps(job, "severity = SEVERITY_WARNING"), ElementsAre(1, 3));
  EXPECT_THAT(Steps(job, "verdict = DOUBTFUL"), ElementsAre(3));
  EXPECT_THAT(Steps(job, "program = 1"), ElementsAre(1, 2));
  EXPECT_THAT(Steps(job, "program = 44 AND code = OPT-E7301"), ElementsAre());
  EXPECT_EQ(Must(Findings(job, "severity = WARNING")).total_size(), 2);
  EXPECT_EQ(Must(Findings(job, "severity = WARNING")).gathered_size(), 1);
  EXPECT_EQ(Must(Findings(job, "code = OPT-E7301")).gathered_size(), 0);
  for (const std::string wrong : {"severity = LOUD", "verdict = FINE", "program = 100",
                                  "program = x", "step = 1", "code", "code = A AND code = B"})
    EXPECT_EQ(Findings(job, wrong).error().code, ErrorCode::kCellBadFilter) << wrong;
}

TEST_F(JobResultsTest, AJobThatHasNotEndedHasNoFindings) {
  bed.SubmitCheck();
  EXPECT_EQ(Findings("jobs/1").error().code, ErrorCode::kCellPrecondition);
  EXPECT_EQ(Findings("jobs/2").error().code, ErrorCode::kCellNotFound);
  EXPECT_EQ(Findings("job").error().code, ErrorCode::kCellInvalidArgument);
}

// Lines of a program that came as an object are those of the text that is kept in its slot, while
// that is of the same object.
TEST_F(JobResultsTest, AStepMapFindsTheTextOfTheObject) {
  const std::string text = "; a part\nSPEED 5\n\nDELAY 1.\nSTOP\n";
  ASSERT_TRUE(
      programs.Store({.name = "machines/optimo-1/programs/12", .file_name = "a.S", .bytes = text}));
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 13, .object = ObjectOf(text)}}, {}));
  v1::GetStepMapResponse map;
  const auto add = [&map](int slot, const std::string& object, std::vector<int> lines) {
    auto& program = *map.add_programs();
    program.set_program(slot);
    program.set_object_sha256(bridge::Sha256Hex(object));
    *program.mutable_lines() = {lines.begin(), lines.end()};
  };
  add(7, ObjectOf("STOP\n"), {3});  // the job brought its text
  add(12, ObjectOf(text), {});
  add(13, ObjectOf(text), {});
  add(14, ObjectOf(text), {});  // the slot is empty by now
  const std::string job = Ended(Stored(12), {}, {StepsArtifact(map)});
  const auto read = Must(Map(job));
  ASSERT_EQ(read.programs_size(), 4);
  EXPECT_THAT(read.programs(0).lines(), ElementsAre(3));
  // Steps 1 to 3 and the END that is implied behind the last.
  EXPECT_THAT(
      std::vector<int>(read.programs(1).lines().begin(), read.programs(1).lines().begin() + 3),
      ElementsAre(2, 4, 5));
  EXPECT_THAT(
      std::vector<int>(read.programs(2).lines().begin(), read.programs(2).lines().begin() + 3),
      ElementsAre(1, 2, 3));  // as the decompiler writes it
  EXPECT_EQ(read.programs(3).lines_size(), 0);
  ASSERT_TRUE(programs.Store(
      {.name = "machines/optimo-1/programs/12", .file_name = "a.S", .bytes = "STOP\n"}));
  EXPECT_EQ(Must(Map(job)).programs(1).lines_size(), 0);
  EXPECT_EQ(Map(Ended(Job("PA;", "mill-1"), {})).error().code, ErrorCode::kCellNotFound);
}

// Those that the job brought stay, though the slot has another text of the same object.
TEST_F(JobResultsTest, AStepMapKeepsTheLinesThatItHas) {
  const std::string text = "; a part\nSPEED 5\nSTOP\n";
  ASSERT_TRUE(
      programs.Store({.name = "machines/optimo-1/programs/12", .file_name = "a.S", .bytes = text}));
  v1::GetStepMapResponse map;
  auto& program = *map.add_programs();
  program.set_program(12);
  program.set_object_sha256(bridge::Sha256Hex(ObjectOf(text)));
  for (const int line : {7, 8}) program.add_lines(line);
  const auto read = Must(Map(Ended(Stored(12), {}, {StepsArtifact(map)})));
  ASSERT_EQ(read.programs_size(), 1);
  EXPECT_THAT(read.programs(0).lines(), ElementsAre(7, 8));
}

// Parts 0, 1 and 4 of 10 ns; between them nothing changes.
v1::SeriesTable SomeSeries() {
  v1::SeriesTable table;
  table.set_part_ns(10);
  table.set_end_ns(60);
  for (const int part : {0, 1, 4}) table.add_parts(part);
  v1::SeriesTable::Column& speed = *table.add_columns();
  speed.set_signal("speed");
  speed.set_unit("mm/s");
  for (const float low : {1.0F, 2.0F, -5.0F}) speed.add_low(low);
  for (const float high : {10.0F, 4.0F, 7.0F}) speed.add_high(high);
  for (const float last : {3.0F, 3.5F, 6.0F}) speed.add_last(last);
  v1::SeriesTable::Column& axis = *table.add_columns();
  axis.set_signal("axis.X");
  axis.set_unit("mm");
  for (int part = 0; part < 3; ++part) {
    axis.add_low(0.0F);
    axis.add_high(0.0F);
    axis.add_last(0.0F);
  }
  return table;
}

TEST_F(JobResultsTest, SeriesHaveTheLeastAndTheGreatestOfEachPart) {
  const std::string job =
      Ended(Job("STOP\n"), {},
            {{"series", "application/x-protobuf", SomeSeries().SerializeAsString(), {}}});
  const auto asked = [&](std::int64_t from, std::int64_t to, int buckets) {
    v1::GetJobSeriesRequest request;
    request.set_name(job);
    request.add_signals("speed");
    request.set_from_ns(from);
    request.set_to_ns(to);
    request.set_buckets(buckets);
    const auto series = Must(results.Series(request)).series(0);
    std::vector<std::pair<double, double>> parts;
    for (int k = 0; k < series.low_size(); ++k) parts.emplace_back(series.low(k), series.high(k));
    return parts;
  };
  using testing::Pair;
  EXPECT_THAT(asked(0, 0, 1), ElementsAre(Pair(-5.0, 10.0)));
  // From 20 to 40 and from 50 on it stands where it was.
  EXPECT_THAT(asked(0, 0, 6), ElementsAre(Pair(1.0, 10.0), Pair(2.0, 4.0), Pair(3.5, 3.5),
                                          Pair(3.5, 3.5), Pair(-5.0, 7.0), Pair(6.0, 6.0)));
  EXPECT_THAT(asked(0, 0, 2), ElementsAre(Pair(1.0, 10.0), Pair(-5.0, 7.0)));
  EXPECT_THAT(asked(10, 50, 2), ElementsAre(Pair(2.0, 4.0), Pair(-5.0, 7.0)));
  EXPECT_THAT(asked(2, 6, 2), ElementsAre(Pair(1.0, 10.0), Pair(1.0, 10.0)));  // no finer than kept
  EXPECT_THAT(asked(25, 35, 1), ElementsAre(Pair(3.5, 3.5)));
  EXPECT_THAT(asked(50, 1000, 1), ElementsAre(Pair(6.0, 6.0)));  // ends with the run
}

TEST_F(JobResultsTest, SeriesThatMakeNoSenseAreRefused) {
  const std::string job =
      Ended(Job("STOP\n"), {},
            {{"series", "application/x-protobuf", SomeSeries().SerializeAsString(), {}}});
  v1::GetJobSeriesRequest good;
  good.set_name(job);
  good.add_signals("axis.X");
  good.add_signals("speed");
  good.set_buckets(10'000);
  const auto made = Must(results.Series(good));
  EXPECT_EQ(made.to_ns(), 60);
  EXPECT_EQ(made.series(0).signal(), "axis.X");
  EXPECT_EQ(made.series(0).unit(), "mm");
  EXPECT_EQ(made.series(1).signal(), "speed");
  EXPECT_EQ(made.series(1).high_size(), 10'000);
  const auto refused = [&](const std::function<void(v1::GetJobSeriesRequest&)>& change) {
    v1::GetJobSeriesRequest request = good;
    change(request);
    const auto series = results.Series(request);
    return series ? Detail() : series.error().detail;
  };
  EXPECT_THAT(refused([](auto& r) { r.add_signals("colour"); }),
              HasSubstr("there are speed axis.X"));
  EXPECT_THAT(refused([](auto& r) { r.clear_signals(); }), HasSubstr("1 to 20"));
  EXPECT_THAT(refused([](auto& r) {
                for (int k = 0; k < 19; ++k) r.add_signals("speed");
              }),
              HasSubstr("1 to 20"));
  EXPECT_THAT(refused([](auto& r) { r.set_buckets(0); }), HasSubstr("1 to 10000"));
  EXPECT_THAT(refused([](auto& r) { r.set_buckets(10'001); }), HasSubstr("1 to 10000"));
  EXPECT_THAT(refused([](auto& r) { r.set_from_ns(-1); }), HasSubstr("0 to 60"));
  EXPECT_THAT(refused([](auto& r) { r.set_from_ns(61); }), HasSubstr("0 to 60"));
  good.set_name(Ended(Job("STOP\n"), {}));  // it asked for none
  EXPECT_EQ(results.Series(good).error().code, ErrorCode::kCellNotFound);
}

// WEB-6.08: verdict, inputs, figures and findings.
TEST_F(JobResultsTest, TwoJobsAreCompared) {
  v1::RunReport one;
  one.set_family("optimo");
  one.set_engine_version("1");
  one.mutable_outcome()->set_verdict(v1::VERDICT_BAD);
  one.mutable_total()->mutable_times()->set_cycle_s(10.0);
  one.mutable_total()->set_cut_length_mm(5.0);
  one.mutable_total()->set_pierces(2);
  one.mutable_total()->set_energy_j_per_mm(3.0);
  (*one.mutable_parameters())["VMAX"] = "20";
  AddFinding(one, "OPT-E7304", 1, 1);
  AddFinding(one, "OPT-E7301", 1, 2);
  v1::RunReport two = one;
  two.mutable_outcome()->set_verdict(v1::VERDICT_GOOD);
  two.mutable_total()->mutable_times()->set_cycle_s(12.5);
  two.mutable_total()->set_pierces(3);
  two.mutable_total()->set_energy_j_per_mm(3.5);
  two.mutable_parameters()->clear();
  (*two.mutable_parameters())["AMAX"] = "7";
  two.clear_diagnostics();
  AddFinding(two, "OPT-E7304", 1, 1);
  AddFinding(two, "OPT-E7304", 1, 5);
  const std::string before = Ended(Job("DELAY 1\nSTOP\n"), one);
  const std::string after = Ended(Job("DELAY 2\nSTOP\n"), two);
  const auto compared = Must(Compare(before, after));
  EXPECT_EQ(compared.verdict_before(), v1::VERDICT_BAD);
  EXPECT_EQ(compared.verdict_after(), v1::VERDICT_GOOD);
  std::vector<std::string> inputs;
  for (const auto& input : compared.inputs())
    inputs.push_back(input.name() + " " + input.before() + ">" + input.after());
  EXPECT_THAT(inputs, ElementsAre("parameters.AMAX >7", "parameters.VMAX 20>",
                                  "program " + bridge::Sha256Hex("DELAY 1\nSTOP\n") + ">" +
                                      bridge::Sha256Hex("DELAY 2\nSTOP\n")));
  std::vector<std::string> figures;
  for (const auto& figure : compared.figures())
    figures.push_back(figure.name() + " " + figure.unit());
  EXPECT_THAT(figures,
              testing::UnorderedElementsAre("cycle_s s", "pierces ", "energy_j_per_mm J/mm"));
  ASSERT_EQ(compared.gained_size(), 1);
  EXPECT_EQ(compared.gained(0).place().step(), 5);
  ASSERT_EQ(compared.lost_size(), 1);
  EXPECT_EQ(compared.lost(0).code(), "OPT-E7301");
  EXPECT_EQ(compared.common(), 1);
  ASSERT_EQ(compared.difference().steps_size(), 1);
  EXPECT_THAT(compared.difference().steps(0).before(), HasSubstr("DELAY 1"));
}

TEST_F(JobResultsTest, AJobIsTheSameAsItself) {
  v1::RunReport report;
  report.set_family("optimo");
  report.mutable_total()->mutable_times()->set_cycle_s(10.0);
  AddFinding(report, "OPT-E7304", 1, 1);
  const std::string job = Ended(Job("STOP\n"), report);
  const auto compared = Must(Compare(job, job));
  EXPECT_EQ(compared.inputs_size() + compared.figures_size() + compared.gained_size() +
                compared.lost_size(),
            0);
  EXPECT_FALSE(compared.has_difference());
  EXPECT_EQ(compared.common(), 1);
}

TEST_F(JobResultsTest, ObjectsAreComparedToo) {
  Must(bed.store().PutPrograms("optimo-1",
                               {{.slot = 12, .object = ObjectOf("DELAY 1\nSTOP\n")},
                                {.slot = 13, .object = ObjectOf("DELAY 2\nSTOP\n")}},
                               {}));
  v1::RunReport report;
  report.set_family("optimo");
  const auto compared = Must(Compare(Ended(Stored(12), report), Ended(Stored(13), report)));
  EXPECT_FALSE(compared.has_difference_error()) << compared.difference_error().message();
  EXPECT_EQ(compared.difference().steps_size(), 1);
}

// What a job says of its program goes before what the name of it says.
TEST_F(JobResultsTest, ObjectsThatWereBroughtAreComparedAsObjects) {
  v1::RunReport report;
  report.set_family("optimo");
  std::vector<std::string> names;
  for (const char* source : {"DELAY 1\nSTOP\n", "DELAY 2\nSTOP\n"}) {
    v1::Job job = Job(ObjectOf(source));
    job.mutable_inline_program()->set_form(v1::PROGRAM_FORM_OBJECT);
    names.push_back(Ended(job, report));
  }
  const auto compared = Must(Compare(names[0], names[1]));
  EXPECT_FALSE(compared.has_difference_error()) << compared.difference_error().message();
  EXPECT_EQ(compared.difference().steps_size(), 1);
}

// A program of a slot is called by its number. OPT-2.09: a hole of radius 0 ends its run.
TEST_F(JobResultsTest, ProgramsOfSlotsAreCalledByTheirNumbers) {
  v1::RunReport report;
  report.set_family("optimo");
  std::vector<std::string> names;
  for (const int slot : {12, 13}) {
    const std::string source = "SPEED " + std::to_string(slot) +
                               "\nCOORD ABSOL\nPATH HOLE (0.)\nMOVE (1000.,900.,-500.,0.,0.)\n";
    Must(bed.store().PutPrograms("optimo-1", {{.slot = slot, .object = ObjectOf(source)}}, {}));
    names.push_back(Ended(Stored(slot), report));
  }
  const auto compared = Must(Compare(names[0], names[1]));
  ASSERT_EQ(compared.difference().notes_size(), 2) << compared.difference_error().message();
  EXPECT_THAT(compared.difference().notes(0), testing::StartsWith("12.O: "));
  EXPECT_THAT(compared.difference().notes(1), testing::StartsWith("13.O: "));
}

// Stored streams of a mill, whose programs have no other form: all else is told in any case.
TEST_F(JobResultsTest, StreamsThatAreStoredAreComparedAsFarAsTheyCanBe) {
  v1::RunReport report;
  report.set_family("rml1");
  std::vector<std::string> names;
  for (const int slot : {7, 8}) {
    Must(bed.store().PutPrograms(
        "mill-1", {{.slot = slot, .object = "PA;PU" + std::to_string(slot) + ",0;"}}, {}));
    v1::Job job;
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/mill-1");
    job.set_program("machines/mill-1/programs/" + std::to_string(slot));
    names.push_back(Ended(job, report));
  }
  const auto compared = Must(Compare(names[0], names[1]));
  EXPECT_NE(compared.has_difference(), compared.has_difference_error());
  ASSERT_EQ(compared.inputs_size(), 1);
  EXPECT_EQ(compared.inputs(0).name(), "program");
}

TEST_F(JobResultsTest, WhatCannotBeComparedIsSaid) {
  v1::RunReport report;
  report.set_family("optimo");
  const std::string good = Ended(Job("STOP\n"), report);
  const auto compared = Must(Compare(good, Ended(Job("NONSENSE\n"), report)));
  EXPECT_FALSE(compared.has_difference());
  EXPECT_EQ(compared.difference_error().code(), "OPT-E7011");
  EXPECT_THAT(compared.difference_error().message(), testing::StartsWith("part.S line 1: "));
  report.set_family("rml1");
  EXPECT_EQ(Compare(good, Ended(Job("PA;", "mill-1"), report)).error().code,
            ErrorCode::kCellPrecondition);
  EXPECT_EQ(Compare(good, "jobs/99").error().code, ErrorCode::kCellNotFound);
}

// 9104: products that are no messages any more.
TEST_F(JobResultsTest, DamagedProductsAreToldAsSuch) {
  const std::string job =
      Ended(Job("STOP\n"), {}, {{"steps", "m", "\xFF", {}}, {"series", "m", "\xFF", {}}});
  EXPECT_EQ(CodeOf(Map(job)), ErrorCode::kCellStoreCorrupt);
  v1::GetJobSeriesRequest series;
  series.set_name(job);
  series.add_signals("x");
  series.set_buckets(1);
  EXPECT_EQ(CodeOf(results.Series(series)), ErrorCode::kCellStoreCorrupt);
  bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  Must(bed.store().Finish(lease, {.outcome = {},
                                  .artifacts = {{"report", "m", "\xFF", {}}},
                                  .executables = {},
                                  .events = {}}));
  EXPECT_EQ(CodeOf(Findings(JobName(lease.job))), ErrorCode::kCellStoreCorrupt);
}

// A figure that one of them alone has is 0 in the other.
TEST_F(JobResultsTest, FiguresOfOneJobAloneAreCompared) {
  const auto report = [](const std::string& name, const std::string& unit, double value) {
    v1::RunReport made;
    made.set_family("optimo");
    v1::Figure& figure = *made.add_figures();
    figure.set_name(name);
    figure.set_unit(unit);
    figure.set_value(value);
    return made;
  };
  const auto compared = Must(Compare(Ended(Job("STOP\n"), report("depth", "mm", 2.0)),
                                     Ended(Job("STOP\n"), report("speed", "mm/s", 3.0))));
  ASSERT_EQ(compared.figures_size(), 2);
  EXPECT_EQ(compared.figures(0).name(), "depth");
  EXPECT_EQ(compared.figures(0).unit(), "mm");
  EXPECT_EQ(compared.figures(0).before(), 2.0);
  EXPECT_EQ(compared.figures(0).after(), 0.0);
  EXPECT_EQ(compared.figures(1).name(), "speed");
  EXPECT_EQ(compared.figures(1).unit(), "mm/s");
  EXPECT_EQ(compared.figures(1).before(), 0.0);
  EXPECT_EQ(compared.figures(1).after(), 3.0);
}

// Lines are added where the machine still has the program; without them the map stands as it is.
TEST_F(JobResultsTest, AStepMapWithoutItsMachineIsThatOfTheJob) {
  const std::string object = ObjectOf("STOP\n");
  for (const char* id : {"mill-1", "optimo-1"})
    Must(bed.store().PutPrograms(id, {{.slot = 45, .object = object}}, {}));
  v1::GetStepMapResponse map;
  map.add_programs()->set_program(45);
  map.mutable_programs(0)->set_object_sha256(bridge::Sha256Hex(object));
  const auto bytes = map.SerializeAsString();
  const std::string mill = Ended(Job("PA;", "mill-1"), {}, {StepsArtifact(map)});
  EXPECT_EQ(Must(Map(mill)).SerializeAsString(), bytes);  // whose programs have no other form
  const std::string job = Ended(Job("STOP\n"), {}, {StepsArtifact(map)});
  EXPECT_GT(Must(Map(job)).programs(0).lines_size(), 0);
  storage::MachineRecord machine = Must(bed.store().GetMachine("optimo-1"));
  machine.profile = "none";
  Must(bed.store().PutMachine(machine, storage::kAnyRevision));
  EXPECT_EQ(Must(Map(job)).SerializeAsString(), bytes);
  Must(bed.store().DeleteMachine("optimo-1", storage::kAnyRevision));
  EXPECT_EQ(Must(Map(job)).SerializeAsString(), bytes);
}

}  // namespace
}  // namespace rmlcell::server
