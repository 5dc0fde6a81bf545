// What a record says where a number is 0 or the first of its kind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/records/job_messages.h"
#include "server/records/machine_capabilities.h"
#include "server/records/machine_messages.h"
#include "server/records/program_memory.h"
#include "server/records/program_place.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

std::vector<std::string> JogAxesOf(const v1::MachineCapabilities& capabilities) {
  std::vector<std::string> axes;
  for (const v1::MachineCapabilities::JogAxis& one : capabilities.jog_axes())
    axes.push_back(one.axis() + (one.unit() == v1::UNIT_RADIAN ? " rad" : " mm"));
  return axes;
}

// LIVE-8.03: an axis that the machine does not have does not move; A turns, of either family.
TEST(RecordValues, OfAxesThatKeysMove) {
  EXPECT_THAT(JogAxesOf(CapabilitiesOf({.id = "o", .family = "optimo"})),
              ElementsAre("X mm", "Y mm", "Z mm", "A rad", "B rad"));
  EXPECT_THAT(JogAxesOf(CapabilitiesOf({.id = "m", .family = "rml1", .profile = "srm-20"})),
              ElementsAre("X mm", "Y mm", "Z mm"));
  EXPECT_THAT(
      JogAxesOf(CapabilitiesOf(
          {.id = "m", .family = "rml1", .profile = "srm-20", .parameters = {{"AXES", "XYZA"}}})),
      ElementsAre("X mm", "Y mm", "Z mm", "A rad"));
}

// Jobs that wait are no job that is simulated.
TEST(RecordValues, OfAMachineWhoseJobsWait) {
  const storage::MachineRecord record{.id = "mill-1", .family = "rml1"};
  v1::MachineStatus status =
      StatusOf(record, {{.machine = "mill-1", .unfinished = 2, .oldest_running = 0}});
  EXPECT_EQ(status.jobs_active(), 2);
  EXPECT_EQ(status.simulating_job(), "");
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_IDLE);
  status = StatusOf(record, {{.machine = "mill-1", .unfinished = 2, .oldest_running = 1}});
  EXPECT_EQ(status.simulating_job(), "jobs/1");
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_RUNNING);
}

// A fraction of a second is told forwards, whatever the second: of 1969 as of today.
TEST(RecordValues, OfTimesBeforeTheEpoch) {
  const std::vector<std::pair<std::int64_t, std::int32_t>> times = {
      {-1, 500'000'000}, {-62'135'596'800, 1'000}, {0, 0}, {1'700'000'000, 999'999'000}};
  for (const auto& [seconds, nanos] : times) {
    google::protobuf::Timestamp time;
    time.set_seconds(seconds);
    time.set_nanos(nanos);
    const google::protobuf::Timestamp told = ToProto(FromProto(time));
    EXPECT_EQ(told.seconds(), seconds);
    EXPECT_EQ(told.nanos(), nanos);
  }
}

// What has no bytes is there all the same.
TEST(RecordValues, OfAProgramWithoutBytes) {
  storage::ProgramSummary summary{.slot = 7};
  summary.source_bytes = 0;
  summary.executable_bytes = -1;
  v1::Program program = ToProto("optimo-1", summary);
  EXPECT_TRUE(program.has_source_bytes());
  EXPECT_FALSE(program.has_executable_bytes());
  summary.source_bytes = -1;
  summary.executable_bytes = 0;
  program = ToProto("optimo-1", summary);
  EXPECT_FALSE(program.has_source_bytes());
  EXPECT_TRUE(program.has_executable_bytes());
}

// Nobody knows what fits into a machine of a later version, or one with parameters that are none.
TEST(RecordValues, OfMemoriesWithoutALimit) {
  EXPECT_FALSE(LimitOfMemory({.id = "odd", .family = "lathe"}));
  EXPECT_FALSE(LimitOfMemory({.id = "o", .family = "optimo", .parameters = {{"NONE", "1"}}}));
  EXPECT_FALSE(LimitOfMemory({.id = "m", .family = "rml1", .profile = "srm-20"}));
  const auto limit =
      LimitOfMemory({.id = "o", .family = "optimo", .parameters = {{"CMOS_SIZE", "1000"}}});
  ASSERT_TRUE(limit);
  EXPECT_EQ(limit->bytes, 1000);
  EXPECT_EQ(limit->full, ErrorCode::kCmosFull);
}

}  // namespace
}  // namespace rmlcell::server
