// What of a run that was cut off is asked for again, and when a job is to begin (live.md 5.10).
#include <gtest/gtest.h>

#include <future>
#include <string>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/records/job_messages.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;

class BegunAgain : public testing::Test {
 protected:
  void SetUp() override {
    book.OnToldToWait([](v1::Job& job) { job.add_start_blockers()->set_code("CELL-E9423"); });
  }
  static v1::SubmitJobRequest Asked() {
    v1::SubmitJobRequest request;
    v1::Job& job = *request.mutable_job();
    job.set_kind(v1::JOB_KIND_RUN);
    job.set_machine("machines/optimo-1");
    job.set_title("a door");
    job.add_labels("order-4711");
    job.set_priority(-7);
    job.mutable_inline_program()->set_file_name("door.S");
    job.mutable_inline_program()->set_content("STOP\n");
    job.mutable_inline_program()->set_form(v1::PROGRAM_FORM_SOURCE);
    job.set_inline_slot(12);
    job.mutable_run()->mutable_step()->set_step(3);
    job.mutable_run()->add_confirmations(v1::CONFIRMATION_TOOL);
    job.mutable_run()->set_occurrence(2);
    job.mutable_run()->set_off_until_work_on(true);
    job.mutable_run()->set_on_loss(v1::ControlLease::ON_LOSS_HOLD);
    return request;
  }
  v1::Job Submitted(const v1::SubmitJobRequest& request) {
    std::promise<Result<v1::Job>> answer;
    book.Submit(request, "anna", [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    return Must(answer.get_future().get());
  }
  std::string Interrupted() {
    const std::string name = Submitted(Asked()).name();
    Must(bed.store().Finish(bed.Lease("RUN"), {.outcome = {.state = JobState::kInterrupted}}));
    return name;
  }
  Result<v1::Job> Again(const std::string& name, bool continues) {
    std::promise<Result<v1::Job>> answer;
    book.Again(name, "bert", "once", continues,
               [&](Result<v1::Job> made) { answer.set_value(std::move(made)); });
    return answer.get_future().get();
  }

  ServerBed bed;
  Config config;
  JobBook book{bed.store(), config};
};

// From its beginning: as it was asked for, of whoever says so.
TEST_F(BegunAgain, ARestartIsAskedForAsItWas) {
  const std::string first = Interrupted();
  const v1::Job again = Must(Again(first, false));
  EXPECT_NE(again.name(), first);
  EXPECT_EQ(again.kind(), v1::JOB_KIND_RUN);
  EXPECT_EQ(again.machine(), "machines/optimo-1");
  EXPECT_EQ(again.title(), "a door");
  ASSERT_EQ(again.labels_size(), 1);
  EXPECT_EQ(again.labels(0), "order-4711");
  EXPECT_EQ(again.priority(), -7);
  EXPECT_EQ(again.caller(), "bert");
  EXPECT_EQ(again.continues(), "");
  EXPECT_FALSE(again.held());
  EXPECT_EQ(again.run().step().step(), 3);
  EXPECT_EQ(again.run().confirmations_size(), 1);
  EXPECT_EQ(again.run().occurrence(), 2);
  EXPECT_TRUE(again.run().off_until_work_on());
  EXPECT_EQ(again.run().on_loss(), v1::ControlLease::ON_LOSS_HOLD);
  EXPECT_EQ(again.inline_slot(), 12);
  EXPECT_EQ(again.inline_program().file_name(), "door.S");
  EXPECT_EQ(again.inline_program().form(), v1::PROGRAM_FORM_SOURCE);
  const std::int64_t id = Must(ParseJobName(again.name()));
  EXPECT_EQ(Must(bed.store().ReadArtifact(id, kMainAttachment)), "STOP\n");
  // LIVE-5.02: it says why it waits, as each that is handed in.
  ASSERT_EQ(again.start_blockers_size(), 1);
  EXPECT_EQ(again.start_blockers(0).code(), "CELL-E9423");
  EXPECT_EQ(Must(Again(first, false)).name(), again.name()) << "asked twice it is one";
}

// Where it goes on a preview has said, and nothing of how the first began counts.
TEST_F(BegunAgain, WhatGoesOnBeginsWhereItIsSaid) {
  const std::string first = Interrupted();
  const v1::Job goes_on = Must(Again(first, true));
  EXPECT_EQ(goes_on.continues(), first);
  EXPECT_TRUE(goes_on.held());
  EXPECT_FALSE(goes_on.run().has_step());
  EXPECT_EQ(goes_on.run().confirmations_size(), 0);
  EXPECT_EQ(goes_on.run().occurrence(), 0);
  EXPECT_FALSE(goes_on.run().off_until_work_on());
  EXPECT_EQ(goes_on.run().on_loss(), v1::ControlLease::ON_LOSS_HOLD);
  EXPECT_EQ(goes_on.title(), "a door");
}

TEST_F(BegunAgain, WhatIsNotThereDoesNotBeginAgain) {
  EXPECT_EQ(CodeOf(Again("jobs/99", false)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(Again("99", true)), ErrorCode::kCellInvalidArgument);
}

// A job that is to begin later says when, to the microsecond; of others nothing is said.
TEST_F(BegunAgain, AJobThatBeginsLaterSaysWhen) {
  v1::SubmitJobRequest request = Asked();
  EXPECT_FALSE(Submitted(request).has_not_before_time());
  request.mutable_job()->mutable_not_before_time()->set_seconds(2'000'000'000);
  request.mutable_job()->mutable_not_before_time()->set_nanos(5'000);
  const v1::Job job = Submitted(request);
  EXPECT_EQ(job.not_before_time().seconds(), 2'000'000'000);
  EXPECT_EQ(job.not_before_time().nanos(), 5'000);
  EXPECT_EQ(job.wait_reason(), v1::WAIT_REASON_NOT_BEFORE);
}

}  // namespace
}  // namespace rmlcell::server
