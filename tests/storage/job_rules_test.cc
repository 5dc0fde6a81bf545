// What any store asks before it changes a job: values in, values out.
#include "storage/jobs/job_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/jobs/queue_rules.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;

// A job that was moved to a place, and one that stands at its own number.
PlacedJob At(std::int64_t job, double place) { return {.job = job, .place = place, .moved = true}; }
PlacedJob Plain(std::int64_t job) { return {.job = job, .place = static_cast<double>(job)}; }

std::vector<double> Places(const std::vector<PlacedJob>& jobs) {
  std::vector<double> places;
  for (const PlacedJob& job : jobs) places.push_back(job.place);
  return places;
}

TEST(QueueRules, APlaceLiesBetweenItsNeighbours) {
  EXPECT_EQ(PlaceBetween(1.0, 2.0, 9), 1.5);
  EXPECT_EQ(PlaceBetween(std::nullopt, 2.0, 9), 1.0);
  EXPECT_EQ(PlaceBetween(4.0, std::nullopt, 9), 9.5);  // 10 is the number of the next job
  EXPECT_EQ(PlaceBetween(9.5, std::nullopt, 9), 9.75);
  EXPECT_EQ(PlaceBetween(std::nullopt, std::nullopt, 0), 0.5);
  const double next = std::nextafter(1.0, 2.0);
  EXPECT_EQ(PlaceBetween(1.0, next, 9), std::nullopt);
  EXPECT_EQ(PlaceBetween(1.0, 1.0, 9), std::nullopt);
  EXPECT_EQ(PlaceBetween(std::nextafter(10.0, 0.0), std::nullopt, 9), std::nullopt);
}

// The moved ones around the place, with the new one among them, part the way between 1 and 3 into
// equal shares; those behind 3 stay.
TEST(QueueRules, MovedJobsAreSpreadBetweenThoseThatWereNot) {
  const std::vector<PlacedJob> line = {Plain(1), At(7, 2.9), At(8, 2.99), Plain(3), At(9, 3.5)};
  const auto spread = Spread(line, 2, 5, 9);
  ASSERT_EQ(spread.size(), 3U);
  EXPECT_EQ(spread[0].job, 7);
  EXPECT_EQ(spread[1].job, 8);
  EXPECT_EQ(spread[2].job, 5);
  EXPECT_THAT(Places(spread), ElementsAre(1.5, 2.5, 2.0));
}

// In front of one that stands at its number, of all, and behind all: below the next number, 10.
TEST(QueueRules, TheEndsOfALineHaveRoom) {
  EXPECT_THAT(Places(Spread(std::vector{Plain(1), Plain(2)}, 1, 5, 9)), ElementsAre(1.5));
  EXPECT_THAT(Places(Spread(std::vector{At(7, 1.0), Plain(2)}, 0, 5, 9)),
              ElementsAre(1.0, 0.0));  // between -1 and 2
  EXPECT_THAT(Places(Spread(std::vector{Plain(8), At(7, 9.9)}, 2, 5, 9)),
              ElementsAre(8.0 + 2.0 / 3.0, 10.0 - 2.0 / 3.0));
  EXPECT_THAT(Places(Spread({}, 0, 5, 9)), ElementsAre(9.5));
}

// records.h kPriorityMin, kPriorityMax.
TEST(JobRules, WhatANewJobHas) {
  EXPECT_TRUE(CheckNewJob({.attempts_max = 1, .priority = -100}));
  EXPECT_TRUE(CheckNewJob({.priority = 100}));
  EXPECT_EQ(CheckNewJob({.attempts_max = 0}).error().detail, "a job needs at least one attempt");
  for (const int priority : {-101, 101}) {
    const Status refused = CheckNewJob({.priority = priority});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(refused.error().detail,
              "priority is " + std::to_string(priority) + ", allowed are -100 to 100");
  }
}

TEST(JobRules, EventsHaveASize) {
  const std::string largest(kEventPayloadBytesMax, 'x');
  EXPECT_TRUE(CheckEventSizes({{.payload = largest}, {.payload = ""}}));
  const Status refused = CheckEventSizes({{.payload = ""}, {.payload = largest + "x"}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(refused.error().detail,
            "an event of " + std::to_string(kEventPayloadBytesMax + 1) + " bytes");
}

TEST(JobRules, ALeaseLastsAYearAndADayAtMost) {
  const WallTime now{std::chrono::seconds(100)};
  using std::chrono::milliseconds;
  constexpr milliseconds kLongest = std::chrono::days(366);
  EXPECT_EQ(LeaseEnd(now, milliseconds(-1)), now);
  EXPECT_EQ(LeaseEnd(now, milliseconds(1)), now + milliseconds(1));
  EXPECT_EQ(LeaseEnd(now, kLongest), now + kLongest);
  EXPECT_EQ(LeaseEnd(now, kLongest + milliseconds(1)), now + kLongest);
}

TEST(JobRules, OnlyWhatHasEndedIsRemoved) {
  JobRecord job{.id = 7};
  for (const JobState state : {JobState::kQueued, JobState::kRunning}) {
    job.state = state;
    const Status refused = CheckRemoval(job);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kCellPrecondition);
    EXPECT_EQ(refused.error().detail, "job 7 has not ended; cancel it first");
  }
  for (const JobState state :
       {JobState::kSucceeded, JobState::kFailed, JobState::kCancelled, JobState::kInterrupted}) {
    job.state = state;
    EXPECT_TRUE(CheckRemoval(job));
  }
}

TEST(QueueRules, WhatKeepsAJobFromItsTurn) {
  const WallTime now{std::chrono::seconds(100)};
  const WallTime later = now + std::chrono::microseconds(1);
  EXPECT_EQ(BlockedAtFirst({}, false, now), 0);
  EXPECT_EQ(BlockedAtFirst({.held = true}, false, now), kBlockedByHold);
  EXPECT_EQ(BlockedAtFirst({.not_before = now}, false, now), 0);
  EXPECT_EQ(BlockedAtFirst({.not_before = later}, false, now), kBlockedByTime);
  EXPECT_EQ(BlockedAtFirst({}, true, now), kBlockedByJobs);
  const int all = kBlockedByHold | kBlockedByTime | kBlockedByJobs;
  EXPECT_EQ(BlockedAtFirst({.held = true, .not_before = later}, true, now), all);
  EXPECT_EQ(BlockedWhenLetGo(all, true), kBlockedByTime | kBlockedByJobs);
  EXPECT_EQ(BlockedWhenLetGo(all, false), kBlockedByTime);
  EXPECT_EQ(BlockedWhenLetGo(kBlockedByHold, false), 0);
}

TEST(QueueRules, WhereAJobMayGo) {
  const JobRecord job{.id = 4, .kind = "CHECK", .pool = "p"};
  const JobRecord before{.id = 5, .kind = "CHECK", .pool = "p", .priority = 3};
  for (const int priority : {-100, 100}) EXPECT_TRUE(CheckMove(job, nullptr, priority));
  EXPECT_TRUE(CheckMove(job, nullptr, {}));
  EXPECT_TRUE(CheckMove(job, &before, {}));
  EXPECT_TRUE(CheckMove(job, &before, 3));
  const auto refused = [](const JobRecord& moved, const JobRecord* other,
                          std::optional<int> priority) {
    const Status may = CheckMove(moved, other, priority);
    return may ? "" : CodeText(may.error().code) + ": " + std::string(may.error().detail);
  };
  const std::string invalid = CodeText(ErrorCode::kCellInvalidArgument) + ": ";
  const std::string precondition = CodeText(ErrorCode::kCellPrecondition) + ": ";
  for (const int priority : {-101, 101}) {
    EXPECT_EQ(refused(job, nullptr, priority),
              invalid + "priority is " + std::to_string(priority) + ", allowed are -100 to 100");
  }
  EXPECT_EQ(refused(job, &job, {}), invalid + "a job cannot stand in front of itself");
  EXPECT_EQ(refused(job, &before, 4), invalid + "in front of a job another one has its priority");
  JobRecord other = before;
  other.pool = "q";
  EXPECT_EQ(refused(job, &other, {}), precondition + "job 5 waits for another kind of worker");
  other = before;
  other.kind = "SIMULATE";
  EXPECT_EQ(refused(job, &other, {}), precondition + "job 5 waits for another kind of worker");
  other = before;
  other.state = JobState::kRunning;
  EXPECT_EQ(refused(job, &other, {}), precondition + "job 5 does not wait in the queue");
  EXPECT_EQ(refused(other, nullptr, {}), precondition + "job 5 does not wait in the queue");
}

TEST(QueueRules, WhatAJobWaitsForFirst) {
  const WallTime now{std::chrono::seconds(100)};
  JobRecord job{
      .kind = "RUN", .held = true, .not_before = now + std::chrono::seconds(1), .after = {4}};
  EXPECT_EQ(FirstWait(job, now), WaitReason::kHeld);
  job.held = false;
  EXPECT_EQ(FirstWait(job, now), WaitReason::kAfterJob);
  job.after.clear();
  EXPECT_EQ(FirstWait(job, now), WaitReason::kNotBefore);
  EXPECT_EQ(FirstWait(job, now + std::chrono::seconds(1)), WaitReason::kMachineBusy);
  job.kind = "CHECK";
  EXPECT_EQ(FirstWait(job, now + std::chrono::seconds(1)), WaitReason::kNone);
}

TEST(QueueRules, WhichJobsAreAwaited) {
  EXPECT_FALSE(*MustAwait(4, JobState::kSucceeded));
  EXPECT_TRUE(*MustAwait(4, JobState::kQueued));
  EXPECT_TRUE(*MustAwait(4, JobState::kRunning));
  for (const JobState state : {JobState::kFailed, JobState::kCancelled, JobState::kInterrupted})
    EXPECT_EQ(MustAwait(4, state).error().code, ErrorCode::kCellPrecondition);
}

// An attempt that does not count is taken off, eight times at most; the machine of a RUN may have
// moved, so it is interrupted, also where a cancel was wanted.
TEST(JobRules, WhatBecomesOfAJobWhoseHolderIsGone) {
  const LossPolicy counts{.cancelled = {{.kind = "cancelled"}}};
  const LossPolicy never_began{.counts = false};
  JobRecord job{.kind = "SIMULATE", .attempts = 1, .attempts_max = 2};
  EXPECT_EQ(LoseAttempt(job, 1, counts), AfterLoss::kQueued);
  job.attempts = 2;
  EXPECT_EQ(LoseAttempt(job, 2, counts), AfterLoss::kEnded);
  EXPECT_EQ(LoseAttempt(job, 2, never_began), AfterLoss::kQueued);
  EXPECT_EQ(job.attempts, 1);
  job.attempts = 2;
  EXPECT_EQ(LoseAttempt(job, 2 + kUncountedAttemptsMax, never_began), AfterLoss::kEnded);
  EXPECT_EQ(job.attempts, 2);
  job.cancel_requested = true;
  EXPECT_EQ(LoseAttempt(job, 2, counts), AfterLoss::kCancelled);
  EXPECT_EQ(LoseAttempt(job, 2, LossPolicy{}), AfterLoss::kEnded);  // nothing to say of a cancel
  job.kind = "RUN";
  EXPECT_EQ(LoseAttempt(job, 2, counts), AfterLoss::kInterrupted);
  EXPECT_FALSE(HandBackAttempt(job, {}));
  EXPECT_EQ(job.attempts, 2);
  EXPECT_TRUE(HandBackAttempt(job, {.not_begun = true}));
  EXPECT_EQ(job.attempts, 1);
  job.attempts = 2;
  job.kind = "CHECK";
  EXPECT_TRUE(HandBackAttempt(job, {}));
  EXPECT_EQ(job.attempts, 1);
}

TEST(JobRules, ALeaseHasOneHolder) {
  const Lease lease{.job = 4, .attempt = 2, .fence = 7, .worker = "a"};
  EXPECT_TRUE(CheckHolder(lease, lease));
  EXPECT_EQ(CheckHolder(lease, std::nullopt).error().detail, "job 4 is not leased");
  for (const Lease& other : {Lease{.job = 4, .attempt = 2, .fence = 8, .worker = "b"},
                             Lease{.job = 4, .attempt = 3, .fence = 7, .worker = "b"}}) {
    const Status refused = CheckHolder(lease, other);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kCellLeaseLost);
    EXPECT_EQ(refused.error().detail,
              "job 4 is leased to b as attempt " + std::to_string(other.attempt));
  }
}

}  // namespace
}  // namespace rmlcell::storage
