// What may overtake a key that is not answered yet, and what may not.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "clients/cli/handbox_hands.h"
#include "clients/cli/remote_call.h"
#include "tests/clients/cli/fake_services.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::cli {
namespace {

// Keeps the keys of its list without an answer until it is opened; answers all others at once.
class LazyHandbox final : public v1::HandboxService::Service {
 public:
  explicit LazyHandbox(std::set<std::string> slow) : slow_(std::move(slow)) {}

  grpc::Status CreateHandboxSession(grpc::ServerContext* context,
                                    const v1::CreateHandboxSessionRequest* /*request*/,
                                    v1::HandboxSession* response) override {
    const std::lock_guard lock(mutex_);
    heard_ += Ends(*context) ? "create " : "create* ";
    response->set_name("s");
    return refusal;
  }
  grpc::Status DeleteHandboxSession(grpc::ServerContext* context,
                                    const v1::DeleteHandboxSessionRequest* request,
                                    google::protobuf::Empty* /*response*/) override {
    const std::lock_guard lock(mutex_);
    heard_ += "delete " + request->name() + (Ends(*context) ? " " : "* ");
    return {};
  }
  grpc::Status PressKey(grpc::ServerContext* context, const v1::PressKeyRequest* request,
                        v1::PressKeyResponse* /*response*/) override {
    std::unique_lock lock(mutex_);
    heard_ += request->key() + (Ends(*context) ? " " : "* ");
    sequences[request->key()] = request->sequence();
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_ || !slow_.contains(request->key()); });
    return {};
  }
  grpc::Status HeartbeatHandbox(grpc::ServerContext* context,
                                const v1::HeartbeatHandboxRequest* request,
                                v1::HeartbeatResponse* /*response*/) override {
    std::unique_lock lock(mutex_);
    heard_ += Ends(*context) ? "beat " : "beat* ";
    beat = *request;
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_ || !slow_.contains("beat"); });
    return {};
  }

  grpc::Status refusal{};  // of a session
  v1::HeartbeatHandboxRequest beat{};
  std::map<std::string, std::int64_t> sequences{};

  void Open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  // As soon as it has that length; whatever it is, after a time that only a failing test takes.
  std::string Heard(std::size_t size) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::minutes(1), [&] { return heard_.size() >= size; });
    return heard_;
  }

 private:
  // Some time, and not never.
  static bool Ends(const grpc::ServerContext& context) {
    return context.deadline() < std::chrono::system_clock::now() + std::chrono::hours(1);
  }

  const std::set<std::string> slow_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  std::string heard_;
};

class HandsInTurn : public testing::Test {
 protected:
  explicit HandsInTurn(std::set<std::string> slow = {"JOB", "REC"}) : handbox_(std::move(slow)) {}
  // A channel must not go on the thread that tells of its own call.
  ~HandsInTurn() override {
    handbox_.Open();
    hands_.reset();
    while (channel_.use_count() > 1) std::this_thread::yield();
  }

  // Until so many keys were answered, as the loop of a terminal does.
  void AwaitAnswers(std::size_t count) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (answered_ < count && std::chrono::steady_clock::now() < until) {
      answered_ += hands_->TakeAnswers().size();
      std::this_thread::yield();
    }
  }

  CliFolder folder_;
  LazyHandbox handbox_;
  FakeServer server_{folder_, {&handbox_}};
  std::atomic<int> told_ = 0;
  std::shared_ptr<grpc::Channel> channel_ = Connect(server_.remote());
  // Keys stay without an answer for as long as a test takes.
  std::unique_ptr<HandboxHands> hands_ = std::make_unique<HandboxHands>(
      channel_, "machines/m/handboxSessions/1", "token", [this] { ++told_; },
      std::chrono::minutes(1));
  std::size_t answered_ = 0;
};

// LIVE-7.04
TEST_F(HandsInTurn, AHaltOvertakesAKeyAndLeavesItsTurnAlone) {
  hands_->Do({"JOB", v1::KEY_ACTION_TAP});
  ASSERT_EQ(handbox_.Heard(4), "JOB ");
  hands_->Do({"HOLD", v1::KEY_ACTION_TAP});
  ASSERT_EQ(handbox_.Heard(9), "JOB HOLD ");
  AwaitAnswers(1);
  // JOB is under way still.
  hands_->Do({"1", v1::KEY_ACTION_TAP});
  hands_->Do({"STOP", v1::KEY_ACTION_TAP});
  ASSERT_EQ(handbox_.Heard(14), "JOB HOLD STOP ");
  hands_->Do({"2", v1::KEY_ACTION_TAP});
  hands_->Do({"EMERGENCY_STOP", v1::KEY_ACTION_RELEASE});
  EXPECT_EQ(handbox_.Heard(29), "JOB HOLD STOP EMERGENCY_STOP ");
  AwaitAnswers(3);
  hands_->Do({"ENT", v1::KEY_ACTION_TAP});
  handbox_.Open();
  AwaitAnswers(5);
  EXPECT_EQ(handbox_.Heard(33), "JOB HOLD STOP EMERGENCY_STOP ENT ");
}

TEST_F(HandsInTurn, EachCallHasItsTime) {
  hands_->Do({"X+", v1::KEY_ACTION_PRESS});
  AwaitAnswers(1);
  hands_->Beat({"X+"});
  EXPECT_EQ(handbox_.Heard(8), "X+ beat ");
  EXPECT_EQ(handbox_.beat.session(), "machines/m/handboxSessions/1");
  EXPECT_EQ(handbox_.beat.control_token(), "token");
  {
    const HandboxSession session(channel_, "machines/m", "token", std::chrono::minutes(1));
    EXPECT_TRUE(session.status().ok());
  }
  EXPECT_EQ(handbox_.Heard(24), "X+ beat create delete s ");
}

// What was never opened is not closed.
TEST_F(HandsInTurn, ASessionThatIsRefusedIsNone) {
  handbox_.refusal = {grpc::StatusCode::FAILED_PRECONDITION, "no handbox"};
  {
    const HandboxSession session(channel_, "machines/m", "token", std::chrono::minutes(1));
    EXPECT_EQ(session.status().error_message(), "no handbox");
  }
  EXPECT_EQ(handbox_.Heard(7), "create ");
}

class HandsBehindABeat : public HandsInTurn {
 protected:
  HandsBehindABeat() : HandsInTurn({"beat"}) {}
};

// LIVE-7.05: one beat is enough; what goes up waits for nothing, and is counted before it.
TEST_F(HandsBehindABeat, AKeyGoesDownBehindIt) {
  hands_->Beat({"X+"});
  ASSERT_EQ(handbox_.Heard(5), "beat ");
  hands_->Do({"Y+", v1::KEY_ACTION_PRESS});
  static_cast<void>(hands_->TakeAnswers());
  hands_->Do({"X+", v1::KEY_ACTION_RELEASE});
  AwaitAnswers(1);
  handbox_.Open();
  AwaitAnswers(2);
  EXPECT_EQ(handbox_.Heard(11), "beat X+ Y+ ");
  EXPECT_EQ(handbox_.sequences, (std::map<std::string, std::int64_t>{{"X+", 1}, {"Y+", 2}}));
}

// Its answer would come to hands that are no more.
TEST_F(HandsInTurn, WhatIsUnderWayIsWaitedFor) {
  hands_->Do({"REC", v1::KEY_ACTION_TAP});
  ASSERT_EQ(handbox_.Heard(4), "REC ");
  std::thread opener([&] {
    EXPECT_TRUE(ComesToRest());  // whoever ends the hands waits
    handbox_.Open();
  });
  hands_.reset();
  EXPECT_EQ(told_, 1);
  opener.join();
}

}  // namespace
}  // namespace rmlcell::cli
