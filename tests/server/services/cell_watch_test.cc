// WatchCell, as proto/rmlcell/v1/cell.proto and docs/api.md ("Watching") have it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "server/base/names.h"
#include "server/base/steady_clock.h"
#include "tests/server/services/stream_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using WatchedCell = OpenedStream<v1::WatchCellResponse>;

v1::WatchCellRequest Of(const std::vector<std::string>& parts, bool events_only = true) {
  v1::WatchCellRequest request;
  for (const std::string& part : parts) {
    v1::Subscription& subscription = *request.add_subscriptions();
    subscription.set_id(part);
    if (part == "jobs") subscription.mutable_jobs()->set_events_only(events_only);
    if (part == "machines") subscription.mutable_machines()->set_events_only(events_only);
    if (part == "projects") subscription.mutable_projects();
  }
  return request;
}

std::string RecordWord(v1::RecordChange change) {
  return change == v1::RECORD_CHANGE_CREATED   ? " created"
         : change == v1::RECORD_CHANGE_UPDATED ? " updated"
         : change == v1::RECORD_CHANGE_DELETED ? " deleted"
                                               : " ?";
}

// What an event tells, without its number: "jobs/1 state".
std::string WordOf(const v1::CellEvent& event) {
  if (event.has_job()) {
    return event.resource() + (event.job().has_ended()     ? " ended"
                               : event.job().has_message() ? " " + event.job().message().text()
                                                           : " state");
  }
  if (event.has_machine()) return event.resource() + RecordWord(event.machine().changed().change());
  if (event.has_program()) return event.resource() + RecordWord(event.program().change());
  if (event.has_project()) return event.resource() + RecordWord(event.project().change());
  if (event.job_deleted()) return event.resource() + " gone";
  return event.resource() + " ?";
}

// The next message: "snapshot", "jobs/1 state", "jobs/1 at 7 steps", with the subscriptions that it
// is for where these are more than one.
std::string WordOf(const v1::WatchCellResponse& message) {
  EXPECT_EQ(message.instance_id(), StreamBed::kInstance);
  EXPECT_NE(message.log_id(), "");
  std::string word = "nothing";
  if (message.has_snapshot()) word = "snapshot of " + message.subscriptions(0);
  if (message.has_event()) word = WordOf(message.event());
  if (message.has_progress())
    word =
        message.progress().job() + " at " + std::to_string(message.progress().steps()) + " steps";
  if (message.has_status())
    word = message.status().machine() + " " +
           v1::MachineState_Name(message.status().state()).substr(14);
  if (message.has_bookmark()) word = "bookmark";
  if (message.has_gap()) word = v1::Gap::Reason_Name(message.gap().reason());
  if (message.has_reconnect()) word = "come back";
  return word;
}

std::string NextOf(WatchedCell& stream) { return WordOf(stream.Next()); }

class CellWatchTest : public testing::Test {
 protected:
  // Two running jobs.
  CellWatchTest() {
    for (const auto& [job, lease] : {std::pair{&one, &lease_one}, {&two, &lease_two}}) {
      *job = room.Submit();
      *lease = room.bed.Lease();
    }
    last = Must(room.bed.store().LastPosition());
    // What the feed has not read yet would be told later than what stands for now.
    EXPECT_TRUE(Eventually([this] { return room.feed.position() >= last; }));
  }
  v1::WatchCellRequest After(std::int64_t sequence,
                             const std::vector<std::string>& parts = {"jobs"},
                             bool events_only = true) {
    v1::WatchCellRequest request = Of(parts, events_only);
    request.set_after_sequence(sequence);
    request.set_log_id(room.bed.store().LogId());
    return request;
  }

  StreamBed room;
  std::int64_t one = 0;
  std::int64_t two = 0;
  storage::Lease lease_one;
  storage::Lease lease_two;
  std::int64_t last = 0;  // position of the newest event
};

TEST_F(CellWatchTest, BeginsWithASnapshotOfEachSubscription) {
  auto watch = room.WatchCell(Of({"jobs", "machines", "projects"}));
  const v1::WatchCellResponse jobs = watch.Next();
  EXPECT_THAT(jobs.subscriptions(), ElementsAre("jobs"));
  EXPECT_EQ(jobs.sequence(), last);  // to go on after, should the line break before the first event
  EXPECT_EQ(jobs.watch_id().size(), 32U);
  EXPECT_EQ(jobs.watch_id().find_first_not_of("0123456789abcdef"), std::string::npos);
  ASSERT_EQ(jobs.snapshot().jobs_size(), 2);  // the newest first
  EXPECT_EQ(jobs.snapshot().jobs(0).name(), JobName(two));
  EXPECT_EQ(jobs.snapshot().jobs(1).name(), JobName(one));
  ASSERT_EQ(jobs.snapshot().counts_size(), 1);
  EXPECT_EQ(jobs.snapshot().counts(0).state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(jobs.snapshot().counts(0).jobs(), 2);
  const v1::WatchCellResponse machines = watch.Next();
  EXPECT_THAT(machines.subscriptions(), ElementsAre("machines"));
  EXPECT_EQ(machines.watch_id(), "");                 // in the first message only
  ASSERT_EQ(machines.snapshot().machines_size(), 2);  // by id
  EXPECT_EQ(machines.snapshot().machines(0).name(), "machines/mill-1");
  EXPECT_EQ(machines.snapshot().machines(0).status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(machines.snapshot().machines(1).name(), "machines/optimo-1");
  EXPECT_EQ(machines.snapshot().machines(1).status().state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(machines.snapshot().machines(1).status().jobs_active(), 2);
  EXPECT_EQ(machines.snapshot().machines(1).status().simulating_job(), JobName(one));
  EXPECT_EQ(NextOf(watch), "snapshot of projects");
}

TEST_F(CellWatchTest, WithoutSubscriptionsEverythingIsWatched) {
  auto watch = room.WatchCell({});
  for (const char* word : {"snapshot of jobs", "snapshot of machines", "snapshot of projects"})
    EXPECT_EQ(NextOf(watch), word);
}

// One log over all resources: who did what, in the order in which it happened.
TEST_F(CellWatchTest, TellsOfEveryResource) {
  auto watch = room.WatchCell(Of({"jobs", "machines", "projects"}));
  for (int i = 0; i < 3; ++i) watch.Next();
  storage::Store& store = room.bed.store();
  Must(store.PutMachine({.id = "mill-9", .family = "rml1", .title = "New"}, 0, "berta"));
  Must(store.PutPrograms("mill-9", {{.slot = 3, .name = "p", .object = "IN;"}}, {}, "berta"));
  Must(store.PutProject({.id = "lid", .title = "Lid"}, 0));
  room.Say(lease_one, {"hello"});
  EXPECT_TRUE(store.DeleteMachine("mill-9", storage::kAnyRevision, "carl"));
  const v1::WatchCellResponse made = watch.Next();
  EXPECT_EQ(WordOf(made), "machines/mill-9 created");
  EXPECT_THAT(made.subscriptions(), ElementsAre("machines"));
  EXPECT_EQ(made.sequence(), last + 1);
  EXPECT_EQ(made.event().sequence(), last + 1);
  EXPECT_EQ(made.event().caller(), "berta");
  EXPECT_TRUE(made.event().has_time());
  EXPECT_EQ(NextOf(watch), "machines/mill-9/programs/3 created");
  const v1::WatchCellResponse project = watch.Next();
  EXPECT_EQ(WordOf(project), "projects/lid created");
  EXPECT_EQ(project.event().project().project().title(), "Lid");
  EXPECT_EQ(project.event().caller(), "");
  EXPECT_EQ(NextOf(watch), "jobs/1 hello");
  EXPECT_EQ(NextOf(watch), "machines/mill-9/programs/3 deleted");
  const v1::WatchCellResponse gone = watch.Next();
  EXPECT_EQ(WordOf(gone), "machines/mill-9 deleted");
  EXPECT_EQ(gone.event().caller(), "carl");
  EXPECT_EQ(gone.event().machine().changed().machine().name(), "machines/mill-9");
}

TEST_F(CellWatchTest, WhatARecordIsNowGoesWithItsEvent) {
  auto watch = room.WatchCell(Of({"machines"}));
  watch.Next();
  storage::Store& store = room.bed.store();
  Must(store.PutPrograms("optimo-1", {{.slot = 45, .name = "Lid", .object = "object"}},
                         {{.number = 7, .name = "thin", .mode = "CW", .power_percent = 40.0}}));
  const v1::Program program = watch.Next().event().program().program();
  EXPECT_EQ(program.title(), "Lid");
  EXPECT_EQ(program.object_bytes(), 6);
  EXPECT_EQ(program.etag(), "1");
  const v1::ProgramEvent schedule = watch.Next().event().program();
  EXPECT_EQ(schedule.change(), v1::RECORD_CHANGE_CREATED);
  EXPECT_EQ(schedule.laser_schedule().name(), "machines/optimo-1/laserSchedules/7");
  EXPECT_EQ(schedule.laser_schedule().power_percent(), 40.0);
  Must(store.PutExecutable("optimo-1", 45, 1, "executable"));
  const v1::ProgramEvent linked = watch.Next().event().program();
  EXPECT_EQ(linked.change(), v1::RECORD_CHANGE_UPDATED);
  EXPECT_EQ(linked.program().executable_bytes(), 10);
  EXPECT_TRUE(store.DeleteSchedule("optimo-1", 7));
  EXPECT_EQ(NextOf(watch), "machines/optimo-1/laserSchedules/7 deleted");
  storage::MachineRecord record = Must(store.GetMachine("mill-1"));
  record.title = "By the window";
  Must(store.PutMachine(record, record.revision));
  const v1::WatchCellResponse changed = watch.Next();
  EXPECT_EQ(WordOf(changed), "machines/mill-1 updated");
  EXPECT_EQ(changed.event().machine().changed().machine().title(), "By the window");
}

// A browser comes back with the number of the last message it got, and that may be the snapshot.
TEST_F(CellWatchTest, WhoComesBackBeforeTheFirstEventMissesNone) {
  std::int64_t seen = 0;
  {
    auto watch = room.WatchCell(Of({"jobs"}));
    seen = watch.Next().sequence();
  }
  room.Say(lease_two, {"a"});
  auto again = room.WatchCell(After(seen));
  const v1::WatchCellResponse first = again.Next();
  EXPECT_EQ(WordOf(first), "bookmark");
  EXPECT_EQ(first.sequence(), seen);
  EXPECT_NE(first.watch_id(), "");
  EXPECT_EQ(NextOf(again), "jobs/2 a");
}

TEST_F(CellWatchTest, GoesOnAfterTheSequenceThatTheClientHas) {
  room.Say(lease_one, std::vector<std::string>(150, "x"));  // more than are read at once
  room.Say(lease_two, {"a"});
  auto watch = room.WatchCell(After(last));
  EXPECT_EQ(NextOf(watch), "bookmark");
  for (int i = 1; i <= 150; ++i) {
    const v1::WatchCellResponse message = watch.Next();
    EXPECT_EQ(message.sequence(), last + i);
    EXPECT_EQ(WordOf(message), "jobs/1 x");
  }
  EXPECT_EQ(NextOf(watch), "jobs/2 a");
}

// 0: all that is kept, from the first event of the store on.
TEST_F(CellWatchTest, AfterNumberZeroTellsAllThatIsKept) {
  auto watch = room.WatchCell(After(0, {"jobs", "machines"}));
  EXPECT_EQ(NextOf(watch), "bookmark");
  EXPECT_EQ(NextOf(watch), "machines/optimo-1 created");
  EXPECT_EQ(NextOf(watch), "machines/mill-1 created");
  EXPECT_EQ(NextOf(watch), "jobs/1 state");
}

TEST_F(CellWatchTest, ANumberOfAnotherLogIsAGapAndASnapshotFollows) {
  v1::WatchCellRequest other = After(last);
  other.set_log_id("0198c5b2-0000-7000-8000-000000000000");
  v1::WatchCellRequest beyond = After(last + 1);
  v1::WatchCellRequest unnamed = After(last + 1);
  unnamed.clear_log_id();
  for (const v1::WatchCellRequest& request : {other, beyond, unnamed}) {
    auto watch = room.WatchCell(request);
    const v1::WatchCellResponse first = watch.Next();
    EXPECT_EQ(WordOf(first), "REASON_OTHER_LOG");
    EXPECT_EQ(first.sequence(), last);
    EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  }
  auto below = room.WatchCell(After(-1));
  below.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "after_sequence is below 0");
}

TEST(CellWatchOfAShortLog, EventsThatAreGoneAreAGapAndASnapshotFollows) {
  StreamBed room({.keep_events = 10});
  room.Submit();
  room.Say(room.bed.Lease(), std::vector<std::string>(50, "x"));
  storage::Store& store = room.bed.store();
  ASSERT_TRUE(Eventually([&] { return Must(store.EventsGoneUntil()) > 3; }));
  v1::WatchCellRequest request = Of({"jobs"});
  request.set_after_sequence(1);
  auto watch = room.WatchCell(request);
  EXPECT_EQ(NextOf(watch), "REASON_GONE");
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  // Ten are kept, and an eighth more; behind the last that is gone there is no gap.
  const std::int64_t last = Must(store.LastPosition());
  ASSERT_TRUE(Eventually([&] { return Must(store.EventsGoneUntil()) >= last - 11; }));
  request.set_after_sequence(Must(store.EventsGoneUntil()));
  auto behind = room.WatchCell(request);
  EXPECT_EQ(NextOf(behind), "bookmark");
  EXPECT_EQ(NextOf(behind), "jobs/1 x");
  // From the first that is kept, without a gap.
  request.set_after_sequence(0);
  auto whole = room.WatchCell(request);
  EXPECT_EQ(NextOf(whole), "bookmark");
  EXPECT_EQ(NextOf(whole), "jobs/1 x");
}

TEST_F(CellWatchTest, AnEventForSeveralSubscriptionsIsToldOnce) {
  v1::WatchCellRequest request = Of({"jobs"});
  v1::Subscription& named = *request.add_subscriptions();
  named.set_id("two");
  named.mutable_jobs()->add_names(JobName(two));
  named.mutable_jobs()->set_events_only(true);
  auto watch = room.WatchCell(request);
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  const v1::WatchCellResponse snapshot = watch.Next();
  EXPECT_EQ(WordOf(snapshot), "snapshot of two");
  ASSERT_EQ(snapshot.snapshot().jobs_size(), 1);
  EXPECT_EQ(snapshot.snapshot().jobs(0).name(), JobName(two));
  room.Say(lease_one, {"a"});
  room.Say(lease_two, {"b"});
  const v1::WatchCellResponse of_one = watch.Next();
  EXPECT_EQ(WordOf(of_one), "jobs/1 a");
  EXPECT_THAT(of_one.subscriptions(), ElementsAre("jobs"));
  const v1::WatchCellResponse of_two = watch.Next();
  EXPECT_EQ(WordOf(of_two), "jobs/2 b");
  EXPECT_THAT(of_two.subscriptions(), ElementsAre("jobs", "two"));
}

TEST_F(CellWatchTest, PositionsComeWhenNoEventIsToBeTold) {
  room.TellSteps(two, 5);
  room.TellSteps(one, 6);
  auto watch = room.WatchCell(After(last - 1, {"jobs"}, false));
  for (const char* word : {"bookmark", "jobs/2 state", "jobs/2 at 5 steps", "jobs/1 at 6 steps"})
    EXPECT_EQ(NextOf(watch), word);
  room.TellSteps(two, 9);
  const v1::WatchCellResponse position = watch.Next();
  EXPECT_EQ(WordOf(position), "jobs/2 at 9 steps");
  EXPECT_THAT(position.subscriptions(), ElementsAre("jobs"));
  EXPECT_EQ(position.sequence(), last);
}

TEST_F(CellWatchTest, PositionsAreLeftOutWhereOnlyEventsAreWanted) {
  room.TellSteps(one, 5);
  auto watch = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  room.TellSteps(one, 6);
  room.Say(lease_one, {"a"});
  EXPECT_EQ(NextOf(watch), "jobs/1 a");
}

TEST_F(CellWatchTest, TheStatusOfAMachineComesWhenItChanges) {
  Executor executor(1);
  MachineStatuses statuses(room.bed.store(), room.feed, executor);
  ASSERT_TRUE(
      Eventually([&] { return room.feed.LatestAfter("machines/optimo-1", 0).has_value(); }));
  auto watch = room.WatchCell(Of({"machines"}, false));
  EXPECT_EQ(NextOf(watch),
            "snapshot of machines");  // has the status in it, which is not told again
  room.Finish(lease_one);
  const v1::WatchCellResponse first = watch.Next();
  EXPECT_EQ(WordOf(first), "machines/optimo-1 RUNNING");
  EXPECT_EQ(first.status().simulating_job(), JobName(two));
  room.Finish(lease_two);
  EXPECT_EQ(NextOf(watch), "machines/optimo-1 IDLE");
}

TEST_F(CellWatchTest, AJobThatIsDeletedIsSaidToBeGone) {
  room.Finish(lease_one);
  auto watch = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  EXPECT_TRUE(room.bed.store().DeleteJob(one, "anna"));
  // Its events are gone from the log: who had not read them is told that some are missing.
  const v1::WatchCellResponse gone = watch.Next();
  EXPECT_EQ(WordOf(gone), "jobs/1 gone");
  EXPECT_EQ(gone.event().caller(), "anna");
}

TEST_F(CellWatchTest, SubscriptionsChangeOnTheWay) {
  auto watch = room.WatchCell(Of({"jobs"}));
  const v1::WatchCellResponse first = watch.Next();
  v1::UpdateWatchRequest change;
  change.set_watch_id(first.watch_id());
  *change.mutable_add() = Of({"machines"}).subscriptions();
  change.add_remove("jobs");
  EXPECT_TRUE(room.registry.Change(change, StreamBed::kCaller));
  EXPECT_EQ(NextOf(watch), "snapshot of machines");
  room.Say(lease_one, {"nobody wants to know"});
  Must(room.bed.store().PutMachine({.id = "mill-9", .family = "rml1"}, 0));
  EXPECT_EQ(NextOf(watch), "machines/mill-9 created");
  // One of the same id is replaced.
  change.clear_remove();
  change.clear_add();
  v1::Subscription& narrow = *change.add_add();
  narrow.set_id("machines");
  narrow.mutable_machines()->add_names("machines/mill-1");
  EXPECT_TRUE(room.registry.Change(change, StreamBed::kCaller));
  const v1::WatchCellResponse again = watch.Next();
  EXPECT_EQ(WordOf(again), "snapshot of machines");
  EXPECT_EQ(again.snapshot().machines_size(), 1);
}

TEST_F(CellWatchTest, OnlyItsCallerChangesAWatch) {
  auto watch = room.WatchCell(Of({"jobs"}));
  v1::UpdateWatchRequest change;
  change.set_watch_id(watch.Next().watch_id());
  EXPECT_EQ(room.registry.Change(change, "berta").error().code, ErrorCode::kCellNotFound);
  v1::UpdateWatchRequest misnamed = change;
  *misnamed.mutable_add() = Of({"jobs"}).subscriptions();
  misnamed.mutable_add(0)->mutable_jobs()->add_names("machines/mill-1");
  EXPECT_EQ(room.registry.Change(misnamed, StreamBed::kCaller).error().code,
            ErrorCode::kCellInvalidArgument);
  v1::UpdateWatchRequest unknown = change;
  unknown.set_watch_id("0");
  EXPECT_EQ(room.registry.Change(unknown, StreamBed::kCaller).error().code,
            ErrorCode::kCellNotFound);
  for (int i = 0; i < 100; ++i) {
    v1::Subscription& one_more = *change.add_add();
    one_more.set_id("of " + std::to_string(i));
    one_more.mutable_projects();
  }
  // With the one that it has they are one too many; it stays as it was.
  EXPECT_EQ(room.registry.Change(change, StreamBed::kCaller).error().code,
            ErrorCode::kCellInvalidArgument);
  change.add_remove("jobs");
  EXPECT_TRUE(room.registry.Change(change, StreamBed::kCaller));
  EXPECT_EQ(NextOf(watch), "snapshot of of 0");
  watch.Cancel();
  EXPECT_TRUE(Eventually([&] {
    const Status changed = room.registry.Change(change, StreamBed::kCaller);
    return !changed && changed.error().code == ErrorCode::kCellNotFound;
  }));
}

// What was added before counts, too; what was refused does not.
TEST_F(CellWatchTest, EarlierChangesCountTowardsTheHundred) {
  auto watch = room.WatchCell(Of({"jobs"}));
  v1::UpdateWatchRequest change;
  change.set_watch_id(watch.Next().watch_id());
  const auto add = [&](int first, int count) {
    change.clear_add();
    for (int i = first; i < first + count; ++i) {
      v1::Subscription& added = *change.add_add();
      added.set_id("of " + std::to_string(i));
      added.mutable_projects();
    }
    return CodeOf(room.registry.Change(change, StreamBed::kCaller));
  };
  EXPECT_EQ(add(0, 60), std::nullopt);
  EXPECT_EQ(add(60, 40), ErrorCode::kCellInvalidArgument);  // with "jobs" one too many
  EXPECT_EQ(add(60, 39), std::nullopt);
  EXPECT_EQ(add(99, 1), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(add(5, 10), std::nullopt);  // in place of those of the same ids
}

// A proxy or a browser sees that the stream lives, and where it is.
TEST(CellWatchBookmarks, ComeWhenNothingElseDoes) {
  StreamBed room({}, std::chrono::milliseconds(20));
  auto watch = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  for (int i = 0; i < 3; ++i) {
    const v1::WatchCellResponse message = watch.Next();
    EXPECT_EQ(WordOf(message), "bookmark");
    EXPECT_EQ(message.sequence(), Must(room.bed.store().LastPosition()));
    EXPECT_GT(message.bookmark().server_time().seconds(), 0);
  }
}

// Also where there is something to tell all the time. By a clock that stands but for once: where a
// message takes longer than an interval, bookmarks alone are told.
TEST(CellWatchBookmarks, ComeBetweenEvents) {
  std::atomic<bool> is_later = false;
  const auto clock = [&is_later, begin = SteadyTime()] {
    return is_later ? begin + std::chrono::hours(1) : begin;
  };
  StreamBed room({}, std::chrono::minutes(10), clock);
  room.Submit();
  const storage::Lease lease = room.bed.Lease();
  auto watch = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  room.Say(lease, std::vector<std::string>(3'000, "x"));
  int told = 0;
  bool between = false;
  std::int64_t before = 0;
  while (told < 3'000) {
    const v1::WatchCellResponse message = watch.Next();
    ASSERT_TRUE(message.has_event() || message.has_bookmark());
    EXPECT_GE(message.sequence(), before);
    before = message.sequence();
    if (message.has_event()) ++told;
    if (told == 1'000) is_later = true;
    between = between || (message.has_bookmark() && told > 0 && told < 3'000);
  }
  EXPECT_TRUE(between);
}

// Whoever may look no longer is sent away; the others go on.
TEST_F(CellWatchTest, ChangedRightsEndAWatch) {
  auto watch = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  room.gate.SetLocal(ViewerPermissions());
  room.Say(lease_one, {"still here"});
  EXPECT_EQ(NextOf(watch), "jobs/1 still here");
  room.gate.SetLocal({});
  watch.ExpectRefused(grpc::StatusCode::PERMISSION_DENIED, "WatchCell");
  auto late = room.WatchCell(Of({"jobs"}));
  late.ExpectRefused(grpc::StatusCode::PERMISSION_DENIED, "WatchCell");
}

TEST_F(CellWatchTest, AServerThatStopsSaysWhereToGoOn) {
  auto watch = room.WatchCell(After(last - 1));
  EXPECT_EQ(NextOf(watch), "bookmark");
  EXPECT_EQ(NextOf(watch), "jobs/2 state");
  auto fresh = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(fresh), "snapshot of jobs");
  room.open.StopAll();
  for (WatchedCell* stream : {&watch, &fresh}) {
    const v1::WatchCellResponse goodbye = stream->Next();
    EXPECT_EQ(WordOf(goodbye), "come back");
    EXPECT_EQ(goodbye.sequence(), last);
    EXPECT_EQ(goodbye.reconnect().after().nanos(), 250'000'000);
    stream->ExpectRefused(grpc::StatusCode::UNAVAILABLE, "CELL-E9002");
  }
}

TEST_F(CellWatchTest, WhatIsNoSubscriptionIsRefused) {
  v1::WatchCellRequest request = Of({"jobs"});
  request.mutable_subscriptions(0)->mutable_jobs()->add_names("machines/mill-1");
  auto misnamed = room.WatchCell(request);
  misnamed.ExpectRefused(grpc::StatusCode::INVALID_ARGUMENT, "CELL-E9003");
  request = Of({"audit"});
  request.mutable_subscriptions(0)->mutable_audit();
  auto later = room.WatchCell(request);
  later.ExpectRefused(grpc::StatusCode::UNIMPLEMENTED, "audit");
}

// A subscription with a rate is told of what changed meanwhile when its time comes, though nothing
// else happens; and then the stream says that it lives.
TEST(CellWatchRate, WhatIsPutOffIsTold) {
  StreamBed room({}, std::chrono::milliseconds(1500));
  const std::int64_t job = room.Submit();
  room.bed.Lease();
  v1::WatchCellRequest request = Of({"jobs"}, false);
  request.mutable_subscriptions(0)->set_max_rate_hz(2);
  auto watch = room.WatchCell(request);
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  // On a machine that is busy a bookmark may fall due before.
  const auto next_position = [&] {
    std::string word = NextOf(watch);
    while (word == "bookmark") word = NextOf(watch);
    return word;
  };
  room.TellSteps(job, 1);
  EXPECT_EQ(next_position(), JobName(job) + " at 1 steps");
  room.TellSteps(job, 2);
  EXPECT_EQ(next_position(), JobName(job) + " at 2 steps");
  EXPECT_EQ(NextOf(watch), "bookmark");
  EXPECT_EQ(NextOf(watch), "bookmark");
}

// Each that is added begins with its snapshot, before any event for it.
TEST_F(CellWatchTest, EachOneThatIsAddedBeginsWithASnapshot) {
  auto watch = room.WatchCell(Of({"projects"}));
  v1::UpdateWatchRequest change;
  change.set_watch_id(watch.Next().watch_id());
  for (const char* id : {"a", "b", "c"}) {
    v1::Subscription& added = *change.add_add();
    added.set_id(id);
    added.mutable_jobs();
  }
  room.TellSteps(one, 7);
  EXPECT_TRUE(room.registry.Change(change, StreamBed::kCaller));
  for (const char* id : {"a", "b", "c"}) EXPECT_EQ(NextOf(watch), std::string("snapshot of ") + id);
  // And where the job is, that was told before.
  EXPECT_EQ(NextOf(watch), JobName(one) + " at 7 steps");
}

// Also the first that anything told at all.
TEST_F(CellWatchTest, WhereAJobIsComesBehindTheEventsThatWereMissed) {
  room.TellSteps(two, 5);
  auto watch = room.WatchCell(After(last - 1, {"jobs"}, false));
  for (const char* word : {"bookmark", "jobs/2 state", "jobs/2 at 5 steps"})
    EXPECT_EQ(NextOf(watch), word);
}

// The stream says that it lives, also behind events that it had in memory.
TEST(CellWatchRate, ABookmarkComesBehindEvents) {
  StreamBed room({}, std::chrono::milliseconds(300));
  const std::int64_t job = room.Submit();
  const storage::Lease lease = room.bed.Lease();
  auto watch = room.WatchCell(Of({"jobs"}));
  EXPECT_EQ(NextOf(watch), "snapshot of jobs");
  for (const char* text : {"a", "b"}) {
    room.Say(lease, {text});
    std::string word = NextOf(watch);
    while (word == "bookmark") word = NextOf(watch);
    EXPECT_EQ(word, JobName(job) + " " + text);
  }
  EXPECT_EQ(NextOf(watch), "bookmark");
  EXPECT_EQ(NextOf(watch), "bookmark");
}

}  // namespace
}  // namespace rmlcell::server
