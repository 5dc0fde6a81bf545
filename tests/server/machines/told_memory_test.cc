// What a host is told of the memory of its machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/machines/host_words.h"
#include "storage/store.h"

namespace rmlcell::server {
namespace {

// OPT-1.13: programs that are gone are told as well as those that are there.
TEST(ToldMemory, SaysWhatIsThereAndWhatIsGone) {
  storage::MachineMemory memory;
  storage::ProgramRecord& program = memory.programs.emplace_back();
  program.slot = 12;
  program.name = "door";
  program.object = "object 12";
  program.revision = 3;
  memory.deleted = {4, 9};
  const v1::HostMemory told = MemoryOf(memory);
  EXPECT_TRUE(told.whole());
  EXPECT_THAT(told.deleted_programs(), testing::ElementsAre(4, 9));
  ASSERT_EQ(told.programs_size(), 1);
  EXPECT_EQ(told.programs(0).slot(), 12);
  EXPECT_EQ(told.programs(0).title(), "door");
  EXPECT_EQ(told.programs(0).content(), "object 12");
  EXPECT_EQ(told.programs(0).object_revision(), 3);
}

}  // namespace
}  // namespace rmlcell::server
