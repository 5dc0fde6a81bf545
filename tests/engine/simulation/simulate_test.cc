#include "engine/simulation/run/simulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/report/facts.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

using machine::RunPhase;

Script Square() {
  Script script;
  const motion::MachinePoint corners[] = {
      {0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {0, 0, 0}};
  for (int k = 1; k < 5; ++k) {
    script.Step(1, k).Line(corners[k - 1], corners[k], {.use = machine::MotionUse::kCut});
    script.Move(corners[k], 50.0, "LIN").Wait(machine::WaitKind::kDwell, 0.1);
  }
  return script;
}

// One call for everything.
TEST(Simulate, RunsToTheEndAndMakesTheProducts) {
  std::string trace;
  SimulationRequest request;
  request.products.trace = [&](const TraceRecord& record) {
    trace += TraceText(record) + '\n';
    return true;
  };
  request.products.picture = true;
  request.variables = {"VR[5]", "VR[6]"};
  const FakeFamily family(Square());
  const Result<SimulationResult> result = Simulate(family, FakeFamily::Setup(), std::move(request));
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_NEAR(result->report.total.cut_mm, 40.0, 1e-12);
  EXPECT_EQ(result->report.family, "fake");
  EXPECT_EQ(result->report.title, "part.FK");
  EXPECT_EQ(result->machine_state, "state");
  EXPECT_EQ(result->executables.at(12), "executable");
  EXPECT_EQ(
      result->variables,
      (std::vector<machine::NamedVariable>{{"VR[5]", {machine::VariableKind::kReal, "7.0"}}}));
  EXPECT_NE(result->svg.find("</svg>"), std::string::npos);
  EXPECT_NE(trace.find("end completed"), std::string::npos);
}

TEST(Simulate, SetupThatMakesNoSenseIsRefused) {
  machine::RunSetup setup = FakeFamily::Setup();
  setup.main_program = 99;
  const Result<SimulationResult> result = Simulate(FakeFamily(), std::move(setup), {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kCellInvalidArgument);
}

// Bytes of which only the first ones are known when a run begins.
class ComingBytes final : public machine::BytesKeeper {
 public:
  explicit ComingBytes(std::string all) : all_(std::move(all)) {}
  std::string_view First(std::size_t size) const { return std::string_view(all_).substr(0, size); }
  std::string_view ReadOn(std::string_view known, std::size_t size) const override {
    return First(std::max(known.size(), size));
  }
  bool IsWhole(std::string_view known) const override { return known.size() == all_.size(); }

 private:
  std::string all_;
};

// Design section 4: the same inputs have the same hash, whether they are there or still come.
TEST(Simulate, AStreamThatComesIsKnownByAllOfIt) {
  const auto keeper = std::make_shared<const ComingBytes>("move");
  machine::RunSetup setup = FakeFamily::Setup();
  setup.programs[1].object = machine::Bytes(keeper, keeper->First(2));
  ASSERT_FALSE(IsWhole(setup));
  EXPECT_EQ(DescribeInputs(FakeFamily(), setup).hash, "");
  const Result<SimulationResult> result = Simulate(FakeFamily(), std::move(setup), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.inputs_hash, DescribeInputs(FakeFamily(), FakeFamily::Setup()).hash);
}

// Design section 4: how time is cut into slices changes no byte of any product.
TEST(Simulation, SlicesChangeNothing) {
  std::vector<std::string> products;
  for (const SimTime slice :
       {SimTime(std::chrono::milliseconds(7)), SimTime(std::chrono::hours(1))}) {
    std::string bytes;
    SimulationRequest request;
    request.products.trace = [&](const TraceRecord& record) {
      bytes += TraceText(record);
      return true;
    };
    request.products.toolpath = [&](std::string_view block) {
      bytes += block;
      return true;
    };
    request.products.picture = true;
    request.options.slice = slice;
    const Result<SimulationResult> result =
        Simulate(FakeFamily(Square()), FakeFamily::Setup(), std::move(request));
    ASSERT_TRUE(result);
    products.push_back(bytes + FactsText(result->report) + result->svg);
  }
  EXPECT_EQ(products[0], products[1]);
}

// A worker steps, looks, and goes on; time moves by the slice.
TEST(Simulation, StepsBySlices) {
  Recorder recorder({}, {}, {});
  FakeRun run(Square(), recorder);
  Simulation simulation(run, recorder);
  EXPECT_EQ(simulation.Step(FromSeconds(0.2)), RunPhase::kRunning);
  EXPECT_EQ(simulation.state().time, FromSeconds(0.2));
  EXPECT_EQ(simulation.Step(SimTime::zero()), RunPhase::kRunning);
  EXPECT_EQ(simulation.state().time, FromSeconds(0.2) + SimTime(1));  // never stands still
  EXPECT_FALSE(simulation.Report().finished);
  while (simulation.Step(FromSeconds(0.1)) != RunPhase::kFinished) {
  }
  EXPECT_TRUE(simulation.finished());
  EXPECT_EQ(simulation.Step(FromSeconds(1)), RunPhase::kFinished);
  EXPECT_TRUE(simulation.Finish().finished);
}

// CELL-E9307: a job that is cancelled ends where it is.
TEST(Simulation, CanBeCancelledFromTheProgressCall) {
  SimulationRequest request;
  int calls = 0;
  SimTime last{0};
  request.options.slice = FromSeconds(0.3);
  request.options.progress = [&](const Progress& progress) {
    EXPECT_GT(progress.state.time, last);
    last = progress.state.time;
    return ++calls < 3;
  };
  const Result<SimulationResult> result =
      Simulate(FakeFamily(Square()), FakeFamily::Setup(), std::move(request));
  ASSERT_TRUE(result);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kCancelled);
  EXPECT_EQ(result->report.outcome.code, ErrorCode::kCellCancelled);
  EXPECT_EQ(result->report.cycle_time, FromSeconds(0.9));
}

Script WithHalt() {
  Script script;
  script.Step(1, 1).Halt("STOP").Step(1, 2).Wait(machine::WaitKind::kDwell, 1.0);
  return script;
}

// CELL-E9308: nobody presses START.
TEST(Simulation, HaltWithoutStartEndsTheRun) {
  const Result<SimulationResult> result = Simulate(FakeFamily(WithHalt()), FakeFamily::Setup(), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kStopped);
  EXPECT_EQ(result->report.outcome.code, ErrorCode::kCellWaitsForever);
  EXPECT_EQ(result->report.outcome.place.step, 1);
  EXPECT_EQ(result->report.steps_executed, 1u);
}

TEST(Simulation, StartCanBeGivenEveryTime) {
  SimulationRequest request;
  request.options.at_halt = AtHalt::kStart;
  const Result<SimulationResult> result =
      Simulate(FakeFamily(WithHalt()), FakeFamily::Setup(), std::move(request));
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(result->report.halts, 1u);
  EXPECT_EQ(result->report.cycle_time, FromSeconds(1.0));
}

// A scripted START acts at its time, however far away, and the wait is the operator's.
TEST(Simulation, ScriptedStartEndsAHalt) {
  machine::RunSetup setup = FakeFamily::Setup();
  setup.inputs = {{FromSeconds(3600.0), machine::InputKind::kStart, 0, 1.0}};
  const Result<SimulationResult> result = Simulate(FakeFamily(WithHalt()), std::move(setup), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(result->report.total.time.operator_wait, FromSeconds(3600.0));
}

// A START that has no effect must not be given for ever.
TEST(Simulation, StartWithoutEffectEndsTheRun) {
  Recorder recorder({}, {}, {});
  FakeRun run(WithHalt(), recorder);
  run.MakeDeaf();
  Simulation simulation(run, recorder);
  SimulationOptions options;
  options.at_halt = AtHalt::kStart;
  const RunReport report = RunToEnd(simulation, options);
  EXPECT_EQ(report.outcome.code, ErrorCode::kCellWaitsForever);
}

// An input that is no START leaves a halt as it is; what comes behind it would not be waited for.
TEST(Simulation, AnInputThatIsNoStartLeavesAHalt) {
  machine::RunSetup setup = FakeFamily::Setup();
  setup.inputs = {{FromSeconds(5.0), machine::InputKind::kLogical, 3, 1.0}};
  const Result<SimulationResult> result = Simulate(FakeFamily(WithHalt()), std::move(setup), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kStopped);
  EXPECT_EQ(result->report.outcome.code, ErrorCode::kCellWaitsForever);
}

// Who cancels a run that is over comes too late.
TEST(Simulation, WhatIsOverIsNotEndedAgain) {
  Recorder recorder({}, {}, {});
  FakeRun run(Square(), recorder);
  Simulation simulation(run, recorder);
  ASSERT_EQ(simulation.Step(FromSeconds(3600.0)), RunPhase::kFinished);
  simulation.Cancel();
  const RunReport report = simulation.Finish();
  EXPECT_EQ(report.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_FALSE(report.outcome.code.has_value());
}

machine::RunSetup SetupOfLaserText(const std::string& text) {
  const machine::MachineFamily& laser = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(laser.parameters())};
  setup.main_program = 1;
  machine::Translation made = laser.Translate({.name = "1.S", .bytes = text}, setup.parameters, {});
  EXPECT_TRUE(made.ok) << text;
  setup.programs[1].object = machine::Bytes::Of(std::move(made.object));
  return setup;
}

// The halted machine is asked again at each input, until one of them is its START.
TEST(Simulation, AHaltWaitsForTheInputThatEndsIt) {
  machine::RunSetup setup = SetupOfLaserText("STOP\nDELAY 1.\n");
  setup.inputs = {{FromSeconds(5.0), machine::InputKind::kLogical, 16, 1.0},
                  {FromSeconds(10.0), machine::InputKind::kStart, 0, 1.0}};
  const auto result = Simulate(*families::FindFamily("optimo"), std::move(setup), {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(result->report.halts, 1u);
  EXPECT_EQ(result->report.total.time.operator_wait, FromSeconds(10.0));
  EXPECT_EQ(result->report.total.time.dwell, FromSeconds(1.0));
}

// A run halts behind the steps that somebody watches.
TEST(Simulation, BreakpointsHaltTheRun) {
  for (const AtHalt at_halt : {AtHalt::kEnd, AtHalt::kStart}) {
    machine::RunSetup setup = SetupOfLaserText("DELAY 1.\nDELAY 1.\nDELAY 1.\n");
    setup.breakpoints = {{.at = {1, 2}}};
    const auto result = Simulate(*families::FindFamily("optimo"), std::move(setup),
                                 {.options = {.at_halt = at_halt}});
    ASSERT_TRUE(result);
    const bool ends = at_halt == AtHalt::kEnd;
    EXPECT_EQ(result->report.halts, 1u);
    EXPECT_EQ(result->report.total.time.dwell, FromSeconds(ends ? 2.0 : 3.0));
    EXPECT_EQ(result->report.outcome.kind,
              ends ? machine::OutcomeKind::kStopped : machine::OutcomeKind::kCompleted);
  }
}

// What is left of a block, what it was compared with, and the plot; of a run without them nothing.
TEST(Simulate, GivesTheBlockItsTargetAndThePlot) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  machine::RunSetup setup(*machine::MakeParameters(mill, "t1", {}));
  setup.main_program = 1;
  setup.programs[1].object =
      machine::Bytes::Of("VS10;!VZ10;!PZ-100,200;!MC1;PU100,100;PD200,100;PU0,0;!MC0;");
  const Stock stock = *ParseStock("20x20x10");
  const HeightField::Size size = HeightField::SizeOf(stock);
  const auto wanted = std::make_shared<const std::vector<float>>(size.columns * size.rows, 0.0f);
  SimulationRequest request;
  request.products.milling =
      Milling{.stock = stock, .tool = *ParseTool("flat:3"), .target = Target{.heights = wanted}};
  request.products.plot = true;
  const auto made = Simulate(mill, setup, std::move(request));
  ASSERT_TRUE(made);
  ASSERT_TRUE(made->material.has_value());
  EXPECT_NEAR(std::ranges::min(made->material->heights()), -1.0f, 1e-4f);
  ASSERT_TRUE(made->target.has_value());
  EXPECT_EQ(made->target->heights, wanted);
  EXPECT_NE(made->plot.find("<svg"), std::string::npos);
  EXPECT_EQ(made->svg, "");
  const auto bare = Simulate(mill, setup, {});
  ASSERT_TRUE(bare);
  EXPECT_FALSE(bare->material.has_value());
  EXPECT_FALSE(bare->target.has_value());
  EXPECT_EQ(bare->plot, "");
}

// CELL-E9306, when the caller wants it; else the product is cut off and the run goes on.
TEST(Simulation, OutputBudget) {
  for (const bool ends : {true, false}) {
    SimulationRequest request;
    request.products.trace = [](const TraceRecord&) { return true; };
    request.products.trace_records_max = 2;
    request.options.end_when_cut_off = ends;
    request.options.slice = FromSeconds(0.1);
    const Result<SimulationResult> result =
        Simulate(FakeFamily(Square()), FakeFamily::Setup(), std::move(request));
    ASSERT_TRUE(result);
    EXPECT_FALSE(result->report.trace.complete);
    if (ends) {
      EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kBudgetExceeded);
      EXPECT_EQ(result->report.outcome.code, ErrorCode::kCellOutputBudget);
    } else {
      EXPECT_EQ(result->report.outcome.kind, machine::OutcomeKind::kCompleted);
    }
  }
}

}  // namespace
}  // namespace rmlcell::simulation
