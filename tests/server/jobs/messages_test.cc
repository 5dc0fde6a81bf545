#include <gtest/gtest.h>

#include <set>

#include "server/executor.h"
#include "server/jobs/framing.h"
#include "server/jobs/job_messages.h"
#include "server/names.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobOutcome;
using storage::JobState;

TEST(Framing, GivesTheFramesBackOneByOne) {
  const std::vector<std::string> frames = {"", "a", std::string(300, 'b'), std::string("\0\xFF", 2),
                                           std::string(70'000, 'c')};
  std::string bytes;
  for (const std::string& frame : frames) AddFrame(frame, bytes);
  EXPECT_EQ(bytes.substr(0, 9),
            std::string("\0\0\0\0\1\0\0\0a", 9));  // length first, least significant byte first
  std::string_view rest = bytes;
  for (const std::string& frame : frames) EXPECT_EQ(TakeFrame(rest), frame);
  EXPECT_EQ(TakeFrame(rest), std::nullopt);
}

TEST(Framing, AFrameThatIsCutOffIsNone) {
  std::string bytes;
  AddFrame("whole", bytes);
  AddFrame("cut off", bytes);
  for (std::size_t missing = 1; missing < 11; ++missing) {
    std::string_view rest = std::string_view(bytes).substr(0, bytes.size() - missing);
    EXPECT_EQ(TakeFrame(rest), "whole");
    EXPECT_EQ(TakeFrame(rest), std::nullopt) << missing;
  }
  std::string_view huge("\xFF\xFF\xFF\xFFtext", 8);
  EXPECT_EQ(TakeFrame(huge), std::nullopt);
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
  event.set_message("hello");
  const storage::NewEvent kept = ToRecord(event);
  EXPECT_FALSE(kept.kind.empty());
  const v1::JobEvent read = ToProto(storage::EventRecord{.position = 99,
                                                         .job = 7,
                                                         .sequence = 3,
                                                         .attempt = 2,
                                                         .at = {},
                                                         .kind = kept.kind,
                                                         .payload = kept.payload});
  EXPECT_EQ(read.message(), "hello");
  EXPECT_EQ(read.job(), "jobs/7");
  EXPECT_EQ(read.sequence(), 3);
  EXPECT_EQ(read.attempt(), 2);
  // A payload that cannot be read must not end a watcher.
  EXPECT_TRUE(
      ToProto(storage::EventRecord{.job = 7, .sequence = 4, .payload = "\xFF\xFF"}).has_message());
}

TEST(JobMessages, EveryStateHasItsOwn) {
  std::set<int> states;
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                               JobState::kFailed, JobState::kCancelled, JobState::kInterrupted}) {
    EXPECT_NE(ToProto(state), v1::Job::STATE_UNSPECIFIED);
    EXPECT_TRUE(states.insert(ToProto(state)).second);
  }
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

}  // namespace
}  // namespace rmlcell::server
