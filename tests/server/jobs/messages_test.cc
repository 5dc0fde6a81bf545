#include <gtest/gtest.h>

#include <latch>

#include "proto/bridge/framing.h"
#include "server/base/executor.h"
#include "server/base/names.h"
#include "server/records/job_messages.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobOutcome;
using storage::JobState;

TEST(Framing, GivesTheFramesBackOneByOne) {
  const std::vector<std::string> frames = {"", "a", std::string(300, 'b'), std::string("\0\xFF", 2),
                                           std::string(70'000, 'c')};
  std::string bytes;
  for (const std::string& frame : frames) bridge::AddFrame(frame, bytes);
  EXPECT_EQ(bytes.substr(0, 9),
            std::string("\0\0\0\0\1\0\0\0a", 9));  // length first, least significant byte first
  std::string_view rest = bytes;
  for (const std::string& frame : frames) EXPECT_EQ(bridge::TakeFrame(rest), frame);
  EXPECT_EQ(bridge::TakeFrame(rest), std::nullopt);
}

TEST(Framing, AFrameThatIsCutOffIsNone) {
  std::string bytes;
  bridge::AddFrame("whole", bytes);
  bridge::AddFrame("cut off", bytes);
  for (std::size_t missing = 1; missing < 11; ++missing) {
    std::string_view rest = std::string_view(bytes).substr(0, bytes.size() - missing);
    EXPECT_EQ(bridge::TakeFrame(rest), "whole");
    EXPECT_EQ(bridge::TakeFrame(rest), std::nullopt) << missing;
  }
  std::string_view huge("\xFF\xFF\xFF\xFFtext", 8);
  EXPECT_EQ(bridge::TakeFrame(huge), std::nullopt);
}

TEST(JobMessages, AnOutcomeKeepsStateCodeTextAndPlace) {
  const std::vector<std::pair<JobOutcome, v1::Outcome::Kind>> cases = {
      {{.state = JobState::kSucceeded}, v1::Outcome::KIND_COMPLETED},
      {{.state = JobState::kFailed,
        .code = ErrorCode::kHoleRadiusZero,
        .detail = "radius is 0",
        .program = 12,
        .step = 34},
       v1::Outcome::KIND_FAILED},
      {{.state = JobState::kFailed, .code = ErrorCode::kCellOutputBudget},
       v1::Outcome::KIND_BUDGET_EXCEEDED},
      {{.state = JobState::kFailed, .code = ErrorCode::kCellWorkerDied}, v1::Outcome::KIND_FAILED},
      {{.state = JobState::kCancelled, .code = ErrorCode::kCellCancelled},
       v1::Outcome::KIND_CANCELLED},
  };
  for (const auto& [outcome, kind] : cases) {
    const v1::Outcome message = ToProto(outcome);
    EXPECT_EQ(message.kind(), kind);
    const JobOutcome back = OutcomeOf(message);
    EXPECT_EQ(back.state, outcome.state);
    EXPECT_EQ(back.code, outcome.code);
    EXPECT_EQ(back.program, outcome.program);
    EXPECT_EQ(back.step, outcome.step);
    if (outcome.code) {
      EXPECT_EQ(message.code(), CodeText(*outcome.code));
      EXPECT_EQ(message.symbol(), ConstantName(*outcome.code));
      EXPECT_EQ(message.advice(), Lookup(*outcome.code).advice);
      EXPECT_FALSE(message.message().empty());
    }
  }
}

TEST(JobMessages, AnEventOfTheLogKnowsItsPlaceThere) {
  v1::JobEvent event;
  event.mutable_message()->set_text("hello");
  const storage::NewEvent kept = ToRecord(event);
  EXPECT_FALSE(kept.kind.empty());
  const v1::JobEvent read = ToProto(storage::EventRecord{.position = 99,
                                                         .job = 7,
                                                         .sequence = 3,
                                                         .attempt = 2,
                                                         .at = {},
                                                         .kind = kept.kind,
                                                         .payload = kept.payload});
  EXPECT_EQ(read.message().text(), "hello");
  EXPECT_EQ(read.job(), "jobs/7");
  EXPECT_EQ(read.sequence(), 3);
  EXPECT_EQ(read.attempt(), 2);
  // A payload that cannot be read must not end a watcher.
  EXPECT_TRUE(
      ToProto(storage::EventRecord{.job = 7, .sequence = 4, .payload = "\xFF\xFF"}).has_message());
}

TEST(JobMessages, EveryStateHasItsOwn) {
  EXPECT_EQ(ToProto(JobState::kQueued), v1::Job::STATE_QUEUED);
  EXPECT_EQ(ToProto(JobState::kRunning), v1::Job::STATE_RUNNING);
  EXPECT_EQ(ToProto(JobState::kSucceeded), v1::Job::STATE_SUCCEEDED);
  EXPECT_EQ(ToProto(JobState::kFailed), v1::Job::STATE_FAILED);
  EXPECT_EQ(ToProto(JobState::kCancelled), v1::Job::STATE_CANCELLED);
  EXPECT_EQ(ToProto(JobState::kInterrupted), v1::Job::STATE_INTERRUPTED);
}

// google/protobuf/timestamp.proto: seconds, and the rest in nanoseconds.
TEST(JobMessages, ATimeIsExactToTheMicrosecond) {
  const auto time = ToProto(storage::WallTime(std::chrono::microseconds(1'700'000'000'654'321)));
  EXPECT_EQ(time.seconds(), 1'700'000'000);
  EXPECT_EQ(time.nanos(), 654'321'000);
}

storage::WallTime AtSecond(int second) { return storage::WallTime(std::chrono::seconds(second)); }

TEST(JobMessages, AJobHasAllOfItsRecord) {
  v1::Job wanted;
  wanted.set_kind(v1::JOB_KIND_CHECK);
  wanted.set_title("as it was asked for");
  const storage::JobRecord record{.id = 17,
                                  .machine = "optimo-1",
                                  .title = "title",
                                  .caller = "caller",
                                  .specification = wanted.SerializeAsString(),
                                  .state = JobState::kFailed,
                                  .cancel_requested = true,
                                  .attempts = 3,
                                  .attempts_max = 4,
                                  .outcome = JobOutcome{.state = JobState::kFailed, .step = 9},
                                  .last_sequence = 55,
                                  .created_at = AtSecond(1),
                                  .started_at = AtSecond(2),
                                  .finished_at = AtSecond(3)};
  const v1::Job job = ToProto(record);
  EXPECT_EQ(job.name(), "jobs/17");
  EXPECT_EQ(job.kind(), v1::JOB_KIND_CHECK);
  EXPECT_EQ(job.machine(), "machines/optimo-1");
  EXPECT_EQ(job.title(), "title");
  EXPECT_EQ(job.caller(), "caller");
  EXPECT_EQ(job.state(), v1::Job::STATE_FAILED);
  EXPECT_TRUE(job.cancel_requested());
  EXPECT_EQ(job.attempts(), 3);
  EXPECT_EQ(job.attempts_max(), 4);
  EXPECT_EQ(job.outcome().place().step(), 9);
  EXPECT_EQ(job.last_sequence(), 55);
  EXPECT_EQ(job.create_time().seconds(), 1);
  EXPECT_EQ(job.start_time().seconds(), 2);
  EXPECT_EQ(job.end_time().seconds(), 3);

  const v1::Job fresh = ToProto(storage::JobRecord{.id = 18, .machine = "mill-1"});
  EXPECT_FALSE(fresh.has_start_time());
  EXPECT_FALSE(fresh.has_end_time());
  EXPECT_FALSE(fresh.has_outcome());
  EXPECT_FALSE(fresh.cancel_requested());
  EXPECT_EQ(fresh.state(), v1::Job::STATE_QUEUED);
  // A specification that cannot be read leaves the rest visible.
  const v1::Job broken = ToProto(
      storage::JobRecord{.id = 19, .machine = "mill-1", .specification = "\x08\x01\xFF\xFF"});
  EXPECT_EQ(broken.name(), "jobs/19");
  EXPECT_EQ(broken.machine(), "machines/mill-1");
  EXPECT_EQ(broken.kind(), v1::JOB_KIND_UNSPECIFIED);
}

TEST(JobMessages, AProductHasItsPathOnTheWebPort) {
  const v1::Artifact artifact = ToProto(storage::ArtifactRecord{
      .job = 17, .name = "report", .media_type = "image/svg+xml", .sha256 = "abc", .size = 33});
  EXPECT_EQ(artifact.name(), "report");
  EXPECT_EQ(artifact.media_type(), "image/svg+xml");
  EXPECT_EQ(artifact.size(), 33);
  EXPECT_EQ(artifact.sha256(), "abc");
  EXPECT_EQ(artifact.url_path(), "/v1/jobs/17/artifacts/report");
}

// job.proto inline_slot: 1 to 99; 0: 1.
TEST(JobMessages, AnInlineProgramHasSlotOneUnlessItSaysAnother) {
  v1::Job job;
  EXPECT_EQ(InlineSlotOf(job), 1);
  job.set_inline_slot(1);
  EXPECT_EQ(InlineSlotOf(job), 1);
  job.set_inline_slot(99);
  EXPECT_EQ(InlineSlotOf(job), 99);
}

TEST(JobMessages, AnEventIsKeptUnderItsKind) {
  v1::JobEvent event;
  EXPECT_EQ(ToRecord(event).kind, "");
  event.mutable_message();
  EXPECT_EQ(ToRecord(event).kind, "message");
  event.mutable_diagnostic();
  EXPECT_EQ(ToRecord(event).kind, "diagnostic");
  event.mutable_gathered();
  EXPECT_EQ(ToRecord(event).kind, "gathered");
  event.mutable_halted();
  EXPECT_EQ(ToRecord(event).kind, "halted");
  event.mutable_resumed();
  EXPECT_EQ(ToRecord(event).kind, "resumed");
  event.mutable_signal();
  EXPECT_EQ(ToRecord(event).kind, "signal");
  event.mutable_program_loaded();
  EXPECT_EQ(ToRecord(event).kind, "program_loaded");
  event.mutable_executable_made();
  EXPECT_EQ(ToRecord(event).kind, "executable_made");
  event.mutable_input_applied();
  EXPECT_EQ(ToRecord(event).kind, "input_applied");
  event.mutable_run_begun();
  EXPECT_EQ(ToRecord(event).kind, "run_begun");
  event.mutable_queue();
  EXPECT_EQ(ToRecord(event).kind, "queue");
  event.set_state(v1::Job::STATE_QUEUED);
  EXPECT_EQ(ToRecord(event).kind, "state");
  EXPECT_EQ(StateEvent(JobState::kQueued).payload, event.SerializeAsString());
  EXPECT_EQ(StateEvent(JobState::kQueued).kind, "state");
  v1::Outcome outcome;
  outcome.set_message("over");
  const storage::NewEvent ended = EndedEvent(outcome);
  EXPECT_EQ(ended.kind, "ended");
  ASSERT_TRUE(event.ParseFromString(ended.payload));
  EXPECT_EQ(event.ended().message(), "over");
}

// What a worker tells of the end becomes what is kept of it.
TEST(JobMessages, AnOutcomeOfAWorkerIsRead) {
  const auto kept = [](v1::Outcome::Kind kind, const std::string& code = "") {
    v1::Outcome outcome;
    outcome.set_kind(kind);
    outcome.set_code(code);
    outcome.set_message("text");
    outcome.mutable_place()->set_program(45);
    outcome.mutable_place()->set_step(6);
    return OutcomeOf(outcome);
  };
  EXPECT_EQ(kept(v1::Outcome::KIND_COMPLETED).state, JobState::kSucceeded);
  EXPECT_EQ(kept(v1::Outcome::KIND_STOPPED).state, JobState::kFailed);  // half a part is no part
  EXPECT_EQ(kept(v1::Outcome::KIND_CANCELLED).state, JobState::kCancelled);
  EXPECT_EQ(kept(v1::Outcome::KIND_FAILED).state, JobState::kFailed);
  EXPECT_EQ(kept(v1::Outcome::KIND_BUDGET_EXCEEDED).state, JobState::kFailed);
  EXPECT_EQ(kept(v1::Outcome::KIND_UNSPECIFIED).state, JobState::kFailed);
  const JobOutcome whole = kept(v1::Outcome::KIND_FAILED, "OPT-E348");
  EXPECT_EQ(whole.code, ErrorCode::kHoleRadiusZero);
  EXPECT_EQ(whole.detail, "text");
  EXPECT_EQ(whole.program, 45);
  EXPECT_EQ(whole.step, 6);
  EXPECT_EQ(kept(v1::Outcome::KIND_FAILED).code, std::nullopt);
  EXPECT_EQ(kept(v1::Outcome::KIND_FAILED, "OPT-E99999").code, std::nullopt);
}

// How a run ended is kept as it was told, whatever the state of the job is called.
TEST(JobMessages, TheKindOfAnEndIsKept) {
  for (const auto kind :
       {v1::Outcome::KIND_COMPLETED, v1::Outcome::KIND_STOPPED, v1::Outcome::KIND_FAILED,
        v1::Outcome::KIND_CANCELLED, v1::Outcome::KIND_BUDGET_EXCEEDED}) {
    v1::Outcome outcome;
    outcome.set_kind(kind);
    EXPECT_EQ(ToProto(OutcomeOf(outcome)).kind(), kind);
    outcome.set_code("OPT-E7507");
    EXPECT_EQ(ToProto(OutcomeOf(outcome)).kind(), kind);
  }
}

// design.md section 8, LIVE-5.08: of a RUN that was lost its watchers hear what became of it, and
// where it was; of other jobs what their outcome will be.
TEST(JobMessages, ALostJobTellsWhereItWas) {
  v1::SourcePlace place;
  place.set_program(45);
  place.set_step(6);
  const storage::LossPolicy policy = LossOf(WorkerDiedOutcome(), place, "the worker died");
  EXPECT_EQ(policy.outcome.state, JobState::kFailed);
  EXPECT_EQ(policy.outcome.program, 45);
  EXPECT_EQ(policy.outcome.step, 6);
  const auto last = [](const std::vector<storage::NewEvent>& events) {
    EXPECT_EQ(events.size(), 2U);
    v1::JobEvent first, event;
    EXPECT_TRUE(first.ParseFromString(events.front().payload));
    EXPECT_EQ(first.message().text(), "the worker died");
    EXPECT_TRUE(event.ParseFromString(events.back().payload));
    return event;
  };
  EXPECT_EQ(last(policy.requeued).state(), v1::Job::STATE_QUEUED);
  EXPECT_EQ(last(policy.cancelled).ended().kind(), v1::Outcome::KIND_CANCELLED);
  for (const auto& [events, kind] : {std::pair(policy.ended, v1::Outcome::KIND_FAILED),
                                     {policy.interrupted, v1::Outcome::KIND_INTERRUPTED}}) {
    const v1::Outcome ended = last(events).ended();
    EXPECT_EQ(ended.kind(), kind);
    EXPECT_EQ(ended.code(), "CELL-E9301");
    EXPECT_EQ(ended.place().program(), 45);
    EXPECT_EQ(ended.place().step(), 6);
  }
}

TEST(JobMessages, AnOutcomeSaysWhatHappenedInItsOwnWordsOrThoseOfTheCatalogue) {
  JobOutcome outcome{.state = JobState::kSucceeded, .code = ErrorCode::kCellCancelled};
  // As stores of before have it: it ended before its last step.
  EXPECT_EQ(ToProto(outcome).kind(), v1::Outcome::KIND_STOPPED);
  outcome = {.state = JobState::kInterrupted};
  EXPECT_EQ(ToProto(outcome).kind(), v1::Outcome::KIND_INTERRUPTED);
  outcome = {.state = JobState::kFailed, .code = ErrorCode::kHoleRadiusZero};
  EXPECT_EQ(ToProto(outcome).message(), Lookup(ErrorCode::kHoleRadiusZero).when);
  EXPECT_FALSE(ToProto(outcome).has_place());
  outcome.detail = "radius is 0";
  EXPECT_EQ(ToProto(outcome).message(), "radius is 0");
  outcome.program = 1;
  outcome.step = 1;
  EXPECT_EQ(ToProto(outcome).place().program(), 1);
  EXPECT_EQ(ToProto(outcome).place().step(), 1);
  EXPECT_EQ(ToProto(JobOutcome{.state = JobState::kSucceeded}).code(), "");
  // What was judged is kept beside it; a judgement that cannot be read hides nothing else.
  v1::Outcome judged;
  judged.set_verdict(v1::VERDICT_DOUBTFUL);
  judged.add_reasons();
  judged.set_message("not kept twice");
  outcome = OutcomeOf(judged);
  v1::Outcome kept;
  ASSERT_TRUE(kept.ParseFromString(outcome.judgement));
  EXPECT_EQ(kept.message(), "");
  EXPECT_EQ(ToProto(outcome).verdict(), v1::VERDICT_DOUBTFUL);
  EXPECT_EQ(ToProto(outcome).reasons_size(), 1);
  outcome.judgement = "\xFF\xFF";
  EXPECT_EQ(ToProto(outcome).verdict(), v1::VERDICT_UNSPECIFIED);
  EXPECT_EQ(ToProto(outcome).message(), "not kept twice");
  EXPECT_EQ(WorkerDiedOutcome().state, JobState::kFailed);
  EXPECT_EQ(WorkerDiedOutcome().code, ErrorCode::kCellWorkerDied);
  EXPECT_FALSE(ToProto(WorkerDiedOutcome()).has_place());  // it died somewhere
}

TEST(Executor, RunsAllThatWasPostedAndSurvivesAnException) {
  std::atomic<int> done = 0;
  {
    Executor executor(4);
    for (int i = 0; i < 1000; ++i) {
      executor.Post([&done, i] {
        if (i % 100 == 7) throw std::runtime_error("a mistake");
        ++done;
      });
    }
  }
  EXPECT_EQ(done, 990);
}

TEST(Executor, TakesNoMoreThanMayWait) {
  std::latch begun(1);
  std::latch go_on(1);
  std::atomic<int> done = 0;
  {
    Executor executor(1, 2);
    ASSERT_TRUE(executor.TryPost([&] {
      begun.count_down();
      go_on.wait();
    }));
    begun.wait();  // what has begun does not wait any more
    const auto work = [&done] { ++done; };
    EXPECT_TRUE(executor.TryPost(work));
    EXPECT_TRUE(executor.TryPost(work));
    EXPECT_FALSE(executor.TryPost(work));
    executor.Post(work);  // never refused
    EXPECT_FALSE(executor.TryPost(work));
    go_on.count_down();
  }
  EXPECT_EQ(done, 3);
}

}  // namespace
}  // namespace rmlcell::server
