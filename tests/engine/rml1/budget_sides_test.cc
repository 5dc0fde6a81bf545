// The least budgets of a run, and what a group of axes says of the size of a program.
#include <gtest/gtest.h>

#include <string>

#include "engine/rml1/device.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// A budget of one command is one, and none is no bound.
TEST(BudgetSides, OneCommand) {
  const auto outcome = [](const std::string& stream, std::uint64_t steps) {
    machine::RunSetup setup = SetupOf(ParametersOf("t1"), stream);
    setup.budget.steps = steps;
    TestRun run(std::move(setup));
    run.AdvanceToEnd();
    return run->outcome().kind;
  };
  EXPECT_EQ(outcome("PU;", 1), machine::OutcomeKind::kCompleted);
  EXPECT_EQ(outcome("PU;PD;", 1), machine::OutcomeKind::kBudgetExceeded);
  EXPECT_EQ(outcome("PU;PD;", 0), machine::OutcomeKind::kCompleted);
}

// LIVE-3.01: where one command at one instant is too many, the first one that takes no time is.
TEST(BudgetSides, OneCommandAtOneInstant) {
  const auto goes_through = [](std::uint64_t most) {
    machine::RunSetup setup = SetupOf(ParametersOf("t1"), "VS4;VS5;VS6;VS7;VS8;");
    setup.budget.steps_at_one_instant = most;
    TestRun run(std::move(setup));
    run.AdvanceToEnd();
    return run->outcome().kind == machine::OutcomeKind::kCompleted;
  };
  EXPECT_FALSE(goes_through(1));
  EXPECT_FALSE(goes_through(2));
  EXPECT_TRUE(goes_through(0));
  EXPECT_TRUE(goes_through(100));
}

class NobodyHears final : public DeviceListener {
 public:
  void OnFinding(const Finding&) override {}
};

// Each axis of a group by itself; one that is not named stays where it is.
TEST(BudgetSides, SizesOfAxisGroups) {
  const Profile profile = MakeProfile(ParametersOf("t1a")).value();
  NobodyHears nobody;
  Device device(profile);
  std::int64_t offset = 0;
  for (const char c : std::string("!ZE X100 Y200 Z-300:Y700:Z-500;")) {
    device.Receive(static_cast<unsigned char>(c), offset++, nobody);
    do {
      while (!device.actions().empty()) device.actions().Pop();
    } while (device.Step(nobody));
  }
  const Programmed& programmed = device.programmed();
  EXPECT_EQ(programmed.x().low, 100.0);
  EXPECT_EQ(programmed.x().high, 100.0);
  EXPECT_EQ(programmed.y().low, 200.0);
  EXPECT_EQ(programmed.y().high, 700.0);
  EXPECT_EQ(programmed.z().low, -500.0);
  EXPECT_EQ(programmed.z().high, -300.0);
  EXPECT_EQ(programmed.z_grain(), 100U);
}

// LIVE-3.12: one turn carries out twenty thousand commands at most, whatever time they take: so
// many are between the ends of two turns.
TEST(BudgetSides, CommandsOfOneTurn) {
  std::string stream;
  for (int n = 0; n < 60'000; ++n) stream += "VS5;";
  TestRun run(ParametersOf("t1"), stream);
  run.seen().keep_events = false;
  ASSERT_EQ(run->Advance(kForever), machine::RunPhase::kRunning);
  const std::uint64_t first = run->steps_executed();
  ASSERT_EQ(run->Advance(kForever), machine::RunPhase::kRunning);
  EXPECT_EQ(run->steps_executed() - first, 20'000U);
  EXPECT_EQ(run->state().time, SimTime::zero());
}

}  // namespace
}  // namespace rmlcell::rml1
