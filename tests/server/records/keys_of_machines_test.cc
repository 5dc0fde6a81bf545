// How fast and how far the keys of a machine move it, and which keys it has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "server/records/machine_capabilities.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

v1::MachineCapabilities::JogAxis AxisOf(const v1::MachineCapabilities& machine,
                                        const std::string& name) {
  for (const v1::MachineCapabilities::JogAxis& one : machine.jog_axes())
    if (one.axis() == name) return one;
  ADD_FAILURE() << "no axis " << name;
  return {};
}
v1::MachineCapabilities MillWith(const std::map<std::string, std::string>& parameters) {
  return CapabilitiesOf(
      {.id = "m", .family = "rml1", .profile = "srm-20", .parameters = parameters});
}

// OPT-4.35: 40 % of the speed of the machine at the highest step of the override.
TEST(KeysOfMachines, AnOptimoMovesWithFortyPercent) {
  const v1::MachineCapabilities optimo = CapabilitiesOf(
      {.id = "o",
       .family = "optimo",
       .parameters = {{"VMAX", "300"}, {"AXIS_SPEED_A", "2"}, {"AXIS_SPEED_B", "1"}}});
  for (const char* axis : {"X", "Y", "Z"})
    EXPECT_DOUBLE_EQ(AxisOf(optimo, axis).speed_max(), 120.0) << axis;
  EXPECT_DOUBLE_EQ(AxisOf(optimo, "A").speed_max(), 0.8);
  EXPECT_DOUBLE_EQ(AxisOf(optimo, "B").speed_max(), 0.4);
}

// LIVE-8.03: a tap is a step of the profile; the rotary axis turns as fast as it can.
TEST(KeysOfMachines, AMillMovesAsFastAsItsProfile) {
  const v1::MachineCapabilities mill =
      MillWith({{"AXES", "XYZA"}, {"A_SPEED", "18"}, {"JOG_STEP", "0.05"}, {"TRAVEL_SPEED", "12"}});
  EXPECT_NEAR(AxisOf(mill, "A").speed_max(), 0.1 * 3.14159265358979, 1e-12);
  EXPECT_EQ(AxisOf(mill, "A").unit(), v1::UNIT_RADIAN);
  for (const char* axis : {"X", "Y", "Z"})
    EXPECT_DOUBLE_EQ(AxisOf(mill, axis).step(), 0.05) << axis;
  EXPECT_EQ(MillWith({{"AXES", "XZA"}}).jog_axes_size(), 3);
}

// Each axis has two keys, behind those of the panel; what the panel has not is not there.
TEST(KeysOfMachines, APanelHasItsKeys) {
  EXPECT_THAT(MillWith({{"AXES", "XZA"}}).panel_keys(),
              ElementsAre("PAUSE", "CONTINUE", "STOP", "BUFFER_CLEAR", "COVER", "POWER",
                          "EMERGENCY_STOP", "X+", "X-", "Z+", "Z-", "A+", "A-"));
  EXPECT_THAT(
      MillWith({{"AXES", "XZA"}, {"PANEL", "FULL"}}).panel_keys(),
      ElementsAre("PAUSE", "CONTINUE", "STOP", "BUFFER_CLEAR", "COVER", "POWER", "EMERGENCY_STOP",
                  "VIEW", "SPINDLE", "Z0", "ORIGIN", "HOME", "X+", "X-", "Z+", "Z-", "A+", "A-"));
}

// LIVE-2.12, LIVE-8.04: what halts it and where; of a machine that nobody knows nothing is said.
TEST(KeysOfMachines, HaltsAreTold) {
  EXPECT_EQ(MillWith({}).stop(), v1::MachineCapabilities::HALT_ON_PATH);
  EXPECT_EQ(MillWith({}).hold(), v1::MachineCapabilities::HALT_AFTER_INSTRUCTION);
  EXPECT_EQ(CapabilitiesOf({.id = "o", .family = "optimo"}).stop(),
            v1::MachineCapabilities::HALT_ON_PATH);
  EXPECT_EQ(CapabilitiesOf({.id = "x", .family = "lathe"}).ByteSizeLong(), 0U);
  EXPECT_EQ(MillWith({{"NO_SUCH", "1"}}).ByteSizeLong(), 0U);
}

}  // namespace
}  // namespace rmlcell::server
