// Slot 1 is the first, and the memory of a machine is used to its last byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "server/programs/special_programs.h"
#include "server/records/program_memory.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/failing_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

// OPT-B.82: the special program of slot 1 is in the way as any other is.
TEST(FirstSlot, IsInTheWayOfASpecialProgram) {
  ServerBed bed;
  Must(bed.store().PutPrograms("optimo-1", {{.slot = 1, .object = ObjectOf("STOP\n")}}, {}));
  v1::StoreSpecialProgramsRequest request;
  request.set_parent("machines/optimo-1");
  request.add_slots(1);
  const auto stored = StoreSpecialPrograms(bed.store(), request, "anna");
  ASSERT_FALSE(stored);
  EXPECT_EQ(stored.error().code, ErrorCode::kCellAlreadyExists);
  EXPECT_THAT(stored.error().detail, HasSubstr("machines/optimo-1 that are there: 1;"));
}

class FirstSlotMemory : public testing::Test {
 protected:
  FirstSlotMemory() {
    const auto limit = LimitOfMemory(machine_);
    EXPECT_TRUE(limit);
    most_ = limit ? static_cast<std::size_t>(limit->bytes) : 0;
  }
  void Put(std::size_t bytes) {
    Must(
        bed_.store().PutPrograms("optimo-1", {{.slot = 1, .object = std::string(bytes, 'o')}}, {}));
  }
  bool HasRoomFor(int slot, std::size_t bytes) {
    const std::vector<storage::ProgramWrite> writes{
        {.slot = slot, .object = std::string(bytes, 'w')}};
    return CheckRoomFor(bed_.store(), machine_, writes).ok();
  }
  bool HasRoomForExecutable(int slot, std::size_t bytes) {
    return CheckRoomForExecutable(bed_.store(), machine_, slot, static_cast<std::int64_t>(bytes))
        .ok();
  }

  ServerBed bed_;
  storage::MachineRecord machine_ = Must(bed_.store().GetMachine("optimo-1"));
  std::size_t most_ = 0;
};

// What stands in slot 1 takes its room, and gives it to what replaces it.
TEST_F(FirstSlotMemory, IsUsedToTheLastByte) {
  Put(most_ - 100);
  EXPECT_TRUE(HasRoomFor(2, 100));
  EXPECT_FALSE(HasRoomFor(2, 101));
  EXPECT_TRUE(HasRoomFor(1, most_));
  EXPECT_FALSE(HasRoomFor(1, most_ + 1));
}

TEST_F(FirstSlotMemory, IsUsedByExecutablesToo) {
  Put(most_ - 100);
  ASSERT_TRUE(Must(bed_.store().PutExecutable("optimo-1", 1, 1, std::string(40, 'e'))));
  EXPECT_TRUE(HasRoomFor(2, 60));
  EXPECT_FALSE(HasRoomFor(2, 61));
  EXPECT_TRUE(HasRoomForExecutable(1, 100));
  EXPECT_FALSE(HasRoomForExecutable(1, 101));
  EXPECT_TRUE(HasRoomForExecutable(2, 60));
  EXPECT_FALSE(HasRoomForExecutable(2, 61));
}

// A mill takes as much as comes: what it holds is not asked for.
TEST(MemoryWithoutALimit, IsNotCounted) {
  ServerBed bed;
  FailingStore store(bed.store());
  const storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  const std::vector<storage::ProgramWrite> writes{{.slot = 1, .object = "PA;"}};
  store.FailAt(1);
  EXPECT_TRUE(CheckRoomFor(store, mill, writes));
  EXPECT_FALSE(store.failed());
}

}  // namespace
}  // namespace rmlcell::server
