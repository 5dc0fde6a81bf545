// The products of a recorded run that began at a step (live.md 3.41, 6).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "engine/machine/machine.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "rmlcell/v1/report.pb.h"
#include "server/worker/replayed_products.h"

namespace rmlcell::server {
namespace {

class ReplayedStarts : public testing::Test {
 protected:
  ReplayedStarts() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ReplayedStarts() override { std::filesystem::remove_all(folder_); }

  // A mill that begins so, and what is recorded of it until then.
  v1::RunReport ReportOf(const machine::MachineInput& input) {
    const machine::MachineFamily& family = *families::FindFamily("rml1");
    machine::RunObserver nobody;
    machine::MachineMemory memory;
    memory.programs[5] = {.name = "part",
                          .object = machine::Bytes::Of("PA;PA;VS10;PU2000,0;PU2000,2000;PU0,0;")};
    recording::Recording made;
    made.head.set_family("rml1");
    made.head.set_profile("srm-20");
    recording::SetMemory(memory, made.head);
    const auto machine = machine::Machine::Make(
        family, *machine::MakeParameters(family, "srm-20", {}), memory, "", nobody);
    EXPECT_TRUE(machine);
    v1::JournalEntry& mark = made.entries.emplace_back();
    mark.set_sequence(1);
    mark.mutable_mark()->set_state((*machine)->Save());
    mark.mutable_mark()->set_state_sha256(*BytesOfHex(bridge::Sha256Hex(mark.mark().state())));
    v1::JournalEntry& start = made.entries.emplace_back();
    start.set_sequence(2);
    *start.mutable_applied()->mutable_input() = bridge::AppliedOf(input);
    for (const int further : {0, 1}) {  // time goes on up to the first, where the run is over
      v1::JournalEntry& entry = made.entries.emplace_back();
      entry.set_sequence(3 + further);
      entry.set_virtual_time_ns(std::chrono::nanoseconds(std::chrono::hours(1 + further)).count());
    }
    std::ofstream(folder_ + "/recording", std::ios::binary) << recording::FileOf(made);
    const Status products = MakeProducts(folder_ + "/recording", folder_);
    EXPECT_TRUE(products) << products.error().detail;
    std::ifstream file(folder_ + "/report", std::ios::binary);
    v1::RunReport report;
    EXPECT_TRUE(report.ParseFromString(std::string(std::istreambuf_iterator<char>(file), {})));
    return report;
  }

  const std::string folder_ = testing::TempDir() + "/replayed-starts-" + std::to_string(::getpid());
};

// Its report is of what was run, and not of the steps before.
TEST_F(ReplayedStarts, TheReportIsOfWhatWasRun) {
  const v1::RunReport whole = ReportOf(machine::StartRun{.program = 5});
  const v1::RunReport rest =
      ReportOf(machine::StartAtStep{.program = 5,
                                    .target = {.at = {.program = 5, .step = 5}},
                                    .acknowledged = {"clamps", "tool", "origin", "Z0", "table"}});
  EXPECT_EQ(whole.total().steps(), 6);
  EXPECT_NEAR(whole.total().path_length_mm(), 40.0 + 20.0 + std::sqrt(800.0), 1e-6);
  EXPECT_EQ(rest.total().steps(), 2);
  EXPECT_NEAR(rest.total().path_length_mm(), 20.0 + std::sqrt(800.0), 1e-6);
  EXPECT_LT(rest.total().times().cycle_s(), 3.0);  // 48.3 mm at 30 mm/s, and not what was before
  EXPECT_NEAR(rest.total().times().cycle_s(), rest.total().times().motion_s(), 1e-6);
  EXPECT_EQ(rest.outcome().kind(), v1::Outcome::KIND_COMPLETED);
}

}  // namespace
}  // namespace rmlcell::server
