#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/machine/standing.h"
#include "engine/machine/tools.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"

namespace rmlcell::optimo {
namespace {

using ::testing::ElementsAre;

machine::Parameters Standard() { return machine::Parameters(OptimoFamily().parameters()); }

// The details of warning 7317 for a corner of 90 degrees that is cut at `speed` with OVERSH 50.
std::string SharpCorner(const std::string& speed, const machine::Parameters& parameters) {
  const std::string text = "COORD ABSOL\nPATH LIN\nOVERSH 50\nSPEED " + speed +
                           "\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (100,0,0,0,0)/FLY\n"
                           "MOVE (100,100,0,0,0)\nWORK 0,0/OFF\n";
  for (const Diagnostic& d : OptimoFamily().Translate({"a.S", text}, parameters, {}).diagnostics) {
    if (d.code == ErrorCode::kFlySharp) return d.detail;
  }
  return {};
}

// OPT-2.42, OPT-2.62, OPT-B.01: the same 25 mm/s in the bend, and the 0.480 mm of case C13, from
// SPEED 10 of a machine of 500 mm/s and from SPEED 20 of one of 250 mm/s.
TEST(OptimoFamily, AdviceIsForTheMachineAtHand) {
  machine::Parameters slow = Standard();
  ASSERT_TRUE(slow.Set("VMAX", 250.0));
  EXPECT_NE(SharpCorner("10", Standard()).find("stays 0.480 mm"), std::string::npos);
  EXPECT_NE(SharpCorner("20", slow).find("stays 0.480 mm"), std::string::npos);
  EXPECT_EQ(SharpCorner("20", Standard()).find("stays 0.480 mm"), std::string::npos);
}

// OPT-B.06, OPT-B.08: a travel that ends before it begins is none; one of a single place is a
// clamped axis.
TEST(OptimoFamily, RefusesTravelsThatEndBeforeTheyBegin) {
  machine::RunObserver nobody;
  for (const std::string axis : {"X", "Y", "Z", "A", "B"}) {
    machine::Parameters parameters = Standard();
    ASSERT_TRUE(parameters.Set("TRAVEL_" + axis + "_MAX", 1.0));
    ASSERT_TRUE(parameters.Set("TRAVEL_" + axis + "_MIN", 1.0));
    EXPECT_TRUE(OptimoFamily().CheckParameters(parameters));
    ASSERT_TRUE(parameters.Set("TRAVEL_" + axis + "_MIN", 1.5));
    const Status fit = OptimoFamily().CheckParameters(parameters);
    ASSERT_FALSE(fit);
    EXPECT_EQ(fit.error().code, ErrorCode::kCellParameterRange);
    EXPECT_EQ(fit.error().detail,
              "TRAVEL_" + axis + "_MIN is 1.5, above TRAVEL_" + axis + "_MAX, which is 1");
    EXPECT_FALSE(OptimoFamily().NewRun(machine::RunSetup(parameters), nobody));
    EXPECT_FALSE(OptimoFamily().NewStanding(parameters, ""));
  }
  EXPECT_TRUE(OptimoFamily().CheckParameters(Standard()));
}

// machine_state.h: no machine stands as bytes say that are no state of it.
TEST(OptimoFamily, StandsOnlyInAStateOfItsOwn) {
  EXPECT_TRUE(OptimoFamily().NewStanding(Standard(), ""));
  const auto foreign = OptimoFamily().NewStanding(Standard(), "no state");
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, ErrorCode::kCellBadText);
}

// What others ask the family for, by the codes of the Optimo.
TEST(OptimoFamily, HasItsCodes) {
  const machine::FamilyInfo& info = OptimoFamily().info();
  EXPECT_EQ(info.no_slot, ErrorCode::kProgramNumber);
  EXPECT_EQ(info.empty_slot, ErrorCode::kProgramMissing);
  EXPECT_EQ(info.in_use, ErrorCode::kProgramInUse);
  EXPECT_EQ(info.no_schedule, ErrorCode::kScheduleRange);
  EXPECT_EQ(info.travel_left, ErrorCode::kTargetOutOfTravel);
  EXPECT_EQ(info.not_zeroed, ErrorCode::kNotZeroed);
  EXPECT_EQ(info.emergency_stop, ErrorCode::kEmergencyStop);
  EXPECT_EQ(info.given_twice, ErrorCode::kProjectDuplicate);
  EXPECT_EQ(info.no_source, ErrorCode::kProjectSource);
  EXPECT_FALSE(info.torn);
  EXPECT_THAT(info.check.of_motion,
              ElementsAre(ErrorCode::kTargetOutOfTravel, ErrorCode::kSpeedHeldByAxis,
                          ErrorCode::kFlyReversal, ErrorCode::kNoMotion));
  EXPECT_THAT(info.check.by_speed, ElementsAre(ErrorCode::kNoMotion));
  EXPECT_THAT(info.check.not_given,
              ElementsAre(ErrorCode::kProgramMissing, ErrorCode::kFunctionMissing,
                          ErrorCode::kCallNotExecutable));
  EXPECT_EQ(info.check.work_offset, "SYSDEF");
  const machine::ToolCodes& tools = OptimoFamily().tools()->codes();
  EXPECT_EQ(tools.source_is_inch, ErrorCode::kSourceIsInch);
  EXPECT_EQ(tools.convert_input, ErrorCode::kConvertInput);
  EXPECT_EQ(tools.convert_output, ErrorCode::kConvertOutput);
  const auto memory = OptimoFamily().ProgramMemory(Standard());
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->bytes, 1'048'576);
  EXPECT_EQ(memory->full, ErrorCode::kCmosFull);
}

// What its machines can do.
TEST(OptimoFamily, SaysWhatItsMachinesCanDo) {
  const machine::FamilyInfo& info = OptimoFamily().info();
  EXPECT_TRUE(info.has_executables);
  EXPECT_EQ(info.schedules, 63);  // OPT-3.44
  EXPECT_TRUE(info.checked_by_running);
  EXPECT_FALSE(info.hold_in_remote);           // OPT-4.17
  EXPECT_EQ(info.override_min_percent, 10.0);  // OPT-4.34
  EXPECT_EQ(info.override_max_percent, 145.0);
  EXPECT_EQ(info.override_step_percent, 15.0);
  EXPECT_TRUE(info.has_repeat);
  EXPECT_EQ(info.jog_axes, "X Y Z A B C");  // OPT-4.20
  EXPECT_TRUE(info.jogs_in_manual);
  EXPECT_EQ(info.zero_program, "ZERO\n");
  EXPECT_EQ(info.home_program, 4);  // OPT-4.50
  EXPECT_THAT(info.waiting, ElementsAre("WAIT", "DELAY"));
  EXPECT_TRUE(info.steps_come_again);
  EXPECT_TRUE(info.has_dry_run);
  EXPECT_TRUE(info.has_breakpoints);
}

// What a process that is ON did not get: by which figure a run is bad or doubtful, and from when.
TEST(OptimoFamily, JudgesRunsByTheirProcess) {
  std::vector<std::string> rules;
  for (const machine::VerdictRule& rule : OptimoFamily().verdict_rules()) {
    rules.push_back(std::to_string(Lookup(rule.code).number) + " " + std::string(rule.figure) +
                    " " + std::to_string(rule.limit).substr(0, 4) +
                    (rule.verdict == machine::Verdict::kBad ? " bad" : " doubtful"));
  }
  const auto number = [](ErrorCode code) { return std::to_string(Lookup(code).number); };
  EXPECT_THAT(
      rules, ElementsAre(number(ErrorCode::kCutWithoutShutter) + " shutter_closed_length 0.01 bad",
                         number(ErrorCode::kCutWithoutBeam) + " beam_off_length 0.01 bad",
                         number(ErrorCode::kGasConflict) + " other_gas_length 0.01 bad",
                         number(ErrorCode::kCutWithoutPower) + " no_power_length 0.01 doubtful",
                         number(ErrorCode::kWorkActiveAtEnd) + " ends_with_process 0.00 doubtful"));
}

// A breakpoint counts from the first pass on, and not for ever.
TEST(OptimoFamily, BreakpointsCountPasses) {
  const auto taken = [](std::uint64_t pass) {
    return OptimoFamily().CheckBreakpoint({.at = {1, 1}, .from_pass = pass}).ok();
  };
  EXPECT_FALSE(taken(0));
  EXPECT_TRUE(taken(1));
  EXPECT_TRUE(taken(machine::kBreakpointPassMax));
  EXPECT_FALSE(taken(machine::kBreakpointPassMax + 1));
}

machine::Bytes Object(const std::string& text) {
  return machine::Bytes::Of(Compile(text, "", {}).object);
}

// OPT-1.13, OPT-1.15: each reason, by slot; one FUNCTION was altered, one deleted, one never
// stored.
TEST(OptimoFamily, SaysWhichExecutablesAreStaleAndWhy) {
  std::map<int, machine::StoredProgram> programs;
  programs[12].object = Object("VI[2]=1\n");
  programs[32].object = Object("FUNCTION 44\nFUNCTION 45\nFUNCTION 46\n");
  for (const int slot : {44, 45, 46}) programs[slot].object = Object("VI[3]=1\n");
  const auto lookup = [&](int slot) -> std::optional<std::string_view> {
    return *programs.at(slot).object;
  };
  for (const int slot : {12, 32}) {
    const Result<Executable> linked = Link(slot, lookup, {});
    ASSERT_TRUE(linked);
    programs[slot].executable = machine::Bytes::Of(EncodeExecutable(*linked));
  }
  EXPECT_TRUE(OptimoFamily().FindStaleExecutables(programs, {}).empty());
  programs[44].object = Object("VI[3]=2\n");
  programs.erase(45);
  programs.erase(46);
  programs[12].executable = machine::Bytes::Of("no executable");
  const auto stale = OptimoFamily().FindStaleExecutables(programs, {45});
  ASSERT_EQ(stale.size(), 2U);
  EXPECT_EQ(stale[0].slot, 12);
  EXPECT_EQ(stale[0].parts[0].reason, machine::StaleReason::kDamaged);
  EXPECT_EQ(stale[1].slot, 32);
  EXPECT_EQ(
      stale[1].parts,
      (std::vector<machine::StalePart>{
          {44, machine::StaleReason::kFunctionChanged, "FUNCTION 44 was altered since it was made"},
          {45, machine::StaleReason::kFunctionDeleted, "FUNCTION 45 is not stored any more"}}));
}

}  // namespace
}  // namespace rmlcell::optimo
