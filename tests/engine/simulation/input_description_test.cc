#include "engine/simulation/run/input_description.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/simulation/run/version.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

// The published test values of FNV-1a with 128 bits.
TEST(Fnv1a, PublishedValues) {
  EXPECT_EQ(Fnv1a128(""), "6c62272e07bb014262b821756295c58d");
  EXPECT_EQ(Fnv1a128("a"), "d228cb696f1a8caf78912b704e4a8964");
  EXPECT_EQ(Fnv1a128("foobar"), "343e1662793c64bf6f0d3597ba446f18");
}

TEST(DescribeInputs, SaysWhatItIs) {
  machine::RunSetup setup = FakeFamily::Setup();
  ASSERT_TRUE(setup.parameters.Set("VMAX", 423.0));
  setup.inputs = {{SimTime(5), machine::InputKind::kStart, 0, 1.0},
                  {SimTime(9), machine::InputKind::kLogical, 3, 1.0}};
  const InputDescription description = DescribeInputs(FakeFamily(), setup);
  EXPECT_EQ(description.family, "fake");
  EXPECT_EQ(description.title, "part.FK");
  EXPECT_EQ(description.changed_parameters, setup.parameters.Changed());
  EXPECT_EQ(description.changed_parameters.size(), 1u);
  EXPECT_EQ(description.input_times, (std::vector{SimTime(5), SimTime(9)}));
  EXPECT_EQ(description.hash.size(), 32u);
}

// Design section 4: same inputs, same hash; any field that a run depends on changes it.
TEST(DescribeInputs, EveryFieldChangesTheHash) {
  using Change = std::function<void(machine::RunSetup&)>;
  const auto bytes = [](std::string_view text) { return machine::Bytes::Of(std::string(text)); };
  const std::vector<Change> changes = {
      [](machine::RunSetup&) {},
      [](machine::RunSetup& s) { ASSERT_TRUE(s.parameters.Set("VMAX", 400.0)); },
      [&](machine::RunSetup& s) { s.programs[1].object = bytes("movE"); },
      [&](machine::RunSetup& s) { s.programs[1].object = nullptr; },
      [&](machine::RunSetup& s) { s.programs[1].executable = bytes(""); },
      [&](machine::RunSetup& s) { s.programs[1].name.push_back('m'); },
      [&](machine::RunSetup& s) { s.programs[2] = s.programs[1]; },
      [](machine::RunSetup& s) { s.main_program = 2; },
      [](machine::RunSetup& s) { s.deleted_programs = {44}; },
      [](machine::RunSetup& s) { s.deleted_programs = {45}; },
      [](machine::RunSetup& s) { s.schedules = {{.number = 1, .name = "", .mode = "CW"}}; },
      [](machine::RunSetup& s) {
        s.schedules = {{.number = 1, .name = "", .mode = "CW", .power_percent = 99.0}};
      },
      [](machine::RunSetup& s) { s.machine_state.push_back('x'); },
      [](machine::RunSetup& s) { s.mode = machine::Mode::kSingle; },
      [](machine::RunSetup& s) { s.override_percent = 70.0; },
      [](machine::RunSetup& s) {
        s.breakpoint = {1, 2};
      },
      [](machine::RunSetup& s) {
        s.simul = {1, 2};
      },
      [](machine::RunSetup& s) {
        s.inputs = {{SimTime(1), machine::InputKind::kHold, 0, 0.0}};
      },
      [](machine::RunSetup& s) {
        s.inputs = {{SimTime(2), machine::InputKind::kHold, 0, 0.0}};
      },
      [](machine::RunSetup& s) {
        s.inputs = {{SimTime(1), machine::InputKind::kHold, 1, 0.0}};
      },
      [](machine::RunSetup& s) {
        s.inputs = {{SimTime(1), machine::InputKind::kHold, 0, 1.0}};
      },
      [](machine::RunSetup& s) {
        s.inputs = {{SimTime(1), machine::InputKind::kStop, 0, 0.0}};
      },
      [](machine::RunSetup& s) { s.inputs.resize(2); },
      [](machine::RunSetup& s) {
        s.breakpoint = {1, 3};
      },
      [](machine::RunSetup& s) {
        s.breakpoint = {2, 2};
      },
      [](machine::RunSetup& s) {
        s.simul = {1, 3};
      },
      [](machine::RunSetup& s) {
        s.simul = {2, 2};
      },
      [](machine::RunSetup& s) {
        s.breakpoint = {1, 2};
        s.simul = {1, 2};
      },
      [](machine::RunSetup& s) { s.schedules = {{.number = 2, .name = "", .mode = "CW"}}; },
      [](machine::RunSetup& s) { s.schedules = {{.number = 1, .name = "a", .mode = "CW"}}; },
      [](machine::RunSetup& s) { s.schedules = {{.number = 1, .name = "", .mode = "PW"}}; },
      [](machine::RunSetup& s) { s.schedules = {{.number = 1, .name = "C", .mode = "W"}}; },
      [&](machine::RunSetup& s) { s.programs[3] = s.programs[1]; },
      [](machine::RunSetup& s) { s.forecast = true; },
      [](machine::RunSetup& s) { s.budget.steps = 7; },
      [](machine::RunSetup& s) { s.budget.virtual_time = SimTime(7); },
  };
  std::set<std::string> hashes;
  for (const Change& change : changes) {
    machine::RunSetup setup = FakeFamily::Setup();
    change(setup);
    const std::string hash = DescribeInputs(FakeFamily(), setup).hash;
    EXPECT_TRUE(hashes.insert(hash).second) << hashes.size();
    EXPECT_EQ(DescribeInputs(FakeFamily(), setup).hash, hash);
  }
}

// What a fingerprint is taken of, by hand: numbers in eight bytes, the least significant first;
// texts behind their length; what may be missing behind a 1, or a 0.
struct HashedBytes {
  std::string all{};

  HashedBytes& Number(std::uint64_t value) {
    for (int k = 0; k < 8; ++k) all += static_cast<char>(value >> (8 * k) & 0xFF);
    return *this;
  }
  HashedBytes& Real(double value) { return Number(std::bit_cast<std::uint64_t>(value)); }
  HashedBytes& Text(std::string_view text) {
    Number(text.size());
    all += text;
    return *this;
  }
};

// The least of all setups, and one that has something of everything.
TEST(FingerprintOf, IsTheHashOfAllFieldsInTheirOrder) {
  machine::RunSetup empty = FakeFamily::Setup();
  empty.programs.clear();
  empty.main_program = 3;
  empty.override_percent = 100.0;
  HashedBytes least;
  least.Text("fake").Text(kEngineVersion).Number(0).Number(0).Number(0).Number(3).Number(0);
  least.Text(empty.machine_state).Number(static_cast<std::uint64_t>(empty.mode)).Real(100.0);
  least.Number(0).Number(0).Number(0).Number(0);
  least.Number(empty.budget.steps);
  least.Number(static_cast<std::uint64_t>(empty.budget.virtual_time.count()));
  EXPECT_EQ(FingerprintOf(FakeFamily(), empty), Fnv1a128(least.all));

  machine::RunSetup full = FakeFamily::Setup();
  ASSERT_TRUE(full.parameters.Set("VMAX", 423.0));
  const std::string large(machine::kReleaseEvery + 5, 'x');
  full.programs.clear();
  full.programs[7] = {.name = "seven", .object = machine::Bytes::Of(std::string(large))};
  full.programs[9] = {.name = "", .executable = machine::Bytes::Of("abc")};
  full.deleted_programs = {4, 5};
  full.main_program = 7;
  full.schedules = {{.number = 11, .name = "n", .mode = "CW", .power_percent = 55.5}};
  full.machine_state = "state";
  full.mode = machine::Mode::kSingle;
  full.override_percent = 70.0;
  full.breakpoint = {1, 2};
  full.simul = {3, 4};
  full.breakpoints = {{.at = {5, 6}, .condition = "VR[1] > 2", .from_pass = 8}};
  full.inputs = {{SimTime(5), machine::InputKind::kLogical, 3, 1.5},
                 {SimTime(6), machine::InputKind::kVariable, 0, 2.5, "VR[4]"}};
  full.forecast = true;
  full.budget = {.steps = 12, .virtual_time = SimTime(13), .steps_at_one_instant = 14};
  HashedBytes most;
  most.Text("fake").Text(kEngineVersion);
  const auto changed = full.parameters.Changed();
  most.Number(1).Text("VMAX").Text(changed.at("VMAX"));
  most.Number(2);
  most.Number(7).Text("seven").Number(1).Text(large).Number(0);
  most.Number(9).Text("").Number(0).Number(1).Text("abc");
  most.Number(2).Number(4).Number(5).Number(7);
  most.Number(1).Number(1).Number(11).Text("n").Text("CW").Real(55.5);
  most.Text("state").Number(static_cast<std::uint64_t>(machine::Mode::kSingle)).Real(70.0);
  most.Number(1).Number(1).Number(2).Number(1).Number(3).Number(4);
  most.Number(~std::uint64_t{1}).Number(1).Number(5).Number(6).Text("VR[1] > 2").Number(8);
  most.Number(2).Number(5).Number(static_cast<std::uint64_t>(machine::InputKind::kLogical));
  most.Number(3).Real(1.5);
  most.Number(6).Number(static_cast<std::uint64_t>(machine::InputKind::kVariable));
  most.Number(0).Real(2.5).Text("VR[4]");
  most.Number(1).Number(12).Number(13).Number(14);
  EXPECT_EQ(FingerprintOf(FakeFamily(), full), Fnv1a128(most.all));
}

}  // namespace
}  // namespace rmlcell::simulation
