// What stands for now, and events as they are told, also where the store cannot be read.
#include "server/services/cell_snapshot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/config.h"
#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/records/machine_messages.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class CellSnapshotTest : public testing::Test {
 protected:
  CellSnapshotTest() {
    Must(bed_.store().PutPrograms("optimo-1", {{.slot = 45, .name = "Lid", .object = "o"}},
                                  {{.number = 7, .power_percent = 40.0}}));
    Must(bed_.store().PutProject({.id = "lid", .title = "Lid"}, 0));
  }

  ReadEvent Told(const storage::EventRecord& event) { return EventOf(records, event); }
  ReadEvent Told(const std::string& resource, std::string_view kind) {
    return Told({.resource = resource, .kind = std::string(kind)});
  }
  // Of one part of the cell: those of these names, or all.
  Result<v1::CellSnapshot> Snapshot(const std::string& part,
                                    const std::vector<std::string>& names = {}) {
    v1::Subscription wanted;
    wanted.set_id("a");
    if (part == "jobs") {
      wanted.mutable_jobs()->mutable_names()->Add(names.begin(), names.end());
      wanted.mutable_jobs();
    } else if (part == "machines") {
      wanted.mutable_machines()->mutable_names()->Add(names.begin(), names.end());
    } else {
      wanted.mutable_projects()->mutable_names()->Add(names.begin(), names.end());
    }
    return SnapshotOf(records, Must(CellSubscription::Make(wanted)));
  }

  ServerBed bed_;
  FailingStore store{bed_.store()};
  Config config;
  JobBook jobs{store, config};
  ProgramBook programs{store, config};
  ProjectBook projects{store};
  CellRecords records{store, jobs, programs, projects};
};

TEST_F(CellSnapshotTest, AnEventSaysWhereWhenAndWho) {
  const storage::WallTime at{std::chrono::seconds(1'000)};
  const v1::CellEvent event = Told({.position = 17,
                                    .resource = "projects/lid",
                                    .at = at,
                                    .caller = "anna",
                                    .kind = "updated"})
                                  .event;
  EXPECT_EQ(event.sequence(), 17);
  EXPECT_EQ(event.resource(), "projects/lid");
  EXPECT_EQ(event.time().seconds(), 1'000);
  EXPECT_EQ(event.caller(), "anna");
  const v1::CellEvent of_job =
      Told({.position = 18, .job = 4, .sequence = 3, .kind = "state"}).event;
  EXPECT_EQ(of_job.resource(), "jobs/4");
  EXPECT_EQ(of_job.job().sequence(), 3);
  EXPECT_TRUE(Told("jobs/4", storage::kDeleted).event.job_deleted());
}

// Each kind of record by what became of it, and what it is by now.
TEST_F(CellSnapshotTest, AnEventOfARecordHasTheRecord) {
  const std::pair<std::string_view, v1::RecordChange> changes[] = {
      {storage::kCreated, v1::RECORD_CHANGE_CREATED},
      {storage::kUpdated, v1::RECORD_CHANGE_UPDATED},
      {storage::kDeleted, v1::RECORD_CHANGE_DELETED},
      {"of tomorrow", v1::RECORD_CHANGE_UNSPECIFIED}};
  const std::string of_machine = "machines/optimo-1";
  for (const auto& [kind, change] : changes) {
    const bool there = change != v1::RECORD_CHANGE_DELETED;
    const v1::MachineChanged machine = Told(of_machine, kind).event.machine().changed();
    EXPECT_EQ(machine.change(), change);
    EXPECT_EQ(machine.machine().name(), of_machine);
    EXPECT_EQ(machine.machine().family(), there ? "optimo" : "");
    EXPECT_FALSE(machine.machine().has_status());
    const v1::ProgramEvent program = Told(of_machine + "/programs/45", kind).event.program();
    EXPECT_EQ(program.change(), change);
    EXPECT_EQ(program.program().name(), of_machine + "/programs/45");
    EXPECT_EQ(program.program().title(), there ? "Lid" : "");
    const v1::ProgramEvent schedule = Told(of_machine + "/laserSchedules/7", kind).event.program();
    EXPECT_EQ(schedule.change(), change);
    EXPECT_EQ(schedule.laser_schedule().name(), of_machine + "/laserSchedules/7");
    EXPECT_EQ(schedule.laser_schedule().power_percent(), there ? 40.0 : 0.0);
    const v1::ProjectEvent project = Told("projects/lid", kind).event.project();
    EXPECT_EQ(project.change(), change);
    EXPECT_EQ(project.project().name(), "projects/lid");
    EXPECT_EQ(project.project().title(), there ? "Lid" : "");
  }
}

// Gone meanwhile: its name alone, and that is all there is to tell.
TEST_F(CellSnapshotTest, AnEventOfARecordThatIsGoneHasItsName) {
  for (const char* gone :
       {"machines/none", "machines/none/programs/1", "machines/optimo-1/programs/1",
        "machines/none/laserSchedules/1", "machines/optimo-1/laserSchedules/1",
        "machines/x/laserSchedules/y", "projects/none"}) {
    const ReadEvent told = Told(gone, storage::kUpdated);
    EXPECT_TRUE(told.whole) << gone;
    EXPECT_EQ(told.event.resource(), gone);
  }
}

TEST_F(CellSnapshotTest, AnEventThatCannotBeReadIsNotWhole) {
  for (const char* resource : {"machines/optimo-1", "machines/optimo-1/programs/45",
                               "machines/optimo-1/laserSchedules/7", "projects/lid"}) {
    store.FailAt(1);
    EXPECT_FALSE(Told(resource, storage::kUpdated).whole) << resource;
    store.FailAt(1);
    EXPECT_TRUE(Told(resource, storage::kDeleted).whole) << resource;  // nothing is read
    store.FailAt(0);
    EXPECT_TRUE(Told(resource, storage::kUpdated).whole) << resource;
  }
}

TEST_F(CellSnapshotTest, WhatAMachineTellsIsHandedOn) {
  v1::MachineEvent said;
  said.set_acknowledged_alarm(5);
  const storage::EventRecord event{.resource = "machines/optimo-1",
                                   .kind = std::string(kMachineEvent),
                                   .payload = said.SerializeAsString()};
  EXPECT_EQ(Told(event).event.machine().acknowledged_alarm(), 5);
  EXPECT_TRUE(Told(event).whole);
  storage::EventRecord damaged = event;
  damaged.payload = "\xFF";
  EXPECT_FALSE(Told(damaged).whole);
}

TEST_F(CellSnapshotTest, OfJobs) {
  const std::int64_t first = bed_.SubmitCheck();
  const std::int64_t second = bed_.SubmitCheck();
  const std::int64_t third = bed_.SubmitCheck();
  bed_.Lease();
  const v1::CellSnapshot named =
      Must(Snapshot("jobs", {JobName(third), "jobs/99", JobName(first), JobName(second)}));
  ASSERT_EQ(named.jobs_size(), 3);  // in the order in which they were asked for
  EXPECT_EQ(named.jobs(0).name(), JobName(third));
  EXPECT_EQ(named.jobs(1).name(), JobName(first));
  ASSERT_EQ(named.counts_size(), 2);
  EXPECT_EQ(named.counts(0).state(), v1::Job::STATE_QUEUED);
  EXPECT_EQ(named.counts(0).jobs(), 2);
  EXPECT_EQ(named.counts(1).state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(named.counts(1).jobs(), 1);
  EXPECT_EQ(Must(Snapshot("jobs")).jobs_size(), 3);
}

TEST_F(CellSnapshotTest, OfMachinesAndProjects) {
  const v1::CellSnapshot one = Must(Snapshot("machines", {"machines/mill-1", "machines/none"}));
  ASSERT_EQ(one.machines_size(), 1);
  EXPECT_EQ(one.machines(0).name(), "machines/mill-1");
  EXPECT_EQ(one.machines(0).family(), "rml1");
  EXPECT_EQ(one.machines(0).status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Must(Snapshot("machines")).machines_size(), 2);
  for (int i = 0; i < 150; ++i)  // more than a page
    Must(bed_.store().PutProject({.id = "p" + std::to_string(i)}, 0));
  EXPECT_EQ(Must(Snapshot("projects")).projects_size(), 151);
  const v1::CellSnapshot few = Must(Snapshot("projects", {"projects/p149", "projects/lid"}));
  ASSERT_EQ(few.projects_size(), 2);
  EXPECT_EQ(few.projects(0).title(), "Lid");
}

TEST_F(CellSnapshotTest, WithoutTheStoreThereIsNone) {
  const std::string job = JobName(bed_.SubmitCheck());
  const auto expect_handed_on = [&](const std::string& part,
                                    const std::vector<std::string>& names) {
    for (int call = 1;; ++call) {
      store.FailAt(call);
      const std::optional<ErrorCode> code = CodeOf(Snapshot(part, names));
      const bool failed = store.failed();
      EXPECT_EQ(code, failed ? std::optional(ErrorCode::kCellStoreFailed) : std::nullopt)
          << part << ", call " << call;
      if (failed && code) continue;
      EXPECT_GT(call, 1) << part;
      break;
    }
    store.FailAt(0);
  };
  expect_handed_on("jobs", {});
  expect_handed_on("jobs", {job});
  expect_handed_on("machines", {});
  expect_handed_on("projects", {});
}

}  // namespace
}  // namespace rmlcell::server
