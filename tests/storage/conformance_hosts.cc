// Hosts of machines: one each, and what they write about them (live.md 3).
#include <gmock/gmock.h>

#include <limits>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kHostLost = ErrorCode::kCellLeaseLost;
constexpr auto kTaken = ErrorCode::kCellMachineTaken;

MachineClaim Claim(const std::string& host, const std::string& machine = "m") {
  return {.machine = machine, .host = host, .server = "s-" + host, .duration = seconds(60)};
}

MachineWrite MarkOf(std::int64_t sequence, const std::string& state) {
  return {.mark = MachineMark{.sequence = sequence, .state = state, .note = "n", .clean = false}};
}

// LIVE-3.02: nobody has it; the same host asks again, and the fence stays; another is told who.
TEST_P(StoreConformance, AMachineHasOneHost) {
  PutMachine("m");
  PutMachine("n");
  const MachineLease first = Must(store().TakeMachine(Claim("a")));
  EXPECT_EQ(first.host, "a");
  EXPECT_EQ(first.server, "s-a");
  EXPECT_EQ(first.duration, seconds(60));
  EXPECT_EQ(first.renewals, 0);
  const MachineLease again = Must(other().TakeMachine(Claim("a")));
  EXPECT_EQ(again.fence, first.fence);
  EXPECT_EQ(again.renewals, 1);
  const auto refused = store().TakeMachine(Claim("b"));
  EXPECT_EQ(CodeOf(refused), kTaken);
  EXPECT_THAT(refused.error().detail, HasSubstr("hosted by a"));
  const MachineLease of_n = Must(store().TakeMachine(Claim("b", "n")));
  EXPECT_GT(of_n.fence, first.fence);
  EXPECT_THAT(Must(other().MachineLeases()), ElementsAre(again, of_n));
  EXPECT_EQ(CodeOf(store().TakeMachine(Claim("a", "none"))), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().TakeMachine(Claim(""))), ErrorCode::kCellInvalidArgument);
  MachineClaim at_once = Claim("a");
  at_once.duration = seconds(0);
  EXPECT_EQ(CodeOf(store().TakeMachine(at_once)), ErrorCode::kCellInvalidArgument);
  at_once.duration = std::chrono::milliseconds(1);
  EXPECT_EQ(Must(store().TakeMachine(at_once)).duration, std::chrono::milliseconds(1));
}

// PG-5.09: who takes it over has seen fence and renewals unchanged; a renewal meanwhile keeps it.
TEST_P(StoreConformance, AMachineIsTakenFromAHostThatIsGone) {
  PutMachine("m");
  const MachineLease first = Must(store().TakeMachine(Claim("a")));
  MachineClaim claim = Claim("b");
  claim.seen = first;
  const MachineLease renewed = Must(store().RenewMachine(first, "s-2"));
  EXPECT_EQ(renewed.renewals, 1);
  EXPECT_EQ(renewed.server, "s-2");
  EXPECT_EQ(CodeOf(store().TakeMachine(claim)), kTaken);
  claim.seen = renewed;
  const MachineLease taken = Must(other().TakeMachine(claim));
  EXPECT_GT(taken.fence, first.fence);
  EXPECT_EQ(taken.renewals, 0);
  // The old host is refused whatever it does.
  EXPECT_EQ(CodeOf(store().RenewMachine(renewed, "s-2")), kHostLost);
  EXPECT_EQ(CodeOf(store().AppendMachine(renewed, MarkOf(1, "x"))), kHostLost);
  EXPECT_EQ(CodeOf(store().ReleaseMachine(renewed)), kHostLost);
  EXPECT_TRUE(store().ReleaseMachine(taken));
  EXPECT_THAT(Must(store().MachineLeases()), IsEmpty());
  // What was seen of a lease that is over says nothing of the next one.
  const MachineLease next = Must(store().TakeMachine(Claim("c")));
  EXPECT_GT(next.fence, taken.fence);
  claim.seen = taken;
  EXPECT_EQ(CodeOf(store().TakeMachine(claim)), kTaken);
}

// LIVE-3.03: a device is given to another host by a person only.
TEST_P(StoreConformance, APinnedMachineIsTakenByHand) {
  PutMachine("m");
  MachineClaim first = Claim("a");
  first.pinned = true;
  const MachineLease held = Must(store().TakeMachine(first));
  EXPECT_TRUE(held.pinned);
  MachineClaim claim = Claim("b");
  claim.seen = held;
  EXPECT_EQ(CodeOf(store().TakeMachine(claim)), kTaken);
  claim.by_hand = true;
  EXPECT_GT(Must(store().TakeMachine(claim)).fence, held.fence);
}

// LIVE-3.25: a mark lies beside the configuration; older ones never overwrite a newer one.
TEST_P(StoreConformance, AMarkChangesNoRevision) {
  PutMachine("m");
  const Revision before = Must(store().GetMachine("m")).revision;
  EXPECT_FALSE(Must(store().GetMachineMark("m")));
  EXPECT_EQ(CodeOf(store().GetMachineMark("none")), ErrorCode::kCellUnknownMachine);
  const MachineLease lease = Must(store().TakeMachine(Claim("a")));
  ASSERT_TRUE(store().AppendMachine(lease, MarkOf(5, Noise(16'000, 3))));
  clock().Advance(seconds(1));
  EXPECT_EQ(CodeOf(store().AppendMachine(lease, MarkOf(5, "again"))),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().AppendMachine(lease, MarkOf(4, "older"))),
            ErrorCode::kCellInvalidArgument);
  Reopen();
  const MachineMark mark = *Must(store().GetMachineMark("m"));
  EXPECT_EQ(mark.fence, lease.fence);
  EXPECT_EQ(mark.sequence, 5);
  EXPECT_EQ(mark.state, Noise(16'000, 3));
  EXPECT_EQ(mark.note, "n");
  EXPECT_FALSE(mark.clean);
  EXPECT_EQ(mark.at, clock().Now() - seconds(1));
  EXPECT_EQ(Must(store().GetMachine("m")).revision, before);
  EXPECT_EQ(Must(store().GetMachineMemory("m", {})).mark->state, mark.state);
  // The next host counts anew.
  MachineClaim claim = Claim("b");
  claim.by_hand = true;
  const MachineLease next = Must(store().TakeMachine(claim));
  EXPECT_TRUE(store().AppendMachine(next, MarkOf(1, "next")));
  EXPECT_EQ(Must(store().GetMachineMark("m"))->state, "next");
  EXPECT_EQ(CodeOf(store().AppendMachine(next, MarkOf(2, std::string(kMachineMarkBytesMax, 'x')))),
            ErrorCode::kCellTooLarge);
  EXPECT_EQ(Must(store().GetMachineMark("m"))->sequence, 1);
  // State and note together; the note has one byte.
  Must(store().AppendMachine(next, MarkOf(3, std::string(kMachineMarkBytesMax - 1, 'x'))));
  EXPECT_EQ(Must(store().GetMachineMark("m"))->sequence, 3);
}

// Events and mark are written together or not at all, and the events stand in the log of the cell.
TEST_P(StoreConformance, WhatAHostWritesIsOneWrite) {
  PutMachine("m");
  const MachineLease lease = Must(store().TakeMachine(Claim("a")));
  const std::int64_t before = Must(store().LastPosition());
  MachineWrite write = MarkOf(1, "one");
  write.events = {{.kind = "input", .payload = "p1", .caller = "anna"},
                  {.kind = "halted", .payload = "p2"}};
  ASSERT_TRUE(store().AppendMachine(lease, write));
  const std::vector<EventRecord> events = Must(other().AllEvents(before, 10));
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].resource, "machines/m");
  EXPECT_EQ(events[0].kind, "input");
  EXPECT_EQ(events[0].payload, "p1");
  EXPECT_EQ(events[0].caller, "anna");
  EXPECT_EQ(events[1].payload, "p2");
  EXPECT_EQ(CodeOf(store().AppendMachine(lease, write)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Must(store().AllEvents(before, 10)).size(), 2U);
  MachineWrite large;
  large.events = {{.kind = "input", .payload = "good"},
                  {.kind = "input", .payload = std::string(kEventPayloadBytesMax + 1, 'x')}};
  EXPECT_EQ(CodeOf(store().AppendMachine(lease, large)), ErrorCode::kCellTooLarge);
  EXPECT_EQ(Must(store().AllEvents(before, 10)).size(), 2U);
}

// store.h MachineWrite: who has no mark to write leaves that which is there.
TEST_P(StoreConformance, AMachineThatOnlyTellsKeepsItsMark) {
  PutMachine("m");
  const MachineLease lease = Must(store().TakeMachine(Claim("a")));
  ASSERT_TRUE(store().AppendMachine(lease, MarkOf(1, "one")));
  const std::int64_t before = Must(store().LastPosition());
  MachineWrite told;
  told.events = {{.kind = "input", .payload = "p"}};
  ASSERT_TRUE(store().AppendMachine(lease, told));
  const std::vector<EventRecord> events = Must(store().AllEvents(before, 10));
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].payload, "p");
  EXPECT_EQ(Must(store().GetMachineMark("m"))->sequence, 1);
  EXPECT_EQ(Must(store().GetMachineMark("m"))->state, "one");
}

// LIVE-5.07: the end of a RUN and where it left the machine are one transaction.
TEST_P(StoreConformance, TheEndOfARunLeavesTheMachineWhereItIs) {
  PutMachine("m");
  const MachineLease host = Must(store().TakeMachine(Claim("a")));
  Submit("RUN", "m");
  const LeasedJob leased = Acquire("a", "RUN");
  JobEnd end;
  end.machine_lease = host;
  end.machine = MarkOf(7, "after");
  end.machine_lease->fence += 1;
  EXPECT_EQ(CodeOf(store().Finish(leased.lease, end)), kHostLost);
  EXPECT_EQ(Must(store().GetJob(leased.job.id)).state, JobState::kRunning);
  EXPECT_FALSE(Must(store().GetMachineMark("m")));
  end.machine_lease = host;
  EXPECT_EQ(Must(store().Finish(leased.lease, end)).state, JobState::kSucceeded);
  EXPECT_EQ(Must(store().GetMachineMark("m"))->state, "after");
}

// LIVE-3.25: what a job tells on its machine stands in the log of the job, in the transaction of
// what the machine tells; a job that is not held any more keeps nothing of it.
TEST_P(StoreConformance, AMachineTellsOfItsJob) {
  PutMachine("m");
  const MachineLease host = Must(store().TakeMachine(Claim("a")));
  Submit("RUN", "m");
  const LeasedJob leased = Acquire("a", "RUN");
  MachineWrite write = MarkOf(3, "moving");
  write.events = {{.kind = "begun", .payload = "m1"}};
  write.job = leased.lease;
  write.job_events = {{.kind = "halted", .payload = "j1"}};
  ASSERT_TRUE(store().AppendMachine(host, write));
  const std::vector<EventRecord> told = EventsOf(leased.job.id);
  EXPECT_EQ(told.back().payload, "j1");
  EXPECT_EQ(told.back().attempt, leased.lease.attempt);
  EXPECT_EQ(Must(store().GetMachineMark("m"))->sequence, 3);
  const std::int64_t before = Must(store().LastPosition());
  write = MarkOf(4, "moving");
  write.events = {{.kind = "begun", .payload = "m2"}};
  write.job = leased.lease;
  write.job->fence += 1;
  write.job_events = {{.kind = "halted", .payload = "j2"}};
  EXPECT_EQ(CodeOf(store().AppendMachine(host, write)), ErrorCode::kCellLeaseLost);
  EXPECT_EQ(Must(store().LastPosition()), before);
  EXPECT_EQ(Must(store().GetMachineMark("m"))->sequence, 3);
}

// LIVE-5.01: a RUN is leased to the host of its machine, which lives on when a server goes.
TEST_P(StoreConformance, ARunOutlivesItsServer) {
  Submit("RUN");
  const LeasedJob leased = Acquire("a", "RUN");
  Submit("CHECK");
  const LeasedJob check = Acquire("w", "CHECK");
  Reopen();
  const auto ended = Must(store().Expire(PolicyOfTests()));
  for (const JobRecord& job : ended) EXPECT_EQ(job.id, check.job.id);
  EXPECT_EQ(Must(store().GetJob(leased.job.id)).state, JobState::kRunning);
  EXPECT_EQ(Must(store().Finish(leased.lease, {})).state, JobState::kSucceeded);
}

// A machine that is deleted takes its host and its mark along; a fence is never used twice.
TEST_P(StoreConformance, ADeletedMachineHasNoHost) {
  PutMachine("m");
  const MachineLease lease = Must(store().TakeMachine(Claim("a")));
  ASSERT_TRUE(store().AppendMachine(lease, MarkOf(1, "one")));
  ASSERT_TRUE(store().DeleteMachine("m", kAnyRevision));
  EXPECT_THAT(Must(store().MachineLeases()), IsEmpty());
  EXPECT_EQ(CodeOf(store().AppendMachine(lease, MarkOf(2, "two"))), kHostLost);
  PutMachine("m");
  EXPECT_FALSE(Must(store().GetMachineMark("m")));
  Reopen();
  EXPECT_GT(Must(store().TakeMachine(Claim("a"))).fence, lease.fence);
}

// LIVE-7.09: what was taught, newest first, counted within the machine; it goes with the machine.
TEST_P(StoreConformance, WhatWasTaughtIsKept) {
  PutMachine("m");
  PutMachine("n");
  const auto add = [&](const std::string& machine, int program, const std::string& entry) {
    return Must(store().AddTeachRecord({.machine = machine, .program = program, .entry = entry}));
  };
  EXPECT_EQ(add("m", 12, "a"), 1);
  EXPECT_EQ(add("m", 13, std::string("b\0c", 3)), 2);
  EXPECT_EQ(add("n", 12, "d"), 1);
  EXPECT_EQ(add("m", 12, "e"), 3);
  const auto listed = [&](int program, std::int64_t before, int limit) {
    std::vector<std::string> entries;
    for (const TeachRecord& one : Must(other().ListTeachRecords("m", program, before, limit)))
      entries.push_back(std::to_string(one.number) + one.entry);
    return entries;
  };
  const TeachRecord newest = Must(store().ListTeachRecords("m", 0, 3, 1)).at(0);
  EXPECT_EQ(newest.machine, "m");
  EXPECT_EQ(newest.number, 2);
  EXPECT_EQ(newest.program, 13);
  EXPECT_THAT(listed(0, 0, 10), ElementsAre("3e", std::string("2b\0c", 4), "1a"));
  EXPECT_THAT(listed(12, 0, 10), ElementsAre("3e", "1a"));
  EXPECT_THAT(listed(12, 3, 10), ElementsAre("1a"));
  EXPECT_THAT(listed(0, 0, 1), ElementsAre("3e"));
  EXPECT_THAT(listed(0, 0, 0), IsEmpty());
  EXPECT_EQ(CodeOf(store().AddTeachRecord({.machine = "none"})), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().ListTeachRecords("none", 0, 0, 1)), ErrorCode::kCellUnknownMachine);
  ASSERT_TRUE(store().DeleteMachine("m", kAnyRevision));
  PutMachine("m");
  EXPECT_THAT(listed(0, 0, 10), IsEmpty());
}

// How a machine lives is part of its record.
TEST_P(StoreConformance, AMachineHasOptions) {
  MachineRecord machine{.id = "m", .family = "optimo", .options = std::string("a\0b", 3)};
  const MachineRecord put = Must(store().PutMachine(machine, 0));
  EXPECT_EQ(Must(other().GetMachine("m")).options, machine.options);
  machine.options.clear();
  Must(store().PutMachine(machine, put.revision));
  EXPECT_EQ(Must(other().GetMachine("m")).options, "");
  EXPECT_EQ(Must(other().ListMachines()).front().options, "");
}

// LIVE-5.04, LIVE-5.10: a job that a person begins is leased by its number, though it is held and
// others stand before it; of a machine that runs none.
TEST_P(StoreConformance, OneJobIsLeasedByItsNumber) {
  PutMachine("m");
  const auto submit = [&](bool held) {
    return Must(store().SubmitAndWait({.machine = "m", .kind = "RUN", .held = held})).job.id;
  };
  const std::int64_t held = submit(true);
  const auto lease = [&](std::int64_t job) {
    return Must(store().AcquireJobs(
        {.worker = "w", .kinds = {"RUN"}, .job = job, .duration = seconds(60)}));
  };
  const auto leased = lease(held);
  ASSERT_EQ(leased.size(), 1U);
  EXPECT_EQ(leased[0].job.id, held);
  const JobRecord running = Must(other().GetJob(held));
  EXPECT_EQ(running.state, JobState::kRunning);
  EXPECT_FALSE(running.held);
  const std::int64_t first = submit(false);
  const std::int64_t later = submit(false);
  EXPECT_THAT(lease(later), IsEmpty());  // the machine is busy
  EXPECT_THAT(lease(held), IsEmpty());   // it does not wait
  Must(store().Finish(leased[0].lease, {.outcome = {.state = JobState::kSucceeded}}));
  EXPECT_EQ(lease(later).size(), 1U);
  EXPECT_EQ(Must(other().GetJob(first)).state, JobState::kQueued);
  const auto code = [&](std::int64_t job) {
    return CodeOf(store().AcquireJobs(
        {.worker = "w", .kinds = {"RUN"}, .job = job, .duration = seconds(60)}));
  };
  EXPECT_EQ(code(4711), ErrorCode::kCellNotFound);
  // One that waits for another one is begun by nobody.
  const std::int64_t follower =
      Must(store().SubmitAndWait({.machine = "m", .kind = "RUN", .held = true, .after = {first}}))
          .job.id;
  EXPECT_EQ(code(follower), ErrorCode::kCellPrecondition);
}

}  // namespace
}  // namespace rmlcell::storage
