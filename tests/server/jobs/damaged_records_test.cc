// What a job book says of records that are damaged, gone, or of a machine that nobody knows any
// more.
#include <gtest/gtest.h>

#include <future>

#include "rmlcell/v1/project.pb.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// One that has forgotten what was told of its jobs.
class ForgetfulStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::EventRecord>> JobEvents(std::int64_t, std::int64_t, int) override {
    return Error{code, "removed", {}};
  }
  ErrorCode code = ErrorCode::kCellEventsGone;
};

class DamagedRecords : public testing::Test {
 protected:
  std::int64_t Add(const std::string& machine, const std::string& specification = {}) {
    return Must(bed.store().SubmitAndWait(
                    {.machine = machine, .kind = "CHECK", .specification = specification}))
        .job.id;
  }
  std::optional<ErrorCode> Override(std::int64_t job, double percent) {
    const Status valid = book.CheckOverride(JobName(job), percent);
    return valid ? std::nullopt : std::optional(valid.error().code);
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// OPT-2.07: up to what the family of its machine allows, and nothing of a family that is not there.
TEST_F(DamagedRecords, AnOverrideIsMeasuredByTheFamilyOfTheMachine) {
  const std::int64_t laser = Add("optimo-1");
  EXPECT_EQ(Override(laser, 145.0), std::nullopt);
  EXPECT_EQ(Override(laser, 145.001), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Override(laser, -1.0), ErrorCode::kCellInvalidArgument);
  Must(bed.store().PutMachine({.id = "odd", .family = "lathe"}, 0));
  EXPECT_EQ(Override(Add("odd"), 100.0), ErrorCode::kCellUnknownFamily);
  EXPECT_EQ(Override(99, 100.0), ErrorCode::kCellNotFound);
}

TEST_F(DamagedRecords, ASpecificationThatCannotBeReadIsADamageOfTheStore) {
  EXPECT_EQ(CodeOf(SpecificationOf(bed.store(), Add("optimo-1", "\xFF"))),
            ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(SpecificationOf(bed.store(), 99)), ErrorCode::kCellNotFound);
}

TEST_F(DamagedRecords, AProjectThatCannotBeReadIsADamageOfTheStore) {
  Must(bed.store().PutProject({.id = "lid", .title = "Lid", .body = "\xFF"}, 0));
  v1::SubmitJobRequest request;
  v1::Job& job = *request.mutable_job();
  job.set_kind(v1::JOB_KIND_SIMULATE);
  job.set_machine("machines/mill-1");
  job.mutable_inline_program()->set_file_name("a.rml");
  job.mutable_inline_program()->set_content("PA;PU0,0;");
  job.mutable_simulation()->set_milling_project("projects/lid");
  std::promise<Result<v1::Job>> answer;
  book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
  EXPECT_EQ(CodeOf(answer.get_future().get()), ErrorCode::kCellStoreCorrupt);
}

// Events that were removed show that the log is this one as long as its name is.
TEST_F(DamagedRecords, AnEventThatIsGoneMayBeGoneOnFrom) {
  ForgetfulStore store{bed.store()};
  JobBook forgetful{store, config};
  const std::int64_t job = Add("optimo-1");
  EXPECT_TRUE(forgetful.CheckLog(job, 5, bed.store().LogId()));
  const Status other = forgetful.CheckLog(job, 5, "another");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_TRUE(forgetful.CheckLog(job, 0, "another")) << "it begins with the first";
  EXPECT_TRUE(forgetful.CheckLog(job, 5, "")) << "it names none";
  for (const ErrorCode code : {ErrorCode::kCellNotFound, ErrorCode::kCellStoreFailed}) {
    store.code = code;
    const Status failed = forgetful.CheckLog(job, 5, bed.store().LogId());
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, code);
  }
}

}  // namespace
}  // namespace rmlcell::server
