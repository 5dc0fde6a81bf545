// The log of the cell: one over all resources (store.h).
#include <gmock/gmock.h>

#include <atomic>
#include <map>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// "machines/m created by anna", in the order of the log.
std::vector<std::string> Lines(const std::vector<EventRecord>& events) {
  std::vector<std::string> lines;
  for (const EventRecord& event : events) {
    const std::string resource = event.job > 0 ? JobName(event.job) : event.resource;
    lines.push_back(resource + " " + event.kind +
                    (event.caller.empty() ? std::string() : " by " + event.caller));
  }
  return lines;
}

std::vector<std::string> LinesAfter(Store& store, std::int64_t position) {
  return Lines(Must(store.AllEvents(position, 1000)));
}

TEST_P(StoreConformance, TellsWhatIsDoneWithRecordsAndByWhom) {
  Must(store().PutMachine({.id = "m"}, 0, "anna"));
  Must(store().PutMachine({.id = "m"}, 1, "berta"));
  Must(store().PutProject({.id = "p"}, 0, "anna"));
  Must(store().PutProject({.id = "p"}, 1));
  Must(store().PutPrograms("m", {{.slot = 7, .object = "a"}, {.slot = 3, .object = "b"}},
                           {{.number = 5}}, "carl"));
  Must(store().PutPrograms("m", {{.slot = 7, .object = "c"}}, {}, "carl"));
  Must(store().PutExecutable("m", 7, 2, "x", "dora"));
  Must(store().DeleteExecutable("m", 7, "emil"));
  Must(store().PutSchedule({.machine = "m", .number = 5}, 1, "fritz"));
  Must(store().DeleteSchedule("m", 5, "gerd"));
  Must(store().DeleteProgram("m", 3, kAnyRevision, "hans"));
  Must(store().DeleteProject("p", kAnyRevision, "ida"));
  Must(store().DeleteMachine("m", kAnyRevision, "jan"));
  EXPECT_THAT(
      LinesAfter(store(), 0),
      ElementsAre(
          "machines/m created by anna", "machines/m updated by berta", "projects/p created by anna",
          "projects/p updated", "machines/m/programs/7 created by carl",
          "machines/m/programs/3 created by carl", "machines/m/laserSchedules/5 created by carl",
          "machines/m/programs/7 updated by carl", "machines/m/programs/7 updated by dora",
          "machines/m/programs/7 updated by emil", "machines/m/laserSchedules/5 updated by fritz",
          "machines/m/laserSchedules/5 deleted by gerd", "machines/m/programs/3 deleted by hans",
          "projects/p deleted by ida", "machines/m/programs/7 deleted by jan",
          "machines/m deleted by jan"));
}

TEST_P(StoreConformance, NothingIsToldOfWhatWasRefused) {
  Must(store().PutMachine({.id = "m"}, 0));
  PutProgram("m", 1, "a");
  const std::int64_t last = Must(store().LastPosition());
  EXPECT_FALSE(store().PutMachine({.id = "m"}, 0));
  EXPECT_FALSE(store().DeleteMachine("m", 9));
  EXPECT_FALSE(store().DeleteProgram("m", 1, 9));
  EXPECT_FALSE(store().DeleteProject("p", kAnyRevision));
  EXPECT_FALSE(store().DeleteSchedule("m", 1));
  // All or none: the second slot is refused.
  EXPECT_FALSE(store().PutPrograms(
      "m", {{.slot = 2, .object = "b"}, {.slot = 1, .object = "c", .expected = 9}}, {}));
  // The executable of another object is not kept.
  EXPECT_FALSE(Must(store().PutExecutable("m", 1, 9, "x")));
  EXPECT_THAT(LinesAfter(store(), last), IsEmpty());
  EXPECT_EQ(Must(store().LastPosition()), last);
}

// One order over jobs and all other resources, which does not fall back.
TEST_P(StoreConformance, PositionsCountOverAllResources) {
  Must(store().PutMachine({.id = "m"}, 0));
  clock().Advance(std::chrono::seconds(5));
  const auto job = Must(store().SubmitAndWait(
      {.machine = "m", .kind = "CHECK", .events = {{.kind = "state", .caller = "anna"}}}));
  PutProgram("m", 1, "a");
  const auto events = Must(store().AllEvents(0, 10));
  EXPECT_THAT(Lines(events),
              ElementsAre("machines/m created", JobName(job.job.id) + " state by anna",
                          "machines/m/programs/1 created"));
  EXPECT_LT(events[0].position, events[1].position);
  EXPECT_LT(events[1].position, events[2].position);
  EXPECT_EQ(events[2].at - events[0].at, std::chrono::seconds(5));
  EXPECT_EQ(events[1].sequence, 1);
  const std::int64_t last = Must(store().LastPosition());
  EXPECT_EQ(events[2].position, last);
  Reopen();
  EXPECT_GE(Must(store().LastPosition()), last);
  PutMachine("other");
  EXPECT_GT(Must(store().LastPosition()), last);
}

// Readers of the log are told, and go on as before: those of the other jobs are all there.
TEST_P(StoreConformance, AJobThatIsDeletedTakesItsOwnEventsAlone) {
  const LeasedJob kept = (Submit(), Acquire());
  const LeasedJob leased = (Submit(), Acquire());
  Must(store().Finish(kept.lease,
                      {.outcome = {.state = JobState::kSucceeded}, .events = {{.kind = "over"}}}));
  Must(store().Finish(leased.lease,
                      {.outcome = {.state = JobState::kSucceeded}, .events = {{.kind = "ended"}}}));
  Must(store().DeleteJob(leased.job.id, "anna"));
  EXPECT_EQ(Must(store().EventsGoneUntil()), 0);
  EXPECT_THAT(LinesAfter(store(), 0), ElementsAre(JobName(kept.job.id) + " over",
                                                  JobName(leased.job.id) + " deleted by anna"));
}

// A position is good in the store that goes on, also after it was opened again; one that it has not
// come to, or that was seen under another name, is not.
TEST_P(StoreConformance, KnowsItsOwnPositions) {
  PutMachine("a");
  const std::string first = store().LogId();
  const std::int64_t seen = Must(store().LastPosition());
  EXPECT_NE(first, "");
  EXPECT_TRUE(Must(store().HasPosition(first, seen)));
  EXPECT_TRUE(Must(store().HasPosition(first, 0)));
  EXPECT_FALSE(Must(store().HasPosition(first, seen + 1)));
  EXPECT_FALSE(Must(store().HasPosition("another", seen)));
  EXPECT_FALSE(Must(store().HasPosition("", seen)));
  PutMachine("b");
  Reopen();
  EXPECT_NE(store().LogId(), first);
  EXPECT_TRUE(Must(store().HasPosition(first, seen)));
  EXPECT_TRUE(Must(store().HasPosition(first, seen + 1)));
  PutMachine("c");
  EXPECT_TRUE(Must(store().HasPosition(store().LogId(), seen + 2)));
  // Nobody saw it under the first name: the store was opened again before it was written.
  EXPECT_FALSE(Must(store().HasPosition(first, seen + 2)));
}

TEST_P(StoreConformance, WhoWatchesHearsOfRecords) {
  std::atomic<int> told = 0;
  const auto watch = store().Watch([&] { ++told; });
  PutMachine("m");
  EXPECT_TRUE(Eventually([&] { return told > 0; }));
}

TEST_P(StoreConformance, JobsAreCountedByState) {
  for (const char* machine : {"m", "m", "n"}) Submit("CHECK", machine);
  Must(store().SubmitAndWait({.machine = "m", .kind = "SIMULATE", .caller = "anna"}));
  Finish(Acquire("w", "CHECK").lease, JobState::kFailed);
  Acquire("w", "CHECK");
  const auto counts = [&](const JobQuery& query) {
    std::map<JobState, std::int64_t> found;
    for (const JobStateCount& count : Must(store().CountByState(query)))
      found[count.state] = count.jobs;
    return found;
  };
  using Counts = std::map<JobState, std::int64_t>;
  EXPECT_EQ(counts({}),
            (Counts{{JobState::kFailed, 1}, {JobState::kRunning, 1}, {JobState::kQueued, 2}}));
  EXPECT_EQ(counts({.machine = "n"}), (Counts{{JobState::kQueued, 1}}));
  EXPECT_EQ(counts({.kind = "SIMULATE"}), (Counts{{JobState::kQueued, 1}}));
  EXPECT_EQ(counts({.caller = "anna", .limit = 0}), (Counts{{JobState::kQueued, 1}}));
  EXPECT_EQ(counts({.machine = "none"}), Counts{});
}

}  // namespace

}  // namespace rmlcell::storage
