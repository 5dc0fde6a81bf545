// The program memory of any Store.
#include <gmock/gmock.h>

#include <thread>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

bool WithPrograms(const MachineRecord&) { return true; }

using testing::ElementsAre;
using testing::IsEmpty;

// SHA-256 of "abc", from FIPS 180-2 appendix B.1.
constexpr const char* kSha256OfAbc =
    "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

std::vector<int> SlotsOf(const std::vector<ProgramSummary>& programs) {
  std::vector<int> slots;
  for (const ProgramSummary& program : programs) slots.push_back(program.slot);
  return slots;
}

// OPT-1.10: programs survive the end of the process.
TEST_P(StoreConformance, ProgramComesBackAsItWasPut) {
  PutMachine("m");
  const std::string object = Noise(34'000, 3);
  const std::string source = "10 SPEED 20\r\n\x1A";
  const auto put = Must(store().PutPrograms(
      "m",
      {{.slot = 45, .name = "cleft", .object = object, .source = source, .source_name = "45.S"}},
      {}));
  ASSERT_EQ(put.size(), 1U);
  EXPECT_EQ(put[0].slot, 45);
  EXPECT_EQ(put[0].object_bytes, 34'000);
  EXPECT_EQ(put[0].source_bytes, static_cast<std::int64_t>(source.size()));
  EXPECT_EQ(put[0].executable_bytes, -1);
  EXPECT_EQ(put[0].revision, 1);
  Reopen();
  const ProgramRecord got = Must(store().GetProgram("m", 45));
  EXPECT_EQ(got.machine, "m");
  EXPECT_EQ(got.slot, 45);
  EXPECT_EQ(got.name, "cleft");
  EXPECT_EQ(got.object, object);
  EXPECT_EQ(got.source, source);
  EXPECT_EQ(got.source_name, "45.S");
  EXPECT_EQ(got.executable, std::nullopt);
  EXPECT_EQ(got.revision, 1);
  EXPECT_EQ(got.created_at, clock().Now());
}

TEST_P(StoreConformance, SummaryTellsSizesAndHash) {
  PutMachine("m");
  PutProgram("m", 1, "abc");
  Must(store().PutExecutable("m", 1, 1, "0123456789"));
  const auto listed = Must(store().ListPrograms("m", 0, 10));
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_EQ(listed[0].slot, 1);
  EXPECT_EQ(listed[0].revision, 1);
  EXPECT_EQ(listed[0].object_sha256, kSha256OfAbc);
  EXPECT_EQ(listed[0].object_bytes, 3);
  EXPECT_EQ(listed[0].source_bytes, -1);
  EXPECT_EQ(listed[0].executable_bytes, 10);
  EXPECT_EQ(Must(store().ReadBlob(kSha256OfAbc)), "abc");
  Must(store().PutPrograms(
      "m", {{.slot = 2, .name = "n", .object = "o", .source = "text", .source_name = "2.S"}}, {}));
  const ProgramSummary named = Must(store().GetProgramSummary("m", 2));
  EXPECT_EQ(named.name, "n");
  EXPECT_EQ(named.source_name, "2.S");
  EXPECT_EQ(named.source_bytes, 4);
  EXPECT_EQ(named.executable_bytes, -1);
}

TEST_P(StoreConformance, ASlotIsLookedUpByItself) {
  PutMachine("m");
  for (const int slot : {4, 6}) PutProgram("m", slot, "abc");
  const ProgramSummary found = Must(store().GetProgramSummary("m", 4));
  EXPECT_EQ(found.slot, 4);
  EXPECT_EQ(found.object_sha256, kSha256OfAbc);
  EXPECT_EQ(found.object_bytes, 3);
  EXPECT_EQ(CodeOf(store().GetProgramSummary("m", 5)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().GetProgramSummary("none", 4)), ErrorCode::kCellUnknownMachine);
}

TEST_P(StoreConformance, ProgramsAreListedInPages) {
  PutMachine("m");
  PutMachine("other");
  for (const int slot : {99, 3, 50, 1}) PutProgram("m", slot, "x");
  PutProgram("other", 2, "x");
  EXPECT_THAT(SlotsOf(Must(store().ListPrograms("m", 0, 3))), ElementsAre(1, 3, 50));
  EXPECT_THAT(SlotsOf(Must(store().ListPrograms("m", 50, 3))), ElementsAre(99));
  EXPECT_THAT(SlotsOf(Must(store().ListPrograms("m", 2, 1))), ElementsAre(3));
  EXPECT_THAT(SlotsOf(Must(store().ListPrograms("m", 99, 3))), IsEmpty());
  EXPECT_THAT(SlotsOf(Must(store().ListPrograms("m", 0, 0))), IsEmpty());
}

// OPT-1.10: objects have numbers 1 to 99, both sides.
TEST_P(StoreConformance, SlotsAre1To99) {
  PutMachine("m");
  const auto put = [&](int slot) {
    return CodeOf(store().PutPrograms("m", {{.slot = slot, .object = "x"}}, {}));
  };
  EXPECT_EQ(put(0), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(put(100), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(put(1), std::nullopt);
  EXPECT_EQ(put(99), std::nullopt);
}

TEST_P(StoreConformance, UnknownMachineHasNoPrograms) {
  constexpr auto kUnknown = ErrorCode::kCellUnknownMachine;
  EXPECT_EQ(CodeOf(store().PutPrograms("none", {{.slot = 1, .object = "x"}}, {})), kUnknown);
  EXPECT_EQ(CodeOf(store().GetProgram("none", 1)), kUnknown);
  EXPECT_EQ(CodeOf(store().ListPrograms("none", 0, 10)), kUnknown);
  EXPECT_EQ(CodeOf(store().GetMachineMemory("none", WithPrograms)), kUnknown);
  EXPECT_EQ(CodeOf(store().DeleteProgram("none", 1, kAnyRevision)), kUnknown);
  EXPECT_EQ(CodeOf(store().DeleteExecutable("none", 1)), kUnknown);
  PutMachine("m");
  EXPECT_EQ(CodeOf(store().GetProgram("m", 1)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().DeleteProgram("m", 1, kAnyRevision)), ErrorCode::kCellNotFound);
}

// OPT-1.12: altering the object deletes its executable, also when the new object is the same.
// OPT-1.13: executables of other programs stay.
TEST_P(StoreConformance, PuttingAnObjectDeletesItsExecutableOnly) {
  PutMachine("m");
  PutProgram("m", 45, "object 45");
  PutProgram("m", 32, "object 32");
  Must(store().PutExecutable("m", 45, 1, "executable 145"));
  Must(store().PutExecutable("m", 32, 1, "executable 132"));
  PutProgram("m", 45, "object 45");
  EXPECT_EQ(Must(store().GetProgram("m", 45)).executable, std::nullopt);
  EXPECT_EQ(Must(store().GetProgram("m", 32)).executable, "executable 132");
}

// OPT-1.12: deleting the object deletes its executable; a new object of that slot has none.
TEST_P(StoreConformance, DeletingAnObjectDeletesItsExecutable) {
  PutMachine("m");
  PutProgram("m", 45, "object");
  Must(store().PutExecutable("m", 45, 1, "executable"));
  Must(store().DeleteProgram("m", 45, 1));
  EXPECT_EQ(CodeOf(store().GetProgram("m", 45)), ErrorCode::kCellNotFound);
  PutProgram("m", 45, "object");
  EXPECT_EQ(Must(store().GetProgram("m", 45)).executable, std::nullopt);
}

// OPT-1.13: deleting counts as altering, so a slot that was deleted is not one that never was.
TEST_P(StoreConformance, DeletedProgramsAreKnownUntilTheirSlotIsUsedAgain) {
  PutMachine("m");
  PutMachine("other");
  for (const int slot : {9, 44, 45, 7}) PutProgram("m", slot, "object");
  PutProgram("other", 50, "object");
  EXPECT_EQ(Must(store().GetMachineMemory("m", WithPrograms)).deleted, std::vector<int>{});
  for (const int slot : {44, 9, 45}) Must(store().DeleteProgram("m", slot, kAnyRevision));
  Must(store().DeleteProgram("other", 50, kAnyRevision));
  EXPECT_EQ(Must(store().GetMachineMemory("m", WithPrograms)).deleted,
            (std::vector<int>{9, 44, 45}));
  PutProgram("m", 44, "another");
  EXPECT_EQ(Must(store().GetMachineMemory("m", WithPrograms)).deleted, (std::vector<int>{9, 45}));
}

// OPT-1.14: an executable can be deleted on its own; the object stays as it is.
TEST_P(StoreConformance, ExecutableIsDeletedAlone) {
  PutMachine("m");
  PutProgram("m", 32, "object");
  EXPECT_EQ(CodeOf(store().DeleteExecutable("m", 32)), ErrorCode::kCellNotFound);
  Must(store().PutExecutable("m", 32, 1, "executable"));
  Must(store().DeleteExecutable("m", 32));
  const ProgramRecord program = Must(store().GetProgram("m", 32));
  EXPECT_EQ(program.object, "object");
  EXPECT_EQ(program.executable, std::nullopt);
  EXPECT_EQ(program.revision, 1);
  EXPECT_EQ(CodeOf(store().DeleteExecutable("m", 33)), ErrorCode::kCellNotFound);
}

// OPT-1.15: an executable is stored only if its object is there, and used until that changes.
TEST_P(StoreConformance, ExecutableOfAnOlderObjectIsDropped) {
  PutMachine("m");
  EXPECT_FALSE(Must(store().PutExecutable("m", 32, 1, "early")));
  EXPECT_FALSE(Must(store().PutExecutable("none", 32, 1, "early")));
  PutProgram("m", 32, "first");
  PutProgram("m", 32, "second");
  EXPECT_FALSE(Must(store().PutExecutable("m", 32, 1, "of first")));
  EXPECT_EQ(Must(store().GetProgram("m", 32)).executable, std::nullopt);
  EXPECT_TRUE(Must(store().PutExecutable("m", 32, 2, "of second")));
  EXPECT_TRUE(Must(store().PutExecutable("m", 32, 2, "of second, again")));
  const ProgramRecord program = Must(store().GetProgram("m", 32));
  EXPECT_EQ(program.executable, "of second, again");
  EXPECT_EQ(program.revision, 2);
}

// records.h, Revision, for OPT-1.15: an executable made of a deleted object is not taken for its
// successor.
TEST_P(StoreConformance, ExecutableOfADeletedObjectIsDropped) {
  PutMachine("m");
  PutProgram("m", 32, "first");
  Must(store().DeleteProgram("m", 32, kAnyRevision));
  EXPECT_EQ(PutProgram("m", 32, "second").revision, 2);
  EXPECT_FALSE(Must(store().PutExecutable("m", 32, 1, "of first")));
}

TEST_P(StoreConformance, ExpectedRevisionOfAProgramIsChecked) {
  PutMachine("m");
  const auto put = [&](Revision expected) {
    return CodeOf(store().PutPrograms("m", {{.slot = 7, .object = "x", .expected = expected}}, {}));
  };
  EXPECT_EQ(put(1), ErrorCode::kCellNotFound);
  EXPECT_EQ(put(0), std::nullopt);
  EXPECT_EQ(put(0), ErrorCode::kCellAlreadyExists);
  EXPECT_EQ(put(2), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(put(1), std::nullopt);
  EXPECT_EQ(CodeOf(store().DeleteProgram("m", 7, 1)), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Must(store().GetProgram("m", 7)).revision, 2);
}

// Issue 2, projects: programs and schedules of a transfer are put all or nothing.
TEST_P(StoreConformance, ProgramsArePutAllOrNothing) {
  PutMachine("m");
  PutProgram("m", 1, "old 1");
  PutProgram("m", 3, "old 3");
  Must(store().PutExecutable("m", 1, 1, "executable 1"));
  const auto refused = store().PutPrograms("m",
                                           {{.slot = 1, .object = "new 1"},
                                            {.slot = 2, .object = "new 2"},
                                            {.slot = 3, .object = "new 3", .expected = 9}},
                                           {{.number = 5}});
  EXPECT_EQ(CodeOf(refused), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Must(store().GetProgram("m", 1)).object, "old 1");
  EXPECT_EQ(Must(store().GetProgram("m", 1)).executable, "executable 1");
  EXPECT_EQ(CodeOf(store().GetProgram("m", 2)), ErrorCode::kCellNotFound);
  EXPECT_THAT(Must(store().ListSchedules("m")), IsEmpty());

  const auto put = Must(store().PutPrograms(
      "m", {{.slot = 3, .object = "new 3", .expected = 1}, {.slot = 1, .object = "new 1"}},
      {{.machine = "another", .number = 5, .name = "steel"}}));
  EXPECT_THAT(SlotsOf(put), ElementsAre(3, 1));
  EXPECT_EQ(Must(store().GetProgram("m", 3)).object, "new 3");
  const auto schedules = Must(store().ListSchedules("m"));
  ASSERT_EQ(schedules.size(), 1U);
  EXPECT_EQ(schedules[0].machine, "m");
  EXPECT_EQ(schedules[0].name, "steel");
}

TEST_P(StoreConformance, OneSlotIsNotWrittenTwiceInOneCall) {
  PutMachine("m");
  EXPECT_EQ(CodeOf(store().PutPrograms(
                "m", {{.slot = 1, .object = "a"}, {.slot = 1, .object = "b"}}, {})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().PutPrograms("m", {}, {{.number = 4}, {.number = 4}})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().PutPrograms("m", {{.slot = 1, .object = "a"}}, {{.number = 64}})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(Must(store().ListPrograms("m", 0, 10)), IsEmpty());
}

// OPT-1.11: a run needs objects and executables; the sources stay where they are.
TEST_P(StoreConformance, ProgramMemoryHasObjectsAndExecutables) {
  PutMachine("m");
  Must(store().PutPrograms(
      "m", {{.slot = 44, .name = "f", .object = "b", .source = "B"}, {.slot = 12, .object = "a"}},
      {}));
  Must(store().PutExecutable("m", 44, 1, "x"));
  const auto memory = Must(store().GetMachineMemory("m", WithPrograms)).programs;
  ASSERT_EQ(memory.size(), 2U);
  EXPECT_EQ(memory[0].slot, 12);
  EXPECT_EQ(memory[0].object, "a");
  EXPECT_EQ(memory[0].executable, std::nullopt);
  EXPECT_EQ(memory[1].name, "f");
  EXPECT_EQ(memory[1].object, "b");
  EXPECT_EQ(memory[1].executable, "x");
  EXPECT_EQ(memory[1].source, std::nullopt);
  EXPECT_EQ(memory[1].revision, 1);
}

// The machine, its programs and its schedules, all as they were at one moment; programs only where
// they are wanted, since those of a mill are large.
TEST_P(StoreConformance, TheMemoryOfAMachineHasWhatIsWanted) {
  Must(store().PutMachine({.id = "m", .family = "f", .profile = "p"}, 0));
  Must(store().PutPrograms("m", {{.slot = 12, .object = "a"}, {.slot = 13, .object = "b"}},
                           {{.number = 9, .name = "nine"}, {.number = 3, .name = "three"}}));
  Must(store().DeleteProgram("m", 13, kAnyRevision));
  std::vector<std::string> asked;
  const auto memory = Must(store().GetMachineMemory("m", [&](const MachineRecord& machine) {
    asked.push_back(machine.profile);
    return true;
  }));
  EXPECT_THAT(asked, testing::ElementsAre("p"));
  EXPECT_EQ(memory.machine.family, "f");
  EXPECT_FALSE(memory.mark);
  ASSERT_EQ(memory.programs.size(), 1U);
  EXPECT_EQ(memory.deleted, std::vector<int>{13});
  ASSERT_EQ(memory.schedules.size(), 2U);
  EXPECT_EQ(memory.schedules[0].name, "three");
  for (const Store::WantsPrograms& wants :
       {Store::WantsPrograms(), Store::WantsPrograms([](const MachineRecord&) { return false; })}) {
    const auto without = Must(store().GetMachineMemory("m", wants));
    EXPECT_EQ(without.machine.profile, "p");
    EXPECT_THAT(without.programs, IsEmpty());
    EXPECT_THAT(without.deleted, IsEmpty());
    EXPECT_EQ(without.schedules.size(), 2U);
  }
}

// An empty object or source is not the same as none.
TEST_P(StoreConformance, EmptyProgramIsAProgram) {
  PutMachine("m");
  Must(store().PutPrograms("m", {{.slot = 1, .object = "", .source = ""}}, {}));
  Must(store().PutExecutable("m", 1, 1, ""));
  const ProgramRecord program = Must(store().GetProgram("m", 1));
  EXPECT_EQ(program.object, "");
  EXPECT_EQ(program.source, "");
  EXPECT_EQ(program.executable, "");
}

// design.md section 6: programs of up to 256 MiB, both sides; each size around the borders of a
// store that cuts them into pieces.
TEST_P(StoreConformance, ProgramsOfEverySizeComeBack) {
  PutMachine("m");
  constexpr std::size_t kMiB = std::size_t{1} << 20;
  int slot = 0;
  for (const std::size_t size :
       {std::size_t{1}, std::size_t{511}, std::size_t{512}, std::size_t{2'048}, std::size_t{2'049},
        kMiB - 1, kMiB, kMiB + 1, 5 * kMiB + 17}) {
    for (const std::string& object : {Noise(size, size), PlotText(size)}) {
      PutProgram("m", ++slot, object);
      EXPECT_TRUE(Must(store().GetProgram("m", slot)).object == object) << size;
    }
  }
}

TEST_P(StoreConformance, LargestProgramIsTaken) {
  PutMachine("m");
  std::string program = PlotText(kProgramBytesMax + 1);
  EXPECT_EQ(CodeOf(store().PutPrograms("m", {{.slot = 1, .object = program}}, {})),
            ErrorCode::kCellTooLarge);
  EXPECT_EQ(CodeOf(store().PutPrograms("m", {{.slot = 1, .source = program}}, {})),
            ErrorCode::kCellTooLarge);
  const auto executable = store().PutExecutable("m", 1, 1, program);
  ASSERT_EQ(CodeOf(executable), ErrorCode::kCellTooLarge);
  EXPECT_EQ(executable.error().detail, "the executable has 268435457 bytes");
  const LeasedJob leased = (Submit("SIMULATE", "m"), Acquire());
  JobEnd end;
  end.executables.push_back({.slot = 1, .object_revision = 1, .bytes = program});
  EXPECT_EQ(CodeOf(store().Finish(leased.lease, end)), ErrorCode::kCellTooLarge);
  end = {};
  program.pop_back();
  PutProgram("m", 1, program);
  EXPECT_TRUE(Must(store().PutExecutable("m", 1, 1, program)));
  Reopen();
  EXPECT_TRUE(Must(store().GetProgram("m", 1)).object == program);
}

// Readers see a transfer whole or not at all, never half of it.
TEST_P(StoreConformance, ReadersSeeWholeTransfers) {
  PutMachine("m");
  constexpr int kSlots = 5;
  const auto transfer = [&](int number) {
    std::vector<ProgramWrite> programs;
    for (int slot = 1; slot <= kSlots; ++slot) {
      programs.push_back({.slot = slot, .object = std::to_string(number)});
    }
    Must(store().PutPrograms("m", programs, {}));
  };
  transfer(0);
  std::atomic<bool> done = false;
  std::atomic<int> torn = 0;
  std::atomic<int> reads = 0;
  std::jthread reader([&] {
    while (!done) {
      const auto memory = store().GetMachineMemory("m", WithPrograms);
      if (!memory || memory->programs.size() != kSlots) ++torn;
      for (const ProgramRecord& program : memory->programs) {
        if (program.object != memory->programs.front().object) ++torn;
      }
      ++reads;
    }
  });
  for (int number = 1; number <= 50 || reads < 50; ++number) transfer(number);
  done = true;
  reader.join();
  EXPECT_EQ(torn, 0);
}

}  // namespace
}  // namespace rmlcell::storage
