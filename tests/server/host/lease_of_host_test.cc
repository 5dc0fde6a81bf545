// How a host keeps its machine, as its servers see it (live.md 3.04, 3.06).
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "server/host/host_process.h"
#include "tests/server/host/fake_host_server.h"

namespace rmlcell::server {
namespace {

class LeaseOfHost : public testing::Test {
 protected:
  LeaseOfHost() : folder_(testing::TempDir() + "/lease-of-host-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/a");
  }
  ~LeaseOfHost() override {
    stopping_ = true;
    if (host_.valid()) host_.wait();
    server_.reset();
    other_.reset();
    std::filesystem::remove_all(folder_);
  }
  void Live(std::int64_t fence, std::chrono::seconds lease) {
    v1::HostWelcome welcome;
    welcome.set_fence(fence);
    welcome.mutable_lease()->set_seconds(lease.count());
    welcome.set_family("rml1");
    welcome.set_profile("srm-20");
    if (other_ != nullptr) welcome.add_servers(other_->address());
    server_->Welcome(welcome);
    host_ = std::async(std::launch::async, [this] {
      return RunHost({.server = server_->address(),
                      .join_token = "let me in",
                      .machine = "machines/mill-1",
                      .journal = folder_ + "/mill-1.journal",
                      .patience = PatientHost()},
                     stopping_);
    });
    v1::HostResponse memory;
    memory.mutable_memory()->set_whole(true);
    server_->Tell(memory);
    server_->Told(v1::HostRequest::kStatus, 1);
  }

  const std::string folder_;
  std::unique_ptr<FakeHostServer> server_;
  std::unique_ptr<FakeHostServer> other_;
  std::atomic<bool> stopping_ = false;
  std::future<int> host_;
};

// LIVE-3.04: whenever a third of the lease is over, whether the server has answered or not.
TEST_F(LeaseOfHost, IsRenewedAgainAndAgain) {
  Live(7, std::chrono::seconds(1));
  for (const v1::HostRequest& request : server_->Told(v1::HostRequest::kRenew, 2))
    EXPECT_EQ(request.renew().fence(), 7);
}

// A third of it lasts longer than this test.
TEST_F(LeaseOfHost, IsNotRenewedBefore) {
  Live(7, std::chrono::seconds(600));
  server_->Told(v1::HostRequest::kHeartbeat, 1);
  EXPECT_EQ(server_->Told(v1::HostRequest::kRenew, 0).size(), 0U);
}

// LIVE-3.06: the other servers of the cell are joined, whatever fence the host has.
TEST_F(LeaseOfHost, TheOtherServersAreJoined) {
  other_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/b");
  Live(1, std::chrono::seconds(60));
  const auto hello = other_->Told(v1::HostRequest::kHello, 1)[0].hello();
  EXPECT_EQ(hello.fence(), 1);
  EXPECT_EQ(hello.machine(), "machines/mill-1");
  const auto status = other_->Told(v1::HostRequest::kStatus, 1)[0].status();
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_IDLE);
}

}  // namespace
}  // namespace rmlcell::server
