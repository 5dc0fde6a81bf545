#include "server/records/job_messages.h"

#include <google/protobuf/util/time_util.h>

#include "engine/core/units.h"
#include "proto/bridge/findings.h"
#include "server/base/names.h"
#include "storage/jobs/job_rules.h"

namespace rmlcell::server {
namespace {

std::string_view KindOf(const v1::JobEvent& event) {
  switch (event.what_case()) {
    case v1::JobEvent::kState:
      return "state";
    case v1::JobEvent::kDiagnostic:
      return "diagnostic";
    case v1::JobEvent::kGathered:
      return "gathered";
    case v1::JobEvent::kMessage:
      return "message";
    case v1::JobEvent::kHalted:
      return "halted";
    case v1::JobEvent::kResumed:
      return "resumed";
    case v1::JobEvent::kSignal:
      return "signal";
    case v1::JobEvent::kProgramLoaded:
      return "program_loaded";
    case v1::JobEvent::kExecutableMade:
      return "executable_made";
    case v1::JobEvent::kInputApplied:
      return "input_applied";
    case v1::JobEvent::kRunBegun:
      return "run_begun";
    case v1::JobEvent::kQueue:
      return "queue";
    case v1::JobEvent::kEnded:
      return "ended";
    case v1::JobEvent::kProductsMade:
      return "products_made";
    case v1::JobEvent::WHAT_NOT_SET:
      break;
  }
  return "";
}

// What the columns of the store do not say: the kind of the end, what its text is made of, verdict
// and reasons, the time.
std::string JudgementBytes(const v1::Outcome& outcome) {
  v1::Outcome judged;
  judged.set_kind(outcome.kind());
  judged.set_verdict(outcome.verdict());
  *judged.mutable_reasons() = outcome.reasons();
  *judged.mutable_arguments() = outcome.arguments();
  if (outcome.has_cycle_time_ns()) judged.set_cycle_time_ns(outcome.cycle_time_ns());
  // Of a stream, which has no steps.
  if (outcome.place().has_byte_offset())
    judged.mutable_place()->set_byte_offset(outcome.place().byte_offset());
  return judged.SerializeAsString();
}

// "BAD"; empty: nothing was judged.
std::string VerdictWord(v1::Verdict verdict) {
  if (verdict == v1::VERDICT_UNSPECIFIED) return {};
  return v1::Verdict_Name(verdict).substr(std::string_view("VERDICT_").size());
}

}  // namespace

google::protobuf::Timestamp ToProto(storage::WallTime time) {
  return google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(time.time_since_epoch().count());
}

v1::Job::State ToProto(storage::JobState state) {
  switch (state) {
    case storage::JobState::kQueued:
      return v1::Job::STATE_QUEUED;
    case storage::JobState::kRunning:
      return v1::Job::STATE_RUNNING;
    case storage::JobState::kSucceeded:
      return v1::Job::STATE_SUCCEEDED;
    case storage::JobState::kFailed:
      return v1::Job::STATE_FAILED;
    case storage::JobState::kCancelled:
      return v1::Job::STATE_CANCELLED;
    case storage::JobState::kInterrupted:
      return v1::Job::STATE_INTERRUPTED;
  }
  return v1::Job::STATE_UNSPECIFIED;
}

v1::WaitReason ToProto(storage::WaitReason reason) {
  switch (reason) {
    case storage::WaitReason::kNone:
      return v1::WAIT_REASON_WORKER;
    case storage::WaitReason::kHeld:
      return v1::WAIT_REASON_HELD;
    case storage::WaitReason::kNotBefore:
      return v1::WAIT_REASON_NOT_BEFORE;
    case storage::WaitReason::kAfterJob:
      return v1::WAIT_REASON_AFTER_JOB;
    case storage::WaitReason::kAfterJobFailed:
      return v1::WAIT_REASON_AFTER_JOB_FAILED;
    case storage::WaitReason::kMachineBusy:
      return v1::WAIT_REASON_MACHINE_BUSY;
  }
  return v1::WAIT_REASON_UNSPECIFIED;
}

storage::WallTime FromProto(const google::protobuf::Timestamp& time) {
  return storage::WallTime(
      std::chrono::microseconds(time.seconds() * 1'000'000 + time.nanos() / 1000));
}

int InlineSlotOf(const v1::Job& job) {
  return job.inline_slot() > 0 ? job.inline_slot() : kSlotMin;
}

int MainSlotOf(const v1::Job& job) {
  const auto stored = ParseProgramName(job.program());
  return stored ? stored->slot : InlineSlotOf(job);
}

std::optional<BroughtProgram> ProgramBrought(const v1::Job& job) {
  if (job.has_inline_program())
    return BroughtProgram{job.inline_program().file_name(), job.inline_program().form()};
  if (job.has_uploaded_program())
    return BroughtProgram{job.uploaded_program().file_name(), job.uploaded_program().form()};
  return std::nullopt;
}

v1::Job ToProto(const storage::JobRecord& record) {
  v1::Job job;
  // A specification that cannot be read leaves the rest of the job visible.
  if (!job.ParseFromString(record.specification)) job.Clear();
  job.clear_start_blockers();
  job.set_name(JobName(record.id));
  job.set_machine(MachineName(record.machine));
  job.set_title(record.title);
  job.set_attempts_max(record.attempts_max);
  job.set_state(ToProto(record.state));
  job.set_attempts(record.attempts);
  job.set_cancel_requested(record.cancel_requested);
  job.set_last_sequence(record.last_sequence);
  job.set_caller(record.caller);
  job.set_priority(record.priority);
  job.set_held(record.held);
  if (record.not_before) *job.mutable_not_before_time() = ToProto(*record.not_before);
  if (record.state == storage::JobState::kQueued) {
    // A RUN that is ready begins as soon as its machine can.
    const bool for_machine =
        record.wait == storage::WaitReason::kNone && record.kind == storage::kRunKind;
    job.set_wait_reason(for_machine ? v1::WAIT_REASON_MACHINE_NOT_READY : ToProto(record.wait));
    if (for_machine) job.set_waits_for(MachineName(record.machine));
  }
  if (record.waits_for > 0) job.set_waits_for(JobName(record.waits_for));
  *job.mutable_create_time() = ToProto(record.created_at);
  if (record.started_at) *job.mutable_start_time() = ToProto(*record.started_at);
  if (record.finished_at) *job.mutable_end_time() = ToProto(*record.finished_at);
  if (record.outcome) *job.mutable_outcome() = ToProto(*record.outcome);
  return job;
}

v1::Artifact ToProto(const storage::ArtifactRecord& record) {
  v1::Artifact artifact;
  artifact.set_name(record.name);
  artifact.set_media_type(record.media_type);
  artifact.set_size(record.size);
  artifact.set_sha256(record.sha256);
  artifact.set_url_path("/v1/" + JobName(record.job) + "/artifacts/" + record.name);
  return artifact;
}

v1::JobEvent ToProto(const storage::EventRecord& record) {
  v1::JobEvent event;
  if (!event.ParseFromString(record.payload))
    event.mutable_message()->set_text("an event that cannot be read");
  event.set_sequence(record.sequence);
  event.set_job(JobName(record.job));
  event.set_attempt(record.attempt);
  *event.mutable_time() = ToProto(record.at);
  return event;
}

storage::NewEvent ToRecord(const v1::JobEvent& event) {
  return {.kind = std::string(KindOf(event)), .payload = event.SerializeAsString()};
}

storage::NewEvent StateEvent(storage::JobState state) {
  v1::JobEvent event;
  event.set_state(ToProto(state));
  return ToRecord(event);
}

storage::NewEvent EndedEvent(const v1::Outcome& outcome) {
  v1::JobEvent event;
  *event.mutable_ended() = outcome;
  return ToRecord(event);
}

storage::NewEvent QueueEvent(bool held, int priority) {
  v1::JobEvent event;
  event.mutable_queue()->set_held(held);
  event.mutable_queue()->set_priority(priority);
  return ToRecord(event);
}

storage::NewEvent By(std::string_view caller, storage::NewEvent event) {
  event.caller = caller;
  return event;
}

storage::JobOutcome OutcomeOf(const v1::Outcome& outcome) {
  storage::JobOutcome made{.state = storage::JobState::kFailed,
                           .code = {},
                           .detail = outcome.message(),
                           .program = outcome.place().program(),
                           .step = outcome.place().step(),
                           .judgement = JudgementBytes(outcome),
                           .verdict = VerdictWord(outcome.verdict())};
  if (!outcome.code().empty()) {
    const auto found = FindByText(outcome.code());
    if (!found.empty()) made.code = found.front()->code;
  }
  // What was stopped is no part: only what ran to its end counts (LIVE-5.08).
  if (outcome.kind() == v1::Outcome::KIND_COMPLETED) {
    made.state = storage::JobState::kSucceeded;
  } else if (outcome.kind() == v1::Outcome::KIND_CANCELLED) {
    made.state = storage::JobState::kCancelled;
  } else if (outcome.kind() == v1::Outcome::KIND_INTERRUPTED) {
    made.state = storage::JobState::kInterrupted;
  }
  return made;
}

v1::Outcome ToProto(const storage::JobOutcome& outcome) {
  v1::Outcome message;
  // A judgement that cannot be read leaves the rest of the outcome visible.
  if (!message.ParseFromString(outcome.judgement)) message.Clear();
  switch (outcome.state) {
    case storage::JobState::kSucceeded:
      if (message.kind() != v1::Outcome::KIND_UNSPECIFIED) break;
      message.set_kind(outcome.code ? v1::Outcome::KIND_STOPPED : v1::Outcome::KIND_COMPLETED);
      break;
    case storage::JobState::kCancelled:
      message.set_kind(v1::Outcome::KIND_CANCELLED);
      break;
    case storage::JobState::kInterrupted:
      message.set_kind(v1::Outcome::KIND_INTERRUPTED);
      break;
    default: {
      if (message.kind() != v1::Outcome::KIND_UNSPECIFIED) break;
      // That a worker died says nothing about what the job needed.
      const bool budget = outcome.code && *outcome.code != ErrorCode::kCellWorkerDied &&
                          Lookup(*outcome.code).severity == Severity::kBudget;
      message.set_kind(budget ? v1::Outcome::KIND_BUDGET_EXCEEDED : v1::Outcome::KIND_FAILED);
    }
  }
  if (outcome.code) {
    const CatalogueEntry& entry = Lookup(*outcome.code);
    message.set_code(CodeText(*outcome.code));
    message.set_symbol(ConstantName(*outcome.code));
    message.set_advice(std::string(entry.advice));
    message.set_message(std::string(entry.when));
  }
  if (!outcome.detail.empty()) message.set_message(outcome.detail);
  if (outcome.program > 0) message.mutable_place()->set_program(outcome.program);
  if (outcome.step > 0) message.mutable_place()->set_step(outcome.step);
  return message;
}

storage::JobOutcome WorkerDiedOutcome() {
  return {.state = storage::JobState::kFailed, .code = ErrorCode::kCellWorkerDied, .detail = {}};
}

storage::JobOutcome StoppedOutcome() {
  return {.state = storage::JobState::kFailed, .code = ErrorCode::kCellHostStopped, .detail = {}};
}

storage::NewEvent CancelledEvent() { return EndedEvent(ToProto(storage::CancelledOutcome())); }

storage::LossPolicy LossOf(storage::JobOutcome outcome, const v1::SourcePlace& place,
                           const std::string& why) {
  v1::JobEvent lost;
  lost.mutable_message()->set_text(why);
  outcome.program = place.program();
  outcome.step = place.step();
  storage::JobOutcome interrupted = outcome;
  interrupted.state = storage::JobState::kInterrupted;
  return {.outcome = outcome,
          .requeued = {ToRecord(lost), StateEvent(storage::JobState::kQueued)},
          .ended = {ToRecord(lost), EndedEvent(ToProto(outcome))},
          .interrupted = {ToRecord(lost), EndedEvent(ToProto(interrupted))},
          .cancelled = {ToRecord(lost), CancelledEvent()}};
}

}  // namespace rmlcell::server
