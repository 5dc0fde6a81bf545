// The ends of what may be asked about the series of a job (GetJobSeries).
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/results/job_results.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class AskedBounds : public testing::Test {
 protected:
  // With parts of 10 ns, from 0 to 40, and a value that is ten times its part.
  v1::GetJobSeriesRequest EndedJob() {
    v1::SeriesTable table;
    table.set_part_ns(10);
    table.set_end_ns(40);
    v1::SeriesTable::Column& speed = *table.add_columns();
    speed.set_signal("speed");
    for (const int part : {0, 1, 2, 3}) {
      table.add_parts(part);
      speed.add_low(static_cast<float>(10 * part));
      speed.add_high(static_cast<float>(10 * part + 1));
      speed.add_last(static_cast<float>(10 * part));
    }
    const std::int64_t job = bed.SubmitCheck();
    Must(bed.store().Finish(
        bed.Lease(),
        {.artifacts = {{"series", "application/x-protobuf", table.SerializeAsString(), {}}}}));
    v1::GetJobSeriesRequest request;
    request.set_name("jobs/" + std::to_string(job));
    request.add_signals("speed");
    request.set_buckets(1);
    return request;
  }
  std::string WhyNo(const v1::GetJobSeriesRequest& request) {
    const auto series = results.Series(request);
    return series ? "" : series.error().detail;
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
  JobResults results{bed.store(), book, tools};
};

// GetJobSeriesRequest.signals: 1 to 20.
TEST_F(AskedBounds, OfSignals) {
  v1::GetJobSeriesRequest request = EndedJob();
  while (request.signals_size() < 20) request.add_signals("speed");
  const v1::GetJobSeriesResponse all = Must(results.Series(request));
  EXPECT_EQ(all.series_size(), 20);
  request.add_signals("speed");
  EXPECT_EQ(WhyNo(request), "signals: 1 to 20 are asked for");
  request.clear_signals();
  EXPECT_EQ(WhyNo(request), "signals: 1 to 20 are asked for");
}

// From the end on there is nothing more than what stands there.
TEST_F(AskedBounds, OfTimes) {
  v1::GetJobSeriesRequest request = EndedJob();
  request.set_from_ns(40);
  const v1::GetJobSeriesResponse end = Must(results.Series(request));
  EXPECT_EQ(end.to_ns(), 40);
  EXPECT_EQ(end.series(0).low(0), 30.0);
  EXPECT_EQ(end.series(0).high(0), 30.0);
  request.set_from_ns(41);
  EXPECT_EQ(WhyNo(request), "from_ns: allowed are 0 to 40");
  request.set_from_ns(21);
  request.set_to_ns(20);
  EXPECT_EQ(WhyNo(request), "from_ns: allowed are 0 to 20");
  request.set_from_ns(-1);
  EXPECT_EQ(WhyNo(request), "from_ns: allowed are 0 to 20");
  request.set_from_ns(10);
  request.set_to_ns(30);
  request.set_buckets(2);
  const v1::GetJobSeriesResponse middle = Must(results.Series(request));
  EXPECT_EQ(middle.to_ns(), 30);
  EXPECT_EQ(middle.series(0).low(0), 10.0);
  EXPECT_EQ(middle.series(0).high(0), 11.0);
  EXPECT_EQ(middle.series(0).low(1), 20.0);
  EXPECT_EQ(middle.series(0).high(1), 21.0);
}

// Pages of one finding: the second begins behind the first, and the last says that it is the last.
TEST_F(AskedBounds, OfPagesOfFindings) {
  v1::RunReport report;
  for (const char* code : {"OPT-E7304", "OPT-E7301"}) {
    v1::Diagnostic& finding = *report.add_diagnostics();
    finding.set_code(code);
    finding.set_severity(v1::SEVERITY_WARNING);
  }
  const std::int64_t job = bed.SubmitCheck();
  Must(bed.store().Finish(
      bed.Lease(),
      {.artifacts = {{"report", "application/x-protobuf", report.SerializeAsString(), {}}}}));
  v1::ListJobFindingsRequest request;
  request.set_name("jobs/" + std::to_string(job));
  request.set_page_size(1);
  const v1::ListJobFindingsResponse first = Must(results.Findings(request));
  ASSERT_EQ(first.findings_size(), 1);
  EXPECT_EQ(first.findings(0).code(), "OPT-E7304");
  EXPECT_EQ(first.total_size(), 2);
  EXPECT_EQ(first.next_page_token(), "1");
  request.set_page_token("1");
  const v1::ListJobFindingsResponse second = Must(results.Findings(request));
  ASSERT_EQ(second.findings_size(), 1);
  EXPECT_EQ(second.findings(0).code(), "OPT-E7301");
  EXPECT_EQ(second.next_page_token(), "");
  request.set_page_token(std::to_string(INT64_MAX));
  const v1::ListJobFindingsResponse beyond = Must(results.Findings(request));
  EXPECT_EQ(beyond.findings_size(), 0);
  EXPECT_EQ(beyond.next_page_token(), "");
  request.set_page_token("0");
  EXPECT_EQ(CodeOf(results.Findings(request)), ErrorCode::kCellBadPageToken);
}

// ListJobFindingsRequest.page_size: 1000 at most, however many are asked for.
TEST_F(AskedBounds, OfAPageOfFindings) {
  v1::RunReport report;
  while (report.diagnostics_size() < 1001) report.add_diagnostics()->set_code("OPT-E7304");
  const std::int64_t job = bed.SubmitCheck();
  Must(bed.store().Finish(
      bed.Lease(),
      {.artifacts = {{"report", "application/x-protobuf", report.SerializeAsString(), {}}}}));
  v1::ListJobFindingsRequest request;
  request.set_name("jobs/" + std::to_string(job));
  request.set_page_size(2000);
  const v1::ListJobFindingsResponse page = Must(results.Findings(request));
  EXPECT_EQ(page.findings_size(), 1000);
  EXPECT_EQ(page.next_page_token(), "1000");
}

}  // namespace
}  // namespace rmlcell::server
