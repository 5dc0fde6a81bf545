// Machines, laser schedules and projects of any Store.
#include <gmock/gmock.h>

#include <limits>
#include <thread>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Text that a careless store would cut, fold or quote.
const std::string kOddText = std::string("it's \"\xC3\xA9\xFF\0;--%_\n", 16);

std::vector<std::string> IdsOf(const std::vector<ProjectRecord>& projects) {
  std::vector<std::string> ids;
  for (const ProjectRecord& project : projects) ids.push_back(project.id);
  return ids;
}

// store.h, machines: every field comes back, and is still there after a restart.
TEST_P(StoreConformance, MachineComesBackAsItWasPut) {
  const MachineRecord machine{.id = "optimo-1",
                              .family = "optimo",
                              .title = kOddText,
                              .profile = "standard",
                              .parameters = {{"axis.x.max_mm", "3000"}, {"", kOddText}}};
  const MachineRecord put = Must(store().PutMachine(machine, 0));
  EXPECT_EQ(put.revision, 1);
  EXPECT_EQ(put.created_at, clock().Now());
  Reopen();
  const MachineRecord got = Must(store().GetMachine("optimo-1"));
  EXPECT_EQ(got.family, "optimo");
  EXPECT_EQ(got.title, kOddText);
  EXPECT_EQ(got.profile, "standard");
  EXPECT_EQ(got.parameters, machine.parameters);
  EXPECT_EQ(got.revision, 1);
  EXPECT_EQ(got.created_at, put.created_at);
  EXPECT_EQ(got.updated_at, put.updated_at);
}

// store.h: `created_at` is of the first put, `updated_at` of the newest; parameters are replaced,
// not added.
TEST_P(StoreConformance, PuttingAMachineAgainReplacesIt) {
  const WallTime first = clock().Now();
  Must(store().PutMachine({.id = "m", .parameters = {{"a", "1"}, {"b", "2"}}}, 0));
  clock().Advance(std::chrono::seconds(5));
  const MachineRecord put = Must(store().PutMachine({.id = "m", .parameters = {{"b", "3"}}}, 1));
  EXPECT_EQ(put.revision, 2);
  EXPECT_EQ(put.created_at, first);
  EXPECT_EQ(put.updated_at, first + std::chrono::seconds(5));
  const MachineRecord got = Must(store().GetMachine("m"));
  EXPECT_EQ(got.parameters, (std::map<std::string, std::string>{{"b", "3"}}));
  EXPECT_EQ(got.revision, 2);
}

// store.h, `expected`: each way in which it may not fit has its own code, and nothing changes.
TEST_P(StoreConformance, ExpectedRevisionOfAMachineIsChecked) {
  EXPECT_EQ(CodeOf(store().GetMachine("m")), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().PutMachine({.id = "m"}, 1)), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().PutMachine({.id = ""}, kAnyRevision)), ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(Must(store().ListMachines()), IsEmpty());

  Must(store().PutMachine({.id = "m", .title = "first"}, 0));
  EXPECT_EQ(CodeOf(store().PutMachine({.id = "m"}, 0)), ErrorCode::kCellAlreadyExists);
  EXPECT_EQ(CodeOf(store().PutMachine({.id = "m"}, 2)), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(CodeOf(store().PutMachine({.id = "m"}, -7)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Must(store().GetMachine("m")).title, "first");
  EXPECT_EQ(Must(store().PutMachine({.id = "m", .title = "second"}, kAnyRevision)).revision, 2);
}

// store.h DeleteMachine: programs and schedules go with it, finished jobs stay, and revisions count
// on.
TEST_P(StoreConformance, DeletedMachineTakesItsMemoryAlong) {
  Must(store().PutMachine({.id = "m", .parameters = {{"a", "1"}}}, 0));
  PutMachine("other");
  PutProgram("m", 7, "first");
  PutProgram("m", 7, "second");
  PutProgram("m", 1, "of the first slot");
  PutProgram("other", 7, "second");
  Must(store().PutSchedule({.machine = "m", .number = 11, .name = "thin"}, 0));
  const LeasedJob leased = (Submit("SIMULATE", "m"), Acquire());
  Finish(leased.lease);
  EXPECT_EQ(CodeOf(store().DeleteMachine("none", kAnyRevision)), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().DeleteMachine("m", 2)), ErrorCode::kCellEtagMismatch);
  Must(store().DeleteMachine("m", 1));
  Reopen();
  EXPECT_EQ(CodeOf(store().GetMachine("m")), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().ListPrograms("m", 0, 99)), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().DeleteMachine("m", kAnyRevision)), ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(Must(store().GetProgram("other", 7)).object, "second");
  EXPECT_EQ(Must(store().GetJob(leased.job.id)).machine, "m");

  EXPECT_EQ(Must(store().PutMachine({.id = "m"}, 0)).revision, 2);
  EXPECT_TRUE(Must(store().GetMachine("m")).parameters.empty());
  EXPECT_TRUE(Must(store().ListPrograms("m", 0, 99)).empty());
  EXPECT_TRUE(Must(store().ListSchedules("m")).empty());
  EXPECT_EQ(PutProgram("m", 7, "third").revision, 3);
}

TEST_P(StoreConformance, MachineWithUnfinishedJobsIsNotDeleted) {
  PutMachine("m");
  PutMachine("n");
  PutProgram("m", 7, "object");
  Submit("SIMULATE", "m");
  EXPECT_EQ(CodeOf(store().DeleteMachine("m", kAnyRevision)), ErrorCode::kCellPrecondition);
  const LeasedJob leased = Acquire();
  EXPECT_EQ(CodeOf(store().DeleteMachine("m", kAnyRevision)), ErrorCode::kCellPrecondition);
  EXPECT_EQ(Must(store().GetProgram("m", 7)).object, "object");
  Must(store().DeleteMachine("n", kAnyRevision));  // the jobs are of another one
  Finish(leased.lease);
  Must(store().DeleteMachine("m", kAnyRevision));
}

// store.h: machines by id, in the order of their bytes.
TEST_P(StoreConformance, MachinesAreListedById) {
  for (const char* id : {"mill-2", "Optimo", "mill-10", "mill-1"}) PutMachine(id);
  std::vector<std::string> ids;
  for (const MachineRecord& machine : Must(store().ListMachines())) ids.push_back(machine.id);
  EXPECT_THAT(ids, ElementsAre("Optimo", "mill-1", "mill-10", "mill-2"));
}

TEST_P(StoreConformance, SchedulesComeBackByNumber) {
  PutMachine("optimo-1");
  PutMachine("optimo-2");
  for (const int number : {63, 2, 1}) {
    Must(store().PutSchedule({.machine = "optimo-1",
                              .number = number,
                              .name = Numbered("s", number),
                              .mode = "PULSE",
                              .power_percent = 12.5},
                             0));
  }
  Must(store().PutSchedule({.machine = "optimo-2", .number = 5}, 0));
  Reopen();
  const std::vector<ScheduleRecord> schedules = Must(store().ListSchedules("optimo-1"));
  ASSERT_EQ(schedules.size(), 3U);
  EXPECT_EQ(schedules[0].number, 1);
  EXPECT_EQ(schedules[2].number, 63);
  EXPECT_EQ(schedules[1].name, "s2");
  EXPECT_EQ(schedules[1].mode, "PULSE");
  EXPECT_EQ(schedules[1].power_percent, 12.5);
  EXPECT_EQ(schedules[1].revision, 1);
  EXPECT_EQ(schedules[1].updated_at, clock().Now());
}

// records.h: numbers 1 to 63, both sides; power is a number.
TEST_P(StoreConformance, BadSchedulesAreRefused) {
  PutMachine("m");
  const auto put = [&](int number, double power) {
    return CodeOf(store().PutSchedule({.machine = "m", .number = number, .power_percent = power},
                                      kAnyRevision));
  };
  EXPECT_EQ(put(0, 1.0), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(put(64, 1.0), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(put(1, std::numeric_limits<double>::quiet_NaN()), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(put(1, 1.0), std::nullopt);
  EXPECT_EQ(put(63, 1.0), std::nullopt);
  EXPECT_EQ(CodeOf(store().PutSchedule({.machine = "none", .number = 1}, kAnyRevision)),
            ErrorCode::kCellUnknownMachine);
  EXPECT_EQ(CodeOf(store().ListSchedules("none")), ErrorCode::kCellUnknownMachine);
}

// records.h, Revision: a record made again goes on counting, so an old expectation never fits.
TEST_P(StoreConformance, ScheduleMadeAgainCountsOn) {
  PutMachine("m");
  Must(store().PutSchedule({.machine = "m", .number = 3}, 0));
  Must(store().PutSchedule({.machine = "m", .number = 3}, 1));
  Must(store().DeleteSchedule("m", 3));
  EXPECT_EQ(CodeOf(store().DeleteSchedule("m", 3)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().PutSchedule({.machine = "m", .number = 3}, 2)),
            ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().PutSchedule({.machine = "m", .number = 3}, 0)).revision, 3);
  EXPECT_EQ(CodeOf(store().PutSchedule({.machine = "m", .number = 3}, 2)),
            ErrorCode::kCellEtagMismatch);
}

TEST_P(StoreConformance, ProjectComesBackAsItWasPut) {
  const ProjectRecord project{.id = "bracket", .title = kOddText, .body = Noise(3'000'000, 2)};
  EXPECT_EQ(Must(store().PutProject(project, 0)).revision, 1);
  Reopen();
  const ProjectRecord got = Must(store().GetProject("bracket"));
  EXPECT_EQ(got.title, kOddText);
  EXPECT_EQ(got.body, project.body);
  EXPECT_EQ(got.revision, 1);
  EXPECT_EQ(got.created_at, clock().Now());
}

TEST_P(StoreConformance, ExpectedRevisionOfAProjectIsChecked) {
  EXPECT_EQ(CodeOf(store().GetProject("p")), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().PutProject({.id = "p"}, 1)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().PutProject({.id = ""}, 0)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().DeleteProject("p", kAnyRevision)), ErrorCode::kCellNotFound);
  Must(store().PutProject({.id = "p", .body = "one"}, 0));
  EXPECT_EQ(CodeOf(store().PutProject({.id = "p"}, 0)), ErrorCode::kCellAlreadyExists);
  EXPECT_EQ(CodeOf(store().DeleteProject("p", 2)), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Must(store().GetProject("p")).body, "one");
  Must(store().DeleteProject("p", 1));
  EXPECT_EQ(CodeOf(store().GetProject("p")), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().PutProject({.id = "p"}, 0)).revision, 2);
}

// AIP-158 by way of store.h: pages cover everything once.
TEST_P(StoreConformance, ProjectsAreListedInPages) {
  for (const char* id : {"e", "b", "d", "a", "c"}) Must(store().PutProject({.id = id}, 0));
  EXPECT_THAT(IdsOf(Must(store().ListProjects("", 2))), ElementsAre("a", "b"));
  EXPECT_THAT(IdsOf(Must(store().ListProjects("b", 2))), ElementsAre("c", "d"));
  EXPECT_THAT(IdsOf(Must(store().ListProjects("d", 2))), ElementsAre("e"));
  EXPECT_THAT(IdsOf(Must(store().ListProjects("e", 2))), IsEmpty());
  EXPECT_THAT(IdsOf(Must(store().ListProjects("", 0))), IsEmpty());
  EXPECT_THAT(IdsOf(Must(store().ListProjects("", -1))), IsEmpty());
}

// AIP-154 by way of store.h: of many who change the same revision exactly one wins.
TEST_P(StoreConformance, OneOfManyWritersOfARevisionWins) {
  Must(store().PutProject({.id = "p"}, 0));
  std::atomic<int> won = 0;
  std::atomic<int> lost = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
      threads.emplace_back([&, i] {
        const auto put = store().PutProject({.id = "p", .title = std::to_string(i)}, 1);
        if (put) ++won;
        if (CodeOf(put) == ErrorCode::kCellEtagMismatch) ++lost;
      });
    }
  }
  EXPECT_EQ(won, 1);
  EXPECT_EQ(lost, 7);
  EXPECT_EQ(Must(store().GetProject("p")).revision, 2);
}

}  // namespace
}  // namespace rmlcell::storage
