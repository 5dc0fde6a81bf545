#include "engine/rml1/profile.h"

#include <gtest/gtest.h>

#include <iterator>
#include <set>
#include <utility>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

Profile ProfileOf(std::string_view id) { return MakeProfile(ParametersOf(id)).value(); }

// The table of rml1.md 0.2; RML1-9.08, RML1-9.10.
TEST(Profile, DefaultsAreTheTestProfile) {
  const Profile t1 = MakeProfile(machine::Parameters(ParameterTable())).value();
  EXPECT_EQ(t1.units_per_mm, 100.0);
  EXPECT_EQ(t1.x.high, 20000.0);
  EXPECT_EQ(t1.y.high, 15000.0);
  EXPECT_EQ(t1.z.low, -6000.0);
  EXPECT_EQ(t1.z.high, 0.0);
  EXPECT_EQ(t1.z0, -2000.0);
  EXPECT_EQ(t1.z1, 0.0);
  EXPECT_EQ(t1.z2, 500.0);
  EXPECT_EQ(t1.xy_speed, 2.0);
  EXPECT_EQ(t1.z_speed, 2.0);
  EXPECT_EQ(t1.travel_speed, 60.0);
  EXPECT_EQ(t1.xy_speeds.minimum_mm_s, 0.5);
  EXPECT_EQ(t1.z_speeds.maximum_mm_s, 60.0);
  EXPECT_EQ(t1.spindle_min_rpm, 4500);
  EXPECT_EQ(t1.spindle_max_rpm, 15000);
  EXPECT_EQ(t1.spin_up_s, 0.0);
  EXPECT_FALSE(t1.has_rotary);
  EXPECT_EQ(t1.commands.setting, CommandSetting::kAuto);
}

// The machines of rml1-profiles.md, figure by figure.
TEST(Profile, HasTheMachinesOfTheTable) {
  const Profile srm = ProfileOf("srm-20");
  EXPECT_EQ(srm.x.high, 20320.0);
  EXPECT_EQ(srm.y.high, 15240.0);
  EXPECT_EQ(srm.z.low, -6050.0);
  EXPECT_EQ(srm.xy_speeds.maximum_mm_s, 30.0);
  EXPECT_EQ(srm.xy_speeds.minimum_mm_s, 0.1);
  EXPECT_EQ(srm.spindle_max_rpm, 7000);
  for (const char* id : {"mdx-15", "mdx-20"}) {
    const Profile modela = ProfileOf(id);
    EXPECT_EQ(modela.units_per_mm, 40.0);
    EXPECT_EQ(modela.z.low, -2420.0);
    EXPECT_EQ(modela.xy_speeds.maximum_mm_s, 15.0);
    EXPECT_EQ(modela.spindle_control, SpindleControl::kNone);
    EXPECT_EQ(modela.spindle_min_rpm, 6500);
  }
  EXPECT_EQ(ProfileOf("mdx-15").x.high, 6096.0);
  EXPECT_EQ(ProfileOf("mdx-20").x.high, 8128.0);
  EXPECT_EQ(ProfileOf("mdx-40a").z.low, -10500.0);
  EXPECT_EQ(ProfileOf("mdx-40a").z_speeds.maximum_mm_s, 30.0);
  EXPECT_FALSE(ProfileOf("mdx-40a").has_rotary);
  const Profile rotary = ProfileOf("mdx-40a-rotary");
  EXPECT_TRUE(rotary.has_rotary);
  EXPECT_EQ(rotary.x.low, 3400.0);
  EXPECT_EQ(rotary.z.low, -6800.0);
  EXPECT_EQ(ProfileOf("mdx-50").z.low, -13500.0);
  EXPECT_EQ(ProfileOf("mdx-540").z.low, -15500.0);
  EXPECT_EQ(ProfileOf("mdx-540").xy_speeds.maximum_mm_s, 125.0);
  const Profile pnc = ProfileOf("pnc-3200");
  EXPECT_EQ(pnc.z_speeds.maximum_mm_s, 30.0);
  EXPECT_EQ(pnc.spindle_control, SpindleControl::kStages);
  EXPECT_FALSE(pnc.commands.axis_command);
}

// The same table whole, in the units of the manuals; where it names no figure the one of T1 stands
// (RML1-9.08), and the travel speed is the highest one (RML1-9.44).
struct MachineRow {
  std::string_view id;
  double units_per_mm, x_min, x_max, y_max, z_min, z2;  // mm
  double xy_slowest, xy_fastest, z_slowest, z_fastest, travel;
  int rpm_min, rpm_max;
  double spin_s, step_mm;
};
constexpr MachineRow kMachineRows[] = {
    {"t1", 100, 0, 200, 150, -60, 5, 0.5, 60, 0.5, 60, 60, 4500, 15000, 0, 0.01},
    {"t1a", 100, 0, 200, 150, -60, 5, 0.5, 60, 0.5, 60, 60, 4500, 15000, 0, 0.01},
    {"t1n", 100, 0, 200, 150, -60, 5, 0.5, 60, 0.5, 60, 60, 4500, 15000, 0, 0.01},
    {"t1s", 100, 0, 200, 150, -60, 5, 0.5, 60, 0.5, 60, 60, 4500, 15000, 0, 0.01},
    {"t1f", 100, 0, 200, 150, -60, 5, 0.5, 60, 0.5, 60, 60, 4500, 15000, 0, 0.01},
    {"srm-20", 100, 0, 203.2, 152.4, -60.5, 0, 0.1, 30, 0.1, 30, 30, 3000, 7000, 2, 0.000998},
    {"mdx-15", 40, 0, 152.4, 101.6, -60.5, 0, 0.1, 15, 0.1, 15, 15, 6500, 6500, 2, 0.025},
    {"mdx-20", 40, 0, 203.2, 152.4, -60.5, 0, 0.1, 15, 0.1, 15, 15, 6500, 6500, 2, 0.025},
    {"mdx-40a", 100, 0, 305, 305, -105, 0, 0.1, 50, 0.1, 30, 50, 4500, 15000, 2, 0.002},
    {"mdx-40a-rotary", 100, 34, 305, 305, -68, 0, 0.1, 50, 0.1, 30, 50, 4500, 15000, 2, 0.002},
    {"mdx-50", 100, 0, 400, 305, -135, 0, 0.1, 60, 0.1, 60, 60, 4500, 15000, 2, 0.01},
    {"mdx-540", 100, 0, 500, 400, -155, 0, 0.5, 125, 0.5, 125, 125, 3000, 12000, 2, 0.01},
    {"pnc-3200", 100, 0, 250, 150, -150, 0, 0.5, 60, 0.5, 30, 60, 3000, 8000, 2, 0.01},
};

// rml1.md 0.2 and rml1-profiles.md; RML1-1.08, RML1-9.10, RML1-9.12.
TEST(Profile, HasEveryFigureOfTheTable) {
  ASSERT_EQ(std::size(kMachineRows), MachineProfiles().size());
  for (const MachineRow& row : kMachineRows) {
    SCOPED_TRACE(row.id);
    const Profile p = ProfileOf(row.id);
    const double u = row.units_per_mm;
    EXPECT_EQ(p.units_per_mm, u);
    EXPECT_NEAR(p.x.low, row.x_min * u, 1e-9);
    EXPECT_NEAR(p.x.high, row.x_max * u, 1e-9);
    EXPECT_EQ(p.y.low, 0.0);
    EXPECT_NEAR(p.y.high, row.y_max * u, 1e-9);
    EXPECT_NEAR(p.z.low, row.z_min * u, 1e-9);
    EXPECT_EQ(p.z.high, 0.0);
    EXPECT_EQ(p.origin_x, row.x_min * u);  // the corner of the travel
    EXPECT_EQ(p.origin_y, 0.0);
    EXPECT_EQ(p.z0, -20.0 * u);
    EXPECT_EQ(p.z1, 0.0);
    EXPECT_EQ(p.z2, row.z2 * u);
    EXPECT_EQ(p.xy_speeds.minimum_mm_s, row.xy_slowest);
    EXPECT_EQ(p.xy_speeds.maximum_mm_s, row.xy_fastest);
    EXPECT_EQ(p.z_speeds.minimum_mm_s, row.z_slowest);
    EXPECT_EQ(p.z_speeds.maximum_mm_s, row.z_fastest);
    EXPECT_EQ(p.xy_speed, 2.0);
    EXPECT_EQ(p.z_speed, 2.0);
    EXPECT_EQ(p.travel_speed, row.travel);
    EXPECT_EQ(p.acceleration_mm_s2, 200.0);  // motion.md section 7
    EXPECT_EQ(p.speed_jump_mm_s, 3.0);
    EXPECT_EQ(p.spindle_min_rpm, row.rpm_min);
    EXPECT_EQ(p.spindle_max_rpm, row.rpm_max);
    EXPECT_EQ(p.spindle_step_rpm, 100);
    EXPECT_EQ(p.spin_up_s, row.spin_s);
    EXPECT_EQ(p.spin_down_s, row.spin_s);
    EXPECT_EQ(p.step_mm, row.step_mm);
    EXPECT_EQ(p.rotary_speed_deg_s, 60.0);  // RML1-9.59
    EXPECT_EQ(p.rotary_acceleration_deg_s2, 200.0);
    EXPECT_EQ(p.rotary_step_deg, 0.01);
    EXPECT_EQ(p.buffer_bytes, 65536U);
  }
}

// rml1.md 0.2 and rml1-profiles.md: what a machine has besides; RML1-9.01, RML1-9.29, RML1-9.37.
TEST(Profile, HasTheEquipmentOfTheTable) {
  std::set<std::string_view> rotary;
  std::set<std::string_view> stages;
  std::set<std::string_view> no_spindle_command;
  for (const machine::MachineProfile& entry : MachineProfiles()) {
    const Profile p = ProfileOf(entry.id);
    if (p.has_rotary) rotary.insert(entry.id);
    if (p.spindle_control == SpindleControl::kStages) stages.insert(entry.id);
    if (p.spindle_control == SpindleControl::kNone) no_spindle_command.insert(entry.id);
    EXPECT_EQ(p.has_y, entry.id != "t1n") << entry.id;
    EXPECT_EQ(p.y_with_rotary, entry.id != "t1a") << entry.id;
    EXPECT_EQ(p.commands.axis_command, entry.id != "pnc-3200") << entry.id;
    const int skipped = entry.id == "mdx-50"    ? kSkipToolChange
                        : entry.id == "mdx-540" ? kSkipToolChange | kSkipVPanel
                                                : kSkipNothing;
    EXPECT_EQ(p.commands.skipped, skipped) << entry.id;
    EXPECT_EQ(p.commands.setting, CommandSetting::kAuto) << entry.id;
    EXPECT_FALSE(p.pause_outside || p.seven_bits || p.all_sequences || p.rotary_reversed);
    EXPECT_FALSE(entry.title.empty());
  }
  EXPECT_EQ(rotary, (std::set<std::string_view>{"t1a", "t1n", "mdx-40a-rotary"}));
  EXPECT_EQ(stages, (std::set<std::string_view>{"t1s", "pnc-3200"}));
  EXPECT_EQ(no_spindle_command, (std::set<std::string_view>{"t1f", "mdx-15", "mdx-20"}));
}

// RML1-9.01, RML1-9.48, RML1-1.12, RML1-9.37, RML1-3D.29: every word has its meaning.
TEST(Profile, UnderstandsItsWords) {
  const auto with = [](std::string_view name, std::string_view word) {
    machine::Parameters parameters = ParametersOf("t1");
    EXPECT_TRUE(parameters.Set(name, word).ok()) << name;
    return MakeProfile(parameters).value();
  };
  EXPECT_EQ(with("COMMAND", "MODE1").commands.setting, CommandSetting::kMode1);
  EXPECT_EQ(with("COMMAND", "MODE2").commands.setting, CommandSetting::kMode2);
  EXPECT_EQ(with("SKIP", "TOOL_CHANGE").commands.skipped, kSkipToolChange);
  EXPECT_EQ(with("SKIP", "VPANEL").commands.skipped, kSkipToolChange | kSkipVPanel);
  EXPECT_EQ(with("SKIP", "PNC3000").commands.skipped, kSkipPnc3000);
  EXPECT_EQ(with("SPINDLE_CONTROL", "RPM").spindle_control, SpindleControl::kRpm);
  EXPECT_TRUE(with("OVER_AREA", "PAUSE").pause_outside);
  EXPECT_TRUE(with("DATA_BITS", "7").seven_bits);
  EXPECT_TRUE(with("SEQUENCES", "ALL").all_sequences);
  EXPECT_TRUE(with("A_SENSE", "LEFT").rotary_reversed);
  EXPECT_FALSE(with("Y_WITH_A", "NO").y_with_rotary);
}

// Numbers of a parameter go where they belong, in device units: RML1-1.08.
TEST(Profile, ReadsEveryNumber) {
  machine::Parameters parameters = ParametersOf("t1");
  double value = 11.0;  // 11, 12, 13: none like another
  for (const char* name :
       {"X_MAX", "Y_MAX", "ORIGIN_X", "ORIGIN_Y", "Z2", "CLAMP_HEIGHT", "XY_SPEED_MAX",
        "Z_SPEED_MAX", "TRAVEL_SPEED", "ACCELERATION", "SPEED_JUMP", "SPINDLE_MIN", "SPINDLE_MAX",
        "SPINDLE_STEP", "SPIN_UP", "SPIN_DOWN", "A_SPEED", "A_ACCELERATION"}) {
    ASSERT_TRUE(parameters.Set(name, value++).ok()) << name;
  }
  for (const auto& [name, number] : {std::pair("X_MIN", -1.0),
                                     {"Y_MIN", -2.0},
                                     {"Z_MIN", -30.0},
                                     {"Z0", -4.0},
                                     {"Z1", -5.0},
                                     {"XY_SPEED_MIN", 1.25},
                                     {"Z_SPEED_MIN", 1.5},
                                     {"XY_SPEED", 3.0},
                                     {"Z_SPEED", 4.0},
                                     {"STEP", 0.5},
                                     {"A_STEP", 0.25},
                                     {"BUFFER", 300.0},
                                     {"UNITS_PER_MM", 40.0}}) {
    ASSERT_TRUE(parameters.Set(name, number).ok()) << name;
  }
  const Profile p = MakeProfile(parameters).value();
  const double read[] = {p.x.high / 40,
                         p.y.high / 40,
                         p.origin_x / 40,
                         p.origin_y / 40,
                         p.z2 / 40,
                         p.clamps_height / 40,
                         p.xy_speeds.maximum_mm_s,
                         p.z_speeds.maximum_mm_s,
                         p.travel_speed,
                         p.acceleration_mm_s2,
                         p.speed_jump_mm_s,
                         static_cast<double>(p.spindle_min_rpm),
                         static_cast<double>(p.spindle_max_rpm),
                         static_cast<double>(p.spindle_step_rpm),
                         p.spin_up_s,
                         p.spin_down_s,
                         p.rotary_speed_deg_s,
                         p.rotary_acceleration_deg_s2};
  for (std::size_t i = 0; i < std::size(read); ++i)
    EXPECT_EQ(read[i], 11.0 + static_cast<double>(i)) << i;
  EXPECT_EQ(p.x.low, -40.0);
  EXPECT_EQ(p.y.low, -80.0);
  EXPECT_EQ(p.z.low, -1200.0);
  EXPECT_EQ(p.z0, -160.0);
  EXPECT_EQ(p.z1, -200.0);
  EXPECT_EQ(p.xy_speeds.minimum_mm_s, 1.25);
  EXPECT_EQ(p.z_speeds.minimum_mm_s, 1.5);
  EXPECT_EQ(p.xy_speed, 3.0);
  EXPECT_EQ(p.z_speed, 4.0);
  EXPECT_EQ(p.step_mm, 0.5);
  EXPECT_EQ(p.rotary_step_deg, 0.25);
  EXPECT_EQ(p.buffer_bytes, 300U);
}

// RML1-9.11: a Z0 below the bottom is limited to the travel; a default speed is one of the steps.
TEST(Profile, LimitsDefaultsToTheMachine) {
  machine::Parameters parameters = ParametersOf("t1");
  ASSERT_TRUE(parameters.Set("Z0", -60.01).ok());
  ASSERT_TRUE(parameters.Set("XY_SPEED", 7.9).ok());
  ASSERT_TRUE(parameters.Set("Z_SPEED", 200.0).ok());
  const Profile p = MakeProfile(parameters).value();
  EXPECT_EQ(p.z0, -6000.0);
  EXPECT_EQ(p.xy_speed, 7.0);
  EXPECT_EQ(p.z_speed, 60.0);
}

// The ends of every range are taken, and what lies beyond them is not. Why there: a travel of ten
// metres is no mill, and a divisor of 0 would be no machine.
TEST(Profile, ParametersHaveTheirRanges) {
  struct Range {
    std::string_view name;
    double low;
    double high;
  };
  constexpr Range kRanges[] = {{"UNITS_PER_MM", 1, 1e4},
                               {"X_MIN", -1e4, 1e4},
                               {"X_MAX", -1e4, 1e4},
                               {"Y_MIN", -1e4, 1e4},
                               {"Y_MAX", -1e4, 1e4},
                               {"Z_MIN", -1e4, 0},
                               {"ORIGIN_X", -1e4, 1e4},
                               {"ORIGIN_Y", -1e4, 1e4},
                               {"Z0", -1e4, 0},
                               {"Z1", -1e4, 0},
                               {"Z2", 0, 1e4},
                               {"CLAMP_HEIGHT", 0, 1e4},
                               {"XY_SPEED_MIN", 0.01, 1e4},
                               {"XY_SPEED_MAX", 0.01, 1e4},
                               {"XY_SPEED", 0.01, 1e4},
                               {"Z_SPEED_MIN", 0.01, 1e4},
                               {"Z_SPEED_MAX", 0.01, 1e4},
                               {"Z_SPEED", 0.01, 1e4},
                               {"TRAVEL_SPEED", 0.01, 1e4},
                               {"ACCELERATION", 0.1, 1e6},
                               {"SPEED_JUMP", 0.01, 1e4},
                               {"SPINDLE_MIN", 0, 1e6},
                               {"SPINDLE_MAX", 0, 1e6},
                               {"SPINDLE_STEP", 1, 1e6},
                               {"SPIN_UP", 0, 600},
                               {"SPIN_DOWN", 0, 600},
                               {"A_SPEED", 0.01, 1e5},
                               {"A_ACCELERATION", 0.1, 1e7},
                               {"A_STEP", 1e-6, 10},
                               {"STEP", 1e-6, 10},
                               {"JOG_STEP", 1e-4, 10},
                               {"BUFFER", 256, 16777216}};
  std::size_t numbers = 0;
  for (const machine::ParameterInfo& info : ParameterTable()) numbers += info.choices.empty();
  EXPECT_EQ(std::size(kRanges), numbers);
  machine::Parameters parameters = ParametersOf("t1");
  for (const Range& range : kRanges) {
    const double span = range.high - range.low;
    EXPECT_TRUE(parameters.Set(range.name, range.low).ok()) << range.name;
    EXPECT_TRUE(parameters.Set(range.name, range.high).ok()) << range.name;
    EXPECT_FALSE(parameters.Set(range.name, range.low - span * 1e-9).ok()) << range.name;
    EXPECT_FALSE(parameters.Set(range.name, range.high + span * 1e-9).ok()) << range.name;
  }
}

// Every profile can be applied and used; real machines begin with Z1 = Z2 = 0 and 2 mm/s.
TEST(Profile, AllOfThemFit) {
  std::set<std::string_view> ids;
  for (const machine::MachineProfile& entry : MachineProfiles()) {
    EXPECT_TRUE(ids.insert(entry.id).second) << entry.id;
    const Profile profile = ProfileOf(entry.id);
    EXPECT_EQ(profile.xy_speed, 2.0) << entry.id;
    if (entry.id.starts_with("t1")) continue;
    EXPECT_EQ(profile.z1, 0.0) << entry.id;
    EXPECT_EQ(profile.z2, 0.0) << entry.id;
    EXPECT_GE(profile.z0, profile.z.low) << entry.id;
  }
  EXPECT_EQ(ids.size(), 13U);
}

// Parameters that do not fit together are refused by name.
TEST(Profile, RefusesMisfits) {
  const auto refusal =
      [](std::initializer_list<std::pair<const char*, double>> values) -> std::string {
    machine::Parameters parameters = ParametersOf("t1");
    for (const auto& [name, value] : values) EXPECT_TRUE(parameters.Set(name, value).ok());
    const Result<Profile> profile = MakeProfile(parameters);
    if (profile) return std::string("none");
    EXPECT_EQ(profile.error().code, ErrorCode::kCellParameterRange);
    return profile.error().detail;
  };
  EXPECT_EQ(refusal({{"X_MAX", 0.0}}), "X_MIN is 0, not below X_MAX, which is 0");
  EXPECT_EQ(refusal({{"Y_MIN", 150.0}}), "Y_MIN is 150, not below Y_MAX, which is 150");
  EXPECT_EQ(refusal({{"Z_MIN", 0.0}}), "Z_MIN is not below 0, the top");
  EXPECT_EQ(refusal({{"XY_SPEED_MIN", 61.0}}),
            "XY_SPEED_MIN is 61, above XY_SPEED_MAX, which is 60");
  EXPECT_EQ(refusal({{"SPINDLE_MIN", 15001.0}}),
            "SPINDLE_MIN is 15001, above SPINDLE_MAX, which is 15000");
  EXPECT_EQ(refusal({{"SPINDLE_MIN", 15000.0}}), "none");
}

// The parameter table itself: defaults inside their ranges, a text and a rule for each.
TEST(Profile, ParameterTableIsSound) {
  std::set<std::string_view> names;
  for (const machine::ParameterInfo& info : ParameterTable()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.text.empty()) << info.name;
    EXPECT_TRUE(info.rule.starts_with("RML1-") || info.rule.starts_with("DEV-")) << info.name;
    if (!info.choices.empty()) {  // a word has no range
      EXPECT_EQ(info.standard, 0.0) << info.name;
      EXPECT_EQ(info.minimum, 0.0) << info.name;
      EXPECT_EQ(info.maximum, 0.0) << info.name;
      continue;
    }
    EXPECT_LE(info.minimum, info.standard) << info.name;
    EXPECT_LE(info.standard, info.maximum) << info.name;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
