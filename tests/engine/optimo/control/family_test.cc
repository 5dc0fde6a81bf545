#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/linker.h"

namespace rmlcell::optimo {
namespace {

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
  }
  EXPECT_TRUE(OptimoFamily().CheckParameters(Standard()));
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
