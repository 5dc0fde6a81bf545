// Series of spans that begin where a part ends, or before the first one (GetJobSeries).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "server/base/config.h"
#include "server/jobs/job_book.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/results/job_results.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::Pair;

class SeriesBounds : public testing::Test {
 protected:
  // With parts 2, 3 and 6 of 10 ns; before the first one nothing is known.
  std::string EndedJob() {
    v1::SeriesTable table;
    table.set_part_ns(10);
    table.set_end_ns(80);
    for (const int part : {2, 3, 6}) table.add_parts(part);
    v1::SeriesTable::Column& speed = *table.add_columns();
    speed.set_signal("speed");
    for (const float low : {1.0F, 2.0F, -5.0F}) speed.add_low(low);
    for (const float high : {10.0F, 4.0F, 7.0F}) speed.add_high(high);
    for (const float last : {3.0F, 3.5F, 6.0F}) speed.add_last(last);
    return EndedWith(table);
  }
  std::string EndedWith(const v1::SeriesTable& table) {
    v1::RunReport report;
    v1::Diagnostic& finding = *report.add_diagnostics();
    finding.set_code("OPT-E7304");
    finding.set_severity(v1::SEVERITY_WARNING);
    const std::int64_t job = bed.SubmitCheck();
    const char* type = "application/x-protobuf";
    Must(bed.store().Finish(bed.Lease(),
                            {.artifacts = {{"series", type, table.SerializeAsString(), {}},
                                           {"report", type, report.SerializeAsString(), {}}}}));
    return "jobs/" + std::to_string(job);
  }
  std::vector<std::pair<double, double>> Parts(const std::string& job, std::int64_t from,
                                               std::int64_t to, int buckets) {
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
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
  ProgramBook programs{bed.store(), config};
  MemoryTools tools{bed.store(), programs};
  JobResults results{bed.store(), book, tools};
};

// A part that ends where a span begins is none of it.
TEST_F(SeriesBounds, APartThatEndsWhereTheSpanBeginsIsNoneOfIt) {
  const std::string job = EndedJob();
  EXPECT_THAT(Parts(job, 30, 40, 1), ElementsAre(Pair(2.0, 4.0)));
  EXPECT_THAT(Parts(job, 20, 40, 2), ElementsAre(Pair(1.0, 10.0), Pair(2.0, 4.0)));
  EXPECT_THAT(Parts(job, 40, 60, 1), ElementsAre(Pair(3.5, 3.5)));
  EXPECT_THAT(Parts(job, 40, 70, 1), ElementsAre(Pair(-5.0, 7.0)));
}

// SeriesTable.last: a value stands until the next part begins, and not within that.
TEST_F(SeriesBounds, APartThatBeginsWithTheSpanHasItsOwnValuesAlone) {
  v1::SeriesTable table;
  table.set_part_ns(10);
  table.set_end_ns(30);
  v1::SeriesTable::Column& speed = *table.add_columns();
  speed.set_signal("speed");
  for (const int part : {0, 1, 2}) table.add_parts(part);
  for (const float low : {1.0F, 4.0F, 2.0F}) speed.add_low(low);
  for (const float high : {9.0F, 5.0F, 3.0F}) speed.add_high(high);
  for (const float last : {9.0F, 4.0F, 2.0F}) speed.add_last(last);
  const std::string job = EndedWith(table);
  EXPECT_THAT(Parts(job, 0, 30, 3), ElementsAre(Pair(1.0, 9.0), Pair(4.0, 5.0), Pair(2.0, 3.0)));
  EXPECT_THAT(Parts(job, 10, 20, 1), ElementsAre(Pair(4.0, 5.0)));
  EXPECT_THAT(Parts(job, 15, 20, 1), ElementsAre(Pair(4.0, 5.0)));
}

// Of what was never kept there is nothing to tell.
TEST_F(SeriesBounds, ASeriesWithoutPartsStandsAtNothing) {
  v1::SeriesTable table;
  table.set_part_ns(10);
  table.set_end_ns(30);
  table.add_columns()->set_signal("speed");
  const std::string job = EndedWith(table);
  EXPECT_THAT(Parts(job, 0, 30, 2), ElementsAre(Pair(0.0, 0.0), Pair(0.0, 0.0)));
}

// Before the first part nothing stood: the first value is what is known.
TEST_F(SeriesBounds, BeforeTheFirstPartStandsItsOwnValue) {
  const std::string job = EndedJob();
  EXPECT_THAT(Parts(job, 0, 10, 1), ElementsAre(Pair(1.0, 10.0)));
  EXPECT_THAT(Parts(job, 5, 30, 1), ElementsAre(Pair(1.0, 10.0)));
}

// Findings of no program are those of program 0; 99 is the last that there is.
TEST_F(SeriesBounds, ProgramsOfAFilterAreThoseOfAMachine) {
  v1::ListJobFindingsRequest request;
  request.set_name(EndedJob());
  const auto found = [&](const std::string& program) {
    request.set_filter("program = " + program);
    const auto listed = results.Findings(request);
    return listed ? listed->findings_size() : -1;
  };
  EXPECT_EQ(found("0"), 1);
  EXPECT_EQ(found("1"), 0);
  EXPECT_EQ(found("99"), 0);
  EXPECT_EQ(found("100"), -1);
  EXPECT_EQ(found("-1"), -1);
}

}  // namespace
}  // namespace rmlcell::server
