// What is told of a job that waits and of one that has ended, and what is kept of an end.
#include <gtest/gtest.h>

#include <chrono>

#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"

namespace rmlcell::server {
namespace {

using storage::JobState;
using storage::WaitReason;

v1::Job Waiting(WaitReason reason, const std::string& kind, std::int64_t waits_for = 0) {
  storage::JobRecord record;
  record.id = 17;
  record.machine = "mill-1";
  record.kind = kind;
  record.state = JobState::kQueued;
  record.wait = reason;
  record.waits_for = waits_for;
  return ToProto(record);
}

// LIVE-5.02: one that is ready waits for a worker, or for its machine where that runs it.
TEST(EndsAndWaits, AJobSaysWhatItWaitsFor) {
  EXPECT_EQ(Waiting(WaitReason::kNone, "CHECK").wait_reason(), v1::WAIT_REASON_WORKER);
  EXPECT_EQ(Waiting(WaitReason::kNone, "CHECK").waits_for(), "");
  EXPECT_EQ(Waiting(WaitReason::kNone, "RUN").wait_reason(), v1::WAIT_REASON_MACHINE_NOT_READY);
  EXPECT_EQ(Waiting(WaitReason::kNone, "RUN").waits_for(), "machines/mill-1");
  EXPECT_EQ(Waiting(WaitReason::kHeld, "RUN").wait_reason(), v1::WAIT_REASON_HELD);
  EXPECT_EQ(Waiting(WaitReason::kHeld, "RUN").waits_for(), "");
  EXPECT_EQ(Waiting(WaitReason::kNotBefore, "RUN").wait_reason(), v1::WAIT_REASON_NOT_BEFORE);
  const v1::Job after = Waiting(WaitReason::kAfterJob, "CHECK", 1);
  EXPECT_EQ(after.wait_reason(), v1::WAIT_REASON_AFTER_JOB);
  EXPECT_EQ(after.waits_for(), "jobs/1");
  const v1::Job failed = Waiting(WaitReason::kAfterJobFailed, "RUN", 5);
  EXPECT_EQ(failed.wait_reason(), v1::WAIT_REASON_AFTER_JOB_FAILED);
  EXPECT_EQ(failed.waits_for(), "jobs/5");
  const v1::Job busy = Waiting(WaitReason::kMachineBusy, "RUN", 6);
  EXPECT_EQ(busy.wait_reason(), v1::WAIT_REASON_MACHINE_BUSY);
  EXPECT_EQ(busy.waits_for(), "jobs/6");
}

// One that does not wait has no reason, whatever was the last.
TEST(EndsAndWaits, AJobThatRunsWaitsForNothing) {
  storage::JobRecord record;
  record.id = 17;
  record.machine = "mill-1";
  record.kind = "RUN";
  record.state = JobState::kRunning;
  record.priority = -7;
  record.held = true;
  record.not_before = storage::WallTime(std::chrono::seconds(9));
  v1::Job asked;
  asked.add_start_blockers()->set_code("of the client");
  record.specification = asked.SerializeAsString();
  const v1::Job job = ToProto(record);
  EXPECT_EQ(job.wait_reason(), v1::WAIT_REASON_UNSPECIFIED);
  EXPECT_EQ(job.waits_for(), "");
  EXPECT_EQ(job.priority(), -7);
  EXPECT_TRUE(job.held());
  EXPECT_EQ(job.not_before_time().seconds(), 9);
  EXPECT_EQ(job.start_blockers_size(), 0);
}

// google/protobuf/timestamp.proto: there and back, to the microsecond.
TEST(EndsAndWaits, ATimeComesBack) {
  google::protobuf::Timestamp time;
  time.set_seconds(1'700'000'000);
  time.set_nanos(654'321'987);
  EXPECT_EQ(FromProto(time), storage::WallTime(std::chrono::microseconds(1'700'000'000'654'321)));
  EXPECT_EQ(ToProto(FromProto(time)).nanos(), 654'321'000);
}

// LIVE-5.08: what was cut off is neither done nor failed; what its machine gave back has a code.
TEST(EndsAndWaits, AnInterruptedRunIsKeptAsOne) {
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(OutcomeOf(outcome).state, JobState::kInterrupted);
  EXPECT_EQ(ToProto(OutcomeOf(outcome)).kind(), v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(StoppedOutcome().state, JobState::kFailed);
  EXPECT_EQ(StoppedOutcome().code, ErrorCode::kCellHostStopped);
}

// The columns of the store have no room for reasons with their arguments, times and bytes.
TEST(EndsAndWaits, WhatWasJudgedComesBack) {
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_FAILED);
  outcome.set_verdict(v1::VERDICT_BAD);
  outcome.add_reasons()->set_code("CELL-E1");
  outcome.add_arguments()->set_name("radius");
  outcome.set_cycle_time_ns(77);
  outcome.mutable_place()->set_byte_offset(41);
  const storage::JobOutcome kept = OutcomeOf(outcome);
  EXPECT_EQ(kept.verdict, "BAD");
  const v1::Outcome told = ToProto(kept);
  EXPECT_EQ(told.verdict(), v1::VERDICT_BAD);
  ASSERT_EQ(told.reasons_size(), 1);
  EXPECT_EQ(told.reasons(0).code(), "CELL-E1");
  ASSERT_EQ(told.arguments_size(), 1);
  EXPECT_EQ(told.arguments(0).name(), "radius");
  EXPECT_EQ(told.cycle_time_ns(), 77);
  EXPECT_EQ(told.place().byte_offset(), 41);
  EXPECT_EQ(told.place().step(), 0);
  const v1::Outcome plain = ToProto(OutcomeOf(v1::Outcome()));
  EXPECT_FALSE(plain.has_cycle_time_ns());
  EXPECT_FALSE(plain.has_place());
  EXPECT_EQ(OutcomeOf(v1::Outcome()).verdict, "");
}

// Of what cannot be read to its end not even the beginning counts.
TEST(EndsAndWaits, HalfAMessageIsNone) {
  v1::Outcome judged;
  judged.set_kind(v1::Outcome::KIND_COMPLETED);
  judged.set_verdict(v1::VERDICT_GOOD);
  storage::JobOutcome outcome;
  outcome.state = JobState::kFailed;
  outcome.judgement = judged.SerializeAsString() + "\xFF";
  EXPECT_EQ(ToProto(outcome).kind(), v1::Outcome::KIND_FAILED);
  EXPECT_EQ(ToProto(outcome).verdict(), v1::VERDICT_UNSPECIFIED);
  v1::Job asked;
  asked.set_kind(v1::JOB_KIND_RUN);
  storage::JobRecord record;
  record.id = 17;
  record.machine = "mill-1";
  record.specification = asked.SerializeAsString() + "\xFF";
  EXPECT_EQ(ToProto(record).kind(), v1::JOB_KIND_UNSPECIFIED);
  EXPECT_EQ(ToProto(record).name(), "jobs/17");
}

// job.proto: a program comes with its job in the message or by its upload; a stored one does not.
TEST(EndsAndWaits, AProgramThatWasBroughtHasItsNameAndForm) {
  v1::Job job;
  job.set_program("machines/optimo-1/programs/7");
  EXPECT_FALSE(ProgramBrought(job));
  job.Clear();
  job.mutable_inline_program()->set_file_name("inline.O");
  job.mutable_inline_program()->set_form(v1::PROGRAM_FORM_OBJECT);
  auto brought = ProgramBrought(job);
  ASSERT_TRUE(brought);
  EXPECT_EQ(brought->file_name, "inline.O");
  EXPECT_EQ(brought->form, v1::PROGRAM_FORM_OBJECT);
  job.Clear();
  job.mutable_uploaded_program()->set_file_name("uploaded.S");
  job.mutable_uploaded_program()->set_form(v1::PROGRAM_FORM_SOURCE);
  brought = ProgramBrought(job);
  ASSERT_TRUE(brought);
  EXPECT_EQ(brought->file_name, "uploaded.S");
  EXPECT_EQ(brought->form, v1::PROGRAM_FORM_SOURCE);
}

// A schedule goes to whoever runs a job as it is kept.
TEST(EndsAndWaits, AScheduleIsAssignedAsItIs) {
  const v1::AssignedSchedule made = ToAssigned(
      {.machine = "optimo-1", .number = 7, .name = "thin", .mode = "PULSE", .power_percent = 62.5});
  EXPECT_EQ(made.number(), 7);
  EXPECT_EQ(made.title(), "thin");
  EXPECT_EQ(made.mode(), "PULSE");
  EXPECT_EQ(made.power_percent(), 62.5);
}

// Who has changed the place of a job in the queue, and how, stands in its log.
TEST(EndsAndWaits, AChangeOfTheQueueIsTold) {
  const storage::NewEvent kept = By("anna", QueueEvent(true, -3));
  EXPECT_EQ(kept.caller, "anna");
  EXPECT_EQ(kept.kind, "queue");
  v1::JobEvent event;
  ASSERT_TRUE(event.ParseFromString(kept.payload));
  EXPECT_TRUE(event.queue().held());
  EXPECT_EQ(event.queue().priority(), -3);
}

}  // namespace
}  // namespace rmlcell::server
