// What hosts tell, on its way into the store (live.md 3.25, 5.07).
#include "server/machines/host_entries.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/names.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using storage::JobState;
using testing::ElementsAre;

class HostEntriesTest : public testing::Test {
 protected:
  std::int64_t SubmitRun(const std::string& continues = {}) {
    v1::Job job;
    job.set_kind(v1::JOB_KIND_RUN);
    job.set_continues(continues);
    storage::NewJob made{.machine = "mill-1",
                         .kind = "RUN",
                         .specification = job.SerializeAsString(),
                         .attempts_max = 1,
                         .events = {StateEvent(JobState::kQueued)}};
    return Must(bed.store().SubmitAndWait(std::move(made))).job.id;
  }
  storage::LeasedJob Acquire(const std::string& host = "hall/1") {
    return Must(bed.store().AcquireJobs({.worker = host,
                                         .kinds = {"RUN"},
                                         .duration = std::chrono::hours(1),
                                         .events = {StateEvent(JobState::kRunning)}}))
        .front();
  }
  v1::JournalEntry& Add(std::int64_t job = 0) {
    v1::JournalEntry& entry = entries.emplace_back();
    entry.set_sequence(++sequence);
    entry.set_fence(lease.fence);
    entry.set_virtual_time_ns(1'000 + sequence);
    if (job > 0) entry.set_job(JobName(job));
    if (job > 0) entry.set_run_time_ns(sequence);
    return entry;
  }
  void Mark(bool clean) {
    v1::MachineMark& mark = *Add().mutable_mark();
    mark.set_state("state " + std::to_string(sequence));
    mark.set_clean(clean);
  }
  void Over(std::int64_t job, v1::Outcome::Kind kind, const std::string& code = {}) {
    v1::RunOver& over = *Add(job).mutable_run_over();
    over.set_job(JobName(job));
    over.mutable_outcome()->set_kind(kind);
    over.mutable_outcome()->set_code(code);
    over.mutable_outcome()->mutable_place()->set_program(5);
    over.mutable_outcome()->mutable_place()->set_step(12);
  }
  std::vector<v1::JobEvent> EventsOf(std::int64_t job) {
    std::vector<v1::JobEvent> told;
    for (const storage::EventRecord& event : Must(bed.store().JobEvents(job, 0, 1000)))
      told.push_back(ToProto(event));
    return told;
  }
  int ToldOfMachine() {
    int told = 0;
    for (const storage::EventRecord& event : Must(bed.store().AllEvents(0, 10'000)))
      told += event.kind == kMachineEvent ? 1 : 0;
    return told;
  }

  ServerBed bed;
  storage::MachineLease lease = Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "hall/1", .server = "s", .duration = std::chrono::hours(1)}));
  std::vector<v1::JournalEntry> entries;
  std::int64_t sequence = 0;
};

// What happens in the run of a job stands in both logs, by the time of the run in that of the job;
// the end, and where it left the machine.
TEST_F(HostEntriesTest, TheRunOfAJobIsToldInItsLog) {
  const std::int64_t job = SubmitRun();
  Acquire();
  Add(job).mutable_run_begun()->set_job(JobName(job));
  Add(job).mutable_event()->mutable_halted()->set_reason(v1::HOLD_REASON_STOP);
  Over(job, v1::Outcome::KIND_COMPLETED);
  Mark(true);
  const StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  ASSERT_TRUE(stored.how) << stored.how.error().detail;
  EXPECT_EQ(stored.count, 4U);
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kSucceeded);
  const auto told = EventsOf(job);
  ASSERT_EQ(told.size(), 5U);
  EXPECT_EQ(told[2].run_begun().job(), JobName(job));
  EXPECT_EQ(told[3].halted().reason(), v1::HOLD_REASON_STOP);
  EXPECT_EQ(told[3].virtual_time_ns(), 2);
  EXPECT_EQ(told[3].attempt(), 1);
  EXPECT_TRUE(told[4].has_ended());
  EXPECT_EQ(ToldOfMachine(), 3);
  const auto mark = Must(bed.store().GetMachineMark("mill-1"));
  EXPECT_EQ(mark->state, "state 4");
  EXPECT_TRUE(mark->clean);
}

// LIVE-5.07, OPT-1.15: what a run compiled is kept with its end, also that of a run that no job is
// for; of a program that was stored anew meanwhile nothing is.
TEST_F(HostEntriesTest, ExecutablesAreKeptWithTheEnd) {
  std::vector<storage::ProgramWrite> programs(3);
  for (int i = 0; i < 3; ++i) {
    programs[static_cast<std::size_t>(i)].slot = 46 + i;
    programs[static_cast<std::size_t>(i)].object = "object";
  }
  const auto put = Must(bed.store().PutPrograms("mill-1", programs, {}));
  const auto made = [&](v1::JournalEntry& entry, int slot, std::int64_t later = 0) {
    v1::LinkedExecutable& executable = *entry.add_executables();
    executable.set_slot(slot);
    executable.set_object_revision(put.at(static_cast<std::size_t>(slot - 46)).revision + later);
    executable.set_content("made of " + std::to_string(slot));
  };
  const auto executable_of = [&](int slot) {
    const auto program = Must(bed.store().GetProgram("mill-1", slot));
    return program.executable.value_or("");
  };
  const std::int64_t job = SubmitRun();
  Acquire();
  Over(job, v1::Outcome::KIND_COMPLETED);
  made(entries.back(), 46);
  made(entries.back(), 48, 1);
  Mark(true);
  Add().mutable_run_over()->set_run(2);
  made(entries.back(), 47);
  Mark(true);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kSucceeded);
  EXPECT_EQ(executable_of(46), "made of 46");
  EXPECT_EQ(executable_of(47), "made of 47");
  EXPECT_EQ(executable_of(48), "");
}

// LIVE-5.08: how a run ends is how its job ends, with the place.
TEST_F(HostEntriesTest, TheOutcomeOfARunIsThatOfItsJob) {
  const std::vector<std::tuple<v1::Outcome::Kind, std::string, JobState>> cases = {
      {v1::Outcome::KIND_STOPPED, "OPT-E7507", JobState::kFailed},
      {v1::Outcome::KIND_FAILED, "OPT-E348", JobState::kFailed},
      {v1::Outcome::KIND_CANCELLED, "CELL-E9307", JobState::kCancelled},
      {v1::Outcome::KIND_INTERRUPTED, "CELL-E9411", JobState::kInterrupted}};
  for (const auto& [kind, code, state] : cases) {
    const std::int64_t job = SubmitRun();
    Acquire();
    entries.clear();
    Over(job, kind, code);
    Mark(true);
    ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how) << code;
    const storage::JobRecord ended = Must(bed.store().GetJob(job));
    EXPECT_EQ(ended.state, state) << code;
    EXPECT_EQ(CodeText(*ended.outcome->code), code);
    EXPECT_EQ(ended.outcome->program, 5);
    EXPECT_EQ(ended.outcome->step, 12);
  }
}

// A job that has ended hears nothing more; its machine does.
TEST_F(HostEntriesTest, AJobThatHasEndedHearsNothingMore) {
  const std::int64_t job = SubmitRun();
  Acquire();
  Over(job, v1::Outcome::KIND_COMPLETED);
  Mark(true);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  const std::size_t told = EventsOf(job).size();
  entries.clear();
  Add(job).mutable_event()->mutable_halted();
  Over(job, v1::Outcome::KIND_FAILED, "OPT-E348");
  Mark(true);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  EXPECT_EQ(EventsOf(job).size(), told);
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kSucceeded);
  EXPECT_EQ(ToldOfMachine(), 3);
}

// What the machine tells behind the end of a run, and what comes late of a job that is over, is not
// of the job that ended; where the machine stands is kept once.
TEST_F(HostEntriesTest, WhatFollowsTheEndOfARunIsNotOfItsJob) {
  const std::int64_t over = SubmitRun();
  Acquire();
  Over(over, v1::Outcome::KIND_COMPLETED);
  Mark(true);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  entries.clear();
  const std::size_t told_of_over = EventsOf(over).size();
  const std::int64_t job = SubmitRun();
  Acquire();
  const std::size_t told = EventsOf(job).size();
  Over(job, v1::Outcome::KIND_COMPLETED);
  Add().mutable_event()->mutable_message()->set_text("the door was opened");
  Add(over).mutable_event()->mutable_message()->set_text("late");
  Mark(true);
  const StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  ASSERT_TRUE(stored.how) << stored.how.error().detail;
  EXPECT_EQ(EventsOf(job).size(), told + 1);
  EXPECT_TRUE(EventsOf(job).back().has_ended());
  EXPECT_EQ(EventsOf(over).size(), told_of_over);
  EXPECT_EQ(ToldOfMachine(), 4);
  const auto mark = Must(bed.store().GetMachineMark("mill-1"));
  v1::MachineMark note;
  ASSERT_TRUE(note.ParseFromString(mark->note));
  EXPECT_EQ(note.state(), "");
}

// Entries that are stored are not stored again with those that were not: what came before the job
// is a write of its own.
TEST_F(HostEntriesTest, WhatWasNotStoredIsToldApart) {
  const std::int64_t job = SubmitRun();
  Acquire();
  Add().mutable_run_begun()->set_run(3);
  Add(job).mutable_run_begun()->set_job(JobName(job));
  Over(job, v1::Outcome::KIND_COMPLETED);
  Mark(true);
  storage::MachineLease lost = lease;
  lost.fence += 1;
  StoredEntries stored = StoreEntries(bed.store(), lost, entries);
  EXPECT_EQ(stored.how.error().code, ErrorCode::kCellLeaseLost);
  EXPECT_EQ(stored.count, 0U);
  entries.back().mutable_mark()->set_state(std::string(storage::kMachineMarkBytesMax + 1, 'x'));
  stored = StoreEntries(bed.store(), lease, entries);
  EXPECT_EQ(stored.how.error().code, ErrorCode::kCellTooLarge);
  EXPECT_EQ(stored.count, 1U) << "the run of the job, its end and the mark belong together";
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kRunning);
  EXPECT_EQ(ToldOfMachine(), 1);
  EXPECT_EQ(EventsOf(job).size(), 2U);
}

// LIVE-5.20, the first row: a job that an earlier host had and never began waits again; that of the
// present host stays its own.
TEST_F(HostEntriesTest, AJobThatNeverBeganWaitsAgain) {
  const std::int64_t job = SubmitRun();
  Acquire("hall/1");
  ASSERT_TRUE(GiveBackUnbegun(bed.store(), "mill-1", "hall/1", {}));
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kRunning);
  ASSERT_TRUE(GiveBackUnbegun(bed.store(), "optimo-1", "hall/2", {}));
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kRunning);
  ASSERT_TRUE(GiveBackUnbegun(bed.store(), "mill-1", "hall/2", {}));
  const storage::JobRecord back = Must(bed.store().GetJob(job));
  EXPECT_EQ(back.state, JobState::kQueued);
  EXPECT_EQ(back.attempts, 0);
  EXPECT_EQ(EventsOf(job).back().state(), v1::Job::STATE_QUEUED);
}

// LIVE-5.20, LIVE-3.35: what the host before had on its disk it may have been told to stop: nobody
// but a person begins it.
TEST_F(HostEntriesTest, AJobThatAHostHadWaitsHeld) {
  for (const bool had : {false, true}) {
    const std::int64_t job = SubmitRun();
    Acquire("hall/1");
    ASSERT_TRUE(GiveBackUnbegun(bed.store(), "mill-1", "hall/2", had ? JobName(job) : "jobs/99"));
    const storage::JobRecord back = Must(bed.store().GetJob(job));
    EXPECT_EQ(back.state, JobState::kQueued);
    EXPECT_EQ(back.held, had);
    Must(bed.store().RequestCancel(job, {}));
  }
}

// LIVE-5.10: one that was to go on where another was cut off is decided about again.
TEST_F(HostEntriesTest, AJobThatGoesOnElsewhereIsCancelled) {
  const std::int64_t job = SubmitRun("jobs/7");
  Acquire("hall/1");
  ASSERT_TRUE(GiveBackUnbegun(bed.store(), "mill-1", "hall/2", JobName(job)));
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kCancelled);
}

// LIVE-3.01, LIVE-5.08: where no host comes any more the job is cut off where the newest mark has
// it; a host that comes later all the same tells of its machine, and the job stays as it is.
TEST_F(HostEntriesTest, AJobWhoseMachineIsOffIsCutOff) {
  const std::int64_t job = SubmitRun();
  Acquire();
  Add(job).mutable_run_begun()->set_job(JobName(job));
  Mark(false);
  v1::MachineMark& mark = *entries.back().mutable_mark();
  mark.set_job(JobName(job));
  mark.set_run_time_ns(77);
  mark.mutable_place()->set_program(5);
  mark.mutable_place()->set_step(12);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  ASSERT_TRUE(EndWithoutHost(bed.store(), "optimo-1"));
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kRunning);
  ASSERT_TRUE(EndWithoutHost(bed.store(), "mill-1"));
  const storage::JobRecord ended = Must(bed.store().GetJob(job));
  EXPECT_EQ(ended.state, JobState::kInterrupted);
  ASSERT_TRUE(ended.outcome);
  EXPECT_EQ(ended.outcome->code, ErrorCode::kCellHostDied);
  const v1::Outcome told = EventsOf(job).back().ended();
  EXPECT_EQ(told.kind(), v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(told.place().step(), 12);
  EXPECT_EQ(told.cycle_time_ns(), 77);
  entries.clear();
  Over(job, v1::Outcome::KIND_INTERRUPTED, "CELL-E9411");
  Mark(false);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  EXPECT_EQ(EventsOf(job).back().ended().cycle_time_ns(), 77) << "told once";
}

// JournalEntry.job, RunOver.job: an end is that of a job where the entry is of the job, and names
// it.
TEST_F(HostEntriesTest, AnEndThatIsNobodysEndsNoJob) {
  const std::int64_t job = SubmitRun();
  Acquire();
  Add(job).mutable_run_begun()->set_job(JobName(job));
  Over(job, v1::Outcome::KIND_COMPLETED);
  entries.back().clear_job();
  Over(job, v1::Outcome::KIND_COMPLETED);
  entries.back().mutable_run_over()->clear_job();
  Mark(true);
  const StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  ASSERT_TRUE(stored.how) << stored.how.error().detail;
  EXPECT_EQ(stored.count, 4U);
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, JobState::kRunning);
}

// OPT-1.15: what a run without a job compiled is kept though no job has ended.
TEST_F(HostEntriesTest, ExecutablesAreKeptWithoutAJob) {
  const auto put = Must(bed.store().PutPrograms(
      "mill-1", {{.slot = 46, .object = "object"}, {.slot = 47, .object = "object"}}, {}));
  Add().mutable_run_over()->set_run(1);
  v1::LinkedExecutable& made = *entries.back().add_executables();
  made.set_slot(47);
  made.set_object_revision(put[1].revision);
  made.set_content("made of 47");
  Mark(true);
  ASSERT_TRUE(StoreEntries(bed.store(), lease, entries).how);
  EXPECT_EQ(Must(bed.store().GetProgram("mill-1", 47)).executable.value_or(""), "made of 47");
  EXPECT_FALSE(Must(bed.store().GetProgram("mill-1", 46)).executable);
}

}  // namespace
}  // namespace rmlcell::server
