#include "engine/families/families.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "engine/machine/machine.h"
#include "engine/machine/reach_step.h"
#include "engine/simulation/run/version.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

TEST(Families, ExtensionsAreComparedWithoutCase) {
  const FakeFamily family;
  const machine::FamilyInfo& info = family.info();
  EXPECT_TRUE(families::ClaimsExtension(info, ".fk"));
  EXPECT_TRUE(families::ClaimsExtension(info, ".FAKE"));
  EXPECT_FALSE(families::ClaimsExtension(info, ".fak"));
  EXPECT_FALSE(families::ClaimsExtension(info, ""));
  EXPECT_FALSE(families::ClaimsExtension(info, "fk"));
}

// Only letters have two cases: what stands beside them in ASCII is itself.
TEST(Families, OnlyLettersHaveTwoCases) {
  const machine::FamilyInfo info{.extensions = ".AZ .B@ .C["};
  for (const char* same : {".AZ", ".az", ".Az", ".b@", ".c["}) {
    EXPECT_TRUE(families::ClaimsExtension(info, same)) << same;
  }
  for (const char* other : {".b`", ".c{", ".A", ".AZ ", ".AZ .B@"}) {
    EXPECT_FALSE(families::ClaimsExtension(info, other)) << other;
  }
}

// The extension is what follows the last point of the name itself, whichever way folders are
// written.
TEST(Families, OfFileNames) {
  const machine::MachineFamily* optimo = families::FindFamily("optimo");
  ASSERT_NE(optimo, nullptr);
  for (const char* name : {"part.S", "part.si", "a.b.S", "C:\\old.d\\part.S", "x.rml/part.cmp"}) {
    EXPECT_EQ(families::FamilyOfFileName(name), optimo) << name;
  }
  EXPECT_EQ(families::FamilyOfFileName("old.S\\part"), nullptr);
  EXPECT_EQ(families::FamilyOfFileName("part.S.bak"), nullptr);
}

TEST(Families, NamesOfNobody) {
  EXPECT_EQ(families::FindFamily("no such family"), nullptr);
  EXPECT_EQ(families::FamilyOfFileName("part.xyz"), nullptr);
  EXPECT_EQ(families::FamilyOfFileName("part"), nullptr);
  EXPECT_EQ(families::FamilyOfFileName(""), nullptr);
  EXPECT_EQ(families::FamilyOfFileName("old.rml/part"), nullptr);  // the extension of a folder
}

// A family is found by its own id and by each of its extensions, and no two share one.
TEST(Families, EachIsFoundByIdAndExtension) {
  std::set<std::string_view> ids;
  for (const machine::MachineFamily* family : families::Families()) {
    ASSERT_NE(family, nullptr);
    EXPECT_TRUE(ids.insert(family->info().id).second);
    EXPECT_EQ(families::FindFamily(family->info().id), family);
    const std::string extensions(family->info().extensions);
    const std::string first = extensions.substr(0, extensions.find(' '));
    EXPECT_EQ(families::FamilyOfFileName("folder.d/part" + first), family);
  }
}

// The version in reports is that of the project.
TEST(Version, IsThatOfTheProject) {
  std::ifstream file(RMLCELL_SOURCE_DIR "/CMakeLists.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::string wanted = "VERSION ";
  wanted += kEngineVersion;
  EXPECT_NE(text.find(wanted + ' '), std::string::npos);
}

// The tools for a text are those of the family that its name tells; a name that tells nothing is
// that of the first one with tools, and a stream has none.
TEST(Families, ToolsGoByTheName) {
  for (const char* name : {"a.S", "a.si", "a.CMP", "a.O", "part", ""}) {
    const auto family = families::FamilyWithTools(name);
    ASSERT_TRUE(family) << name;
    EXPECT_EQ((*family)->info().id, "optimo") << name;
    EXPECT_NE((*family)->tools(), nullptr);
  }
  const auto none = families::FamilyWithTools("a.rml");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_NE(none.error().detail.find("a.rml"), std::string::npos);
}

// An object says by itself whose it is; of what nobody knows the first one with tools says why.
TEST(Families, ObjectsGoByTheirBytes) {
  const machine::MachineFamily& optimo = *families::FindFamily("optimo");
  const auto made = optimo.tools()->Compile({.name = "a.S", .bytes = "STOP\n"},
                                            machine::Parameters(optimo.parameters()), {});
  ASSERT_TRUE(made.ok);
  for (const std::string& bytes : {made.object, std::string("no object"), std::string()})
    EXPECT_EQ(*families::FamilyOfObject(bytes), &optimo);
}

// OPT-3.44: an Optimo has 63 laser schedules, a mill none.
TEST(Families, SchedulesAreOfOneFamily) {
  ASSERT_NE(families::FamilyWithSchedules(), nullptr);
  EXPECT_EQ(families::FamilyWithSchedules()->info().id, "optimo");
  EXPECT_EQ(families::FamilyWithSchedules()->info().schedules, 63);
}

TEST(Families, ObjectsGoByTheName) {
  EXPECT_TRUE(families::IsObjectFileName("12.O"));
  EXPECT_TRUE(families::IsObjectFileName("12.o"));
  EXPECT_TRUE(families::IsObjectFileName("old.S/12.O"));
  for (const char* name :
       {"12.S", "12", "o", "12.rml", "12.O.S", ".O", "jobs/.O", "jobs\\.o", "old.O/12", ""})
    EXPECT_FALSE(families::IsObjectFileName(name)) << name;
}

// The keys of both controls go to 145 %; a machine that says nothing takes no more than its
// programs ask for.
TEST(Families, TheOverrideHasTheRangeOfTheFamily) {
  for (const machine::MachineFamily* family : families::Families())
    EXPECT_EQ(family->info().override_max_percent, 145.0) << family->info().id;
  EXPECT_EQ(families::OverrideMax(), 145.0);
  EXPECT_EQ(machine::FamilyInfo{}.override_max_percent, 100.0);
}

// What a family does not have is not live on its machines.
TEST(Families, OneWithoutBreakpointsKeysAndSteps) {
  const FakeFamily family;
  const Status breakpoint = family.CheckBreakpoint({.at = {1, 2}});
  ASSERT_FALSE(breakpoint);
  EXPECT_EQ(breakpoint.error().code, ErrorCode::kCellNotLive);
  EXPECT_EQ(breakpoint.error().detail, "Fake machine has no breakpoints");
  machine::RunObserver nobody;
  const Result<std::unique_ptr<machine::Machine>> made =
      machine::Machine::Make(family, machine::Parameters(FakeFamily::Table()), {}, {}, nobody);
  ASSERT_TRUE(made);
  const Status key = (*made)->Apply(machine::PressJog{});
  ASSERT_FALSE(key);
  EXPECT_EQ(key.error().code, ErrorCode::kCellNotLive);
  EXPECT_EQ(key.error().detail, "Fake machine has no keys that move its axes");
  const Result<machine::StepReach> reach =
      machine::ReachStep(family, FakeFamily::Setup(), {.at = {1, 1}}, {});
  ASSERT_FALSE(reach);
  EXPECT_EQ(reach.error().code, ErrorCode::kCellNotLive);
  EXPECT_EQ(reach.error().detail, "the machine has no start at a step");
}

// Each comparison of streams is that of a family that is there, and each family has one at most.
TEST(Families, ComparisonsOfStreamsAreWhole) {
  std::set<std::string> compared;
  for (const families::StreamComparison& each : families::StreamComparisons()) {
    ASSERT_NE(each.family, nullptr);
    EXPECT_TRUE(each.diff != nullptr) << each.family->info().id;
    EXPECT_EQ(families::FindFamily(each.family->info().id), each.family);
    EXPECT_TRUE(compared.insert(std::string(each.family->info().id)).second);
  }
  EXPECT_EQ(compared, std::set<std::string>{"rml1"});
}

}  // namespace
}  // namespace rmlcell::simulation
