#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "engine/core/hex.h"
#include "engine/families/families.h"
#include "engine/machine/machine.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/sha256.h"
#include "proto/recording/recording.h"
#include "rmlcell/v1/report.pb.h"
#include "server/worker/replayed_products.h"

namespace rmlcell::server {

// What a machine that lived recorded of a run, made into the products of that run. LIVE-3.41
class ReplayedBed : public testing::Test {
 protected:
  struct Lived {
    std::string family = "rml1";
    std::string profile = "srm-20";
    machine::MachineMemory memory{};
    std::vector<machine::MachineInput> before{};  // what was done to it before it was recorded
    machine::MachineInput input{};
    std::chrono::seconds until = std::chrono::hours(1);
  };

  ReplayedBed() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ReplayedBed() override { std::filesystem::remove_all(folder_); }

  static machine::MachineMemory MillWith(const std::string& stream) {
    machine::MachineMemory memory;
    memory.programs[5] = {.name = "part", .object = machine::Bytes::Of(stream)};
    return memory;
  }
  // Up to a time at which nothing happens.
  static recording::Recording RecordingOf(const Lived& lived) {
    const machine::MachineFamily& family = *families::FindFamily(lived.family);
    machine::RunObserver nobody;
    recording::Recording made;
    made.head.set_machine("machines/one");
    made.head.set_family(lived.family);
    made.head.set_profile(lived.profile);
    recording::SetMemory(lived.memory, made.head);
    const auto machine = machine::Machine::Make(
        family, *machine::MakeParameters(family, lived.profile, {}), lived.memory, "", nobody);
    EXPECT_TRUE(machine);
    for (const machine::MachineInput& one : lived.before) {
      const Status done = (*machine)->Apply(one);
      EXPECT_TRUE(done) << done.error().detail;
    }
    v1::JournalEntry& mark = made.entries.emplace_back();
    mark.set_sequence(1);
    mark.mutable_mark()->set_state((*machine)->Save());
    mark.mutable_mark()->set_state_sha256(*BytesOfHex(bridge::Sha256Hex(mark.mark().state())));
    v1::JournalEntry& start = made.entries.emplace_back();
    start.set_sequence(2);
    *start.mutable_applied()->mutable_input() = bridge::AppliedOf(lived.input);
    // Two entries that tell nothing: time goes on up to the first, and behind it.
    for (const int further : {0, 1}) {
      v1::JournalEntry& entry = made.entries.emplace_back();
      entry.set_sequence(3 + further);
      entry.set_virtual_time_ns(
          std::chrono::nanoseconds(lived.until + std::chrono::seconds(further)).count());
    }
    return made;
  }
  Status Make(const recording::Recording& recording) const {
    std::ofstream(folder_ + "/recording", std::ios::binary) << recording::FileOf(recording);
    return MakeProducts(folder_ + "/recording", folder_);
  }
  std::string Product(const std::string& name) const {
    std::ifstream file(folder_ + "/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  v1::RunReport Report() const {
    v1::RunReport report;
    EXPECT_TRUE(report.ParseFromString(Product("report")));
    return report;
  }
  v1::RunReport ReportOf(const Lived& lived) const {
    const Status made = Make(RecordingOf(lived));
    EXPECT_TRUE(made) << made.error().detail;
    return Report();
  }
  // Why nothing is made of it.
  std::string Refused(const recording::Recording& recording) const {
    const Status made = Make(recording);
    return made ? "" : CodeText(made.error().code) + " " + std::string(made.error().detail);
  }

  const std::string folder_ = testing::TempDir() + "/replayed-" + std::to_string(::getpid());
};

}  // namespace rmlcell::server
