// What a host tells of now, under the names by which it is looked for.
#include <gtest/gtest.h>

#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

class LiveNews : public HostsTest {};

// The progress of a run is told of its job, too.
TEST_F(LiveNews, TheProgressOfARunIsThatOfItsJob) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_IDLE);
  v1::HostRequest request;
  v1::MachineStatus& status = *request.mutable_status();
  status.set_machine("machines/mill-1");
  status.set_state(v1::MACHINE_STATE_RUNNING);
  status.mutable_run()->set_job("jobs/17");
  hosts.Receive(*link, std::move(request));
  EXPECT_TRUE(Eventually([&] { return feed.LatestAfter("jobs/17", 0).has_value(); }));
}

TEST_F(LiveNews, TheHandboxIsToldUnderItsOwnName) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_IDLE);
  v1::HostRequest request;
  request.mutable_panel()->set_display("READY");
  hosts.Receive(*link, std::move(request));
  EXPECT_TRUE(Eventually([&] {
    const auto latest = feed.LatestAfter("handboxes/mill-1", 0);
    v1::HandboxPanel panel;
    return latest && panel.ParseFromString(*latest->bytes) && panel.display() == "READY";
  }));
}

}  // namespace
}  // namespace rmlcell::server
