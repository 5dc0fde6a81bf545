// Names of schedules that are none say which form they should have.
#include <gtest/gtest.h>

#include "server/base/names.h"

namespace rmlcell::server {
namespace {

TEST(OddNames, AScheduleSaysWhatItsNameShouldBe) {
  for (const char* name :
       {"machines", "machines/a", "machines/a/programs/1", "machines/a/laserSchedules/x"}) {
    const auto parsed = ParseScheduleName(name);
    ASSERT_FALSE(parsed) << name;
    EXPECT_EQ(parsed.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(parsed.error().detail,
              "name is '" + std::string(name) + "', expected is machines/ID/laserSchedules/NUMBER");
  }
}

}  // namespace
}  // namespace rmlcell::server
