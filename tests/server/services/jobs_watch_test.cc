// WatchJobs, as proto/rmlcell/v1/job.proto and docs/api.md ("Watching") have it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "server/base/names.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using WatchedCell = OpenedStream<v1::WatchJobsResponse>;

class JobsWatchTest : public testing::Test {
 protected:
  // Two running jobs: positions 1 and 2 of the log are that they were submitted.
  JobsWatchTest() {
    for (const auto& [job, lease] : {std::pair{&one, &lease_one}, {&two, &lease_two}}) {
      *job = room.Submit();
      *lease = room.bed.Lease();
    }
  }
  static v1::WatchJobsRequest After(std::int64_t sequence, bool events_only = true) {
    v1::WatchJobsRequest request;
    request.set_after_sequence(sequence);
    request.set_events_only(events_only);
    return request;
  }
  // What is told: the position in the log, the job and what happened to it; "jobs/1 at 7 steps".
  static std::string NextOf(WatchedCell& stream) {
    const v1::WatchJobsResponse message = stream.Next();
    EXPECT_EQ(message.instance_id(), StreamBed::kInstance);
    if (message.has_snapshot()) return "snapshot";
    if (message.has_progress()) {
      EXPECT_EQ(message.sequence(), 0);
      return message.progress().job() + " at " + std::to_string(message.progress().steps()) +
             " steps";
    }
    if (!message.has_event()) return "nothing";
    const v1::JobEvent& event = message.event();
    return std::to_string(message.sequence()) + " " + event.job() + " " +
           (event.has_ended()     ? "ended"
            : event.has_message() ? event.message().text()
                                  : "state");
  }

  StreamBed room;
  std::int64_t one = 0;
  std::int64_t two = 0;
  storage::Lease lease_one;
  storage::Lease lease_two;
};

TEST_F(JobsWatchTest, ASnapshotOfTheCellFirst) {
  auto watch = room.WatchAll(After(0));
  const v1::WatchJobsResponse first = watch.Next();
  ASSERT_TRUE(first.has_snapshot());
  EXPECT_EQ(first.instance_id(), StreamBed::kInstance);
  EXPECT_EQ(first.sequence(), 2);  // to go on after, should the line break before the first event
  const v1::JobsSnapshot& cell = first.snapshot();
  EXPECT_EQ(cell.sequence(), 2);
  ASSERT_EQ(cell.jobs_size(), 2);  // the newest first
  EXPECT_EQ(cell.jobs(0).name(), JobName(two));
  EXPECT_EQ(cell.jobs(1).name(), JobName(one));
  ASSERT_EQ(cell.machines_size(), 2);  // by id
  EXPECT_EQ(cell.machines(0).name(), "machines/mill-1");
  EXPECT_EQ(cell.machines(1).name(), "machines/optimo-1");
}

// A browser comes back with the number of the last message it got, and that may be the snapshot.
TEST_F(JobsWatchTest, WhoComesBackBeforeTheFirstEventMissesNone) {
  std::int64_t seen = 0;
  {
    auto watch = room.WatchAll(After(0));
    seen = watch.Next().sequence();
  }
  room.Say(lease_two, {"a"});
  auto again = room.WatchAll(After(seen));
  EXPECT_EQ(NextOf(again), "snapshot");
  EXPECT_EQ(NextOf(again), "3 jobs/2 a");
  // The snapshot of a resumed watch names what the client has, not what the cell has by now.
  auto resumed = room.WatchAll(After(1));
  EXPECT_EQ(resumed.Next().sequence(), 1);
}

TEST_F(JobsWatchTest, TheSnapshotSaysWhichMachinesWork) {
  room.Submit();  // waits
  auto watch = room.WatchAll(After(0));
  const v1::JobsSnapshot cell = watch.Next().snapshot();
  const std::string machine = cell.jobs(0).machine();
  ASSERT_EQ(cell.machines_size(), 2);
  for (const v1::Machine& one_of_them : cell.machines()) {
    const bool busy = one_of_them.name() == machine;
    EXPECT_EQ(one_of_them.status().jobs_active(), busy ? 3 : 0) << one_of_them.name();
    EXPECT_EQ(one_of_them.status().state(),
              busy ? v1::MACHINE_STATE_RUNNING : v1::MACHINE_STATE_IDLE);
    EXPECT_EQ(one_of_them.status().simulating_job(), busy ? JobName(one) : "");
  }
}

TEST_F(JobsWatchTest, WithoutASequenceOnlyWhatComesFromNowOnIsTold) {
  auto watch = room.WatchAll(After(0));
  EXPECT_EQ(NextOf(watch), "snapshot");
  room.Say(lease_two, {"a"});
  room.Say(lease_one, {"b"});
  EXPECT_EQ(NextOf(watch), "3 jobs/2 a");
  EXPECT_EQ(NextOf(watch), "4 jobs/1 b");
  room.Finish(lease_one);  // the end of a job does not end it
  EXPECT_EQ(NextOf(watch), "5 jobs/1 ended");
  room.Say(lease_two, {"c"});
  EXPECT_EQ(NextOf(watch), "6 jobs/2 c");
}

TEST_F(JobsWatchTest, GoesOnAfterTheSequenceThatTheClientHas) {
  std::vector<std::string> texts(150, "x");  // more than are read from the log at once
  room.Say(lease_one, texts);
  room.Say(lease_two, {"a"});
  auto watch = room.WatchAll(After(1));
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(NextOf(watch), "2 jobs/2 state");
  for (int position = 3; position < 153; ++position)
    EXPECT_EQ(NextOf(watch), std::to_string(position) + " jobs/1 x");
  EXPECT_EQ(NextOf(watch), "153 jobs/2 a");
}

TEST_F(JobsWatchTest, ASequenceThatTheCellDoesNotHaveIsRefused) {
  auto below = room.WatchAll(After(-1));
  below.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "after_sequence is below 0");
  auto beyond = room.WatchAll(After(3));
  beyond.ExpectRefused(
      grpc::StatusCode::INVALID_ARGUMENT,
      "after_sequence is 3, the last event of the cell is 2: begin anew, with a snapshot");
  auto last = room.WatchAll(After(2));
  EXPECT_EQ(NextOf(last), "snapshot");
}

TEST_F(JobsWatchTest, WithNamesOnlyThoseJobsAreTold) {
  room.Say(lease_one, {"a"});
  room.Say(lease_two, {"b"});
  room.TellSteps(one, 7);
  room.TellSteps(two, 8);
  v1::WatchJobsRequest request = After(1, false);
  request.add_names(JobName(two));
  auto watch = room.WatchAll(request);
  for (const char* word : {"snapshot", "2 jobs/2 state", "4 jobs/2 b", "jobs/2 at 8 steps"})
    EXPECT_EQ(NextOf(watch), word);
  room.Say(lease_one, std::vector<std::string>(100, "x"));
  room.Say(lease_two, {"c"});
  EXPECT_EQ(NextOf(watch), "105 jobs/2 c");
  request.add_names("machines/mill-1");
  auto misnamed = room.WatchAll(request);
  misnamed.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
}

TEST_F(JobsWatchTest, PositionsOfAllJobsInTheOrderOfTheirChange) {
  room.TellSteps(two, 5);
  room.TellSteps(one, 6);
  auto watch = room.WatchAll(After(2, false));
  for (const char* word : {"snapshot", "jobs/2 at 5 steps", "jobs/1 at 6 steps"})
    EXPECT_EQ(NextOf(watch), word);
  room.TellSteps(two, 9);
  EXPECT_EQ(NextOf(watch), "jobs/2 at 9 steps");
}

TEST_F(JobsWatchTest, PositionsAreLeftOutWhereOnlyEventsAreWanted) {
  room.TellSteps(one, 5);
  auto watch = room.WatchAll(After(1));
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(NextOf(watch), "2 jobs/2 state");
  room.TellSteps(one, 6);
  room.Say(lease_one, {"a"});
  EXPECT_EQ(NextOf(watch), "3 jobs/1 a");
}

TEST_F(JobsWatchTest, AServerThatStopsSaysWhereToGoOn) {
  auto watch = room.WatchAll(After(1));
  EXPECT_EQ(NextOf(watch), "snapshot");
  EXPECT_EQ(NextOf(watch), "2 jobs/2 state");
  auto fresh = room.WatchAll(After(0));
  EXPECT_EQ(NextOf(fresh), "snapshot");
  room.open.StopAll();
  for (WatchedCell* stream : {&watch, &fresh}) {
    const v1::WatchJobsResponse goodbye = stream->Next();
    EXPECT_EQ(goodbye.instance_id(), StreamBed::kInstance);
    EXPECT_EQ(goodbye.sequence(), 2);
    EXPECT_EQ(goodbye.reconnect(), "the server stops; watch again after sequence 2");
    stream->ExpectRefused(grpc::StatusCode::UNAVAILABLE, "CELL-E9002");
  }
}

}  // namespace
}  // namespace rmlcell::server
