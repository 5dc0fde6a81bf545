// What the queue of runs asks a host, and what it hands over (live.md 5.01, 5.02, 6.03).
#include "tests/server/runs/run_queue_bed.h"

namespace rmlcell::server {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

class AskedOfHosts : public RunQueueTest {
 protected:
  // A simulation with a block that came to a good end.
  std::string Proof() {
    v1::Job asked;
    asked.set_kind(v1::JOB_KIND_SIMULATE);
    Must(bridge::SetBlockAndTool("60x30x5", "flat:3",
                                 *asked.mutable_simulation()->mutable_milling()));
    const std::int64_t job =
        Must(bed.store().SubmitAndWait({.machine = "mill-1",
                                        .kind = "SIMULATE",
                                        .specification = asked.SerializeAsString()}))
            .job.id;
    v1::Outcome good;
    good.set_kind(v1::Outcome::KIND_COMPLETED);
    good.set_verdict(v1::VERDICT_GOOD);
    v1::RunReport report;
    report.set_family("rml1");
    report.set_engine_version("0.1.0");
    (*report.mutable_inputs())["program"] = std::string(32, 'x');
    storage::JobEnd end{.outcome = OutcomeOf(good)};
    end.artifacts.push_back({.name = "report",
                             .media_type = "application/x-protobuf",
                             .bytes = report.SerializeAsString()});
    Must(bed.store().Finish(bed.Lease("SIMULATE"), end));
    return JobName(job);
  }
  // A start at a step that a person sees to something of.
  static void Ask(v1::PreviewStartResponse& preview, const std::string& item,
                  v1::Confirmation confirmation) {
    v1::StartDifference& one = *preview.add_differences();
    one.set_item(item);
    one.set_action(v1::START_ACTION_ASK);
    one.set_confirmation(confirmation);
  }
  std::vector<std::string> WhyItWaits(std::int64_t job) {
    std::vector<std::string> told;
    const v1::Job asked = Must(book.Get(JobName(job)));
    for (const v1::StartBlocker& one : asked.start_blockers())
      told.push_back(one.code() + " " + one.message());
    return told;
  }
};

// LIVE-6.03, LIVE-5.10
TEST_F(AskedOfHosts, AStartAtAStepIsAskedForAsTheJobSays) {
  const std::string proof = Proof();
  Tell(Idle());
  Submit([&](v1::Job& asked) {
    asked.mutable_run()->mutable_step()->set_step(2);
    asked.mutable_run()->set_occurrence(3);
    asked.mutable_run()->set_off_until_work_on(true);
    asked.mutable_run()->set_ticket(proof);
  });
  const v1::PreviewStartRequest asked = NewestOrder(1).preview_start();
  EXPECT_EQ(asked.machine(), "machines/mill-1");
  EXPECT_EQ(asked.occurrence(), 3);
  EXPECT_TRUE(asked.off_until_work_on());
  EXPECT_EQ(asked.milling().stock().size_x_mm(), 60.0);
}

// LIVE-6.08
TEST_F(AskedOfHosts, WhatNobodyHasSeenToIsNamed) {
  Tell(Idle());
  const std::int64_t job = Submit([](v1::Job& asked) {
    asked.mutable_run()->mutable_step()->set_step(2);
    asked.mutable_run()->add_confirmations(v1::CONFIRMATION_CLAMPS);
  });
  v1::HostRequest request;
  request.mutable_answer()->set_number(NewestOrder(1).number());
  v1::PreviewStartResponse& preview = *request.mutable_answer()->mutable_preview();
  preview.set_preview_token("a token");
  v1::StartDifference& pose = *preview.add_differences();
  pose.set_item("pose");
  pose.set_action(v1::START_ACTION_MOVE);
  Ask(preview, "tool", v1::CONFIRMATION_TOOL);
  Ask(preview, "clamps", v1::CONFIRMATION_CLAMPS);
  Ask(preview, "cover", v1::CONFIRMATION_COVER);
  hosts.Receive(*link, std::move(request));
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kFailed; }));
  EXPECT_EQ(Job(job).outcome->code, ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(Job(job).outcome->detail,
              EndsWith("job.run.confirmations: nobody has seen to tool, cover"));
}

// LIVE-6.04: of several reasons why it may not begin there the first one is told.
TEST_F(AskedOfHosts, TheFirstReasonAgainstAStartEndsIt) {
  Tell(Idle());
  const std::int64_t job =
      Submit([](v1::Job& asked) { asked.mutable_run()->mutable_step()->set_step(2); });
  v1::HostRequest request;
  request.mutable_answer()->set_number(NewestOrder(1).number());
  v1::PreviewStartResponse& preview = *request.mutable_answer()->mutable_preview();
  const auto refuse = [&preview](ErrorCode code, const std::string& why) {
    v1::Diagnostic& one = *preview.add_refusals();
    one.set_code(CodeText(code));
    one.set_message(why);
  };
  refuse(ErrorCode::kCellStepUnreachable, "within a loop");
  refuse(ErrorCode::kCellInvalidArgument, "no such pass");
  hosts.Receive(*link, std::move(request));
  EXPECT_TRUE(Eventually([&] { return Job(job).state == JobState::kFailed; }));
  EXPECT_EQ(Job(job).outcome->code, ErrorCode::kCellStepUnreachable);
  EXPECT_EQ(Job(job).outcome->detail, "within a loop");
}

// LIVE-6.08: what is only moved or switched asks nobody, and what was seen to is not asked again.
TEST_F(AskedOfHosts, WhatWasSeenToBegins) {
  Tell(Idle());
  const std::int64_t job = Submit([](v1::Job& asked) {
    asked.mutable_run()->mutable_step()->set_step(2);
    asked.mutable_run()->add_confirmations(v1::CONFIRMATION_CLAMPS);
    asked.mutable_run()->add_confirmations(v1::CONFIRMATION_TOOL);
  });
  v1::HostRequest request;
  request.mutable_answer()->set_number(NewestOrder(1).number());
  v1::PreviewStartResponse& preview = *request.mutable_answer()->mutable_preview();
  preview.set_preview_token("a token");
  preview.add_differences()->set_action(v1::START_ACTION_SWITCH);
  Ask(preview, "tool", v1::CONFIRMATION_TOOL);
  Ask(preview, "clamps", v1::CONFIRMATION_CLAMPS);
  hosts.Receive(*link, std::move(request));
  const v1::HostOrder order = NewestOrder(2);
  ASSERT_TRUE(order.has_continue_job());
  EXPECT_EQ(order.continue_job().start().machine(), "machines/mill-1");
  EXPECT_EQ(order.continue_job().start().confirmations_size(), 2);
  EXPECT_EQ(order.continue_job().assignment().lease().job(), job);
}

// LIVE-5.01: the host tells of it by its lease.
TEST_F(AskedOfHosts, AnAssignmentSaysWhoseItIs) {
  Tell(Idle());
  const std::int64_t job = Submit();
  const v1::WorkerAssignment assignment = NewestOrder(1).run_job();
  const storage::AttemptRecord attempt = Must(bed.store().ListAttempts(job)).back();
  EXPECT_EQ(assignment.lease().job(), job);
  EXPECT_EQ(assignment.lease().attempt(), attempt.number);
  EXPECT_EQ(assignment.lease().fence(), attempt.fence);
  EXPECT_FALSE(assignment.has_ticket());
}

// LIVE-5.02: the host compares what was simulated with what it has.
TEST_F(AskedOfHosts, ATicketGoesWithTheJob) {
  const std::string proof = Proof();
  Tell(Idle());
  Submit([&](v1::Job& asked) { asked.mutable_run()->set_ticket(proof); });
  const v1::WorkerAssignment assignment = NewestOrder(1).run_job();
  EXPECT_EQ(assignment.ticket().job(), proof);
  EXPECT_EQ(assignment.ticket().family(), "rml1");
  EXPECT_EQ(assignment.ticket().inputs_size(), 1);
}

// The host has the memory of its machine: nothing of it is sent with a job.
TEST_F(AskedOfHosts, TheProgramOfTheJobGoesAlone) {
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 9, .object = "an object"}}, {}));
  Must(bed.store().PutSchedule(
      {.machine = "optimo-1", .number = 7, .name = "thin", .mode = "PULSE", .power_percent = 40.0},
      0));
  const auto other = std::make_shared<FakeLink>();
  v1::HostHello hello;
  hello.set_join_token("secret");
  hello.set_machine("machines/optimo-1");
  hello.set_host("hall/2");
  hello.set_protocol(1);
  ASSERT_TRUE(hosts.Join(other, hello));
  v1::HostRequest request;
  *request.mutable_status() = Idle();
  request.mutable_status()->set_machine("machines/optimo-1");
  request.mutable_status()->set_host("hall/2");
  hosts.Receive(*other, std::move(request));
  Submit([](v1::Job& asked) {
    asked.set_machine("machines/optimo-1");
    asked.set_inline_slot(7);
    asked.mutable_inline_program()->set_file_name("a.S");
    asked.mutable_inline_program()->set_content("STOP\n");
  });
  const auto sent = other->Newest(v1::HostResponse::kOrder);
  ASSERT_TRUE(sent);
  const v1::WorkerAssignment& assignment = sent->order().run_job();
  EXPECT_EQ(assignment.main_program(), 7);
  ASSERT_EQ(assignment.programs_size(), 1);
  EXPECT_EQ(assignment.programs(0).slot(), 7);
  EXPECT_EQ(assignment.programs(0).content(), "STOP\n");
  EXPECT_TRUE(assignment.schedules().empty());
  EXPECT_TRUE(assignment.machine_state().empty());
  EXPECT_TRUE(Orders().empty()) << "the other machine";
}

// A host is asked of its own machine.
TEST_F(AskedOfHosts, WhetherAJobBegan) {
  Tell(Idle());
  Mark();
  Submit();
  Accept(NewestOrder(1));
  runs.WakeAll();
  Settle();
  clock.Advance(RunQueue::kUnheardOf);
  runs.WakeAll();
  EXPECT_EQ(NewestOrder(2).run_state().machine(), "machines/mill-1");
}

// LIVE-5.02
TEST_F(AskedOfHosts, NothingBeforeItsMachineIsHeardOf) {
  std::int64_t job = 0;
  for (const v1::MachineState state : {v1::MACHINE_STATE_STARTING, v1::MACHINE_STATE_LOST}) {
    v1::MachineStatus status = Idle();
    status.set_state(state);
    Tell(status);
    if (job == 0) job = Submit();
    runs.WakeAll();
    Settle();
    EXPECT_TRUE(Orders().empty()) << state;
    EXPECT_THAT(WhyItWaits(job), testing::ElementsAre(HasSubstr("no host tells of it"))) << state;
  }
  v1::MachineStatus armed = Idle();
  armed.set_armed_for("jobs/99");
  Tell(armed);
  Settle();
  EXPECT_TRUE(Orders().empty());
  EXPECT_THAT(WhyItWaits(job), testing::ElementsAre(HasSubstr("it is armed for jobs/99")));
  armed.set_armed_for(JobName(job));
  Tell(armed);
  runs.WakeAll();
  EXPECT_EQ(NewestOrder(1).run_job().job().name(), JobName(job));
}

// LIVE-2.05: the job whose run was cut off is to be decided, and no other.
TEST_F(AskedOfHosts, TheJobThatWasCutOffIsToBeDecided) {
  EXPECT_FALSE(runs.IsToBeDecided("jobs/5"));
  v1::MachineStatus status = Idle();
  status.set_cut_off_job("jobs/5");
  Tell(status);
  EXPECT_TRUE(runs.IsToBeDecided("jobs/5"));
  EXPECT_FALSE(runs.IsToBeDecided("jobs/6"));
}

}  // namespace
}  // namespace rmlcell::server
