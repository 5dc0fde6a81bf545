// What is wrong with a filter of findings is told with its field and its value.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/results/job_results.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class ToldValues : public testing::Test {
 protected:
  // Of a job with a finding of program 0, which is none, and one of program 99.
  ToldValues() {
    v1::RunReport report;
    for (const int program : {0, 99}) {
      v1::Diagnostic& finding = *report.add_diagnostics();
      finding.set_code("OPT-E7304");
      finding.mutable_place()->set_program(program);
    }
    request_.set_name("jobs/" + std::to_string(bed_.SubmitCheck()));
    Must(bed_.store().Finish(
        bed_.Lease(),
        {.artifacts = {{"report", "application/x-protobuf", report.SerializeAsString(), {}}}}));
  }
  std::string WhyNo(const std::string& filter) {
    request_.set_filter(filter);
    const auto found = results_.Findings(request_);
    return found ? std::string() : std::string(found.error().detail);
  }
  int Found(const std::string& filter) {
    request_.set_filter(filter);
    return Must(results_.Findings(request_)).findings_size();
  }

  ServerBed bed_;
  Config config_;
  JobBook book_{bed_.store(), config_};
  ProgramBook programs_{bed_.store(), config_};
  MemoryTools tools_{bed_.store(), programs_};
  JobResults results_{bed_.store(), book_, tools_};
  v1::ListJobFindingsRequest request_;
};

TEST_F(ToldValues, OfAFilterThatIsNone) {
  EXPECT_EQ(WhyNo("severity = LOUD"), "no severity 'LOUD'");
  EXPECT_EQ(WhyNo("verdict = FINE"), "no verdict 'FINE'");
  for (const char* program : {"-1", "100", "x"})
    EXPECT_EQ(WhyNo("program = " + std::string(program)),
              "no program '" + std::string(program) + "'");
  EXPECT_EQ(WhyNo("colour = red"), "no field 'colour'; there are code, severity, verdict, program");
}

// Program 0 is that of a finding that has no place in one.
TEST_F(ToldValues, OfProgramsAtTheirEnds) {
  EXPECT_EQ(Found("program = 0"), 1);
  EXPECT_EQ(Found("program = 99"), 1);
  EXPECT_EQ(Found("program = 1"), 0);
}

// GetJobSeries: without a part of its own a span has what stood last before it; a run that recorded
// nothing has nothing but zeros.
TEST_F(ToldValues, OfSpansWithoutAPart) {
  const auto between = [this](const v1::SeriesTable& table, std::int64_t from, std::int64_t to) {
    const std::int64_t job = bed_.SubmitCheck();
    Must(bed_.store().Finish(
        bed_.Lease(),
        {.artifacts = {{"series", "application/x-protobuf", table.SerializeAsString(), {}}}}));
    v1::GetJobSeriesRequest request;
    request.set_name("jobs/" + std::to_string(job));
    request.add_signals("speed");
    request.set_from_ns(from);
    request.set_to_ns(to);
    request.set_buckets(1);
    const v1::Series series = Must(results_.Series(request)).series(0);
    return std::pair(series.low(0), series.high(0));
  };
  v1::SeriesTable table;
  table.set_part_ns(10);
  table.set_end_ns(60);
  v1::SeriesTable::Column& speed = *table.add_columns();
  speed.set_signal("speed");
  EXPECT_EQ(between(table, 0, 60), std::pair(0.0, 0.0));
  for (const int part : {0, 4}) table.add_parts(part);
  for (const float low : {1.0F, 20.0F}) speed.add_low(low);
  for (const float high : {9.0F, 30.0F}) speed.add_high(high);
  for (const float last : {3.5F, 25.0F}) speed.add_last(last);
  EXPECT_EQ(between(table, 20, 30), std::pair(3.5, 3.5));
  EXPECT_EQ(between(table, 20, 50), std::pair(3.5, 30.0));
  EXPECT_EQ(between(table, 40, 50), std::pair(20.0, 30.0));
}

}  // namespace
}  // namespace rmlcell::server
