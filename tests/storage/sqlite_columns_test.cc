// What is put into the embedded store comes back field by field: no two fields alike here.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using testing::ElementsAre;

class SqliteColumns : public testing::Test {
 protected:
  Store& store() { return bed_.store(); }
  TestClock& clock() { return bed_.clock(); }
  WallTime Now() { return clock().Now(); }

  SqliteBed bed_;
};

TEST_F(SqliteColumns, OfAJobThatWaits) {
  const std::int64_t first = Must(store().SubmitAndWait({.kind = "CHECK"})).job.id;
  clock().Advance(milliseconds(7));
  const WallTime submitted_at = Now();
  const NewJob wanted{.request_id = "the request",
                      .request_hash = "its hash",
                      .machine = "a machine",
                      .family = "a family",
                      .kind = "SIMULATE",
                      .pool = "a pool",
                      .title = "a title",
                      .caller = "a caller",
                      .labels = {"one", "two"},
                      .specification = "a specification",
                      .attempts_max = 6,
                      .priority = -5,
                      .held = true,
                      .not_before = submitted_at + hours(9),
                      .after = {first},
                      .events = {{.kind = "state"}, {.kind = "step"}, {.kind = "step"}}};
  const std::int64_t id = Must(store().SubmitAndWait(wanted)).job.id;
  clock().Advance(milliseconds(11));
  bed_.Reopen();
  const JobRecord job = Must(store().GetJob(id));
  EXPECT_EQ(job.id, id);
  EXPECT_EQ(job.request_id, "the request");
  EXPECT_EQ(job.request_hash, "its hash");
  EXPECT_EQ(job.machine, "a machine");
  EXPECT_EQ(job.family, "a family");
  EXPECT_EQ(job.kind, "SIMULATE");
  EXPECT_EQ(job.pool, "a pool");
  EXPECT_EQ(job.title, "a title");
  EXPECT_EQ(job.caller, "a caller");
  EXPECT_THAT(job.labels, ElementsAre("one", "two"));
  EXPECT_EQ(job.specification, "a specification");
  EXPECT_EQ(job.state, JobState::kQueued);
  EXPECT_EQ(job.priority, -5);
  EXPECT_EQ(job.place, static_cast<double>(id));
  EXPECT_TRUE(job.held);
  EXPECT_TRUE(job.blocked);
  EXPECT_EQ(job.not_before, submitted_at + hours(9));
  EXPECT_THAT(job.after, ElementsAre(first));
  EXPECT_FALSE(job.cancel_requested);
  EXPECT_EQ(job.attempts, 0);
  EXPECT_EQ(job.attempts_max, 6);
  EXPECT_EQ(job.last_sequence, 3);
  EXPECT_EQ(job.events_gone_until, 0);
  EXPECT_EQ(job.created_at, submitted_at);
  EXPECT_EQ(job.started_at, std::nullopt);
  EXPECT_EQ(job.finished_at, std::nullopt);
  EXPECT_EQ(Must(store().FindSubmitted("the request", "its hash"))->id, id);
}

TEST_F(SqliteColumns, OfAJobThatEnded) {
  const std::int64_t id =
      Must(store().SubmitAndWait({.request_hash = "h", .kind = "CHECK", .attempts_max = 9})).job.id;
  std::optional<Lease> lease;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    clock().Advance(hours(attempt));
    const auto leased =
        Must(store().Acquire("w" + std::to_string(attempt), {"CHECK"}, hours(1), {}));
    ASSERT_TRUE(leased);
    lease = leased->lease;
    EXPECT_EQ(lease->attempt, attempt);
    if (attempt == 1) Must(store().HandBack(*lease, PolicyOfTests()));
    if (attempt == 2) Must(store().RequestCancel(id, {}));
    if (attempt == 2) Must(store().Abandon(*lease, {.outcome = {.state = JobState::kFailed}}));
  }
  const WallTime first_at = Now() - hours(5);
  clock().Advance(milliseconds(250));
  Must(store().Finish(*lease, {.outcome = {.state = JobState::kFailed,
                                           .code = ErrorCode::kCellWorkerDied,
                                           .detail = "a detail",
                                           .program = 12,
                                           .step = 34,
                                           .judgement = std::string("j\0k", 3),
                                           .verdict = "BAD"}}));
  const JobRecord job = Must(store().GetJob(id));
  EXPECT_EQ(job.state, JobState::kFailed);
  ASSERT_TRUE(job.outcome);
  EXPECT_EQ(job.outcome->state, JobState::kFailed);
  EXPECT_EQ(job.outcome->code, ErrorCode::kCellWorkerDied);
  EXPECT_EQ(job.outcome->detail, "a detail");
  EXPECT_EQ(job.outcome->program, 12);
  EXPECT_EQ(job.outcome->step, 34);
  EXPECT_EQ(job.outcome->judgement, std::string("j\0k", 3));
  EXPECT_EQ(job.outcome->verdict, "BAD");
  EXPECT_TRUE(job.cancel_requested);
  EXPECT_EQ(job.attempts, 2);  // one was handed back
  EXPECT_EQ(job.attempts_max, 9);
  EXPECT_EQ(job.started_at, first_at);
  EXPECT_EQ(job.finished_at, Now());
  EXPECT_FALSE(job.held);
  EXPECT_FALSE(job.blocked);
}

TEST_F(SqliteColumns, OfAttempts) {
  const std::int64_t id = Must(store().SubmitAndWait({.kind = "CHECK", .attempts_max = 9})).job.id;
  const WallTime at = Now();
  const auto one = Must(store().Acquire("a worker", {"CHECK"}, hours(3), {}));
  ASSERT_TRUE(one);
  clock().Advance(milliseconds(40));
  Must(store().HandBack(one->lease, PolicyOfTests()));
  clock().Advance(milliseconds(80));
  const auto other = Must(store().Acquire("another", {"CHECK"}, hours(3), {}));
  ASSERT_TRUE(other);
  const std::vector<AttemptRecord> attempts = Must(store().ListAttempts(id));
  ASSERT_EQ(attempts.size(), 2u);
  EXPECT_EQ(attempts[0].job, id);
  EXPECT_EQ(attempts[0].number, 1);
  EXPECT_EQ(attempts[0].worker, "a worker");
  EXPECT_EQ(attempts[0].fence, one->lease.fence);
  EXPECT_EQ(attempts[0].started_at, at);
  EXPECT_EQ(attempts[0].ended_at, at + milliseconds(40));
  EXPECT_EQ(attempts[0].how_it_ended, "handed back");
  EXPECT_EQ(attempts[1].number, 2);
  EXPECT_EQ(attempts[1].worker, "another");
  EXPECT_EQ(attempts[1].fence, other->lease.fence);
  EXPECT_EQ(attempts[1].started_at, at + milliseconds(120));
  EXPECT_EQ(attempts[1].ended_at, std::nullopt);
  EXPECT_EQ(attempts[1].how_it_ended, "");
  EXPECT_FALSE(Must(store().GetJob(id)).cancel_requested);
  Must(store().Finish(other->lease,
                      {.outcome = {.state = JobState::kSucceeded, .detail = "a detail"}}));
  const JobRecord ended = Must(store().GetJob(id));
  EXPECT_EQ(ended.outcome->code, std::nullopt);
  EXPECT_EQ(ended.outcome->detail, "a detail");
}

// Held and due later are two things.
TEST_F(SqliteColumns, OfWhatAJobWaitsFor) {
  const auto put = [&](bool held, std::optional<WallTime> not_before) {
    const std::int64_t id =
        Must(store().SubmitAndWait({.kind = "CHECK", .held = held, .not_before = not_before}))
            .job.id;
    return Must(store().GetJob(id));
  };
  const JobRecord later = put(false, Now() + hours(1));
  EXPECT_FALSE(later.held);
  EXPECT_TRUE(later.blocked);
  EXPECT_EQ(later.wait, WaitReason::kNotBefore);
  const JobRecord held = put(true, std::nullopt);
  EXPECT_TRUE(held.held);
  EXPECT_TRUE(held.blocked);
  EXPECT_EQ(held.not_before, std::nullopt);
  EXPECT_FALSE(put(false, std::nullopt).blocked);
}

// An order comes with the lease that it is for.
TEST_F(SqliteColumns, OfOrders) {
  Must(store().SubmitAndWait({.kind = "CHECK"}));
  const std::int64_t id = Must(store().SubmitAndWait({.kind = "SIMULATE"})).job.id;
  Must(store().AcquireJobs(
      {.worker = "x", .server = "y", .kinds = {"CHECK"}, .duration = hours(1)}));
  const std::vector<LeasedJob> leased = Must(store().AcquireJobs(
      {.worker = "a worker", .server = "a server", .kinds = {"SIMULATE"}, .duration = hours(7)}));
  ASSERT_EQ(leased.size(), 1u);
  Must(store().PutOrder(id, "another server", "a payload"));
  const std::vector<TakenOrder> orders = Must(store().TakeOrders("a server"));
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].payload, "a payload");
  EXPECT_EQ(orders[0].lease.job, id);
  EXPECT_EQ(orders[0].lease.attempt, 1);
  EXPECT_EQ(orders[0].lease.fence, leased[0].lease.fence);
  EXPECT_EQ(orders[0].lease.worker, "a worker");
  EXPECT_EQ(orders[0].lease.server, "a server");
  EXPECT_EQ(orders[0].lease.until, Now() + hours(7));
}

// Who hosts a machine, and where that stands.
TEST_F(SqliteColumns, OfMachinesAndTheirHosts) {
  const MachineRecord wanted{.id = "m",
                             .family = "a family",
                             .title = "a title",
                             .profile = "a profile",
                             .parameters = {{"NAME", "value"}, {"OTHER", "7"}},
                             .options = "options"};
  const WallTime made_at = Now();
  Must(store().PutMachine(wanted, 0));
  clock().Advance(milliseconds(30));
  Must(store().PutMachine(wanted, 1));
  const WallTime changed_at = Now();
  const MachineLease taken = Must(store().TakeMachine({.machine = "m",
                                                       .host = "a host",
                                                       .server = "a server",
                                                       .duration = milliseconds(1'234),
                                                       .pinned = true}));
  MachineLease renewed = taken;
  for (int i = 0; i < 3; ++i) renewed = Must(store().RenewMachine(taken, "another server"));
  EXPECT_EQ(renewed.renewals, taken.renewals + 3);
  clock().Advance(milliseconds(70));
  Must(store().AppendMachine(
      renewed,
      {.mark = MachineMark{.sequence = 8, .state = "a state", .note = "a note", .clean = false}}));
  bed_.Reopen();
  const MachineRecord machine = Must(store().GetMachine("m"));
  EXPECT_EQ(machine.family, "a family");
  EXPECT_EQ(machine.title, "a title");
  EXPECT_EQ(machine.profile, "a profile");
  EXPECT_EQ(machine.parameters, wanted.parameters);
  EXPECT_EQ(machine.options, "options");
  EXPECT_EQ(machine.revision, 2);
  EXPECT_EQ(machine.created_at, made_at);
  EXPECT_EQ(machine.updated_at, changed_at);
  const std::vector<MachineLease> leases = Must(store().MachineLeases());
  ASSERT_EQ(leases.size(), 1u);
  EXPECT_EQ(leases[0], (MachineLease{.machine = "m",
                                     .host = "a host",
                                     .server = "another server",
                                     .fence = taken.fence,
                                     .renewals = taken.renewals + 3,
                                     .duration = milliseconds(1'234),
                                     .pinned = true}));
  const auto mark = Must(store().GetMachineMark("m"));
  ASSERT_TRUE(mark);
  EXPECT_EQ(mark->fence, taken.fence);
  EXPECT_EQ(mark->sequence, 8);
  EXPECT_EQ(mark->state, "a state");
  EXPECT_EQ(mark->note, "a note");
  EXPECT_FALSE(mark->clean);
  EXPECT_EQ(mark->at, changed_at + milliseconds(70));
}

TEST_F(SqliteColumns, OfPrograms) {
  Must(store().PutMachine({.id = "m"}, 0));
  const auto put = [&](const std::string& object) {
    Must(store().PutPrograms("m",
                             {{.slot = 45,
                               .name = "a name",
                               .object = object,
                               .source = "a longer source",
                               .source_name = "a.S"},
                              {.slot = 46, .name = "bare", .object = "xy"}},
                             {}));
  };
  const WallTime made_at = Now();
  put("old");
  clock().Advance(milliseconds(50));
  put("object");
  const WallTime changed_at = Now();
  ASSERT_TRUE(Must(store().PutExecutable("m", 45, 2, "executable!")));
  const ProgramSummary summary = Must(store().GetProgramSummary("m", 45));
  EXPECT_EQ(summary.slot, 45);
  EXPECT_EQ(summary.name, "a name");
  EXPECT_EQ(summary.source_name, "a.S");
  EXPECT_EQ(summary.object_bytes, 6);
  EXPECT_EQ(summary.source_bytes, 15);
  EXPECT_EQ(summary.executable_bytes, 11);
  EXPECT_EQ(summary.object_sha256, HexOf(Sha256("object")));
  EXPECT_EQ(summary.revision, 2);
  EXPECT_EQ(summary.created_at, made_at);
  EXPECT_EQ(summary.updated_at, changed_at);
  const ProgramRecord program = Must(store().GetProgram("m", 45));
  EXPECT_EQ(program.machine, "m");
  EXPECT_EQ(program.slot, 45);
  EXPECT_EQ(program.name, "a name");
  EXPECT_EQ(program.object, "object");
  EXPECT_EQ(program.source, "a longer source");
  EXPECT_EQ(program.source_name, "a.S");
  EXPECT_EQ(program.executable, "executable!");
  EXPECT_EQ(program.revision, 2);
  EXPECT_EQ(program.created_at, made_at);
  EXPECT_EQ(program.updated_at, changed_at);
  const ProgramSummary bare = Must(store().GetProgramSummary("m", 46));
  EXPECT_EQ(bare.source_bytes, -1);
  EXPECT_EQ(bare.executable_bytes, -1);
}

TEST_F(SqliteColumns, OfSchedulesAndProjects) {
  Must(store().PutMachine({.id = "m"}, 0));
  const ScheduleRecord wanted{
      .machine = "m", .number = 17, .name = "a name", .mode = "a mode", .power_percent = 62.5};
  Must(store().PutSchedule(wanted, 0));
  clock().Advance(milliseconds(20));
  Must(store().PutSchedule(wanted, 1));
  const std::vector<ScheduleRecord> schedules = Must(store().ListSchedules("m"));
  ASSERT_EQ(schedules.size(), 1u);
  EXPECT_EQ(schedules[0].machine, "m");
  EXPECT_EQ(schedules[0].number, 17);
  EXPECT_EQ(schedules[0].name, "a name");
  EXPECT_EQ(schedules[0].mode, "a mode");
  EXPECT_EQ(schedules[0].power_percent, 62.5);
  EXPECT_EQ(schedules[0].revision, 2);
  EXPECT_EQ(schedules[0].updated_at, Now());
  const WallTime made_at = Now();
  Must(store().PutProject({.id = "p", .title = "a title", .body = "one"}, 0));
  clock().Advance(milliseconds(60));
  Must(store().PutProject({.id = "p", .title = "a title", .body = "two"}, 1));
  const ProjectRecord project = Must(store().GetProject("p"));
  EXPECT_EQ(project.id, "p");
  EXPECT_EQ(project.title, "a title");
  EXPECT_EQ(project.body, "two");
  EXPECT_EQ(project.revision, 2);
  EXPECT_EQ(project.created_at, made_at);
  EXPECT_EQ(project.updated_at, made_at + milliseconds(60));
}

TEST_F(SqliteColumns, OfEventsAndArtifacts) {
  Must(store().PutMachine({.id = "m"}, 0, "an owner"));
  const std::int64_t id =
      Must(store().SubmitAndWait(
               {.kind = "CHECK",
                .attachments = {{.name = "program", .media_type = "text/x", .bytes = "abcde"}},
                .events = {{.kind = "state", .payload = "queued", .caller = "me"}}}))
          .job.id;
  clock().Advance(milliseconds(15));
  const auto leased = Must(store().Acquire("w", {"CHECK"}, hours(1), {}));
  ASSERT_TRUE(leased);
  ASSERT_EQ(Must(store().AppendAndWait(leased->lease, {{.kind = "step", .payload = "7"}})), 2);
  const std::vector<EventRecord> all = Must(store().AllEvents(0, 9));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].job, 0);
  EXPECT_EQ(all[0].resource, "machines/m");
  EXPECT_EQ(all[0].kind, "created");
  EXPECT_EQ(all[0].caller, "an owner");
  EXPECT_EQ(all[1].position, all[0].position + 1);
  EXPECT_EQ(all[1].job, id);
  EXPECT_EQ(all[1].resource, "");
  EXPECT_EQ(all[1].sequence, 1);
  EXPECT_EQ(all[1].attempt, 0);
  EXPECT_EQ(all[1].kind, "state");
  EXPECT_EQ(all[1].payload, "queued");
  EXPECT_EQ(all[1].caller, "me");
  EXPECT_EQ(all[1].at, Now() - milliseconds(15));
  EXPECT_EQ(all[2].sequence, 2);
  EXPECT_EQ(all[2].attempt, 1);
  EXPECT_EQ(all[2].payload, "7");
  EXPECT_EQ(all[2].at, Now());
  const ArtifactRecord artifact = Must(store().GetArtifact(id, "program"));
  EXPECT_EQ(artifact.job, id);
  EXPECT_EQ(artifact.name, "program");
  EXPECT_EQ(artifact.media_type, "text/x");
  EXPECT_EQ(artifact.size, 5);
  EXPECT_EQ(artifact.sha256, HexOf(Sha256("abcde")));
  EXPECT_EQ(Must(store().ReadArtifact(id, "program")), "abcde");
}

}  // namespace
}  // namespace rmlcell::storage
