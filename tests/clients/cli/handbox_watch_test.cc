// What a handbox on a terminal hears of its machine, and when it has lost it.
#include "clients/cli/handbox_watch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "tests/clients/cli/fake_machine.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::cli {
namespace {

// Until the stream is left, or is to end.
void Stay(const grpc::ServerContext& context, const std::atomic<bool>& ends) {
  while (!ends && !context.IsCancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

// Tells what it is given; its streams stay until they are left or `ends`.
class WatchedMachine final : public FakeMachine {
 public:
  using FakeMachine::FakeMachine;
  grpc::Status WatchMachine(Context context, const v1::WatchMachineRequest* request,
                            grpc::ServerWriter<v1::WatchMachineResponse>* writer) override {
    const grpc::Status end = FakeMachine::WatchMachine(context, request, writer);
    Stay(*context, ends);
    over = true;
    return end;
  }
  grpc::Status RenewControl(Context context, const v1::RenewControlRequest* request,
                            v1::RenewControlResponse* response) override {
    ++renewals;
    {
      const std::lock_guard lock(renewed_mutex_);
      renewed_at_.emplace(request->control_token(), std::chrono::steady_clock::now());
    }
    return FakeMachine::RenewControl(context, request, response);
  }
  // For the first time, of this control.
  std::chrono::steady_clock::time_point RenewedAt(const std::string& token) {
    const std::lock_guard lock(renewed_mutex_);
    return renewed_at_[token];
  }
  std::atomic<bool> ends = false;
  std::atomic<bool> over = false;
  std::atomic<int> renewals = 0;

 private:
  std::mutex renewed_mutex_;
  std::map<std::string, std::chrono::steady_clock::time_point> renewed_at_;
};

class WatchedHandbox final : public v1::HandboxService::Service {
 public:
  grpc::Status WatchHandbox(grpc::ServerContext* context, const v1::WatchHandboxRequest* request,
                            grpc::ServerWriter<v1::WatchHandboxResponse>* writer) override {
    asked = request->machine();
    v1::WatchHandboxResponse message;
    message.mutable_panel()->set_display("P=45");
    writer->Write(message);
    Stay(*context, ends);
    return end;
  }
  std::string asked;
  std::atomic<bool> ends = false;
  grpc::Status end{};
};

class HandboxWatchTest : public testing::Test {
 protected:
  HandboxWatchTest() {
    machine_.watched.emplace_back();  // without a status: nothing new
    machine_.watched.emplace_back().mutable_status()->set_machine("machines/m");
    act_.machine = "m";
    control_ = std::make_unique<Control>(remote_, act_);
    calls_.Take();
  }
  // Once it has seen this; only a failing test waits for a minute.
  template <class Condition>
  HandboxSeen Await(const HandboxWatch& watch, Condition condition) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(
        rung_.wait_for(lock, std::chrono::minutes(1), [&] { return condition(watch.seen()); }));
    return watch.seen();
  }
  std::unique_ptr<HandboxWatch> Watch(std::chrono::seconds control_time) {
    return std::make_unique<HandboxWatch>(Connect(remote_), "machines/m", *control_, control_time,
                                          [this] {
                                            const std::lock_guard lock(mutex_);
                                            ++rings_;
                                            rung_.notify_all();
                                          });
  }

  CliFolder folder_;
  CallNotes calls_;
  WatchedMachine machine_{calls_};
  WatchedHandbox handbox_;
  FakeServer server_{folder_, {&machine_, &handbox_}};
  const Remote remote_ = server_.remote();
  MachineAct act_;
  std::unique_ptr<Control> control_;
  std::mutex mutex_;
  std::condition_variable rung_;
  int rings_ = 0;
};

bool IsLost(const HandboxSeen& seen) { return seen.lost.has_value(); }

TEST_F(HandboxWatchTest, SeesPanelAndMachine) {
  {
    const auto watch = Watch(std::chrono::seconds(60));
    const HandboxSeen seen = Await(*watch, [](const HandboxSeen& now) {
      return !now.panel.display().empty() && !now.status.machine().empty();
    });
    EXPECT_EQ(seen.panel.display(), "P=45");
    EXPECT_EQ(seen.status.machine(), "machines/m");
    EXPECT_FALSE(seen.lost);
    EXPECT_EQ(handbox_.asked, "machines/m");
    EXPECT_EQ(calls_.Take(), "WatchMachine name: \"machines/m\" max_rate_hz: 10\n");
  }
  EXPECT_EQ(rings_, 2);  // whoever leaves is told nothing more
}

// A server that ends its streams well goes without a reason.
TEST_F(HandboxWatchTest, TheFirstReasonIsTheOne) {
  machine_.refused["WatchMachine"] = {grpc::StatusCode::PERMISSION_DENIED, "not you"};
  const auto watch = Watch(std::chrono::hours(1));
  handbox_.ends = true;
  const HandboxSeen seen = Await(*watch, IsLost);
  EXPECT_EQ(seen.lost->error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(seen.lost->error_message(), "the server has ended");
  machine_.ends = true;
  while (!machine_.over) std::this_thread::yield();
  EXPECT_TRUE(ComesToRest());  // the end of the other stream has come, too
  EXPECT_EQ(watch->seen().lost->error_message(), "the server has ended");
}

TEST_F(HandboxWatchTest, AReasonIsKept) {
  machine_.refused["WatchMachine"] = {grpc::StatusCode::PERMISSION_DENIED, "not you"};
  machine_.ends = true;
  const auto watch = Watch(std::chrono::seconds(60));
  EXPECT_EQ(Await(*watch, IsLost).lost->error_message(), "not you");
}

// At a third of its time, until somebody has taken it. With a time that is too short for a slow
// machine the answer itself may come too late: then once more, with twice the time.
TEST_F(HandboxWatchTest, ControlIsRenewed) {
  machine_.refused["RenewControl"] = {grpc::StatusCode::PERMISSION_DENIED, "taken"};
  std::string lost;
  for (std::chrono::seconds time(1); lost != "taken" && time < std::chrono::minutes(1); time *= 2) {
    const std::string token = "t" + std::to_string(time.count());
    machine_.control.set_control_token(token);
    control_ = std::make_unique<Control>(remote_, act_);
    const auto begun = std::chrono::steady_clock::now();
    const auto watch = Watch(time);
    lost = Await(*watch, IsLost).lost->error_message();
    if (lost == "taken") {
      EXPECT_GE(machine_.RenewedAt(token) - begun, std::chrono::milliseconds(time) / 3);
    }
  }
  EXPECT_EQ(lost, "taken");
}

// And not before.
TEST_F(HandboxWatchTest, ControlThatIsFreshIsNotRenewed) {
  const auto watch = Watch(std::chrono::hours(1));
  Await(*watch, [](const HandboxSeen& now) {
    return !now.panel.display().empty() && !now.status.machine().empty();
  });
  EXPECT_TRUE(ComesToRest());
  EXPECT_EQ(machine_.renewals, 0);
}

}  // namespace
}  // namespace rmlcell::cli
