// What a key that nobody has answered yet keeps from being sent, and what does not end that.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "clients/cli/handbox_hands.h"
#include "clients/cli/handbox_screen.h"
#include "clients/cli/remote_call.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

// Answers no JOB before it may, all other keys at once, and no beat with a word that is good.
class SlowHandbox final : public v1::HandboxService::Service {
 public:
  grpc::Status PressKey(grpc::ServerContext* /*context*/, const v1::PressKeyRequest* request,
                        v1::PressKeyResponse* /*response*/) override {
    std::unique_lock lock(mutex_);
    pressed_.push_back(*request);
    changed_.notify_all();
    changed_.wait(lock, [&] { return answers_ || request->key() != "JOB"; });
    return grpc::Status::OK;
  }
  grpc::Status HeartbeatHandbox(grpc::ServerContext* /*context*/,
                                const v1::HeartbeatHandboxRequest* /*request*/,
                                v1::HeartbeatResponse* /*response*/) override {
    return {grpc::StatusCode::FAILED_PRECONDITION, "late"};
  }

  void Answer() {
    const std::lock_guard lock(mutex_);
    answers_ = true;
    changed_.notify_all();
  }
  // "1:JOB 2:STOP": the first of them, by their numbers, as soon as there are so many.
  std::string First(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::minutes(1), [&] { return pressed_.size() >= count; });
    std::vector<v1::PressKeyRequest> sorted = pressed_;
    std::ranges::sort(sorted, {}, [](const auto& one) { return one.sequence(); });
    std::string told;
    for (const v1::PressKeyRequest& one : sorted)
      told += (told.empty() ? "" : " ") + std::to_string(one.sequence()) + ":" + one.key();
    return told;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool answers_ = false;
  std::vector<v1::PressKeyRequest> pressed_;
};

class HandboxTurns : public testing::Test {
 protected:
  // As soon as something of this key was answered; empty: a beat.
  bool Answered(const std::string& key) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (std::chrono::steady_clock::now() < until) {
      for (const KeyAnswer& answer : hands_.TakeAnswers()) {
        if (answer.key == key) return true;
      }
      std::this_thread::yield();
    }
    return false;
  }

  CliFolder folder_;
  SlowHandbox handbox_;
  FakeServer server_{folder_, {&handbox_}};
  // JOB stays without an answer for as long as a test takes.
  HandboxHands hands_{Connect(server_.remote()), "machines/optimo-1/handboxSessions/1", "token",
                      [] {}, std::chrono::minutes(1)};
};

// LIVE-7.04: ENT waits for the answer to JOB, whoever else is answered, and HOLD forgets it.
TEST_F(HandboxTurns, AHaltThatIsAnsweredTakesNoTurn) {
  hands_.Do({"JOB", v1::KEY_ACTION_TAP});
  hands_.Do({"STOP", v1::KEY_ACTION_TAP});
  EXPECT_TRUE(Answered("STOP"));
  hands_.Do({"ENT", v1::KEY_ACTION_TAP});
  hands_.Do({"HOLD", v1::KEY_ACTION_TAP});
  EXPECT_EQ(handbox_.First(3), "1:JOB 2:STOP 3:HOLD");
  handbox_.Answer();
  EXPECT_TRUE(Answered("JOB"));
  hands_.Do({"1", v1::KEY_ACTION_TAP});  // behind whatever waits
  EXPECT_EQ(handbox_.First(4), "1:JOB 2:STOP 3:HOLD 4:1");
}

TEST_F(HandboxTurns, ABeatThatIsAnsweredTakesNoTurn) {
  hands_.Do({"JOB", v1::KEY_ACTION_TAP});
  hands_.Beat({"X+"});
  EXPECT_TRUE(Answered(""));
  hands_.Do({"ENT", v1::KEY_ACTION_TAP});
  hands_.Do({"HOLD", v1::KEY_ACTION_TAP});
  EXPECT_EQ(handbox_.First(2), "1:JOB 2:HOLD");
  handbox_.Answer();
  EXPECT_TRUE(Answered("JOB"));
}

// Nothing fits on a line without columns.
TEST(HandboxTooSmall, OfNoColumnsNothingIsSaid) {
  HandboxView view;
  view.rows = 3;
  view.columns = 0;
  EXPECT_EQ(HandboxLines(view), (std::vector<std::string>{"", "", ""}));
  view.columns = 1;
  EXPECT_EQ(HandboxLines(view), (std::vector<std::string>{"t", "n", "S"}));
}

}  // namespace
}  // namespace rmlcell::cli
