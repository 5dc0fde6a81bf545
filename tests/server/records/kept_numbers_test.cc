// What a record says of what every machine can, and of lists in the configuration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/base/config.h"
#include "server/records/machine_capabilities.h"
#include "server/records/machine_options.h"
#include "server/records/toolpath_levels.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;

// LIVE-8.04: each machine is stopped, watched and started at a step.
TEST(KeptNumbers, OfWhatEachMachineCan) {
  for (const auto& record :
       {storage::MachineRecord{.id = "o", .family = "optimo"},
        storage::MachineRecord{.id = "m", .family = "rml1", .profile = "srm-20"}}) {
    const v1::MachineCapabilities can = CapabilitiesOf(record);
    EXPECT_TRUE(can.emergency_stop()) << record.id;
    EXPECT_TRUE(can.variables()) << record.id;
    EXPECT_TRUE(can.reports_position()) << record.id;
    EXPECT_TRUE(can.start_at_step()) << record.id;
  }
}

// As fast as the machine goes, 30 mm/s of an SRM-20, and not only as slow as its keys do.
TEST(KeptNumbers, OfTheSpeedOfKeys) {
  const v1::MachineCapabilities mill =
      CapabilitiesOf({.id = "m", .family = "rml1", .profile = "srm-20"});
  ASSERT_GT(mill.jog_axes_size(), 1);
  EXPECT_EQ(mill.jog_axes(0).axis(), "X");
  EXPECT_DOUBLE_EQ(mill.jog_axes(0).speed_max(), 30.0);
}

// What stands between commas, without the blanks around it.
TEST(KeptNumbers, OfAListThatIsConfigured) {
  for (const ConfigKey& key : ConfigKeys()) {
    if (key.name != "web.origins") continue;
    Config config;
    ASSERT_TRUE(key.set(config, " http://a ,\thttp://bc\t, ,http://d"));
    EXPECT_THAT(config.web_origins, ElementsAre("http://a", "http://bc", "http://d"));
  }
}

// A machine that is enabled is not disabled as well; without a word jobs start by themselves.
TEST(KeptNumbers, OfOptionsThatContradict) {
  v1::MachineOptions options;
  options.set_enabled(true);
  options.set_disabled(true);
  const auto kept = OptionsOf({.id = "m", .family = "rml1", .options = BytesOf(options)});
  ASSERT_TRUE(kept);
  EXPECT_TRUE(kept->enabled());
  EXPECT_FALSE(kept->disabled());
  EXPECT_EQ(kept->start(), v1::MachineOptions::START_QUEUE);
}

}  // namespace
}  // namespace rmlcell::server
