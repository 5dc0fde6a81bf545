#include "engine/machine/family.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/families/families.h"
#include "engine/machine/handbox.h"
#include "engine/machine/machine_status.h"
#include "engine/machine/panel.h"

namespace rmlcell::machine {
namespace {

const MachineFamily& Mills() { return *families::FindFamily("rml1"); }

TransferPlan PlanOf(const ProjectBundle& project) {
  return Mills().PlanTransfer(project, *MakeParameters(Mills(), "t1", {}), {});
}
ProjectProgram Stream(int slot, const std::string& bytes) {
  return {.slot = slot, .file = {.name = std::to_string(slot) + ".rml", .bytes = bytes}};
}

// The only thing that is wrong with a project: nothing of it is stored.
Diagnostic OnlyFault(const ProjectBundle& project) {
  const TransferPlan plan = PlanOf(project);
  EXPECT_FALSE(plan.ok);
  EXPECT_TRUE(plan.programs.empty());
  std::vector<Diagnostic> errors;
  for (const Diagnostic& finding : plan.diagnostics) {
    if (IsError(finding.severity)) errors.push_back(finding);
  }
  EXPECT_EQ(errors.size(), 1U);
  return errors.empty() ? Diagnostic{} : errors.front();
}

// A mill has no variables that a person could write, and says so.
TEST(MillFamily, HasNoVariablesToWrite) {
  const machine::Parameters t1 = *MakeParameters(Mills(), "t1", {});
  const Status written = Mills().CheckWrite(t1, "VR[1]", 1.0);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(written.error().detail, "no variable is called 'VR[1]'");
}

// What a mill does not have: a handbox, whose state it then is, and whose edits it undoes.
TEST(MillFamily, HasNoHandbox) {
  const machine::Parameters t1 = *MakeParameters(Mills(), "t1", {});
  const Result<std::unique_ptr<Handbox>> none = Mills().NewHandbox(t1, "");
  ASSERT_TRUE(none);
  EXPECT_EQ(*none, nullptr);
  const Result<std::unique_ptr<Handbox>> some = Mills().NewHandbox(t1, "1");
  ASSERT_FALSE(some);
  EXPECT_EQ(some.error().code, ErrorCode::kCellBadText);
  EXPECT_EQ(some.error().detail, "a machine without handbox has a state of one");
  const Result<std::string> undone = Mills().UndoEdit({}, "PU;");
  ASSERT_FALSE(undone);
  EXPECT_EQ(undone.error().code, ErrorCode::kCellNotLive);
  EXPECT_EQ(undone.error().detail, std::string(Mills().info().title) + " has no handbox");
}

// What a family without a panel of its own shows of its machine: that it has power.
TEST(LaserFamily, ShowsItsPower) {
  const MachineFamily& lasers = *families::FindFamily("optimo");
  MachineStatus status;
  status.state = MachineState::kIdle;
  EXPECT_EQ(lasers.ShowPanel(status).lamps, std::vector<std::string_view>{"POWER"});
  status.state = MachineState::kOff;
  EXPECT_TRUE(lasers.ShowPanel(status).lamps.empty());
}

// A breakpoint stands behind a command of a slot, and a stream comes there once.
TEST(MillFamily, BreakpointsStandBehindCommands) {
  const auto said = [](const Breakpoint& breakpoint) {
    const Status good = Mills().CheckBreakpoint(breakpoint);
    if (good) return std::string("good");
    EXPECT_EQ(good.error().code, ErrorCode::kCellInvalidArgument);
    return std::string(good.error().detail);
  };
  for (const ProgramStep at : {ProgramStep{1, 1}, ProgramStep{99, 2'000'000'000}})
    EXPECT_EQ(said({.at = at}), "good");
  for (const ProgramStep at : {ProgramStep{0, 1}, ProgramStep{100, 1}, ProgramStep{1, 0}}) {
    EXPECT_EQ(said({.at = at}), "the breakpoint behind step " + std::to_string(at.step) +
                                    " stands in no program: give a slot of 1 to 99 and a step "
                                    "from 1 on");
  }
  const std::string of_7 = "the breakpoint behind step 7 ";
  for (const std::uint64_t pass : {std::uint64_t{0}, std::uint64_t{1'000'000'000'001}}) {
    EXPECT_EQ(said({.at = {1, 7}, .from_pass = pass}),
              of_7 + "counts passes from 1 to a million millions");
  }
  for (const std::uint64_t pass : {std::uint64_t{2}, std::uint64_t{1'000'000'000'000}}) {
    EXPECT_EQ(said({.at = {1, 7}, .from_pass = pass}),
              of_7 + "waits for a later pass, but a stream comes to each command once");
  }
  EXPECT_EQ(said({.at = {1, 7}, .condition = "X"}),
            of_7 + "has a condition, but the programs of this machine have no expressions");
}

// Of each program its stream, from the first slot to the last.
TEST(PlanTransfer, StoresStreamsAsTheyAre) {
  const TransferPlan plan = PlanOf({.programs = {Stream(1, "PU;"), Stream(99, "PU1,1;")}});
  EXPECT_TRUE(plan.ok);
  ASSERT_EQ(plan.programs.size(), 2U);
  EXPECT_EQ(plan.programs[0].slot, 1);
  EXPECT_EQ(plan.programs[0].source, "PU;");
  EXPECT_EQ(plan.programs[1].slot, 99);
  EXPECT_EQ(plan.programs[1].object, "PU1,1;");
  EXPECT_TRUE(PlanOf({}).ok);
}

// What a mill has no place for is refused with its file and slot.
TEST(PlanTransfer, RefusesWhatAMillHasNoPlaceFor) {
  for (const int slot : {0, 100}) {
    const Diagnostic fault = OnlyFault({.programs = {Stream(slot, "PU;")}});
    EXPECT_EQ(fault.code, ErrorCode::kCellInvalidArgument);
    EXPECT_EQ(fault.detail, "slot " + std::to_string(slot) + " is not one of 1 to 99");
    EXPECT_EQ(fault.file, std::to_string(slot) + ".rml");
    EXPECT_EQ(fault.program, slot);
  }
  const Diagnostic twice = OnlyFault({.programs = {Stream(5, "PU;"), Stream(5, "PU1,1;")}});
  EXPECT_EQ(twice.code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(twice.detail, "slot 5 has two programs");
  ProjectProgram inch = Stream(7, "PU;");
  inch.inch = true;
  EXPECT_EQ(OnlyFault({.programs = {inch}}).detail,
            "a stream is in units of its machine, not in inches");
  const std::string title(Mills().info().title);
  EXPECT_EQ(OnlyFault({.schedules = {LaserSchedule{}}}).detail, title + " has no laser schedules");
  EXPECT_EQ(OnlyFault({.processes = {ProcessDefinition{}}}).detail,
            title + " has no process definitions");
}

// What is found in a program has its slot, and one that cannot be read holds back all of them.
TEST(PlanTransfer, EveryProgramOrNone) {
  const TransferPlan plan =
      PlanOf({.programs = {Stream(3, "PU;"), Stream(4, std::string(300, '$'))}});
  EXPECT_FALSE(plan.ok);
  EXPECT_TRUE(plan.programs.empty());
  ASSERT_FALSE(plan.diagnostics.empty());
  for (const Diagnostic& finding : plan.diagnostics) EXPECT_EQ(finding.program, 4);
}

// A thousand findings of all programs together are told, and the places of the others are known.
TEST(PlanTransfer, TellsAThousandFindings) {
  std::string bad;
  for (int n = 0; n < 600; ++n) bad += "PU100,100;PU200,200;PU300,300;PU400,400;QQ;";
  const std::size_t each = PlanOf({.programs = {Stream(3, bad)}}).diagnostics.size();
  ASSERT_GT(each, kDiagnosticsMax / 2);
  ASSERT_LT(each, kDiagnosticsMax);
  const TransferPlan plan = PlanOf({.programs = {Stream(3, bad), Stream(4, bad), Stream(5, bad)}});
  ASSERT_EQ(plan.diagnostics.size(), kDiagnosticsMax);
  EXPECT_EQ(plan.diagnostics.front().program, 3);
  EXPECT_EQ(plan.diagnostics.back().program, 4);
  EXPECT_EQ(plan.diagnostics_dropped.count(), 3 * each - kDiagnosticsMax);
  for (const auto& [code, kind] : plan.diagnostics_dropped.kinds()) {
    EXPECT_EQ(kind.first.program, 4);
    EXPECT_EQ(kind.last.program, 5);
  }
  // The one that is no stream holds back all of them, which is told whatever was told before it.
  const TransferPlan held =
      PlanOf({.programs = {Stream(3, bad), Stream(4, bad), Stream(5, std::string(300, '$'))}});
  EXPECT_FALSE(held.ok);
  ASSERT_EQ(held.diagnostics.size(), kDiagnosticsMax);
  EXPECT_EQ(held.diagnostics.back().code, ErrorCode::kRml1NoProgram);
  EXPECT_EQ(held.diagnostics.back().program, 5);
}

TEST(MakeParameters, RefusesProfilesAndValuesThatThereAreNot) {
  const auto code = [](const std::string& profile,
                       const std::map<std::string, std::string>& changed) {
    const Result<Parameters> made = MakeParameters(Mills(), profile, changed);
    return made ? ErrorCode::kCellUsage : made.error().code;
  };
  EXPECT_EQ(code("t1", {}), ErrorCode::kCellUsage);
  EXPECT_EQ(code("lathe", {}), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(code("t1", {{"X_SIZE", "1"}}), ErrorCode::kCellUnknownParameter);
  EXPECT_EQ(code("t1", {{"X_MIN", "9"}, {"X_MAX", "8"}}), ErrorCode::kCellParameterRange);
  EXPECT_EQ(code("t1", {{"X_MIN", "8"}, {"X_MAX", "9"}, {"ORIGIN_X", "8"}}), ErrorCode::kCellUsage);
}

// Before a stream runs it is there, and can be read: else the first of its errors is told.
TEST(MillFamily, NeedsAStreamThatCanBeRead) {
  const machine::Parameters t1 = *MakeParameters(Mills(), "t1", {});
  std::map<int, StoredProgram> memory;
  const Status none = Mills().CheckNeeds(memory, {}, t1, 3);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Mills().info().empty_slot);
  EXPECT_EQ(none.error().detail, "program 3");
  memory[3].name = "3.rml";
  EXPECT_EQ(Mills().CheckNeeds(memory, {}, t1, 3).error().code, Mills().info().empty_slot);
  memory[3].object = Bytes::Of("PU;PA0,0;");
  EXPECT_TRUE(Mills().CheckNeeds(memory, {}, t1, 3));
  EXPECT_FALSE(Mills().CheckNeeds(memory, {}, t1, 4));
  const std::string text(300, '$');
  memory[3].object = Bytes::Of(text);
  const Status bad = Mills().CheckNeeds(memory, {}, t1, 3);
  ASSERT_FALSE(bad);
  const Translation read =
      Mills().Translate({.name = "3.rml", .bytes = text}, t1, {.advice = false});
  ASSERT_FALSE(read.ok);
  for (const Diagnostic& finding : read.diagnostics) {
    if (!IsError(finding.severity)) continue;
    EXPECT_EQ(bad.error().code, finding.code);
    EXPECT_EQ(bad.error().detail, finding.detail);
    break;
  }
}

}  // namespace
}  // namespace rmlcell::machine
