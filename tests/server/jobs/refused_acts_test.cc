// What is asked of jobs in vain: whoever asked hears why, whichever call to the store it was.
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// Of which the calls for the queue fail as well.
class FailingQueue final : public FailingStore {
 public:
  explicit FailingQueue(storage::Store& store) : FailingStore(store) {}

  Result<std::vector<storage::JobStateCount>> CountByState(
      const storage::JobQuery& query) override {
    return Or([&] { return store_.CountByState(query); });
  }
  Result<std::vector<storage::JobRecord>> ActOn(std::span<const std::int64_t> jobs,
                                                storage::QueueAct act,
                                                const EventOf& event) override {
    return Or([&] { return store_.ActOn(jobs, act, event); });
  }
  Result<bool> HasPosition(std::string_view log_id, std::int64_t position) override {
    return Or([&] { return store_.HasPosition(log_id, position); });
  }
};

class RefusedActs : public testing::Test {
 protected:
  static v1::SubmitJobRequest Asked(v1::JobKind kind) {
    v1::SubmitJobRequest request;
    request.mutable_job()->set_kind(kind);
    request.mutable_job()->set_machine("machines/optimo-1");
    return request;
  }
  std::optional<ErrorCode> Submit(const v1::SubmitJobRequest& request) {
    std::promise<std::optional<ErrorCode>> answer;
    book.Submit(request, "tester",
                [&](const Result<v1::Job>& job) { answer.set_value(CodeOf(job)); });
    return answer.get_future().get();
  }
  Result<v1::Job> Again(const std::string& name) {
    std::promise<Result<v1::Job>> answer;
    book.Again(name, "bert", {}, false,
               [&](Result<v1::Job> job) { answer.set_value(std::move(job)); });
    return answer.get_future().get();
  }

  ServerBed bed;
  FailingQueue store{bed.store()};
  Config config;
  JobBook book{store, config};
};

// JobBook: jobs that wait in the queue are held back, let go and moved, and no others.
TEST_F(RefusedActs, OfAJobThatDoesNotWait) {
  const std::string runs = JobName(bed.SubmitCheck());
  bed.Lease();
  const std::vector<std::pair<std::string, ErrorCode>> cases = {
      {"7", ErrorCode::kCellInvalidArgument},
      {"jobs/7", ErrorCode::kCellNotFound},
      {runs, ErrorCode::kCellPrecondition}};
  for (const auto& [name, code] : cases) {
    v1::MoveJobRequest move;
    move.set_name(name);
    EXPECT_EQ(CodeOf(book.HoldBack(name, "anna")), code) << name;
    EXPECT_EQ(CodeOf(book.LetGo(name, "anna")), code) << name;
    EXPECT_EQ(CodeOf(book.Move(move, "anna")), code) << name;
  }
}

// Jobs that are over are deleted, and no others.
TEST_F(RefusedActs, ADeletionNamesAJobThatIsOver) {
  EXPECT_EQ(CodeOf(book.Delete("7", "anna")), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(book.Delete("jobs/7", "anna")), ErrorCode::kCellNotFound);
  const std::string job = JobName(bed.SubmitCheck());
  const storage::Lease lease = bed.Lease();
  EXPECT_EQ(CodeOf(book.Delete(job, "anna")), ErrorCode::kCellPrecondition);
  Must(bed.store().Finish(lease, {.outcome = {.state = storage::JobState::kSucceeded}}));
  EXPECT_EQ(CodeOf(book.Delete(job, "anna")), std::nullopt);
  EXPECT_EQ(CodeOf(book.Get(job)), ErrorCode::kCellNotFound);
}

TEST_F(RefusedActs, InFrontOfAJobThatIsNone) {
  v1::MoveJobRequest move;
  move.set_name(JobName(bed.SubmitCheck()));
  move.set_before("7");
  EXPECT_EQ(CodeOf(book.Move(move, "anna")), ErrorCode::kCellInvalidArgument);
  move.set_before("jobs/7");
  EXPECT_EQ(CodeOf(book.Move(move, "anna")), ErrorCode::kCellNotFound);
}

TEST_F(RefusedActs, OfNamesAndOrdersThatAreNone) {
  v1::JobChoice choice;
  choice.mutable_names()->add_names("7");
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(book.CheckOverride("7", 100.0)), ErrorCode::kCellInvalidArgument);
  v1::ListJobsRequest list;
  list.set_order_by("colour");
  EXPECT_EQ(CodeOf(book.List(list)), ErrorCode::kCellInvalidArgument);
}

// A job outlives its machine, which alone knows what override it could have.
TEST_F(RefusedActs, AnOverrideOnAMachineThatIsGone) {
  const std::string job = JobName(bed.SubmitCheck());
  EXPECT_EQ(CodeOf(book.CheckOverride(job, 100.0)), std::nullopt);
  Must(bed.store().Finish(bed.Lease(), {.outcome = {.state = storage::JobState::kSucceeded}}));
  Must(bed.store().DeleteMachine("optimo-1", storage::kAnyRevision));
  EXPECT_EQ(CodeOf(book.CheckOverride(job, 100.0)), ErrorCode::kCellUnknownMachine);
}

TEST_F(RefusedActs, ByTheStore) {
  const std::string job = JobName(bed.SubmitCheck());
  v1::ListJobsRequest counted;
  counted.set_count(true);
  ExpectFailuresHandedOn(store, "counting", 3, [&] { return CodeOf(book.List(counted)); });
  v1::JobChoice all;
  all.set_all(true);
  ExpectFailuresHandedOn(store, "choosing", 1, [&] { return CodeOf(book.Choose(all, {})); });
  const std::vector<std::string> names = {job};
  ExpectFailuresHandedOn(store, "holding many", 1, [&] {
    return CodeOf(book.ActOn(names, storage::QueueAct::kHold, "anna"));
  });
  const std::string log = bed.store().LogId();
  ExpectFailuresHandedOn(store, "looking for a number", 1,
                         [&] { return CodeOf(book.CheckLog(1, 1, log)); });
}

// OPT-1.10: what a machine has stored is the object of a slot, and so it is handed in again.
TEST_F(RefusedActs, AStoredProgramIsHandedInAgainAsAnObject) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "object"}}, {}));
  v1::SubmitJobRequest request = Asked(v1::JOB_KIND_RUN);
  request.mutable_job()->set_program("machines/optimo-1/programs/45");
  ASSERT_EQ(Submit(request), std::nullopt);
  const v1::Job anew = Must(Again("jobs/1"));
  EXPECT_EQ(anew.inline_program().form(), v1::PROGRAM_FORM_OBJECT);
  EXPECT_EQ(anew.inline_slot(), 45);
  EXPECT_EQ(Must(bed.store().ReadArtifact(2, kMainAttachment)), "object");
  ExpectFailuresHandedOn(store, "handing in again", 4, [&] { return CodeOf(Again("jobs/1")); });
}

// A program that was uploaded before has the bounds of one that comes with its job.
TEST_F(RefusedActs, AnUploadedProgramIsLookedAt) {
  const std::string bytes = "DELAY 1\nSTOP\n";
  const std::string sha256 = bridge::Sha256Hex(bytes);
  const auto writer = Must(bed.store().WriteBlob(sha256, bytes.size()));
  Must(writer->Append(bytes));
  Must(writer->Finish(std::chrono::hours(1)));
  v1::SubmitJobRequest request = Asked(v1::JOB_KIND_CHECK);
  request.set_validate_only(true);
  request.mutable_job()->mutable_uploaded_program()->set_sha256(sha256);
  request.mutable_job()->mutable_uploaded_program()->set_file_name("a.S");
  config.limit_program_bytes = 13;
  EXPECT_EQ(Submit(request), std::nullopt);
  config.limit_program_bytes = 12;
  EXPECT_EQ(Submit(request), ErrorCode::kCellTooLarge);
  config.limit_program_bytes = 13;
  request.mutable_job()->set_inline_slot(99);
  EXPECT_EQ(Submit(request), std::nullopt);
  request.mutable_job()->set_inline_slot(100);
  EXPECT_EQ(Submit(request), ErrorCode::kProgramNumber);
}

// LIVE-5.01: what becomes of a run whose client is lost is one of what there is.
TEST_F(RefusedActs, ARunThatWouldBeLeftInNoWayThatThereIs) {
  v1::SubmitJobRequest request = Asked(v1::JOB_KIND_RUN);
  request.set_validate_only(true);
  request.mutable_job()->mutable_inline_program()->set_file_name("part.S");
  request.mutable_job()->mutable_inline_program()->set_content("STOP\n");
  v1::RunOptions& run = *request.mutable_job()->mutable_run();
  run.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  EXPECT_EQ(Submit(request), std::nullopt);
  run.set_on_loss(static_cast<v1::ControlLease::OnLoss>(99));
  EXPECT_EQ(Submit(request), ErrorCode::kCellInvalidArgument);
}

}  // namespace
}  // namespace rmlcell::server
