// Program memories that hold no more than their machine has (OPT-B.73).
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

// Those of family "small" have ten bytes, and their own number for it that there is no room.
std::optional<ProgramMemoryLimit> TenBytes(const MachineRecord& machine) {
  if (machine.family != "small") return std::nullopt;
  const auto bytes = machine.parameters.find("BYTES");
  return ProgramMemoryLimit{
      .bytes = bytes == machine.parameters.end() ? 10 : std::stoll(bytes->second),
      .full = ErrorCode::kCmosFull};
}

class SqliteRoom : public testing::Test {
 protected:
  SqliteRoom() {
    Must(store().PutMachine({.id = "m", .family = "small"}, 0));
    Must(store().PutMachine({.id = "mill", .family = "large"}, 0));
  }
  Store& store() { return bed_.store(); }
  Status Put(int slot, std::size_t bytes, const std::string& machine = "m") {
    const auto put =
        store().PutPrograms(machine, {{.slot = slot, .object = std::string(bytes, 'o')}}, {});
    return put ? Status() : Status(put.error());
  }
  Result<bool> PutExecutable(int slot, std::size_t bytes) {
    const Revision revision = Must(store().GetProgramSummary("m", slot)).revision;
    return store().PutExecutable("m", slot, revision, std::string(bytes, 'e'));
  }
  // "1: 4+2, 2: 3", objects and executables.
  std::string Memory() {
    std::string text;
    for (const ProgramSummary& program : Must(store().ListPrograms("m", 0, 99))) {
      text += (text.empty() ? "" : ", ") + std::to_string(program.slot) + ": " +
              std::to_string(program.object_bytes);
      if (program.executable_bytes >= 0) text += "+" + std::to_string(program.executable_bytes);
    }
    return text;
  }

  SqliteBed bed_{{.program_memory = TenBytes}};
};

// OPT-B.73, OPT-E.7109: what goes beyond is refused, and changes nothing.
TEST_F(SqliteRoom, AProgramNeedsRoom) {
  ASSERT_TRUE(Put(1, 6));
  EXPECT_EQ(CodeOf(Put(2, 5)), ErrorCode::kCmosFull);
  EXPECT_EQ(Put(2, 5).error().detail, "the program memory has 10 bytes, and 11 would be in it");
  EXPECT_EQ(Memory(), "1: 6");
  ASSERT_TRUE(Put(2, 4));
  // In place of what is in its slot.
  ASSERT_TRUE(Put(1, 5));
  EXPECT_EQ(CodeOf(Put(1, 7)), ErrorCode::kCmosFull);
  EXPECT_EQ(Memory(), "1: 5, 2: 4");
  EXPECT_EQ(Must(store().GetProgramSummary("m", 1)).revision, 2);
  ASSERT_TRUE(Put(1, 100'000, "mill"));
}

TEST_F(SqliteRoom, ABatchIsPutWholeOrNotAtAll) {
  ASSERT_TRUE(Put(1, 6));
  const auto put = [&](std::size_t second) {
    return CodeOf(store().PutPrograms(
        "m", {{.slot = 1, .object = "1"}, {.slot = 2, .object = std::string(second, 'o')}},
        {{.number = 5, .name = "five"}}));
  };
  EXPECT_EQ(put(10), ErrorCode::kCmosFull);
  EXPECT_EQ(Memory(), "1: 6");
  EXPECT_TRUE(Must(store().ListSchedules("m")).empty());
  EXPECT_EQ(put(9), std::nullopt);
  EXPECT_EQ(Memory(), "1: 1, 2: 9");
}

TEST_F(SqliteRoom, AnExecutableNeedsRoom) {
  ASSERT_TRUE(Put(1, 6));
  EXPECT_EQ(CodeOf(PutExecutable(1, 5)), ErrorCode::kCmosFull);
  EXPECT_EQ(Memory(), "1: 6");
  EXPECT_TRUE(Must(PutExecutable(1, 4)));
  EXPECT_TRUE(Must(PutExecutable(1, 3)));  // in place of the other
  EXPECT_EQ(CodeOf(Put(2, 2)), ErrorCode::kCmosFull);
  EXPECT_EQ(Memory(), "1: 6+3");
  // A new object takes its executable with it. OPT-1.12
  ASSERT_TRUE(Put(1, 10));
  EXPECT_EQ(Memory(), "1: 10");
}

// What a job made can be made again: where there is no room it is dropped, and the job has ended.
TEST_F(SqliteRoom, WhatAJobMadeIsDropped) {
  ASSERT_TRUE(Put(1, 3));
  ASSERT_TRUE(Put(2, 3));
  Must(store().SubmitAndWait({.machine = "m", .kind = "SIMULATE"}));
  const auto leased = Must(store().Acquire("w", {"SIMULATE"}, std::chrono::hours(1), {}));
  ASSERT_TRUE(leased);
  const auto ended =
      Must(store().Finish(leased->lease, {.outcome = {.state = JobState::kSucceeded},
                                          .executables = {{1, 1, "four"}, {2, 1, "four"}}}));
  EXPECT_EQ(ended.state, JobState::kSucceeded);
  EXPECT_EQ(Memory(), "1: 3+4, 2: 3");
}

// Where as much may be as comes nobody asks how much there is: a program that is damaged keeps no
// other one out.
TEST_F(SqliteRoom, OfAMemoryWithoutALimitNothingIsRead) {
  bed_.LeaveUnchecked();
  ASSERT_TRUE(Put(1, 6, "mill"));
  bed_.Close();
  ExecuteIn(bed_.path(), "DELETE FROM blob");
  bed_.Reopen();
  EXPECT_EQ(CodeOf(store().ListPrograms("mill", 0, 9)), ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(CodeOf(Put(2, 5, "mill")), std::nullopt);
  EXPECT_EQ(Must(store().GetProgramSummary("mill", 2)).object_bytes, 5);
}

// Where the machine has less than is in it already, it may have no more.
TEST_F(SqliteRoom, AMemoryThatIsTooFullMayShrink) {
  ASSERT_TRUE(Put(1, 6));
  ASSERT_TRUE(Put(2, 4));
  MachineRecord smaller = Must(store().GetMachine("m"));
  smaller.parameters = {{"BYTES", "5"}};
  Must(store().PutMachine(smaller, kAnyRevision));
  EXPECT_EQ(CodeOf(Put(2, 5)), ErrorCode::kCmosFull);
  ASSERT_TRUE(Put(2, 4));
  ASSERT_TRUE(Put(1, 5));
  EXPECT_EQ(Memory(), "1: 5, 2: 4");
}

}  // namespace
}  // namespace rmlcell::storage
