// WatchJob, as proto/rmlcell/v1/job.proto and docs/api.md ("Watching") have it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

// What the feed has read and not told yet it puts into the memory for those who begin to watch
// meanwhile: a part of what there is, or what is gone by now.
bool HasReadTheLog(StreamBed& room) {
  return Eventually([&] { return room.feed.position() == Must(room.bed.store().LastPosition()); });
}

class JobWatchTest : public testing::Test {
 protected:
  // What is told, in a word: "snapshot", "2 text", "3 ended", "at 7 steps", "come back".
  static std::string WordOf(const v1::WatchJobResponse& message) {
    EXPECT_EQ(message.instance_id(), StreamBed::kInstance);
    if (message.has_event() || message.has_progress()) {
      EXPECT_EQ(message.sequence(), message.has_event() ? message.event().sequence() : 0);
    }
    if (message.has_snapshot()) return "snapshot";
    if (message.has_progress())
      return "at " + std::to_string(message.progress().steps()) + " steps";
    if (message.has_event()) {
      const v1::JobEvent& event = message.event();
      const std::string what = event.has_ended()     ? "ended"
                               : event.has_message() ? event.message().text()
                                                     : "state";
      return std::to_string(event.sequence()) + " " + what;
    }
    return message.what_case() == v1::WatchJobResponse::kReconnect ? "come back" : "nothing";
  }
  static std::vector<std::string> Words(const std::vector<v1::WatchJobResponse>& messages) {
    std::vector<std::string> words;
    for (const v1::WatchJobResponse& message : messages) words.push_back(WordOf(message));
    return words;
  }
  static std::string NextOf(OpenedStream<v1::WatchJobResponse>& stream) {
    return WordOf(stream.Next());
  }

  StreamBed room;
};

TEST_F(JobWatchTest, ASnapshotFirstThenEveryEventInOrderUpToTheEndOfTheJob) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  room.Say(lease, {"a", "b"});
  auto watch = room.Watch(job);
  const v1::WatchJobResponse first = watch.Next();
  EXPECT_EQ(WordOf(first), "snapshot");
  EXPECT_EQ(first.snapshot().name(), JobName(job));
  EXPECT_EQ(first.snapshot().state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(first.snapshot().last_sequence(), 3);
  EXPECT_EQ(NextOf(watch), "1 state");
  EXPECT_EQ(NextOf(watch), "2 a");
  EXPECT_EQ(NextOf(watch), "3 b");
  room.Say(lease, {"c"});  // while it is watched
  EXPECT_EQ(NextOf(watch), "4 c");
  room.Finish(lease);
  EXPECT_THAT(Words(watch.Rest()), ElementsAre("5 ended"));
  watch.ExpectGoodEnd();
}

// More than are read from the log at once.
TEST_F(JobWatchTest, OfManyEventsEachIsToldOnce) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  std::vector<std::string> texts, words{"snapshot", "1 state"};
  for (int i = 2; i < 202; ++i) {
    texts.push_back("x");
    words.push_back(std::to_string(i) + " x");
  }
  room.Say(lease, texts);
  room.Finish(lease);
  words.push_back("202 ended");
  auto watch = room.Watch(job);
  EXPECT_EQ(Words(watch.Rest()), words);
  watch.ExpectGoodEnd();
}

TEST_F(JobWatchTest, GoesOnAfterTheSequenceThatTheClientHas) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  room.Say(lease, {"a", "b"});
  {
    auto watch = room.Watch(job, 2);
    const v1::WatchJobResponse first = watch.Next();
    EXPECT_EQ(WordOf(first), "snapshot");
    EXPECT_EQ(first.sequence(), 2);  // to go on after, should the line break before the next event
    EXPECT_EQ(NextOf(watch), "3 b");
  }
  auto watch = room.Watch(job, 3);  // the last one: what comes next is waited for
  EXPECT_EQ(NextOf(watch), "snapshot");
  room.Finish(lease);
  EXPECT_THAT(Words(watch.Rest()), ElementsAre("4 ended"));
  watch.ExpectGoodEnd();
}

TEST_F(JobWatchTest, AJobThatHasEndedIsToldToItsEnd) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  room.Say(lease, {"a"});
  room.Finish(lease);
  auto from_the_second = room.Watch(job, 1);
  EXPECT_THAT(Words(from_the_second.Rest()), ElementsAre("snapshot", "2 a", "3 ended"));
  from_the_second.ExpectGoodEnd();
  // Nothing is left to be told: it does not wait for what never comes.
  auto from_the_last = room.Watch(job, 3);
  EXPECT_THAT(Words(from_the_last.Rest()), ElementsAre("snapshot"));
  from_the_last.ExpectGoodEnd();
}

// It comes of another cell, or of before a backup was put back: told, and nothing else.
TEST_F(JobWatchTest, ASequenceThatTheJobDoesNotHaveIsRefused) {
  const std::int64_t job = room.Submit();
  room.Say(room.bed.Lease(), {"a"});
  auto below = room.Watch(job, -1);
  below.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "after_sequence is below 0");
  auto beyond = room.Watch(job, 3);
  beyond.ExpectRefused(
      grpc::StatusCode::INVALID_ARGUMENT,
      "after_sequence is 3, the last event of the job is 2: begin anew, with a snapshot");
}

// Numbers of jobs begin at 1 in each log: of a log that was put back another job may have them.
TEST_F(JobWatchTest, ANumberOfAnotherLogIsRefused) {
  const std::int64_t job = room.Submit();
  room.Say(room.bed.Lease(), {"a", "b"});
  v1::WatchJobRequest request;
  request.set_name(JobName(job));
  request.set_after_sequence(2);
  request.set_log_id(room.bed.store().LogId());
  {
    auto watch = room.Watch(request);
    const v1::WatchJobResponse first = watch.Next();
    EXPECT_EQ(first.log_id(), room.bed.store().LogId());
    const v1::WatchJobResponse second = watch.Next();
    EXPECT_EQ(WordOf(second), "3 b");
    EXPECT_EQ(second.log_id(), room.bed.store().LogId());
  }
  request.set_log_id("another");
  auto refused = room.Watch(request);
  refused.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "of another log");
  request.clear_after_sequence();  // from now on: it has no number
  {
    auto watch = room.Watch(request);
    EXPECT_EQ(NextOf(watch), "snapshot");
  }
  request.set_after_sequence(0);  // from the first on: whatever log it was
  auto watch = room.Watch(request);
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(NextOf(watch), "1 state");
}

TEST_F(JobWatchTest, WhatIsNoJobIsRefused) {
  auto unknown = room.Watch(7);
  unknown.ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E9004");
  v1::WatchJobRequest request;
  request.set_name("job 7");
  auto misnamed = room.Watch(request);
  misnamed.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

// Events that are no longer kept cannot be told: the number from which they are there is.
TEST(JobWatchOfAShortLog, EventsThatAreGoneAreSaidToBeGone) {
  StreamBed room({.keep_events = 10});
  const std::int64_t job = room.Submit();
  room.Say(room.bed.Lease(), std::vector<std::string>(50, "x"));
  ASSERT_TRUE(Eventually([&] { return Must(room.bed.store().GetJob(job)).events_gone_until > 1; }));
  ASSERT_TRUE(HasReadTheLog(room));
  auto watch = room.Watch(job, 1);
  EXPECT_TRUE(watch.Next().has_snapshot());
  watch.ExpectRefused(grpc::StatusCode::OUT_OF_RANGE, "CELL-E9021");
}

TEST_F(JobWatchTest, PositionsComeWhenNoEventIsToBeTold) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  room.Say(lease, {"a"});
  room.TellSteps(job, 7);
  auto watch = room.Watch(job);
  for (const char* word : {"snapshot", "1 state", "2 a", "at 7 steps"})
    EXPECT_EQ(NextOf(watch), word);
  room.Say(lease, {"b"});
  EXPECT_EQ(NextOf(watch), "3 b");  // the same position is not told twice
  room.TellSteps(job, 8);
  EXPECT_EQ(NextOf(watch), "at 8 steps");
  room.Finish(lease);
  EXPECT_THAT(Words(watch.Rest()), ElementsAre("4 ended"));
  watch.ExpectGoodEnd();
}

TEST_F(JobWatchTest, PositionsAreLeftOutWhereOnlyEventsAreWanted) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  room.TellSteps(job, 7);
  auto watch = room.Watch(job, 0, true);
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(NextOf(watch), "1 state");
  room.TellSteps(job, 8);
  room.Say(lease, {"a"});
  EXPECT_EQ(NextOf(watch), "2 a");
  room.Finish(lease);
  EXPECT_THAT(Words(watch.Rest()), ElementsAre("3 ended"));
  watch.ExpectGoodEnd();
}

// What it has read it tells, of a job that is deleted meanwhile, too: 64 events, which is all that
// a watch ever holds. A client that does not read lets it read no more.
TEST_F(JobWatchTest, OfAJobThatIsDeletedItTellsWhatItHas) {
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  room.Say(lease, std::vector<std::string>(100, std::string(10'000, 'x')));
  room.Finish(lease);
  ASSERT_TRUE(HasReadTheLog(room));
  auto watch = room.Watch(job);
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(NextOf(watch), "1 state");
  ASSERT_TRUE(room.bed.store().DeleteJob(job, "anna"));
  ASSERT_TRUE(HasReadTheLog(room));
  EXPECT_EQ(watch.Rest().size(), 63U);
  watch.ExpectRefused(grpc::StatusCode::NOT_FOUND, "CELL-E");
}

TEST_F(JobWatchTest, AServerThatStopsSaysWhereToGoOn) {
  const std::int64_t job = room.Submit();
  room.Say(room.bed.Lease(), {"a", "b"});
  auto watch = room.Watch(job, 1);
  for (const char* word : {"snapshot", "2 a", "3 b"}) EXPECT_EQ(NextOf(watch), word);
  room.open.StopAll();
  const v1::WatchJobResponse goodbye = watch.Next();
  EXPECT_EQ(WordOf(goodbye), "come back");
  EXPECT_EQ(goodbye.sequence(), 3);
  EXPECT_EQ(goodbye.log_id(), room.bed.store().LogId());
  EXPECT_EQ(goodbye.reconnect().after().nanos(), 250'000'000);
  watch.ExpectRefused(grpc::StatusCode::UNAVAILABLE, "CELL-E9002");
  // A watch that begins now gets no further than it was.
  auto late = room.Watch(job, 2);
  const v1::WatchJobResponse last_word = late.Next();
  EXPECT_TRUE(last_word.has_reconnect());
  EXPECT_EQ(last_word.sequence(), 2);
  late.ExpectRefused(grpc::StatusCode::UNAVAILABLE, "the server stops");
}

TEST_F(JobWatchTest, AClientThatIsGoneLeavesNoStream) {
  const std::int64_t job = room.Submit();
  auto watch = room.Watch(job);
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(room.open.count(), 1U);
  watch.Cancel();
  EXPECT_TRUE(Eventually([&] { return room.open.count() == 0; }));
}

}  // namespace
}  // namespace rmlcell::server
