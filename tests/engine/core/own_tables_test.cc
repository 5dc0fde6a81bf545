// Errors that families bring along in tables of their own stand beside those of the catalogue. A
// program by itself: every other one has the tables of its registry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/catalogue.h"

namespace rmlcell {
namespace {

constexpr int kLathes = OwnErrorTable("LAT");
constexpr int kSaws = OwnErrorTable("SAW");
constexpr int kDrills = OwnErrorTable("DRI");  // which brings none

constexpr std::array kLatheErrors = {CatalogueEntry{OwnError(kLathes, 0), OwnErrorFamily(kLathes),
                                                    1, "LatNoTool", Severity::kProgram,
                                                    "no tool is chosen", "choose a tool first"}};
constexpr std::array kSawErrors = {
    CatalogueEntry{OwnError(kSaws, 0), OwnErrorFamily(kSaws), 1, "SawBlunt", Severity::kWarning,
                   "the blade is blunt", "sharpen the blade"},
    CatalogueEntry{OwnError(kSaws, 1), OwnErrorFamily(kSaws), 348, "SawJammed", Severity::kAlarm,
                   "the blade is jammed", "free the blade"}};

std::vector<std::string> OwnFound(std::string_view text) {
  std::vector<std::string> codes;
  for (const CatalogueEntry* entry : FindByText(text)) codes.push_back(CodeText(entry->code));
  return codes;
}

}  // namespace

std::span<const ErrorTable> OwnErrorTables() {
  static const std::array<ErrorTable, 2> tables = {
      {{.prefix = "LAT", .rows = kLatheErrors}, {.prefix = "SAW", .rows = kSawErrors}}};
  return tables;
}

namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

TEST(OwnTables, AreLookedUpByCode) {
  EXPECT_EQ(Lookup(OwnError(kLathes, 0)).symbol, "LatNoTool");
  EXPECT_EQ(Lookup(OwnError(kSaws, 0)).symbol, "SawBlunt");
  EXPECT_EQ(Lookup(OwnError(kSaws, 1)).symbol, "SawJammed");
  EXPECT_EQ(CodeText(OwnError(kLathes, 0)), "LAT-E1");
  EXPECT_EQ(CodeText(OwnError(kSaws, 1)), "SAW-E348");
  EXPECT_EQ(ConstantName(OwnError(kSaws, 1)), "SAW_JAMMED");
  EXPECT_EQ(CodeText(ErrorCode::kHoleRadiusZero), "OPT-E348");
}

TEST(OwnTables, HaveThePrefixOfTheirFamily) {
  EXPECT_EQ(FamilyPrefix(OwnErrorFamily(kLathes)), "LAT");
  EXPECT_EQ(FamilyPrefix(OwnErrorFamily(kSaws)), "SAW");
  EXPECT_EQ(FamilyPrefix(OwnErrorFamily(kDrills)), "");
}

// A number is that of a family: the same one of others is another error.
TEST(OwnTables, AreFoundByFamilyAndNumber) {
  EXPECT_EQ(FindError(OwnErrorFamily(kLathes), 1), OwnError(kLathes, 0));
  EXPECT_EQ(FindError(OwnErrorFamily(kSaws), 1), OwnError(kSaws, 0));
  EXPECT_EQ(FindError(OwnErrorFamily(kSaws), 348), OwnError(kSaws, 1));
  EXPECT_EQ(FindError(OwnErrorFamily(kLathes), 348), std::nullopt);
  EXPECT_EQ(FindError(OwnErrorFamily(kDrills), 1), std::nullopt);
  EXPECT_EQ(FindError(ErrorFamily::kOptimo, 348), ErrorCode::kHoleRadiusZero);
}

TEST(OwnTables, AreSearchedByWhatAPersonMayWrite) {
  for (const std::string_view text :
       {"SAW-E348", "saw-348", "SawJammed", "sawjammed", "SAW_JAMMED", "saw_jammed"})
    EXPECT_THAT(OwnFound(text), ElementsAre("SAW-E348")) << text;
  EXPECT_THAT(OwnFound("348"), UnorderedElementsAre("OPT-E348", "SAW-E348"));
  EXPECT_THAT(OwnFound("LAT-E348"), testing::IsEmpty());
}

TEST(OwnTablesDeathTest, WhatIsNoRowOfThemStops) {
  EXPECT_DEATH((void)Lookup(OwnError(kLathes, 1)), "check failed");
  EXPECT_DEATH((void)Lookup(OwnError(kSaws, 2)), "check failed");
  EXPECT_DEATH((void)Lookup(OwnError(kDrills, 0)), "check failed");
}

}  // namespace
}  // namespace rmlcell
