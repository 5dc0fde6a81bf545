// A whole server in this process: what keeps it from starting, and what is left when it has ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "server/cell/cell.h"
#include "storage/opening/open_store.h"

namespace rmlcell::server {
namespace {

using testing::StartsWith;

class CellStartTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(::mkdtemp(folder_.data()), nullptr); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // A store of its own, any port, no worker, no machine that lives.
  Config Alone(const std::string& name) const {
    Config config;
    config.listen_grpc = {"127.0.0.1:0"};
    config.listen_web = "";
    config.state_directory = folder_ + "/" + name;
    config.machines_hosts = "enabled";
    config.workers_count = 0;
    config.workers_program = "/bin/true";
    config.machines = {{"mill-1", "rml1", "srm-20", "A mill"},
                       {"mill-2", "rml1", "srm-20", "Another"}};
    return config;
  }
  static Error Refusal(const Config& config) {
    const auto cell = Cell::Start(config);
    return cell ? Error{ErrorCode::kCellInternal, "it has started", {}} : cell.error();
  }
  // Hosts had these machines when the server of before ended.
  static void PutLeases(const Config& config, bool pinned) {
    storage::StoreChoice choice;
    choice.directory = config.state_directory;
    choice.keep_record_events = 100;
    const auto store = storage::OpenStore(choice);
    ASSERT_TRUE(store) << store.error().detail;
    for (const MachineConfig& machine : config.machines) {
      ASSERT_TRUE((*store)->PutMachine({.id = machine.id,
                                        .family = machine.family,
                                        .title = machine.title,
                                        .profile = machine.profile},
                                       0));
      ASSERT_TRUE((*store)->TakeMachine({.machine = machine.id,
                                         .host = "a host",
                                         .server = "a server",
                                         .duration = std::chrono::minutes(1),
                                         .pinned = pinned}));
    }
  }

  std::string folder_ = testing::TempDir() + "cell_XXXXXX";
};

TEST_F(CellStartTest, TwoServersShareNoAddress) {
  Config first = Alone("first");
  first.listen_grpc = {"unix:" + folder_ + "/first.sock", "127.0.0.1:0"};
  first.listen_web = "127.0.0.1:0";
  const auto cell = Cell::Start(first);
  ASSERT_TRUE(cell) << cell.error().detail;
  const std::vector<std::string> addresses = (*cell)->grpc_addresses();
  ASSERT_EQ(addresses.size(), 2U);
  EXPECT_EQ(addresses[0], first.listen_grpc[0]);
  EXPECT_THAT(addresses[1], StartsWith("127.0.0.1:"));
  EXPECT_NE(addresses[1], "127.0.0.1:0");
  EXPECT_THAT((*cell)->web_address(), StartsWith("127.0.0.1:"));
  EXPECT_NE((*cell)->web_address(), "127.0.0.1:0");

  Config second = Alone("second");
  second.listen_grpc = {addresses[1]};
  const Error at_port = Refusal(second);
  EXPECT_EQ(at_port.code, ErrorCode::kCellPortUsed);
  EXPECT_EQ(at_port.detail, "cannot listen on " + addresses[1]);
  second.listen_grpc = {"127.0.0.1:0", addresses[1]};
  EXPECT_EQ(Refusal(second).detail, "cannot listen on " + addresses[1]) << "the one that is taken";
  second.listen_grpc = {addresses[0]};
  const Error at_socket = Refusal(second);
  EXPECT_EQ(at_socket.code, ErrorCode::kCellPortUsed);
  EXPECT_EQ(at_socket.detail,
            "cannot listen on " + addresses[0] + ": another server listens there");
  second.listen_grpc = {"127.0.0.1:0"};
  second.listen_web = (*cell)->web_address();
  const Error at_web = Refusal(second);
  EXPECT_EQ(at_web.code, ErrorCode::kCellPortUsed);
  EXPECT_THAT(at_web.detail, StartsWith("web port " + second.listen_web + ": "));
  // None of the three has left anything running.
  second.listen_web = "";
  const auto again = Cell::Start(second);
  ASSERT_TRUE(again) << again.error().detail;
  EXPECT_EQ((*again)->web_address(), "");
}

TEST_F(CellStartTest, TheWebHasAnAddressOfIpv6) {
  std::ifstream file("/proc/net/if_inet6");
  const std::string known{std::istreambuf_iterator<char>(file), {}};
  if (known.find(std::string(31, '0') + "1 ") == std::string::npos) {
    GTEST_SKIP() << "this computer has no ::1";
  }
  Config config = Alone("web");
  config.listen_web = "[::1]:0";
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  EXPECT_THAT((*cell)->web_address(), StartsWith("[::1]:"));
  EXPECT_NE((*cell)->web_address(), "[::1]:0");
}

TEST_F(CellStartTest, AMachineThatThereCannotBeStopsTheStart) {
  Config config = Alone("odd");
  config.machines = {{"mill-9", "rml1", "no-such-mill", "Odd"}};
  const Error refused = Refusal(config);
  EXPECT_EQ(refused.code, ErrorCode::kCellConfiguration);
  EXPECT_THAT(refused.detail, StartsWith("machine mill-9: "));
}

TEST_F(CellStartTest, WithoutItsSecretOfHostsThereIsNoServer) {
  const Config config = Alone("secret");
  std::filesystem::create_directories(config.state_directory + "/host.token");
  const Error refused = Refusal(config);
  EXPECT_EQ(refused.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(refused.detail, config.state_directory + "/host.token: Is a directory");
}

// Machines that never lived can wait for it; workers, and machines that had a host, cannot.
TEST_F(CellStartTest, NeedsItsProgramForWhatWasThereAndForWorkers) {
  Config config = Alone("new");
  config.workers_program = folder_ + "/none";
  const std::string missing =
      "workers.program " + config.workers_program + ": No such file or directory";
  config.machines_hosts = "all";
  EXPECT_TRUE(Cell::Start(config));
  config.workers_count = 1;
  const Error worker = Refusal(config);
  EXPECT_EQ(worker.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(worker.detail, missing);

  config.workers_count = 0;
  config.machines_hosts = "enabled";
  config.state_directory = folder_ + "/had";
  PutLeases(config, false);
  const Error host = Refusal(config);
  EXPECT_EQ(host.code, ErrorCode::kCellConfiguration);
  EXPECT_EQ(host.detail, missing);
  // The host of a device is no process of this server.
  config.state_directory = folder_ + "/pinned";
  PutLeases(config, true);
  EXPECT_TRUE(Cell::Start(config));
}

// More machines than may live are no reason to serve none.
TEST_F(CellStartTest, StartsThoughNotAllOfItsMachinesMayLive) {
  Config config = Alone("full");
  config.machines_hosts_max = 1;
  PutLeases(config, false);
  const auto cell = Cell::Start(config);
  EXPECT_TRUE(cell) << cell.error().detail;
}

TEST_F(CellStartTest, LeavesNothingBehind) {
  Config config = Alone("one");
  const std::string socket = folder_ + "/one.sock";
  config.listen_grpc = {"unix:" + socket};
  const auto cell = Cell::Start(config);
  ASSERT_TRUE(cell) << cell.error().detail;
  EXPECT_TRUE(std::filesystem::is_socket(socket));
  EXPECT_TRUE(std::filesystem::exists(config.state_directory + "/private"));
  (*cell)->Stop();
  EXPECT_FALSE(std::filesystem::exists(socket));
  EXPECT_FALSE(std::filesystem::exists(config.state_directory + "/private"));
  // The store is free, and who stops once more stops nothing of the next one.
  const auto next = Cell::Start(config);
  ASSERT_TRUE(next) << next.error().detail;
  (*cell)->Stop();
  EXPECT_TRUE(std::filesystem::is_socket(socket));
  EXPECT_TRUE(std::filesystem::exists(config.state_directory + "/private"));
}

}  // namespace
}  // namespace rmlcell::server
