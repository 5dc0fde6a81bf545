#include "engine/machine/family.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "engine/families/families.h"

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

}  // namespace
}  // namespace rmlcell::machine
