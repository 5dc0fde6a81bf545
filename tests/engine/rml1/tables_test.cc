// The tables of a mill, row by row: what a figure means for a part, which parameters there are,
// which number a finding has. A changed row is another machine, so that it stands here a second
// time.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>

#include "engine/machine/parameters.h"
#include "engine/rml1/figures.h"
#include "engine/rml1/finding.h"
#include "engine/rml1/profile.h"
#include "engine/rml1/verdict_rules.h"

namespace rmlcell::rml1 {
namespace {

using machine::Verdict;

struct Rule {
  const char* code;
  const char* figure;
  double limit;
  Verdict verdict;
};
constexpr std::array kRules = {
    Rule{"RML1-E8007", "foreign_share", kForeignShareMax_percent, Verdict::kBad},
    Rule{"RML1-E8008", "positions_refused", 0.0, Verdict::kBad},
    Rule{"RML1-E8002", "oversize_x", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "oversize_y", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "oversize_z", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "clipped_cut_length", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "clipped_x_low", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "clipped_x_high", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "clipped_y_low", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "clipped_y_high", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "move_x_less", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "move_x_more", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "move_y_less", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "move_y_more", 0.01, Verdict::kBad},
    Rule{"RML1-E8002", "clipped_z_low", 0.01, Verdict::kBad},
    Rule{"RML1-E8009", "spindle_stands_length", 0.01, Verdict::kBad},
    Rule{"CELL-E9305", "least_time", 2592000.0, Verdict::kBad},
    Rule{"CELL-E9308", "waits_for_key", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8010", "no_clearance_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8020", "z0_raised", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8020", "z0_lowered", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8016", "step_fits_at", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8016", "step_lift", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8017", "fast_plunge_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8019", "fast_across_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8018", "below_clamps_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8003", "feed_limited_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8003", "rpm_limited_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8001", "incomplete_at_end", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8011", "depth_at_end", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8012", "spindle_on_at_end", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8013", "feed_not_given_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8021", "place_not_given_length", 0.01, Verdict::kDoubtful},
    Rule{"RML1-E8014", "errors", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8014", "communication_errors", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8015", "nothing_cut", 0.0, Verdict::kDoubtful},
    Rule{"RML1-E8015", "skimmed_length", 0.01, Verdict::kDoubtful},
};

TEST(MillTables, VerdictRules) {
  const auto rules = VerdictRules();
  ASSERT_EQ(rules.size(), kRules.size());
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    EXPECT_EQ(rules[i].figure, kRules[i].figure);
    EXPECT_EQ(CodeText(rules[i].code), kRules[i].code) << kRules[i].figure;
    EXPECT_EQ(rules[i].limit, kRules[i].limit) << kRules[i].figure;
    EXPECT_EQ(rules[i].verdict, kRules[i].verdict) << kRules[i].figure;
  }
}

struct Row {
  const char* name;
  const char* unit;
  double standard, low, high;
  const char* choices;
};
// Defaults: the test profile T1 of rml1.md 0.2.
constexpr std::array kParameters = {
    Row{"UNITS_PER_MM", "", 100.0, 1.0, 10000.0, ""},
    Row{"X_MIN", "mm", 0.0, -1e4, 1e4, ""},
    Row{"X_MAX", "mm", 200.0, -1e4, 1e4, ""},
    Row{"Y_MIN", "mm", 0.0, -1e4, 1e4, ""},
    Row{"Y_MAX", "mm", 150.0, -1e4, 1e4, ""},
    Row{"Z_MIN", "mm", -60.0, -1e4, 0.0, ""},
    Row{"ORIGIN_X", "mm", 0.0, -1e4, 1e4, ""},
    Row{"ORIGIN_Y", "mm", 0.0, -1e4, 1e4, ""},
    Row{"Z0", "mm", -20.0, -1e4, 0.0, ""},
    Row{"Z1", "mm", 0.0, -1e4, 0.0, ""},
    Row{"Z2", "mm", 5.0, 0.0, 1e4, ""},
    Row{"CLAMP_HEIGHT", "mm", 0.0, 0.0, 1e4, ""},
    Row{"XY_SPEED_MIN", "mm/s", 0.5, 0.01, 1e4, ""},
    Row{"XY_SPEED_MAX", "mm/s", 60.0, 0.01, 1e4, ""},
    Row{"XY_SPEED", "mm/s", 2.0, 0.01, 1e4, ""},
    Row{"Z_SPEED_MIN", "mm/s", 0.5, 0.01, 1e4, ""},
    Row{"Z_SPEED_MAX", "mm/s", 60.0, 0.01, 1e4, ""},
    Row{"Z_SPEED", "mm/s", 2.0, 0.01, 1e4, ""},
    Row{"TRAVEL_SPEED", "mm/s", 60.0, 0.01, 1e4, ""},
    Row{"ACCELERATION", "mm/s2", 200.0, 0.1, 1e6, ""},
    Row{"SPEED_JUMP", "mm/s", 3.0, 0.01, 1e4, ""},
    Row{"SPINDLE_MIN", "rpm", 4500.0, 0.0, 1e6, ""},
    Row{"SPINDLE_MAX", "rpm", 15000.0, 0.0, 1e6, ""},
    Row{"SPINDLE_STEP", "rpm", 100.0, 1.0, 1e6, ""},
    Row{"SPINDLE_CONTROL", "", 0, 0, 0, "RPM STAGES NONE"},
    Row{"SPIN_UP", "s", 0.0, 0.0, 600.0, ""},
    Row{"SPIN_DOWN", "s", 0.0, 0.0, 600.0, ""},
    Row{"AXES", "", 0, 0, 0, "XYZ XYZA XZA"},
    Row{"Y_WITH_A", "", 0, 0, 0, "YES NO"},
    Row{"A_SPEED", "deg/s", 60.0, 0.01, 1e5, ""},
    Row{"A_ACCELERATION", "deg/s2", 200.0, 0.1, 1e7, ""},
    Row{"A_SENSE", "", 0, 0, 0, "RIGHT LEFT"},
    Row{"A_STEP", "deg", 0.01, 1e-6, 10.0, ""},
    Row{"STEP", "mm", 0.01, 1e-6, 10.0, ""},
    Row{"PANEL", "", 0, 0, 0, "PLAIN FULL"},
    Row{"COVER", "", 0, 0, 0, "PAUSE EMERGENCY NONE"},
    Row{"JOG_STEP", "mm", 0.01, 1e-4, 10.0, ""},
    Row{"COMMAND", "", 0, 0, 0, "AUTO MODE1 MODE2"},
    Row{"AXIS_COMMAND", "", 0, 0, 0, "YES NO"},
    Row{"SKIP", "", 0, 0, 0, "NONE TOOL_CHANGE VPANEL PNC3000"},
    Row{"OVER_AREA", "", 0, 0, 0, "CONTINUE PAUSE"},
    Row{"DATA_BITS", "", 0, 0, 0, "8 7"},
    Row{"SEQUENCES", "", 0, 0, 0, "K ALL"},
    Row{"BUFFER", "bytes", 65536.0, 256.0, 16777216.0, ""},
};

TEST(MillTables, Parameters) {
  const auto table = ParameterTable();
  ASSERT_EQ(table.size(), kParameters.size());
  for (std::size_t i = 0; i < kParameters.size(); ++i) {
    const Row& row = kParameters[i];
    EXPECT_EQ(table[i].name, row.name);
    EXPECT_EQ(table[i].unit, row.unit) << row.name;
    EXPECT_EQ(table[i].standard, row.standard) << row.name;
    EXPECT_EQ(table[i].minimum, row.low) << row.name;
    EXPECT_EQ(table[i].maximum, row.high) << row.name;
    EXPECT_EQ(table[i].choices, row.choices) << row.name;
  }
}

// A sentence for people, and the rule that it is from.
TEST(MillTables, ParametersNameTheirRules) {
  for (const machine::ParameterInfo& info : ParameterTable()) {
    EXPECT_NE(info.text.find(' '), std::string_view::npos) << info.name;
    EXPECT_TRUE(info.rule.starts_with("RML1-") || info.rule.starts_with("DEV-")) << info.name;
  }
}

struct Number {
  FindingKind kind;
  const char* code;
};
// The numbers are those of the guideline where it has one: rml1.md 6.
constexpr std::array kFindings = {
    Number{FindingKind::kForeignCharacter, "RML1-E1"},
    Number{FindingKind::kUnknownName, "RML1-E1"},
    Number{FindingKind::kStrayNumber, "RML1-E2"},
    Number{FindingKind::kUnknownCall, "RML1-E2"},
    Number{FindingKind::kAxisTwice, "RML1-E2"},
    Number{FindingKind::kAxisValue, "RML1-E3"},
    Number{FindingKind::kAxisLetter, "RML1-E3"},
    Number{FindingKind::kAxesTogether, "RML1-E3"},
    Number{FindingKind::kLeftOver, "RML1-E2"},
    Number{FindingKind::kValueRange, "RML1-E3"},
    Number{FindingKind::kHeightRange, "RML1-E3"},
    Number{FindingKind::kSettingRange, "RML1-E3"},
    Number{FindingKind::kTravelRange, "RML1-E3"},
    Number{FindingKind::kBadSequence, "RML1-E11"},
    Number{FindingKind::kBadSequenceParameter, "RML1-E12"},
    Number{FindingKind::kSequenceParameterRange, "RML1-E13"},
    Number{FindingKind::kTooManySequenceParameters, "RML1-E14"},
    Number{FindingKind::kLineError, "RML1-E15"},
    Number{FindingKind::kBufferOverflow, "RML1-E16"},
    Number{FindingKind::kSpeedLimited, "RML1-E8003"},
    Number{FindingKind::kClipped, "RML1-E8002"},
    Number{FindingKind::kSkippedName, "RML1-E8005"},
    Number{FindingKind::kLogCut, "RML1-E8004"},
};

TEST(MillTables, NumbersOfFindings) {
  ASSERT_EQ(kFindings.size(), static_cast<std::size_t>(kFindingKindCount));
  for (const Number& row : kFindings)
    EXPECT_EQ(CodeText(RowOf(row.kind).code), row.code) << static_cast<int>(row.kind);
}

struct Said {
  const char* figure;
  const char* row;
  const char* said;
  bool when_zero;
  machine::FigureInfo::Where where;
};
// What people read of a run or a check; of nothing only what a part always has.
constexpr auto kReport = machine::FigureInfo::Where::kReport;
constexpr auto kCheck = machine::FigureInfo::Where::kCheck;
constexpr auto kBoth = machine::FigureInfo::Where::kBoth;
constexpr auto kCheckMachine = machine::FigureInfo::Where::kCheckMachine;
constexpr std::array kSaid = {
    Said{"commands", "commands", "#", true, kCheck},
    Said{"motions", "motions", "#", true, kCheck},
    Said{"cut_length", "path", "cut # mm", true, kCheck},
    Said{"travel_length", "path", "travel # mm", true, kCheck},
    Said{"plunges", "plunges", "#", true, kCheck},
    Said{"tool_up_time", "tool", "up # s", true, kReport},
    Said{"tool_down_time", "tool", "down # s", true, kReport},
    Said{"box_mm.xmin", "X", "from # mm", true, kCheck},
    Said{"box_mm.xmax", "X", "to # mm", true, kCheck},
    Said{"box_mm.ymin", "Y", "from # mm", true, kCheck},
    Said{"box_mm.ymax", "Y", "to # mm", true, kCheck},
    Said{"box_mm.zmin", "Z", "from # mm", true, kCheck},
    Said{"box_mm.zmax", "Z", "to # mm", true, kCheck},
    Said{"machine_mm.xmin", "machine X", "from # mm", true, kCheckMachine},
    Said{"machine_mm.xmax", "machine X", "to # mm", true, kCheckMachine},
    Said{"machine_mm.ymin", "machine Y", "from # mm", true, kCheckMachine},
    Said{"machine_mm.ymax", "machine Y", "to # mm", true, kCheckMachine},
    Said{"machine_mm.zmin", "machine Z", "from # mm", true, kCheckMachine},
    Said{"machine_mm.zmax", "machine Z", "to # mm", true, kCheckMachine},
    Said{"origin.xmin", "origin X", "may be from # mm", true, kBoth},
    Said{"origin.xmax", "origin X", "to # mm", true, kBoth},
    Said{"origin.ymin", "origin Y", "may be from # mm", true, kBoth},
    Said{"origin.ymax", "origin Y", "to # mm", true, kBoth},
    Said{"origin.zmin", "origin Z", "may be from # mm", true, kBoth},
    Said{"origin.zmax", "origin Z", "to # mm", true, kBoth},
    Said{"move_x_less", "origin X", "none fits; the program has to move # mm to less X", false,
         kBoth},
    Said{"move_x_more", "origin X", "none fits; the program has to move # mm to greater X", false,
         kBoth},
    Said{"move_y_less", "origin Y", "none fits; the program has to move # mm to less Y", false,
         kBoth},
    Said{"move_y_more", "origin Y", "none fits; the program has to move # mm to greater Y", false,
         kBoth},
    Said{"clipped_length", "clipped", "# mm beyond the cutting range", false, kBoth},
    Said{"assumed_absolute", "assumed", "coordinates are absolute (command #)", false, kBoth},
    Said{"assumed_heights", "assumed", "Z1 and Z2 of the machine (command #)", false, kBoth},
    Said{"assumed_rotation", "assumed", "the spindle may turn (command #)", false, kBoth},
    Said{"assumed_cleared", "assumed", "an earlier cut has cleared the way down (command #)", false,
         kBoth},
    Said{"z0_raised", "Z0", "raised by # mm by !ZO", false, kBoth},
    Said{"z0_lowered", "Z0", "lowered by # mm by !ZO", false, kBoth},
    Said{"speed_clamps", "speeds", "# limited to those of the machine", false, kBoth},
};

TEST(MillTables, FiguresThatPeopleRead) {
  std::size_t next = 0;
  for (const machine::FigureInfo& info : FigureTable()) {
    if (info.row.empty()) {
      EXPECT_TRUE(info.said.empty() && !info.when_zero && info.where == kReport) << info.name;
      continue;
    }
    ASSERT_LT(next, kSaid.size()) << info.name;
    const Said& wanted = kSaid[next++];
    EXPECT_EQ(info.name, wanted.figure);
    EXPECT_EQ(info.row, wanted.row) << info.name;
    EXPECT_EQ(info.said, wanted.said) << info.name;
    EXPECT_EQ(info.when_zero, wanted.when_zero) << info.name;
    EXPECT_EQ(info.where, wanted.where) << info.name;
  }
  EXPECT_EQ(next, kSaid.size());
}

}  // namespace
}  // namespace rmlcell::rml1
