#include "engine/rml1/profile.h"

#include <gtest/gtest.h>

#include <set>

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
  const auto refusal = [](std::initializer_list<std::pair<const char*, double>> values) {
    machine::Parameters parameters = ParametersOf("t1");
    for (const auto& [name, value] : values) EXPECT_TRUE(parameters.Set(name, value).ok());
    const Result<Profile> profile = MakeProfile(parameters);
    return profile ? std::string("none") : profile.error().detail;
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
    EXPECT_TRUE(info.rule.starts_with("RML1-")) << info.name;
    if (!info.choices.empty()) continue;
    EXPECT_LE(info.minimum, info.standard) << info.name;
    EXPECT_LE(info.standard, info.maximum) << info.name;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
