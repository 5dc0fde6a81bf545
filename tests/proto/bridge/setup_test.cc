#include "proto/bridge/setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::bridge {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const machine::MachineFamily& Optimo() { return *families::FindFamily("optimo"); }

simulation::MemoryProgram Source(int slot, const std::string& text,
                                 const std::string& name = "p.S") {
  return {.slot = slot,
          .name = "part",
          .file_name = name,
          .bytes = machine::Bytes::Of(text),
          .is_source = true};
}

simulation::ProgramMemory MemoryOf(std::vector<simulation::MemoryProgram> programs) {
  return {.family = &Optimo(), .programs = std::move(programs)};
}

// Of program 12.
Result<simulation::PreparedRun> Prepare(const simulation::ProgramMemory& memory,
                                        const v1::SimulationOptions& options,
                                        const v1::Budget& budget,
                                        machine::Mode default_mode = machine::Mode::kRemote) {
  return simulation::PrepareRun(memory, *RunOptionsOf(options, budget, 12, default_mode));
}

TEST(MakeParameters, DefaultsThenProfileThenValues) {
  const auto plain = machine::MakeParameters(Optimo(), "", {});
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->Number("VMAX"), 500.0);
  EXPECT_EQ(machine::MakeParameters(Optimo(), "mc-1000ipm", {})->Number("VMAX"), 423.333);
  EXPECT_EQ(machine::MakeParameters(Optimo(), "mc-1000ipm", {{"VMAX", "300"}})->Number("VMAX"),
            300.0);
  const auto code = [](const std::string& profile,
                       const std::map<std::string, std::string>& values) {
    return machine::MakeParameters(Optimo(), profile, values).error().code;
  };
  EXPECT_EQ(code("lathe", {}), ErrorCode::kCellInvalidArgument);
  EXPECT_THAT(machine::MakeParameters(Optimo(), "lathe", {}).error().detail,
              HasSubstr("no profile 'lathe'; there are standard mc-1000ipm"));
  EXPECT_EQ(code("", {{"COLOUR", "1"}}), ErrorCode::kCellUnknownParameter);
  EXPECT_EQ(code("", {{"VMAX", "-1"}}), ErrorCode::kCellParameterRange);
  EXPECT_EQ(code("", {{"TRAVEL_X_MIN", "100"}, {"TRAVEL_X_MAX", "50"}}),
            ErrorCode::kCellParameterRange);
}

TEST(PrepareRun, TakesManyBreakpoints) {
  const auto made = [](const std::vector<std::tuple<int, std::string, int>>& asked) {
    v1::SimulationOptions options;
    for (const auto& [step, condition, passes] : asked) {
      v1::Breakpoint& one = *options.add_breakpoints();
      one.mutable_step()->set_step(step);
      one.set_condition(condition);
      one.set_passes(passes);
    }
    return *RunOptionsOf(options, {}, 12, machine::Mode::kCycle);
  };
  EXPECT_EQ(made({{7, "", 1}}).breakpoint, (machine::ProgramStep{.program = 12, .step = 7}));
  const machine::ProgramStep seven{.program = 12, .step = 7};
  const machine::ProgramStep eight{.program = 12, .step = 8};
  using List = std::vector<machine::Breakpoint>;
  EXPECT_EQ(made({{7, "", 0}, {8, "", 3}}).breakpoints,
            (List{{.at = seven}, {.at = eight, .from_pass = 3}}));
  EXPECT_EQ(made({{7, "VI[1] > 2", 0}}).breakpoints,
            (List{{.at = seven, .condition = "VI[1] > 2"}}));
  EXPECT_EQ(made({{7, "", 2}}).breakpoint, std::nullopt);
}

TEST(PrepareRun, TakesEverythingOver) {
  simulation::ProgramMemory input = MemoryOf({Source(12, "SPEED 20\n"), Source(13, "SPEED 30\n")});
  input.programs.push_back({.slot = 14,
                            .name = "object",
                            .file_name = "q.O",
                            .bytes = machine::Bytes::Of("bytes"),
                            .is_source = true,
                            .executable = machine::Bytes::Of("executable")});
  input.profile = "mc-1000ipm";
  input.parameters = {{"CYCLE", "0.064"}, {"SETTLE", "0.5"}};
  input.deleted_programs = {3, 4};
  input.schedules = {{.number = 11}};
  input.machine_state = "state";
  v1::SimulationOptions options;
  (*options.mutable_parameters())["SETTLE"] = "0.25";
  options.set_override_percent(55.0);
  options.add_breakpoints()->mutable_step()->set_step(7);
  options.mutable_simul()->set_program(13);
  options.mutable_simul()->set_step(8);
  options.add_inputs()->mutable_input()->mutable_start();
  v1::Budget budget;
  budget.set_steps(9);
  budget.set_virtual_time_ns(10'000'000'000);
  const auto made = Prepare(input, options, budget);
  ASSERT_TRUE(made);
  ASSERT_TRUE(made->setup);
  const machine::RunSetup& setup = *made->setup;
  EXPECT_EQ(setup.parameters.Number("VMAX"), 423.333);
  EXPECT_EQ(setup.parameters.Number("CYCLE"), 0.064);
  EXPECT_EQ(setup.parameters.Number("SETTLE"), 0.25);  // the job's over the machine's
  EXPECT_THAT(setup.deleted_programs, ElementsAre(3, 4));
  EXPECT_EQ(setup.main_program, 12);
  EXPECT_EQ(setup.schedules.size(), 1U);
  EXPECT_EQ(setup.machine_state, "state");
  EXPECT_EQ(setup.mode, machine::Mode::kRemote);
  EXPECT_TRUE(setup.forecast);
  EXPECT_EQ(setup.override_percent, 55.0);
  ASSERT_TRUE(setup.breakpoint);
  EXPECT_EQ(setup.breakpoint->program, 12);  // none named: that of the main program
  EXPECT_EQ(setup.breakpoint->step, 7);
  EXPECT_TRUE(setup.breakpoints.empty());
  EXPECT_EQ(setup.simul->program, 13);
  EXPECT_EQ(setup.simul->step, 8);
  EXPECT_EQ(setup.inputs.size(), 1U);
  EXPECT_EQ(setup.budget.steps, 9U);
  EXPECT_EQ(ToSeconds(setup.budget.virtual_time), 10.0);
  ASSERT_EQ(setup.programs.size(), 3U);
  EXPECT_EQ(setup.programs.at(12).name, "part");
  EXPECT_TRUE(setup.programs.at(12).source);
  EXPECT_EQ(*setup.programs.at(14).object, "bytes");  // its name says that it is an object
  EXPECT_EQ(*setup.programs.at(14).executable, "executable");
  EXPECT_FALSE(setup.programs.at(14).source);
}

TEST(PrepareRun, ModesAndWhatIsNotAskedFor) {
  simulation::ProgramMemory input = MemoryOf({Source(12, "SPEED 20\n")});
  v1::SimulationOptions options;
  const auto mode = [&](v1::OperatingMode asked) {
    options.set_mode(asked);
    return Prepare(input, options, {}, machine::Mode::kCycle)->setup->mode;
  };
  EXPECT_EQ(mode(v1::OPERATING_MODE_UNSPECIFIED), machine::Mode::kCycle);
  EXPECT_EQ(mode(v1::OPERATING_MODE_REMOTE), machine::Mode::kRemote);
  EXPECT_EQ(mode(v1::OPERATING_MODE_SINGLE), machine::Mode::kSingle);
  EXPECT_EQ(mode(v1::OPERATING_MODE_REPEAT), machine::Mode::kRepeat);
  options.set_mode(v1::OPERATING_MODE_UNSPECIFIED);
  EXPECT_EQ(Prepare(input, options, {})->setup->mode, machine::Mode::kRemote);
  options.set_mode(v1::OPERATING_MODE_CYCLE);
  EXPECT_EQ(Prepare(input, options, {})->setup->mode, machine::Mode::kCycle);
  const machine::RunSetup plain(machine::Parameters(Optimo().parameters()));
  const auto made = Prepare(input, options, {});
  EXPECT_EQ(made->setup->override_percent, 100.0);
  v1::SimulationOptions slow;
  slow.set_override_percent(0.5);
  EXPECT_EQ(RunOptionsOf(slow, {}, 1, machine::Mode::kCycle)->override_percent, 0.5);
  EXPECT_FALSE(made->setup->breakpoint);
  EXPECT_FALSE(made->setup->simul);
  EXPECT_EQ(made->setup->budget.steps, plain.budget.steps);
  EXPECT_EQ(made->setup->budget.virtual_time, plain.budget.virtual_time);
}

TEST(PrepareRun, InputsThatCannotBeAreRefused) {
  v1::SimulationOptions options;
  options.add_inputs()->set_virtual_time_ns(-1);
  const auto made = RunOptionsOf(options, {}, 12, machine::Mode::kCycle);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(made.error().detail, "virtual_time_ns must be 0 or later");
}

// Every program is translated, also behind one with errors; advice is for the main one alone.
TEST(PrepareRun, FindingsOfEveryProgram) {
  const auto made =
      Prepare(MemoryOf({Source(13, "SPEDE 20\n"), Source(12, "SPEED\n"), Source(14, "SPEED 20\n")}),
              {}, {});
  ASSERT_TRUE(made);
  EXPECT_FALSE(made->setup);
  std::vector<int> slots;
  for (const Diagnostic& d : made->diagnostics) slots.push_back(d.program);
  EXPECT_EQ(slots, (std::vector<int>{13, 12}));
  EXPECT_TRUE(made->diagnostics_dropped.empty());
  std::string many;
  for (int n = 0; n < 1500; ++n) many += "SPEDE 20\n";
  const auto most = Prepare(MemoryOf({Source(13, many), Source(12, many)}), {}, {});
  EXPECT_EQ(most->diagnostics.size() + most->diagnostics_dropped.count(), 3000U);
  // The second program's last line is the last place of all, its slot being the lower one: the
  // first 1000 of program 13 are kept, its last is the last by slot.
  ASSERT_EQ(most->diagnostics_dropped.kinds().size(), 1U);
  const GatheredFindings& rest = most->diagnostics_dropped.kinds().begin()->second;
  EXPECT_EQ(rest.first.program, 12);
  EXPECT_EQ(rest.first.where.line, 1);
  EXPECT_EQ(rest.last.program, 13);
  EXPECT_EQ(rest.last.where.line, 1500);
  EXPECT_EQ(most->diagnostics.size(), machine::kDiagnosticsMax);
}

// A program that the checked one calls is run with it; one with errors is as if it were not there.
TEST(CheckProgram, RunsTheOthersOfTheMemoryThatAreGood) {
  const machine::Parameters parameters(Optimo().parameters());
  const auto check = [&](const std::string& main) {
    return *simulation::CheckProgram(MemoryOf({Source(12, main), Source(13, "SPEDE 20\n"),
                                               Source(14, "MOVE (99999.,0.,0.,0.,0.)\n")}),
                                     parameters, 12, true, {});
  };
  const simulation::CheckedProgram called = check("CALL 14\n");
  EXPECT_TRUE(called.translation.ok);
  ASSERT_EQ(called.motion.findings.size(), 1U);
  EXPECT_EQ(called.motion.findings[0].code, ErrorCode::kTargetOutOfTravel);
  EXPECT_EQ(called.motion.findings[0].program, 14);
  EXPECT_FALSE(called.ok());
  EXPECT_TRUE(called.motion.cut_short.empty());
  const simulation::CheckedProgram missing = check("CALL 13\n");
  EXPECT_TRUE(missing.motion.findings.empty());
  EXPECT_THAT(missing.motion.cut_short.at(12).text, HasSubstr("OPT-E7102"));
  // Of a whole memory what has errors is there all the same; what is in no slot is not.
  simulation::ProgramMemory whole = MemoryOf({Source(12, "CALL 13\n"), Source(13, "SPEDE 20\n")});
  whole.given = simulation::MemoryGiven::kWhole;
  EXPECT_TRUE(simulation::CheckProgram(whole, parameters, 12, true, {})->ok());
  whole.programs.pop_back();
  EXPECT_FALSE(simulation::CheckProgram(whole, parameters, 12, true, {})->ok());
  // Its text alone, when that is bad; and what stands later takes the place of what stood there.
  const simulation::CheckedProgram bad = check("CALL\n");
  EXPECT_FALSE(bad.ok());
  EXPECT_TRUE(bad.motion.cut_short.empty());
  const auto last = simulation::CheckProgram(
      MemoryOf({Source(12, "CALL 13\n"), Source(12, "SPEED 20\n")}), parameters, 12, true, {});
  EXPECT_TRUE(last->ok());
  EXPECT_TRUE(last->motion.cut_short.empty());
  EXPECT_EQ(simulation::CheckProgram(MemoryOf({}), parameters, 12, true, {}).error().code,
            ErrorCode::kProgramMissing);
}

TEST(ObjectFileName, EndsInO) {
  EXPECT_TRUE(families::IsObjectFileName("1.O"));
  EXPECT_TRUE(families::IsObjectFileName("12.o"));
  EXPECT_FALSE(families::IsObjectFileName(".O"));
  EXPECT_FALSE(families::IsObjectFileName("12.S"));
  EXPECT_FALSE(families::IsObjectFileName("12O"));
}

TEST(Variables, RangesAreWrittenOut) {
  EXPECT_THAT(*ExpandVariables({"VI[99]", "Z1", "VR[8..10]", "VL[3..3]"}),
              ElementsAre("VI[99]", "Z1", "VR[8]", "VR[9]", "VR[10]", "VL[3]"));
  EXPECT_EQ(ExpandVariables({"VR[0..999]"})->size(), 1000U);
  for (const char* wrong : {"VR[0..1000]", "VR[5..4]", "VR[-1..4]", "VR0..4]", "VR[0..4", "VR[..4]",
                            "VR[0..]", "VR[a..4]"}) {
    const auto expanded = ExpandVariables({wrong});
    ASSERT_FALSE(expanded) << wrong;
    EXPECT_EQ(expanded.error().code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(expanded.error().detail, "variables: '" + std::string(wrong) + "': write VR[0..9]");
  }
  EXPECT_EQ(ExpandVariables({"VR[0..999]", "A"}).error().detail, "variables: more than 1,000");
  EXPECT_THAT(ExpandVariables({std::string(100, 'x') + ".."}).error().detail,
              HasSubstr("'" + std::string(80, 'x') + "'"));
}

}  // namespace
}  // namespace rmlcell::bridge
