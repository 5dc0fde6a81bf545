// What a submission asks for beside its program, as it is kept, listed and asked for again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/assignment.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

// One that notes whether more jobs are to come.
class AnnouncedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::vector<int> more_come;

  void Submit(storage::NewJob job,
              std::function<void(Result<storage::SubmittedJob>)> done) override {
    more_come.push_back(job.more_come ? 1 : 0);
    store_.Submit(std::move(job), std::move(done));
  }
};

class KeptWishes : public testing::Test {
 protected:
  using Change = std::function<void(v1::Job&)>;

  static v1::SubmitJobRequest Asked(
      v1::JobKind kind, const Change& change = [](v1::Job&) {}) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(kind);
    job.set_machine("machines/optimo-1");
    job.mutable_inline_program()->set_file_name("part.S");
    job.mutable_inline_program()->set_content("STOP\n");
    change(job);
    return request;
  }
  Result<v1::Job> Submit(const v1::SubmitJobRequest& request, bool more_come = false) {
    std::promise<Result<v1::Job>> answer;
    book.Submit(
        request, "anna", [&](Result<v1::Job> job) { answer.set_value(std::move(job)); }, more_come);
    return answer.get_future().get();
  }
  v1::Job Simulation(const Change& change = [](v1::Job&) {}) {
    return Must(Submit(Asked(v1::JOB_KIND_SIMULATE, change)));
  }
  static std::int64_t Number(const v1::Job& job) { return Must(ParseJobName(job.name())); }
  std::optional<storage::LeasedJob> Leased() {
    return Must(bed.store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  }
  std::vector<std::string> Listed(const std::string& order) {
    v1::ListJobsRequest request;
    request.set_order_by(order);
    std::vector<std::string> names;
    const v1::ListJobsResponse page = Must(book.List(request));
    for (const v1::Job& job : page.jobs()) names.push_back(job.name());
    return names;
  }

  ServerBed bed;
  AnnouncedStore store{bed.store()};
  Config config;
  JobBook book{store, config};
};

// Job.held: it does not start until it is let go.
TEST_F(KeptWishes, AJobThatIsHandedInHeldWaits) {
  const v1::Job job = Simulation([](v1::Job& asked) { asked.set_held(true); });
  EXPECT_EQ(job.wait_reason(), v1::WAIT_REASON_HELD);
  EXPECT_FALSE(Leased().has_value());
  EXPECT_FALSE(Must(book.LetGo(job.name(), "anna")).held());
  EXPECT_TRUE(Leased().has_value());
}

// What is told of a job that is held back or let go has its priority, which stays.
TEST_F(KeptWishes, HoldingAndLettingGoTellThePriority) {
  const v1::Job job = Simulation([](v1::Job& asked) { asked.set_priority(7); });
  Must(book.HoldBack(job.name(), "anna"));
  Must(book.LetGo(job.name(), "anna"));
  const auto events = Must(bed.store().JobEvents(Number(job), 0, 100));
  ASSERT_EQ(events.size(), 3U);
  const v1::JobEvent held = ToProto(events[1]);
  EXPECT_TRUE(held.queue().held());
  EXPECT_EQ(held.queue().priority(), 7);
  const v1::JobEvent let_go = ToProto(events[2]);
  EXPECT_FALSE(let_go.queue().held());
  EXPECT_EQ(let_go.queue().priority(), 7);
}

// LIVE-5.01: a RUN has one attempt, whatever the configuration says of other jobs.
TEST_F(KeptWishes, ARunHasOneAttempt) {
  config.jobs_attempts = 3;
  const v1::Job run = Must(Submit(Asked(v1::JOB_KIND_RUN)));
  EXPECT_EQ(run.attempts_max(), 1);
  EXPECT_EQ(Simulation().attempts_max(), 3);
}

// AIP-163: asked again after its job was made, it is that job that counts, and not what has become
// of those that it waits for.
TEST_F(KeptWishes, ARequestThatIsKnownIsTakenWhateverItAwaits) {
  const v1::Job awaited = Simulation();
  v1::SubmitJobRequest request = Asked(
      v1::JOB_KIND_SIMULATE, [&awaited](v1::Job& asked) { asked.add_after_jobs(awaited.name()); });
  request.set_request_id("once");
  const v1::Job made = Must(Submit(request));
  Must(bed.store().RequestCancel(Number(awaited), {}));
  EXPECT_EQ(Must(Submit(request)).name(), made.name());
  request.set_validate_only(true);
  EXPECT_EQ(CodeOf(Submit(request)), std::nullopt);
  request.set_request_id("another");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kCellPrecondition);
}

// Who saw no answer and repeats has his job, though what it was made of is gone by now.
TEST_F(KeptWishes, ARequestThatIsRepeatedHasItsJobWhateverIsGone) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 45, .object = "object"}}, {}));
  v1::SubmitJobRequest request = Asked(v1::JOB_KIND_SIMULATE, [](v1::Job& asked) {
    asked.set_program("machines/optimo-1/programs/45");
  });
  request.set_request_id("once");
  const v1::Job made = Must(Submit(request));
  Must(bed.store().DeleteProgram("optimo-1", 45, storage::kAnyRevision));
  EXPECT_EQ(Must(Submit(request)).name(), made.name());
  request.set_request_id("another");
  EXPECT_EQ(CodeOf(Submit(request)), ErrorCode::kProgramMissing);
}

// storage/store.h, NewJob: others are on their way from the same caller.
TEST_F(KeptWishes, TheStoreIsToldThatMoreCome) {
  for (const bool more_come : {true, false}) Must(Submit(Asked(v1::JOB_KIND_SIMULATE), more_come));
  EXPECT_THAT(store.more_come, ElementsAre(1, 0));
}

// JobChoice.expected_count: one is a number as any other, and the refusal tells both.
TEST_F(KeptWishes, OneJobThatIsExpectedIsNotTwo) {
  for (int i = 0; i < 2; ++i) Simulation();
  v1::JobChoice choice;
  choice.set_all(true);
  choice.set_expected_count(1);
  const auto chosen = book.Choose(choice, std::nullopt);
  ASSERT_FALSE(chosen);
  EXPECT_EQ(chosen.error().code, ErrorCode::kCellPrecondition);
  EXPECT_EQ(chosen.error().detail, "these are 2 jobs, expected were 1");
  choice.set_expected_count(2);
  EXPECT_EQ(Must(book.Choose(choice, std::nullopt)).size(), 2U);
}

// ListJobsRequest.order_by, and how many there are of each state.
TEST_F(KeptWishes, ListsAreInTheOrderAskedForAndCounted) {
  for (const int priority : {0, 0, 5})
    Simulation([priority](v1::Job& asked) { asked.set_priority(priority); });
  Must(bed.store().RequestCancel(1, {}));
  EXPECT_THAT(Listed(""), ElementsAre("jobs/3", "jobs/2", "jobs/1"));
  EXPECT_THAT(Listed("create_time desc"), ElementsAre("jobs/3", "jobs/2", "jobs/1"));
  EXPECT_THAT(Listed("create_time"), ElementsAre("jobs/1", "jobs/2", "jobs/3"));
  Simulation();
  EXPECT_THAT(Listed("queue"), ElementsAre("jobs/3", "jobs/2", "jobs/4", "jobs/1"));
  v1::ListJobsRequest request;
  request.set_page_size(1);
  EXPECT_EQ(Must(book.List(request)).total_size(), 0);  // nobody has asked for it
  request.set_count(true);
  const v1::ListJobsResponse counted = Must(book.List(request));
  EXPECT_EQ(counted.total_size(), 4);
  ASSERT_EQ(counted.counts_size(), 2);
  for (const v1::JobCount& count : counted.counts())
    EXPECT_EQ(count.jobs(), count.state() == v1::Job::STATE_QUEUED ? 3 : 1);
}

// UploadedProgram: bytes that the server has, by their SHA-256, kept with the job as those that it
// brings.
TEST_F(KeptWishes, AnUploadedProgramIsThatOfTheJob) {
  const std::string bytes = "DELAY 1\nSTOP\n";
  const std::string sha256 = bridge::Sha256Hex(bytes);
  const auto asked = [](const std::string& of) {
    return Asked(v1::JOB_KIND_SIMULATE, [&of](v1::Job& job) {
      job.mutable_uploaded_program()->set_sha256(of);
      job.mutable_uploaded_program()->set_file_name("lid.S");
      job.set_inline_slot(7);
    });
  };
  EXPECT_EQ(CodeOf(Submit(asked(sha256))), ErrorCode::kCellNotFound);
  const auto writer = Must(bed.store().WriteBlob(sha256, bytes.size()));
  Must(writer->Append(bytes));
  Must(writer->Finish(std::chrono::hours(1)));
  const auto refused = Submit(asked(sha256.substr(1)));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(refused.error().detail, "job.uploaded_program.sha256 is not 64 hexadecimal digits");
  const v1::Job job = Must(Submit(asked(sha256)));
  EXPECT_EQ(Must(bed.store().ReadArtifact(Number(job), kMainAttachment)), bytes);
  const auto leased = Leased();
  ASSERT_TRUE(leased.has_value());
  const AssignmentMessages made = Must(MakeAssignment(bed.store(), config, *leased));
  ASSERT_EQ(made.first.assignment().programs_size(), 1);
  const v1::AssignedProgram& program = made.first.assignment().programs(0);
  EXPECT_EQ(program.slot(), 7);
  EXPECT_EQ(program.content(), bytes);
  EXPECT_EQ(program.file_name(), "lid.S");
  EXPECT_TRUE(program.is_source());
}

}  // namespace
}  // namespace rmlcell::server
