// The ends of what is taken into a record.
#include <gtest/gtest.h>

#include <string>

#include "engine/simulation/toolpath/toolpath_level.h"
#include "server/records/file_family.h"
#include "server/records/machine_options.h"
#include "server/records/toolpath_levels.h"

namespace rmlcell::server {
namespace {

TEST(RecordLimits, OfFileNames) {
  EXPECT_TRUE(CheckFileName("", "file_name"));
  EXPECT_TRUE(CheckFileName(std::string(255, 'a'), "file_name"));
  const Status longer = CheckFileName(std::string(256, 'a'), "program.file_name");
  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(longer.error().detail, "program.file_name is longer than 255 bytes");
}

TEST(RecordLimits, OfToolpathLevels) {
  EXPECT_TRUE(CheckToolpathLevel(0));
  EXPECT_TRUE(CheckToolpathLevel(simulation::kToolpathLevelMax));
  for (const int level : {-1, simulation::kToolpathLevelMax + 1}) {
    const Status checked = CheckToolpathLevel(level);
    ASSERT_FALSE(checked) << level;
    EXPECT_EQ(checked.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(checked.error().detail, "level is " + std::to_string(level) + ", allowed are 0 to " +
                                          std::to_string(simulation::kToolpathLevelMax));
  }
}

// Each level is said with how exact it is and how large; that of the store is level 0.
TEST(RecordLimits, EachToolpathLevelIsTold) {
  v1::ToolpathHeader header;
  AddLevels("", 0.01, header);
  ASSERT_EQ(header.levels_size(), simulation::kToolpathLevelMax + 1);
  for (int level = 0; level <= simulation::kToolpathLevelMax; ++level) {
    EXPECT_EQ(header.levels(level).level(), level);
    EXPECT_EQ(header.levels(level).tolerance_mm(), simulation::LevelTolerance(0.01, level));
    EXPECT_EQ(header.levels(level).bytes(), 0);
  }
  SetLevel(0.01, 2, 17, header);
  EXPECT_EQ(header.level(), 2);
  EXPECT_EQ(header.level_max(), simulation::kToolpathLevelMax);
  EXPECT_EQ(header.tolerance_mm(), simulation::LevelTolerance(0.01, 2));
  EXPECT_EQ(header.bytes(), 17);
}

// LIVE-3.31: 0.1 s to 1 h, both of them.
TEST(RecordLimits, OfTimesOfAMachine) {
  const auto taken = [](std::int64_t seconds, int nanos) {
    v1::MachineOptions options;
    options.mutable_late_hold()->set_seconds(seconds);
    options.mutable_late_hold()->set_nanos(nanos);
    v1::MachineOptions other;
    *other.mutable_server_lost_after() = options.late_hold();
    EXPECT_EQ(CheckOptions(options).ok(), CheckOptions(other).ok());
    return CheckOptions(options).ok();
  };
  EXPECT_FALSE(taken(0, 0));
  EXPECT_FALSE(taken(0, 99'000'000));
  EXPECT_TRUE(taken(0, 100'000'000));
  EXPECT_TRUE(taken(3'600, 0));
  EXPECT_FALSE(taken(3'600, 1'000'000));
}

}  // namespace
}  // namespace rmlcell::server
