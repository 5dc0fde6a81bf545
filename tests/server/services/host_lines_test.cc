// A host and the servers of its cell, over the wire, or without it for the race detector
// (live.md 3.06).
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <future>
#include <memory>
#include <mutex>
#include <thread>

#include "server/base/executor.h"
#include "server/events/event_feed.h"
#include "server/host/host_process.h"
#include "server/machines/hosts.h"
#include "server/records/machine_options.h"
#include "tests/server/fake_link.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/host/patient_host.h"
#include "tests/server/server_bed.h"
#include "tests/server/services/listening.h"

namespace rmlcell::server {
namespace {

constexpr const char* kHosted = "mill-1";

// Takes nothing of a machine while it is stopped.
class StoppedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Status AppendMachine(const storage::MachineLease& lease,
                       const storage::MachineWrite& write) override {
    {
      std::unique_lock lock(mutex_);
      goes_on_.wait(lock, [this] { return !stopped_; });
    }
    return ForwardingStore::AppendMachine(lease, write);
  }
  void Stop(bool stopped) {
    const std::lock_guard lock(mutex_);
    stopped_ = stopped;
    goes_on_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable goes_on_;
  bool stopped_ = false;
};

// One of the servers of a cell, as far as hosts know it.
struct OneServer {
  OneServer(storage::Store& store, std::string name, const std::string& folder,
            const std::vector<std::string>& servers)
      : feed(store),
        hosts({.store = store,
               .feed = feed,
               .executor = *executor,
               .server = name,
               .join_token = "secret",
               .servers = servers,
               .clock = clock.clock()}),
        listening(AddressOf(folder, name), hosts, *executor) {}
  ~OneServer() {
    End();
    executor.reset();  // what was posted is done
  }
  static std::string AddressOf(const std::string& folder, const std::string& name) {
    return "unix:" + folder + "/" + name;
  }
  void End() {
    hosts.CloseAll();
    listening.End();
  }

  v1::MachineState State() {
    const auto status = hosts.StatusOf(kHosted);
    return status ? status->state() : v1::MACHINE_STATE_UNSPECIFIED;
  }
  bool Becomes(v1::MachineState state) {
    return Eventually([&] { return State() == state; });
  }
  v1::HostOrderAnswer Ask(v1::HostOrder order) {
    order.set_caller("anna");
    std::promise<Result<v1::HostOrderAnswer>> answered;
    hosts.Ask(kHosted, std::move(order),
              [&](Result<v1::HostOrderAnswer> answer) { answered.set_value(std::move(answer)); });
    Result<v1::HostOrderAnswer> answer = answered.get_future().get();
    EXPECT_TRUE(answer) << answer.error().detail;
    if (!answer) return {};
    EXPECT_FALSE(answer->has_refusal()) << answer->refusal().message();
    return *std::move(answer);
  }

  EventFeed feed;
  TestSteadyClock clock;  // it stands: an answer may take long
  std::unique_ptr<Executor> executor = std::make_unique<Executor>(4);
  Hosts hosts;
  Listening listening;
};

class HostLinesTest : public testing::Test {
 protected:
  HostLinesTest() {
    std::filesystem::create_directories(folder_);
    Must(store_.PutPrograms(
        kHosted, {{.slot = 5, .name = "p", .object = "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PD8000,0;"}},
        {}, "anna"));
    storage::MachineRecord mill = Must(store_.GetMachine(kHosted));
    v1::MachineOptions options;
    options.mutable_late_hold()->set_seconds(60);  // its computer may be slow
    // So may be the change from one line to another; less than it looks for a server that is gone.
    options.set_server_lost(v1::MachineOptions::SERVER_LOST_GO_ON);
    options.mutable_server_lost_after()->set_seconds(4);
    mill.options = BytesOf(options);
    Must(store_.PutMachine(mill, mill.revision, "test"));
    const std::vector<std::string> servers = {OneServer::AddressOf(folder_, "a"),
                                              OneServer::AddressOf(folder_, "b")};
    a_ = std::make_unique<OneServer>(store_, "a", folder_, servers);
    b_ = std::make_unique<OneServer>(store_, "b", folder_, servers);
    host_ = std::thread([this] {
      RunHost({.server = OneServer::AddressOf(folder_, "a"),
               .join_token = "secret",
               .machine = "machines/mill-1",
               .journal = folder_ + "/journal",
               .patience = PatientHost()},
              stopping_);
    });
  }
  ~HostLinesTest() override {
    store_.Stop(false);
    stopping_ = true;
    host_.join();
    a_.reset();
    b_.reset();
  }
  void Control(OneServer& server) {
    v1::HostOrder order;
    order.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
    order.mutable_acquire_control()->set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
    order.mutable_acquire_control()->set_client("a test");
    token_ = server.Ask(order).control().control_token();
    EXPECT_NE(token_, "");
  }
  void Start(OneServer& server) {
    v1::HostOrder order;
    order.mutable_start()->set_program(5);
    order.mutable_start()->set_control_token(token_);
    order.mutable_start()->set_request_id("start " + std::to_string(++requests_));
    server.Ask(order);
  }
  void Resume(OneServer& server) {
    v1::HostOrder order;
    order.mutable_resume()->set_control_token(token_);
    order.mutable_resume()->set_request_id("resume " + std::to_string(++requests_));
    server.Ask(order);
  }
  static void Stop(OneServer& server) {
    v1::HostOrder order;
    order.mutable_stop();
    server.Ask(order);
  }

  storage::TestDirectory directory_;  // two programs have these cases, and run at the same time
  const std::string folder_ = directory_.File("lines");
  std::atomic<bool> is_heard_anew_ = false;  // by the second server, or from the beginning
  ServerBed bed_;
  StoppedStore store_{bed_.store()};
  std::unique_ptr<OneServer> a_;
  std::unique_ptr<OneServer> b_;
  std::atomic<bool> stopping_ = false;
  std::thread host_;
  std::string token_;
  int requests_ = 0;
};

// LIVE-3.06, LIVE-4.01: either server shows the machine and orders it, and control is the host's.
TEST_F(HostLinesTest, EitherServerReachesTheMachine) {
  ASSERT_TRUE(a_->Becomes(v1::MACHINE_STATE_IDLE));
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_IDLE));
  Control(*b_);
  Start(*a_);
  EXPECT_TRUE(b_->Becomes(v1::MACHINE_STATE_RUNNING));
  EXPECT_EQ(a_->hosts.StatusOf(kHosted)->control().holder(), "anna");
  Stop(*b_);
  EXPECT_TRUE(a_->Becomes(v1::MACHINE_STATE_HELD));
  Resume(*b_);
  EXPECT_TRUE(a_->Becomes(v1::MACHINE_STATE_RUNNING));
}

// LIVE-3.06, LIVE-4.07, LIVE-3.34: STOP and status never pass the store, whichever server got the
// call.
TEST_F(HostLinesTest, AStopPassesNoStore) {
  ASSERT_TRUE(a_->Becomes(v1::MACHINE_STATE_IDLE));
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_IDLE));
  Control(*a_);
  Start(*a_);
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_RUNNING));
  store_.Stop(true);
  Stop(*b_);
  EXPECT_TRUE(a_->Becomes(v1::MACHINE_STATE_HELD));
  EXPECT_TRUE(b_->Becomes(v1::MACHINE_STATE_HELD));
  Resume(*a_);
  EXPECT_TRUE(b_->Becomes(v1::MACHINE_STATE_RUNNING));
  Stop(*a_);
  EXPECT_TRUE(b_->Becomes(v1::MACHINE_STATE_HELD));
}

// LIVE-10.05, LIVE-4.01: whoever asks whichever server at the same time, one has control.
TEST_F(HostLinesTest, OneHasControlWhicheverServerIsAsked) {
  ASSERT_TRUE(a_->Becomes(v1::MACHINE_STATE_IDLE));
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_IDLE));
  for (int round = 0; round < 20; ++round) {
    std::array<std::promise<std::string>, 2> tokens;
    const std::array<OneServer*, 2> servers = {a_.get(), b_.get()};
    for (std::size_t i = 0; i < servers.size(); ++i) {
      v1::HostOrder order;
      order.set_caller(i == 0 ? "anna" : "bert");
      order.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
      order.mutable_acquire_control()->set_client("a test");
      servers[i]->hosts.Ask(kHosted, std::move(order),
                            [&tokens, i](const Result<v1::HostOrderAnswer>& answer) {
                              tokens[i].set_value(answer ? answer->control().control_token() : "");
                            });
    }
    const std::string first = tokens[0].get_future().get();
    const std::string second = tokens[1].get_future().get();
    EXPECT_NE(first.empty(), second.empty());
    v1::HostOrder release;
    release.mutable_release_control()->set_control_token(first + second);
    a_->Ask(std::move(release));
  }
}

// LIVE-10.05, LIVE-3.02: another host is told that the machine is taken, by either server, and
// touches nothing.
TEST_F(HostLinesTest, AnotherHostIsRefusedByEitherServer) {
  ASSERT_TRUE(a_->Becomes(v1::MACHINE_STATE_IDLE));
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_IDLE));
  Control(*a_);
  Start(*a_);
  ASSERT_TRUE(a_->Becomes(v1::MACHINE_STATE_RUNNING));
  const std::int64_t fence = Must(store_.MachineLeases()).front().fence;
  v1::HostHello hello;
  hello.set_join_token("secret");
  hello.set_machine("machines/mill-1");
  hello.set_host("elsewhere/1");
  hello.set_protocol(1);
  for (OneServer* server : {a_.get(), b_.get()}) {
    const Status joined = server->hosts.Join(std::make_shared<FakeLink>(), hello);
    ASSERT_FALSE(joined);
    EXPECT_EQ(joined.error().code, ErrorCode::kCellMachineTaken);
  }
  EXPECT_EQ(Must(store_.MachineLeases()).front().fence, fence);
  EXPECT_EQ(a_->State(), v1::MACHINE_STATE_RUNNING);
}

// LIVE-3.06, LIVE-3.31: one server goes; the run does not, and the other one stores what happens.
TEST_F(HostLinesTest, TheOtherServerGoesOnWithTheMachine) {
  ASSERT_TRUE(a_->Becomes(v1::MACHINE_STATE_IDLE));
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_IDLE));
  Control(*b_);
  Start(*b_);
  ASSERT_TRUE(b_->Becomes(v1::MACHINE_STATE_RUNNING));
  const std::int64_t fence = Must(store_.MachineLeases()).front().fence;
  is_heard_anew_ = Must(store_.MachineLeases()).front().server == "b";
  b_->hosts.OnRunOver([this](const std::string&) { is_heard_anew_ = true; });
  a_->End();
  // Until the host has noticed, the lease is that of the server that is gone.
  EXPECT_TRUE(Eventually([&] { return Must(store_.MachineLeases()).front().server == "b"; }));
  // The line that the second server had is given up for the one that the lease comes with, and on
  // that nothing is known of the machine until its host has told it.
  EXPECT_TRUE(Eventually([&] { return is_heard_anew_.load(); }));
  EXPECT_TRUE(Eventually([&] { return b_->hosts.IsSettled(kHosted); }));
  EXPECT_TRUE(b_->Becomes(v1::MACHINE_STATE_RUNNING));
  EXPECT_EQ(Must(store_.MachineLeases()).front().fence, fence);
  Stop(*b_);
  EXPECT_TRUE(b_->Becomes(v1::MACHINE_STATE_HELD));
  EXPECT_EQ(b_->hosts.StatusOf(kHosted)->hold_reason(), v1::HOLD_REASON_STOP);
}

}  // namespace
}  // namespace rmlcell::server
