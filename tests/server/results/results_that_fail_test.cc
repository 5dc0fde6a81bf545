// What is asked in vain about jobs that have ended: whoever asked hears why.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/results/job_results.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// The program of one job cannot be read, if one is named.
class UnreadableProgram final : public FailingStore {
 public:
  explicit UnreadableProgram(storage::Store& store) : FailingStore(store) {}
  Result<std::string> ReadArtifact(std::int64_t job, std::string_view name) override {
    if (job == unreadable && name == kMainAttachment)
      return Error{ErrorCode::kCellStoreUnavailable, "the line broke", {}};
    return FailingStore::ReadArtifact(job, name);
  }
  std::int64_t unreadable = 0;
};

class ResultsThatFail : public testing::Test {
 protected:
  // Has ended with this product; its number.
  std::int64_t Ended(const std::string& product, const std::string& bytes,
                     const std::string& source = "STOP\n") {
    const std::int64_t job = bed.SubmitCheck(source);
    Must(bed.store().Finish(bed.Lease(),
                            {.artifacts = {{product, "application/x-protobuf", bytes, {}}}}));
    return job;
  }
  std::int64_t Reported(const std::string& source) {
    v1::RunReport report;
    report.set_family("optimo");
    return Ended("report", report.SerializeAsString(), source);
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

  ServerBed bed;
  UnreadableProgram store{bed.store()};
  Config config;
  JobBook book{store, config};
  ProgramBook programs{store, config};
  MemoryTools tools{store, programs};
  JobResults results{store, book, tools};
};

TEST_F(ResultsThatFail, OfANameThatIsNone) {
  v1::GetJobSeriesRequest series;
  series.set_name("job");
  EXPECT_EQ(CodeOf(results.Series(series)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(Map("job")), ErrorCode::kCellInvalidArgument);
  const std::string good = JobName(Reported("STOP\n"));
  EXPECT_EQ(CodeOf(Compare("job", good)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(Compare(good, "job")), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(Compare("jobs/99", good)), ErrorCode::kCellNotFound);
  v1::ListJobFindingsRequest findings;
  findings.set_name(good);
  findings.set_page_size(-1);
  EXPECT_EQ(CodeOf(results.Findings(findings)), ErrorCode::kCellInvalidArgument);
}

TEST_F(ResultsThatFail, ByTheStore) {
  v1::GetStepMapResponse map;
  map.add_programs()->set_program(45);
  const std::string mapped = JobName(Ended("steps", map.SerializeAsString()));
  ExpectFailuresHandedOn(store, "a step map", 4, [&] { return CodeOf(Map(mapped)); });
  // The report, the job with its products, and its program; what was read once is known.
  const std::string job = JobName(Reported("STOP\n"));
  for (int call = 1; call <= 4; ++call) {
    store.FailAt(call);
    EXPECT_EQ(CodeOf(Compare(job, job)), ErrorCode::kCellStoreFailed) << call;
  }
  store.FailAt(0);
  EXPECT_EQ(CodeOf(Compare(job, job)), std::nullopt);
}

// Of programs that cannot be read all else is compared.
TEST_F(ResultsThatFail, AProgramThatCannotBeReadIsNotCompared) {
  const std::int64_t before = Reported("DELAY 1\n");
  const std::int64_t after = Reported("DELAY 2\n");
  for (const std::int64_t unreadable : {before, after}) {
    store.unreadable = unreadable;
    const auto compared = Must(Compare(JobName(before), JobName(after)));
    EXPECT_FALSE(compared.has_difference());
    EXPECT_EQ(compared.difference_error().code(), CodeText(ErrorCode::kCellStoreUnavailable));
    ASSERT_EQ(compared.inputs_size(), 1);
    EXPECT_EQ(compared.inputs(0).name(), "program");
  }
  store.unreadable = 0;
  EXPECT_TRUE(Must(Compare(JobName(before), JobName(after))).has_difference());
}

// An object that is none has no text, and its steps have no lines.
TEST_F(ResultsThatFail, AnObjectThatIsNoneHasNoLines) {
  const std::string object = "no object";
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = object}}, {}));
  v1::GetStepMapResponse map;
  map.add_programs()->set_program(45);
  map.mutable_programs(0)->set_object_sha256(bridge::Sha256Hex(object));
  const auto read = Must(Map(JobName(Ended("steps", map.SerializeAsString()))));
  ASSERT_EQ(read.programs_size(), 1);
  EXPECT_EQ(read.programs(0).lines_size(), 0);
}

}  // namespace
}  // namespace rmlcell::server
