// What is told of the handbox of a machine: what is to be seen now, and each change, once
// (proto/rmlcell/v1/handbox.proto).
#include "tests/server/services/live_machines_bed.h"

namespace rmlcell::server {
namespace {

class HandboxWatches : public LiveMachines {
 protected:
  void Show(const std::string& display) {
    v1::HostRequest told;
    told.mutable_panel()->set_display(display);
    hosts.Receive(*host, std::move(told));
  }
  // Until watchers see it, and not what was on its way before it.
  void Publish(const std::string& panel) {
    const std::string name = Hosts::HandboxOf("optimo-1");
    const std::uint64_t before = feed().version();
    feed().Publish(name, panel);
    EXPECT_TRUE(Eventually([&] {
      const auto told = feed().LatestAfter(name, before);
      return told && *told->bytes == panel;
    }));
  }
  static std::string Panel(const std::string& display) {
    v1::HandboxPanel panel;
    panel.set_display(display);
    return panel.SerializeAsString();
  }
};

TEST_F(HandboxWatches, NeitherWhatWasBeforeNorWhatIsShownAlready) {
  Show("READY");
  Publish(Panel("before"));
  const auto shown = hosts.HandboxPanelOf("optimo-1");
  ASSERT_TRUE(shown);
  v1::WatchHandboxRequest request;
  request.set_machine(kLaser);
  const auto context = Context();
  const auto watch = handbox->WatchHandbox(context.get(), request);
  v1::WatchHandboxResponse seen;
  ASSERT_TRUE(watch->Read(&seen));
  EXPECT_EQ(seen.panel().display(), "READY");
  for (int time = 0; time < 2; ++time) Publish(shown->SerializeAsString());
  Show("TEACH");
  ASSERT_TRUE(watch->Read(&seen));
  EXPECT_EQ(seen.panel().display(), "TEACH");
  EXPECT_EQ(seen.sequence(), 2);
  context->TryCancel();
  EXPECT_FALSE(watch->Read(&seen));
  watch->Finish();
}

// What cannot be read is nothing to be seen, and no number is spent on it.
TEST_F(HandboxWatches, WhatIsNoPanelIsNotTold) {
  Show("READY");
  ASSERT_TRUE(
      Eventually([&] { return feed().LatestAfter(Hosts::HandboxOf("optimo-1"), 0).has_value(); }));
  v1::WatchHandboxRequest request;
  request.set_machine(kLaser);
  const auto context = Context();
  const auto watch = handbox->WatchHandbox(context.get(), request);
  v1::WatchHandboxResponse seen;
  ASSERT_TRUE(watch->Read(&seen));
  EXPECT_EQ(seen.panel().display(), "READY");
  Publish("\xFF");
  Show("TEACH");
  ASSERT_TRUE(watch->Read(&seen));
  EXPECT_EQ(seen.panel().display(), "TEACH");
  EXPECT_EQ(seen.sequence(), 2);
  context->TryCancel();
  EXPECT_FALSE(watch->Read(&seen));
  watch->Finish();
}

}  // namespace
}  // namespace rmlcell::server
