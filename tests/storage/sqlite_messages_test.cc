// What the embedded store says of a refusal: which record it is about, and what stands there in its
// place.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "storage/sqlite/database.h"
#include "storage/sqlite/store_files.h"
#include "storage/sqlite/tables.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage::sqlite {
namespace {

// "the detail", or "none" where nothing was refused.
template <class T>
std::string DetailOf(const Result<T>& result) {
  return result ? "none" : result.error().detail;
}
std::string DetailOf(const Status& status) { return status ? "none" : status.error().detail; }

class SqliteMessages : public testing::Test {
 protected:
  Store& store() { return bed_.store(); }
  SqliteBed bed_;
};

TEST_F(SqliteMessages, OfRevisions) {
  EXPECT_EQ(DetailOf(store().PutMachine({.id = ""}, 0)), "a machine needs an id");
  EXPECT_EQ(DetailOf(store().PutMachine({.id = "m"}, 3)), "machine m");
  EXPECT_EQ(DetailOf(store().GetMachine("m")), "m");
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().PutMachine({.id = "m"}, 1));
  EXPECT_EQ(DetailOf(store().PutMachine({.id = "m"}, 0)), "machine m has revision 2");
  EXPECT_EQ(DetailOf(store().PutMachine({.id = "m"}, 5)), "machine m has revision 2, expected 5");
  EXPECT_EQ(DetailOf(store().PutMachine({.id = "m"}, -7)), "expected revision -7");
  EXPECT_EQ(DetailOf(store().PutProject({.id = ""}, 0)), "a project needs an id");
  EXPECT_EQ(DetailOf(store().GetProject("p")), "project p");
  EXPECT_EQ(DetailOf(store().PutProject({.id = "p"}, 1)), "project p");
  EXPECT_EQ(DetailOf(store().DeleteProject("p", kAnyRevision)), "project p");
  Must(store().PutProject({.id = "p"}, 0));
  EXPECT_EQ(DetailOf(store().DeleteProject("p", 2)), "project p has revision 1, expected 2");
}

TEST_F(SqliteMessages, OfProgramsAndSchedules) {
  Must(store().PutMachine({.id = "m"}, 0));
  const auto put = [&](const std::vector<ProgramWrite>& programs,
                       const std::vector<ScheduleRecord>& schedules = {}) {
    return DetailOf(store().PutPrograms("m", programs, schedules));
  };
  EXPECT_EQ(DetailOf(store().GetProgram("m", 12)), "slot 12 of m is empty");
  EXPECT_EQ(DetailOf(store().GetProgramSummary("m", 12)), "slot 12 of m is empty");
  EXPECT_EQ(DetailOf(store().DeleteProgram("m", 12, kAnyRevision)), "slot 12 of m is empty");
  EXPECT_EQ(DetailOf(store().DeleteExecutable("m", 12)), "slot 12 of m is empty");
  EXPECT_EQ(put({{.slot = 100}}), "slot 100");
  EXPECT_EQ(put({{.slot = 12}, {.slot = 12}}), "slot 12 is written twice");
  EXPECT_EQ(put({}, {{.number = 64}}), "laser schedule 64");
  EXPECT_EQ(put({}, {{.number = 5}, {.number = 5}}), "laser schedule 5 is written twice");
  EXPECT_EQ(put({}, {{.number = 5, .power_percent = std::nan("")}}),
            "power_percent is not a number");
  Must(store().PutPrograms("m", {{.slot = 12, .object = "o"}}, {{.number = 5}}));
  EXPECT_EQ(DetailOf(store().DeleteExecutable("m", 12)), "slot 12 of m has no executable");
  EXPECT_EQ(put({{.slot = 12, .object = "p", .expected = 4}}),
            "slot 12 of m has revision 1, expected 4");
  EXPECT_EQ(DetailOf(store().DeleteProgram("m", 12, 4)), "slot 12 of m has revision 1, expected 4");
  EXPECT_EQ(DetailOf(store().PutSchedule({.machine = "m", .number = 5}, 4)),
            "laser schedule 5 of m has revision 1, expected 4");
  EXPECT_EQ(DetailOf(store().DeleteSchedule("m", 6)), "laser schedule 6 of m");
  for (const auto& refused :
       {DetailOf(store().ListPrograms("n", 0, 1)), DetailOf(store().GetProgram("n", 1)),
        DetailOf(store().ListSchedules("n")), DetailOf(store().DeleteSchedule("n", 5)),
        DetailOf(store().DeleteProgram("n", 5, 1)), DetailOf(store().DeleteExecutable("n", 5)),
        DetailOf(store().PutSchedule({.machine = "n", .number = 5}, 0))})
    EXPECT_EQ(refused, "n");
}

TEST_F(SqliteMessages, OfJobs) {
  EXPECT_EQ(DetailOf(store().GetJob(7)), "job 7");
  EXPECT_EQ(DetailOf(store().JobEvents(7, 0, 1)), "job 7");
  EXPECT_EQ(DetailOf(store().SubmitAndWait({.kind = "CHECK", .attempts_max = 0})),
            "a job needs at least one attempt");
  Must(store().SubmitAndWait({.request_id = "r", .request_hash = "a", .kind = "CHECK"}));
  EXPECT_EQ(
      DetailOf(store().SubmitAndWait({.request_id = "r", .request_hash = "b", .kind = "CHECK"})),
      "it made job 1");
  EXPECT_EQ(DetailOf(store().SubmitAndWait({.kind = "CHECK", .queued_max = 1})), "1 jobs wait");
  EXPECT_EQ(DetailOf(store().SubmitAndWait(
                {.kind = "CHECK",
                 .attachments = {{.name = "main", .bytes = "a"}, {.name = "main", .bytes = "b"}}})),
            "two artifacts named main");
  EXPECT_EQ(DetailOf(store().GetArtifact(1, "report")), "job 1 has no artifact report");
  for (const auto& refused :
       {DetailOf(store().GetArtifact(7, "report")), DetailOf(store().ReadArtifact(7, "report")),
        DetailOf(store().OpenArtifact(7, "report"))})
    EXPECT_EQ(refused, "job 7");
  EXPECT_EQ(DetailOf(store().ReadBlob("xyz")), "no content with SHA-256 xyz");
  const std::string hash(64, 'a');
  EXPECT_EQ(DetailOf(store().ReadBlob(hash)), "no content with SHA-256 " + hash);
  EXPECT_EQ(DetailOf(store().SubmitAndWait(
                {.kind = "CHECK", .attachments = {{.name = "a", .existing_sha256 = hash}}})),
            "no content with SHA-256 " + hash);
  const Lease lease = Must(store().Acquire("w", {"CHECK"}, kLease, {}))->lease;
  EXPECT_EQ(DetailOf(store().Finish(lease, {.outcome = {.state = JobState::kRunning}})),
            "an outcome has to be final");
}

TEST_F(SqliteMessages, OfMachinesThatAreHosted) {
  Must(store().PutMachine({.id = "m"}, 0));
  const auto take = [&](const std::string& host) {
    return store().TakeMachine({.machine = "m", .host = host, .server = "s", .duration = kLease});
  };
  const MachineLease lease = Must(take("a"));
  const auto mark = [&](const MachineLease& of, std::int64_t sequence, const std::string& state) {
    const MachineMark one{.sequence = sequence, .state = state, .note = "note"};
    return DetailOf(store().AppendMachine(of, {.mark = one}));
  };
  EXPECT_EQ(mark(lease, 5, "axes"), "none");
  EXPECT_EQ(mark(lease, 4, "axes"), "the mark 4 is not newer than 5");
  // State and note together: four bytes more than may be.
  EXPECT_EQ(mark(lease, 6, std::string(kMachineMarkBytesMax, 'x')), "a mark of 262148 bytes");
  EXPECT_EQ(DetailOf(take("b")), "machine m is hosted by a");
  MachineLease other = lease;
  other.fence += 1;
  EXPECT_EQ(mark(other, 6, "axes"), "machine m is hosted by a");
  Must(store().ReleaseMachine(lease));
  EXPECT_EQ(mark(lease, 6, "axes"), "machine m has no host");
}

// records.h: `created_at` is of the first put, `updated_at` of the newest, of none between them; in
// lists, too.
TEST_F(SqliteMessages, RecordsKeepTheTimesOfTheirFirstAndLastPut) {
  const WallTime first = bed_.clock().Now();
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().PutProject({.id = "p"}, 0));
  Must(store().PutPrograms("m", {{.slot = 1, .object = "a"}}, {{.number = 2}}));
  bed_.clock().Advance(std::chrono::seconds(5));
  Must(store().PutMachine({.id = "m"}, 1));
  Must(store().PutProject({.id = "p"}, 1));
  Must(store().PutPrograms("m", {{.slot = 1, .object = "c"}}, {{.number = 2}}));
  bed_.clock().Advance(std::chrono::seconds(5));
  const WallTime last = bed_.clock().Now();
  Must(store().PutMachine({.id = "m"}, 2));
  const ProjectRecord put = Must(store().PutProject({.id = "p"}, 2));
  const auto programs =
      Must(store().PutPrograms("m", {{.slot = 1, .object = "b"}}, {{.number = 2}}));
  EXPECT_EQ(put.created_at, first);
  EXPECT_EQ(put.updated_at, last);
  EXPECT_EQ(programs[0].created_at, first);
  EXPECT_EQ(programs[0].updated_at, last);
  bed_.Reopen();
  for (const MachineRecord& machine :
       {Must(store().GetMachine("m")), Must(store().ListMachines())[0]}) {
    EXPECT_EQ(machine.created_at, first);
    EXPECT_EQ(machine.updated_at, last);
  }
  for (const ProjectRecord& project :
       {Must(store().GetProject("p")), Must(store().ListProjects("", 1))[0]}) {
    EXPECT_EQ(project.created_at, first);
    EXPECT_EQ(project.updated_at, last);
    EXPECT_EQ(project.revision, 3);
  }
  for (const ProgramSummary& summary :
       {Must(store().GetProgramSummary("m", 1)), Must(store().ListPrograms("m", 0, 1))[0]}) {
    EXPECT_EQ(summary.created_at, first);
    EXPECT_EQ(summary.updated_at, last);
  }
  for (const ProgramRecord& program : {Must(store().GetProgram("m", 1)),
                                       Must(store().GetMachineMemory("m", [](const MachineRecord&) {
                                         return true;
                                       })).programs[0]}) {
    EXPECT_EQ(program.created_at, first);
    EXPECT_EQ(program.updated_at, last);
  }
  EXPECT_EQ(Must(store().ListSchedules("m"))[0].updated_at, last);
}

// 9104: references that do not add up are told, and the write that met them is not done.
TEST_F(SqliteMessages, OfAContentThatIsNamedMoreOftenThanItCounts) {
  bed_.LeaveUnchecked();
  Must(store().PutMachine({.id = "m"}, 0));
  Must(store().PutPrograms("m", {{.slot = 1, .object = "one"}}, {}));
  Must(store().PutPrograms("m", {{.slot = 2, .object = Noise(3 << 20, 1)}}, {}));
  bed_.Close();
  const std::int64_t one = NumberIn(bed_.path(), "SELECT object_blob FROM program WHERE slot = 1");
  ExecuteIn(bed_.path(), "UPDATE blob SET refs = 0, holds = 1 WHERE id = " + std::to_string(one));
  bed_.Reopen();  // holds of the last run are given back, and what nobody names is swept
  const Status refused = store().DeleteProgram("m", 1, kAnyRevision);
  EXPECT_EQ(CodeOf(refused), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(DetailOf(refused), "blob " + std::to_string(one) + ": has no reference to drop");
  EXPECT_EQ(Must(store().GetProgramSummary("m", 2)).object_bytes, 3 << 20);
  Must(store().DeleteProgram("m", 2, kAnyRevision));
}

TEST_F(SqliteMessages, OfABodyThatIsNamedMoreOftenThanItCounts) {
  bed_.LeaveUnchecked();
  Must(store().PutProject({.id = "p", .body = Noise(20'000, 1)}, 0));
  bed_.Close();
  const std::string body = TextIn(bed_.path(), "SELECT body_blob FROM project");
  ExecuteIn(bed_.path(), "UPDATE blob SET refs = 0, holds = 1 WHERE id = " + body);
  bed_.Reopen();
  const auto refused = store().PutProject({.id = "p", .body = "short"}, kAnyRevision);
  EXPECT_EQ(CodeOf(refused), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(DetailOf(refused), "blob " + body + ": has no reference to drop");
}

// 9104: a content is looked at when it is read, and each way in which it is wrong has its words.
TEST_F(SqliteMessages, OfDamagedContents) {
  bed_.LeaveUnchecked();
  Must(store().PutMachine({.id = "m"}, 0));
  for (int slot = 1; slot <= 3; ++slot)
    Must(store().PutPrograms("m", {{.slot = slot, .object = Numbered("object ", slot)}}, {}));
  bed_.Close();
  const auto blob = [&](int slot) {
    return std::to_string(NumberIn(
        bed_.path(), "SELECT object_blob FROM program WHERE slot = " + std::to_string(slot)));
  };
  const std::string swapped = blob(1), negative = blob(2), gone = blob(3);
  ExecuteIn(bed_.path(), "UPDATE blob SET content = 'OBJECT 1' WHERE id = " + swapped +
                             "; UPDATE blob SET size = -1 WHERE id = " + negative +
                             "; DELETE FROM blob WHERE id = " + gone);
  bed_.Reopen();
  EXPECT_EQ(DetailOf(store().GetProgram("m", 1)),
            "blob " + swapped + ": does not have its SHA-256");
  EXPECT_EQ(DetailOf(store().GetProgram("m", 2)), "blob " + negative + ": has a size below 0");
  EXPECT_EQ(DetailOf(store().GetProgram("m", 3)), "blob " + gone + ": is named but not there");
}

void Write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(SqliteFiles, WhatCannotBeOpenedIsNamedWithItsReason) {
  const TestDirectory directory;
  const std::string folder = directory.File("folder");
  ASSERT_EQ(mkdir(folder.c_str(), 0700), 0);
  EXPECT_EQ(DetailOf(StoreLock::Take(folder)),
            "cannot open lock file " + folder + ": Is a directory");
  EXPECT_EQ(DetailOf(MakePrivateFile(folder)), "cannot open " + folder + ": Is a directory");
  Write(directory.File("file"), "x");
  for (const char* path : {"file/cell.db", "file/below/cell.db", "file/below/it/cell.db"}) {
    EXPECT_EQ(DetailOf(MakeDirectoryOf(directory.File(path))),
              "cannot make directory " + directory.File("file") + ": Not a directory");
  }
  const std::string too_long = directory.File(std::string(300, 'd'));
  EXPECT_EQ(DetailOf(MakeDirectoryOf(too_long + "/cell.db")),
            "cannot make directory " + too_long + ": File name too long");
  EXPECT_EQ(DetailOf(MakeDirectoryOf("cell.db")), "none");  // here
}

// A new file whose name may not be on the disk is no file of ours. There is room for one more open
// file here: the file itself, and not its directory.
TEST(SqliteFiles, ADirectoryThatIsNotSyncedIsNamed) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db");
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int next = open("/dev/null", O_RDONLY | O_CLOEXEC);  // the lowest number that is free
  ASSERT_GE(next, 0);
  close(next);
  struct rlimit limit {};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &limit), 0);
  struct rlimit one_more = limit;
  one_more.rlim_cur = static_cast<rlim_t>(next) + 1;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &one_more), 0);
  const Status made = MakePrivateFile(path);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  EXPECT_EQ(DetailOf(made), "cannot sync directory " + folder + ": Too many open files");
  EXPECT_EQ(CodeOf(made), ErrorCode::kCellStoreFailed);
}

// proc(5): everybody may read it, and nobody changes that.
TEST(SqliteFiles, AModeThatCannotBeSetIsNamed) {
  EXPECT_EQ(DetailOf(MakePrivateFile("/proc/self/comm")),
            "cannot set the mode of /proc/self/comm: Operation not permitted");
}

// A lock that another one holds: who it is, up to the end of the first line, of 23 characters.
TEST(SqliteFiles, ALockNamesItsHolder) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db.lock");
  const auto refused_with = [&](const std::string& bytes) {
    Write(path, bytes);
    const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_EQ(flock(file, LOCK_EX | LOCK_NB), 0);
    const auto taken = StoreLock::Take(path);
    EXPECT_EQ(CodeOf(taken), ErrorCode::kCellStoreBusy);
    close(file);
    return DetailOf(taken);
  };
  const std::string held = path + " is held by ";
  EXPECT_EQ(refused_with("123\n"), held + "process 123");
  EXPECT_EQ(refused_with("123\nmore\n"), held + "process 123");
  EXPECT_EQ(refused_with(""), held + "another process");
  EXPECT_EQ(refused_with("\n"), held + "another process");
  EXPECT_EQ(refused_with(std::string(30, '7')), held + "process " + std::string(23, '7'));
  // What an earlier holder wrote goes.
  Write(path, std::string(30, '7'));
  const auto taken = StoreLock::Take(path);
  ASSERT_TRUE(taken);
  EXPECT_EQ(std::filesystem::file_size(path), std::to_string(getpid()).size() + 1);
}

bool IsStandardOutputOpen() { return fcntl(STDOUT_FILENO, F_GETFD) != -1; }

// A lock that is handed on is the same file: no other is closed with what it comes from.
TEST(SqliteFiles, ALockThatIsHandedOnClosesNothing) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db.lock");
  ASSERT_TRUE(IsStandardOutputOpen());
  {
    Result<StoreLock> taken = StoreLock::Take(path);
    ASSERT_TRUE(taken);
    EXPECT_TRUE(IsStandardOutputOpen());
    const StoreLock handed_on = *std::move(taken);
    EXPECT_EQ(CodeOf(StoreLock::Take(path)), ErrorCode::kCellStoreBusy);
  }
  EXPECT_TRUE(IsStandardOutputOpen());
  EXPECT_FALSE(CodeOf(StoreLock::Take(path)));
}

// A process without a standard output: the lock has its number then, and is let go as any other.
TEST(SqliteFiles, ALockIsLetGoWhateverItsNumber) {
  const TestDirectory directory;
  const std::string path = directory.File("cell.db.lock");
  const int output = dup(STDOUT_FILENO);
  close(STDOUT_FILENO);
  const auto first = CodeOf(StoreLock::Take(path));
  const auto second = CodeOf(StoreLock::Take(path));
  if (output >= 0) {
    dup2(output, STDOUT_FILENO);
    close(output);
  }
  EXPECT_EQ(first, std::nullopt);
  EXPECT_EQ(second, std::nullopt);
}

}  // namespace
}  // namespace rmlcell::storage::sqlite
