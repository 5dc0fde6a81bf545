// Where jobs come to stand that are moved, and what becomes of those that are lost.
#include <gtest/gtest.h>

#include <span>
#include <utility>
#include <vector>

#include "storage/jobs/job_rules.h"
#include "storage/jobs/queue_rules.h"

namespace rmlcell::storage {
namespace {

PlacedJob MovedTo(std::int64_t job, double place) {
  return {.job = job, .place = place, .moved = true};
}
PlacedJob Unmoved(std::int64_t job) { return {.job = job, .place = static_cast<double>(job)}; }

// A line that begins with moved ones: all of them make room, below the first that nobody moved, and
// whoever has a new place was moved.
TEST(PlacedJobs, TheFirstOfALineMakesRoomToo) {
  const auto spread = Spread(std::vector{MovedTo(7, 1.0), MovedTo(8, 1.5), Unmoved(2)}, 2, 5, 9);
  ASSERT_EQ(spread.size(), 3u);
  EXPECT_EQ(spread[0].job, 7);
  EXPECT_EQ(spread[1].job, 8);
  EXPECT_EQ(spread[2].job, 5);
  EXPECT_DOUBLE_EQ(spread[1].place - spread[0].place, spread[2].place - spread[1].place);
  EXPECT_DOUBLE_EQ(2.0 - spread[2].place, spread[2].place - spread[1].place);
  EXPECT_GT(spread[1].place, spread[0].place);
  for (const PlacedJob& one : spread) EXPECT_TRUE(one.moved) << one.job;
}

// Those that did not count are the difference between all and those that did: six of nine here.
TEST(PlacedJobs, AttemptsThatDoNotCountAreThoseTakenOff) {
  JobRecord job{.kind = "CHECK", .attempts = 3, .attempts_max = 3};
  EXPECT_EQ(LoseAttempt(job, 9, {.counts = false}), AfterLoss::kQueued);
  EXPECT_EQ(job.attempts, 2);
  job.attempts = 3;
  EXPECT_EQ(LoseAttempt(job, 3 + kUncountedAttemptsMax, {.counts = false}), AfterLoss::kEnded);
  EXPECT_EQ(job.attempts, 3);
}

TEST(PlacedJobs, OutcomesOfWhatWasNotCarriedOut) {
  const JobOutcome cancelled = CancelledOutcome();
  EXPECT_EQ(cancelled.state, JobState::kCancelled);
  EXPECT_EQ(cancelled.code, ErrorCode::kCellCancelled);
  const JobOutcome interrupted =
      InterruptedOutcome({.outcome = {.state = JobState::kFailed, .detail = "it died"}});
  EXPECT_EQ(interrupted.state, JobState::kInterrupted);
  EXPECT_EQ(interrupted.detail, "it died");
  EXPECT_TRUE(CheckFinal({.state = JobState::kInterrupted}));
  const Status running = CheckFinal({.state = JobState::kRunning});
  ASSERT_FALSE(running);
  EXPECT_EQ(running.error().code, ErrorCode::kCellInvalidArgument);
}

// A line is a part of what is kept: what lies in front of it and behind is none of it, though it
// was moved, too.
TEST(PlacedJobs, WhatLiesAroundALineIsNoneOfIt) {
  const std::vector<PlacedJob> kept = {Unmoved(0), MovedTo(7, 0.25), Unmoved(1), Unmoved(2),
                                       MovedTo(8, 2.5)};
  const std::span<const PlacedJob> line = std::span(kept).subspan(2, 2);
  // The number of those that have a new place, and the place of the new one, which comes last.
  const auto placed = [](const std::vector<PlacedJob>& spread) {
    return std::pair(spread.size(), spread.back().place);
  };
  using Placed = std::pair<std::size_t, double>;
  EXPECT_EQ(placed(Spread(line, 0, 5, 9)), Placed(1, 0.5));           // between 0 and 1
  EXPECT_EQ(placed(Spread(line, 2, 5, 9)), Placed(1, 6.0));           // between 2 and 10
  EXPECT_EQ(placed(Spread(line.first(0), 0, 5, 9)), Placed(1, 9.5));  // between 9 and 10
}

}  // namespace
}  // namespace rmlcell::storage
