// How a machine lives, and what can be done with it.
#include "server/records/machine_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "server/records/machine_capabilities.h"
#include "server/records/machine_messages.h"

namespace rmlcell::server {
namespace {

using testing::Contains;

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// LIVE-3.01: nothing is stated: as the server does by default; what a person said stands.
TEST(MachineOptions, WhoSaysWhetherAMachineLives) {
  storage::MachineRecord record{.id = "m", .family = "rml1"};
  EXPECT_FALSE(OptionsOf(record));
  EXPECT_TRUE(IsEnabled(record, true));
  EXPECT_FALSE(IsEnabled(record, false));
  record.options = BytesOf(v1::MachineOptions());
  ASSERT_TRUE(OptionsOf(record));
  EXPECT_TRUE(IsEnabled(record, true));  // it says nothing of that
  v1::MachineOptions disabled;
  disabled.set_disabled(true);
  record.options = BytesOf(disabled);
  EXPECT_FALSE(IsEnabled(record, true));
  v1::MachineOptions enabled;
  enabled.set_enabled(true);
  enabled.set_disabled(true);
  record.options = BytesOf(enabled);
  EXPECT_TRUE(IsEnabled(record, false));
  EXPECT_EQ(OptionsOf(record)->start(), v1::MachineOptions::START_QUEUE);
  EXPECT_FALSE(OptionsOf(record)->disabled());  // of two that contradict each other one is kept
}

// LIVE-3.01: a machine that lives begins anew with what it is, and goes on with another title.
TEST(MachineOptions, WhatMakesAMachineLiveOtherwise) {
  const storage::MachineRecord before{
      .id = "m", .family = "rml1", .title = "a mill", .profile = "srm-20"};
  storage::MachineRecord now = before;
  now.title = "another title";
  EXPECT_FALSE(LivesOtherwise(before, now));
  now.profile = "t1";
  EXPECT_TRUE(LivesOtherwise(before, now));
  now = before;
  now.parameters = {{"PANEL", "FULL"}};
  EXPECT_TRUE(LivesOtherwise(before, now));
  now = before;
  now.options = BytesOf(v1::MachineOptions());
  EXPECT_TRUE(LivesOtherwise(before, now));
}

// LIVE-5.04: each of these by itself is of a machine with a device.
TEST(MachineOptions, WhatOnlyADeviceHas) {
  using Options = v1::MachineOptions;
  const std::vector<void (*)(Options&)> cases = {
      [](Options& options) { options.set_pace(Options::PACE_MODEL); },
      [](Options& options) { options.mutable_lead(); },
      [](Options& options) { options.mutable_lead_max(); },
      [](Options& options) { options.set_hold(Options::DEVICE_HOLD_CLEAR); },
      [](Options& options) { options.set_home(true); },
      [](Options& options) { options.set_unattended(true); }};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Options options;
    cases[i](options);
    const Status checked = CheckOptions(options);
    ASSERT_FALSE(checked) << i;
    EXPECT_THAT(checked.error().detail, HasSubstr("are for machines with a device")) << i;
  }
}

// LIVE-5.04, LIVE-3.31: what only machines with a device have is refused, and times out of range.
TEST(MachineOptions, WhatAVirtualMachineHas) {
  v1::MachineOptions options;
  options.set_start(v1::MachineOptions::START_ARMED);
  options.set_server_lost(v1::MachineOptions::SERVER_LOST_GO_ON);
  options.mutable_server_lost_after()->set_seconds(40);
  options.mutable_late_hold()->set_nanos(100'000'000);
  EXPECT_TRUE(CheckOptions(options));
  const auto refused = [](const v1::MachineOptions& wrong) {
    const Status checked = CheckOptions(wrong);
    return checked ? std::string("taken") : std::string(checked.error().detail);
  };
  v1::MachineOptions wrong = options;
  wrong.set_server_lost(v1::MachineOptions::SERVER_LOST_FINISH);
  EXPECT_THAT(refused(wrong), HasSubstr("server_lost"));
  wrong = options;
  wrong.set_pace(v1::MachineOptions::PACE_FLOW);
  EXPECT_THAT(refused(wrong), HasSubstr("pace"));
  wrong = options;
  wrong.mutable_late_hold()->set_nanos(99'000'000);
  EXPECT_THAT(refused(wrong), HasSubstr("late_hold"));
  wrong = options;
  wrong.mutable_server_lost_after()->set_seconds(3'601);
  EXPECT_THAT(refused(wrong), HasSubstr("server_lost_after"));
  storage::MachineRecord record{.id = "m", .family = "rml1", .options = BytesOf(wrong)};
  EXPECT_FALSE(CheckMachine(record));
}

// LIVE-8.04: keys of a handbox or of a panel, axes that they move, ten steps of the override
// (OPT-4.34).
TEST(MachineCapabilities, OfBothFamilies) {
  const v1::MachineCapabilities optimo = CapabilitiesOf({.id = "o", .family = "optimo"});
  EXPECT_TRUE(optimo.handbox());
  EXPECT_THAT(optimo.panel_keys(), IsEmpty());
  EXPECT_THAT(optimo.override_steps_percent(),
              ElementsAre(10, 25, 40, 55, 70, 85, 100, 115, 130, 145));
  ASSERT_EQ(optimo.jog_axes_size(), 5);
  EXPECT_EQ(optimo.jog_axes(0).axis(), "X");
  EXPECT_EQ(optimo.jog_axes(0).unit(), v1::UNIT_MILLIMETRE);
  EXPECT_EQ(optimo.jog_axes(4).unit(), v1::UNIT_RADIAN);
  EXPECT_TRUE(optimo.inputs());
  EXPECT_EQ(optimo.hold(), v1::MachineCapabilities::HALT_AFTER_INSTRUCTION);
  EXPECT_EQ(optimo.hold_in_remote(), v1::MachineCapabilities::HALT_ON_PATH);  // LIVE-2.12

  const v1::MachineCapabilities mill =
      CapabilitiesOf({.id = "m", .family = "rml1", .profile = "srm-20"});
  EXPECT_FALSE(mill.handbox());
  for (const char* key : {"PAUSE", "CONTINUE", "COVER", "POWER", "X+", "Z-"})
    EXPECT_THAT(mill.panel_keys(), Contains(key));
  EXPECT_THAT(mill.panel_keys(), Not(Contains("VIEW")));  // nobody knows its panel
  EXPECT_EQ(mill.jog_axes(0).step(), 0.01);
  EXPECT_FALSE(mill.inputs());
  EXPECT_EQ(mill.hold_in_remote(), v1::MachineCapabilities::HALT_AFTER_INSTRUCTION);

  const v1::MachineCapabilities full = CapabilitiesOf(
      {.id = "m", .family = "rml1", .profile = "srm-20", .parameters = {{"PANEL", "FULL"}}});
  for (const char* key : {"VIEW", "SPINDLE", "Z0", "ORIGIN", "HOME"})
    EXPECT_THAT(full.panel_keys(), Contains(key));
}

// What no version knows is refused as a wrong argument, as all that is out of range.
TEST(MachineOptions, WhatIsNoneThatThereIs) {
  const auto refused = [](const v1::MachineOptions& wrong) {
    const Status checked = CheckOptions(wrong);
    EXPECT_TRUE(checked || checked.error().code == ErrorCode::kCellInvalidArgument);
    return checked ? std::string("taken") : std::string(checked.error().detail);
  };
  v1::MachineOptions wrong;
  wrong.set_start(static_cast<v1::MachineOptions::Start>(99));
  EXPECT_EQ(refused(wrong), "machine.options.start is none that there is");
  wrong.Clear();
  wrong.set_server_lost(static_cast<v1::MachineOptions::ServerLost>(99));
  EXPECT_EQ(refused(wrong), "machine.options.server_lost is none that there is");
  wrong.Clear();
  wrong.mutable_late_hold()->set_seconds(3'601);
  EXPECT_EQ(refused(wrong), "machine.options.late_hold: 0.1 s to 1 h");
}

}  // namespace
}  // namespace rmlcell::server
