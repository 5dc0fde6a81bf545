// The queue as clients see it (proto/rmlcell/v1/job.proto): priority, holding back, dependencies,
// places, and acts on many jobs. What the store does with them has tests of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;
using testing::ElementsAre;

class JobQueue : public testing::Test {
 protected:
  v1::Job Submit(const std::function<void(v1::Job&)>& change = [](v1::Job&) {}) {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_SIMULATE);
    job.set_machine("machines/optimo-1");
    job.mutable_inline_program()->set_file_name("part.S");
    job.mutable_inline_program()->set_content("STOP\n");
    change(job);
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    return Must(answer.get_future().get());
  }
  std::vector<v1::JobEvent> Events(const v1::Job& job) {
    std::vector<v1::JobEvent> events;
    for (const auto& event : Must(bed.store().JobEvents(*ParseJobName(job.name()), 0, 100)))
      events.push_back(ToProto(event));
    return events;
  }
  std::vector<std::string> Chosen(const v1::JobChoice& choice,
                                  std::optional<JobState> state = std::nullopt) {
    return Must(book.Choose(choice, state));
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

TEST_F(JobQueue, AJobSaysItsPlaceAndWhatItWaitsFor) {
  const v1::Job first = Submit();
  EXPECT_EQ(first.wait_reason(), v1::WAIT_REASON_WORKER);
  const v1::Job job = Submit([&](v1::Job& wanted) {
    wanted.set_priority(7);
    wanted.add_after_jobs(first.name());
    wanted.mutable_not_before_time()->set_seconds(4'000'000'000);
    wanted.mutable_not_before_time()->set_nanos(5'000);
  });
  const v1::Job read = Must(book.Get(job.name()));
  EXPECT_EQ(read.priority(), 7);
  EXPECT_EQ(read.not_before_time().seconds(), 4'000'000'000);
  EXPECT_EQ(read.not_before_time().nanos(), 5'000);
  EXPECT_THAT(read.after_jobs(), ElementsAre(first.name()));
  EXPECT_EQ(read.wait_reason(), v1::WAIT_REASON_AFTER_JOB);
  EXPECT_EQ(read.waits_for(), first.name());
}

TEST_F(JobQueue, HoldingBackAndLettingGoAreEventsWithTheirCaller) {
  const v1::Job job = Submit();
  EXPECT_EQ(Must(book.HoldBack(job.name(), "berta")).wait_reason(), v1::WAIT_REASON_HELD);
  EXPECT_TRUE(Must(book.Get(job.name())).held());
  EXPECT_FALSE(Must(book.LetGo(job.name(), "carl")).held());
  const auto events = Events(job);
  ASSERT_EQ(events.size(), 3U);
  EXPECT_TRUE(events[1].queue().held());
  EXPECT_TRUE(events[2].has_queue());
  EXPECT_FALSE(events[2].queue().held());
  const auto records = Must(bed.store().JobEvents(*ParseJobName(job.name()), 0, 100));
  EXPECT_EQ(records[0].caller, "anna");
  EXPECT_EQ(records[1].caller, "berta");
  EXPECT_EQ(records[2].caller, "carl");
}

TEST_F(JobQueue, JobsAreFoundByTheirLabels) {
  const v1::Job first = Submit([](v1::Job& job) {
    job.add_labels("order-4711");
    job.add_labels("urgent");
  });
  Submit([](v1::Job& job) { job.add_labels("order-471"); });
  Submit();
  EXPECT_THAT(Must(book.Get(first.name())).labels(), ElementsAre("order-4711", "urgent"));
  const auto found = [&](const std::string& filter) {
    v1::ListJobsRequest request;
    request.set_filter(filter);
    const v1::ListJobsResponse page = Must(book.List(request));
    return page.jobs_size();
  };
  EXPECT_EQ(found("label = order-4711"), 1);
  EXPECT_EQ(found("label = urgent AND state = QUEUED"), 1);
  EXPECT_EQ(found("label = order-471"), 1);
  EXPECT_EQ(found("label = order"), 0);
  v1::ListJobsRequest request;
  request.set_filter("label = \"a b\"");
  EXPECT_EQ(CodeOf(book.List(request)), ErrorCode::kCellBadFilter);
}

TEST_F(JobQueue, AMoveTellsThePriority) {
  const v1::Job first = Submit([](v1::Job& job) { job.set_priority(4); });
  const v1::Job second = Submit();
  v1::MoveJobRequest request;
  request.set_name(second.name());
  request.set_before(first.name());
  EXPECT_EQ(Must(book.Move(request, "anna")).priority(), 4);
  EXPECT_EQ(Events(second).back().queue().priority(), 4);
  request.clear_before();
  request.set_priority(-3);
  EXPECT_EQ(Must(book.Move(request, "anna")).priority(), -3);
  EXPECT_EQ(Events(second).back().queue().priority(), -3);
  request.set_priority(101);
  EXPECT_EQ(CodeOf(book.Move(request, "anna")), ErrorCode::kCellInvalidArgument);
  request.set_name("jobs/99");
  EXPECT_EQ(CodeOf(book.Move(request, "anna")), ErrorCode::kCellNotFound);
}

TEST_F(JobQueue, ManyJobsAreChosenByNameFilterOrAll) {
  const v1::Job one = Submit();
  const v1::Job two = Submit([](v1::Job& job) {
    job.set_machine("machines/mill-1");
    job.mutable_inline_program()->set_file_name("a.rml");
    job.mutable_inline_program()->set_content("PU;");
  });
  const v1::Job three = Submit();
  bed.Lease("SIMULATE");  // the first one runs
  v1::JobChoice choice;
  choice.set_all(true);
  EXPECT_THAT(Chosen(choice), ElementsAre(three.name(), two.name(), one.name()));
  EXPECT_THAT(Chosen(choice, JobState::kQueued), ElementsAre(three.name(), two.name()));
  choice.set_filter("machine = machines/mill-1");
  EXPECT_THAT(Chosen(choice), ElementsAre(two.name()));
  choice.set_filter("state = RUNNING");
  EXPECT_THAT(Chosen(choice), ElementsAre(one.name()));
  EXPECT_THAT(Chosen(choice, JobState::kQueued), ElementsAre());
  choice.mutable_names()->add_names(three.name());
  EXPECT_THAT(Chosen(choice), ElementsAre(three.name()));
  choice.mutable_names()->add_names(three.name());  // twice is once
  choice.set_expected_count(1);
  EXPECT_THAT(Chosen(choice), ElementsAre(three.name()));
  choice.set_expected_count(2);
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellPrecondition);
}

// What a submission refuses its trial refuses, too.
TEST_F(JobQueue, ATrialLooksAtTheJobsThatAreAwaited) {
  const v1::Job first = Submit();
  const auto tried = [&](const std::string& after) {
    v1::SubmitJobRequest request;
    request.set_validate_only(true);
    request.mutable_job()->set_kind(v1::JOB_KIND_SIMULATE);
    request.mutable_job()->set_machine("machines/optimo-1");
    request.mutable_job()->mutable_inline_program()->set_file_name("part.S");
    request.mutable_job()->mutable_inline_program()->set_content("STOP\n");
    request.mutable_job()->add_after_jobs(after);
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    return CodeOf(answer.get_future().get());
  };
  EXPECT_EQ(tried(first.name()), std::nullopt);
  EXPECT_EQ(tried("jobs/99"), ErrorCode::kCellNotFound);
  Must(bed.store().RequestCancel(1, {}));
  EXPECT_EQ(tried(first.name()), ErrorCode::kCellPrecondition);
}

// Those that it changes are counted, and hear of it; more than go into one transaction.
TEST_F(JobQueue, ManyAreHeldReleasedAndCancelled) {
  std::vector<std::string> names;
  for (int i = 0; i < 450; ++i) names.push_back(Submit().name());
  bed.Lease("SIMULATE");  // the first one runs
  const auto act = [&](storage::QueueAct what) {
    return Must(book.ActOn(names, what, "anna")).size();
  };
  EXPECT_EQ(act(storage::QueueAct::kRelease), 0U);
  EXPECT_EQ(act(storage::QueueAct::kHold), 449U);
  EXPECT_EQ(act(storage::QueueAct::kHold), 0U);
  EXPECT_TRUE(Must(book.Get(names.back())).held());
  EXPECT_EQ(act(storage::QueueAct::kRelease), 449U);
  Must(bed.store().RequestCancel(5, {}));
  Must(bed.store().DeleteJob(5));
  EXPECT_EQ(act(storage::QueueAct::kCancel), 449U);
  EXPECT_EQ(act(storage::QueueAct::kCancel), 0U);
  EXPECT_TRUE(Must(bed.store().GetJob(1)).cancel_requested);
  const auto told = Must(bed.store().JobEvents(450, 0, 10));
  ASSERT_EQ(told.size(), 4U);
  EXPECT_EQ(told[1].caller, "anna");
  EXPECT_TRUE(ToProto(told[1]).queue().held());
  EXPECT_FALSE(ToProto(told[2]).queue().held());
  EXPECT_TRUE(ToProto(told[3]).has_ended());
}

TEST_F(JobQueue, AChoiceThatIsNoneIsRefused) {
  v1::JobChoice choice;
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellInvalidArgument);
  choice.set_filter("");
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellInvalidArgument);
  choice.set_filter("colour = red");
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellBadFilter);
  choice.set_all(false);
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellInvalidArgument);
  choice.mutable_names()->add_names("jobs/7");
  EXPECT_EQ(CodeOf(book.Choose(choice, {})), ErrorCode::kCellNotFound);
}

}  // namespace
}  // namespace rmlcell::server
