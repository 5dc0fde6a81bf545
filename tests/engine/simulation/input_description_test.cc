#include "engine/simulation/run/input_description.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

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

}  // namespace
}  // namespace rmlcell::simulation
