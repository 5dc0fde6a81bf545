#include "clients/cli/handbox_hands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "clients/cli/remote_call.h"
#include "tests/clients/cli/fake_services.h"

namespace rmlcell::cli {
namespace {

// Notes what is pressed, in the order of its numbers; answers keys while it is open.
class FakeHandbox final : public v1::HandboxService::Service {
 public:
  grpc::Status CreateHandboxSession(grpc::ServerContext* /*context*/,
                                    const v1::CreateHandboxSessionRequest* request,
                                    v1::HandboxSession* response) override {
    response->set_name(request->machine() + "/handboxSessions/1");
    return grpc::Status::OK;
  }
  grpc::Status PressKey(grpc::ServerContext* /*context*/, const v1::PressKeyRequest* request,
                        v1::PressKeyResponse* response) override {
    std::unique_lock lock(mutex_);
    pressed_.push_back(*request);
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_ || request->action() == v1::KEY_ACTION_RELEASE; });
    response->set_sequence(request->sequence());
    return grpc::Status::OK;
  }
  grpc::Status HeartbeatHandbox(grpc::ServerContext* /*context*/,
                                const v1::HeartbeatHandboxRequest* request,
                                v1::HeartbeatResponse* /*response*/) override {
    std::unique_lock lock(mutex_);
    beats_.push_back(*request);
    changed_.notify_all();
    changed_.wait(lock, [this] { return beats_open_; });
    return grpc::Status::OK;
  }
  grpc::Status DeleteHandboxSession(grpc::ServerContext* /*context*/,
                                    const v1::DeleteHandboxSessionRequest* request,
                                    google::protobuf::Empty* /*response*/) override {
    const std::lock_guard lock(mutex_);
    deleted_ = request->name();
    return grpc::Status::OK;
  }

  void Set(bool open, bool beats_open = true) {
    const std::lock_guard lock(mutex_);
    open_ = open;
    beats_open_ = beats_open;
    changed_.notify_all();
  }
  // As soon as there are so many.
  std::vector<v1::PressKeyRequest> Pressed(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPatience, [&] { return pressed_.size() >= count; });
    return pressed_;
  }
  std::vector<v1::HeartbeatHandboxRequest> Beats(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPatience, [&] { return beats_.size() >= count; });
    return beats_;
  }
  std::string deleted() {
    const std::lock_guard lock(mutex_);
    return deleted_;
  }

 private:
  static constexpr std::chrono::seconds kPatience{60};  // only a failing test has it

  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  bool beats_open_ = true;
  std::vector<v1::PressKeyRequest> pressed_;
  std::vector<v1::HeartbeatHandboxRequest> beats_;
  std::string deleted_;
};

class HandboxHandsTest : public testing::Test {
 protected:
  // Goes on until all is answered, as the loop of a terminal does.
  void Settle() {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!hands_.at_rest() && std::chrono::steady_clock::now() < until) {
      for (KeyAnswer& answer : hands_.TakeAnswers()) answers_.push_back(std::move(answer));
      std::this_thread::yield();
    }
    for (KeyAnswer& answer : hands_.TakeAnswers()) answers_.push_back(std::move(answer));
  }
  // In the order of the numbers: a server may begin with the second of two calls.
  std::string Told(std::vector<v1::PressKeyRequest> pressed) {
    std::ranges::sort(pressed, {}, [](const auto& one) { return one.sequence(); });
    std::string told;
    for (const v1::PressKeyRequest& one : pressed)
      told += (told.empty() ? "" : " ") + std::to_string(one.sequence()) + ":" + one.key();
    return told;
  }

  CliFolder folder_;
  FakeHandbox handbox_;
  FakeServer server_{folder_, {&handbox_}};
  // Keys stay without an answer for as long as a test takes.
  HandboxHands hands_{Connect(server_.remote()), "machines/optimo-1/handboxSessions/1", "token",
                      [] {}, std::chrono::minutes(1)};
  std::vector<KeyAnswer> answers_;
};

TEST_F(HandboxHandsTest, ASessionIsDeletedWithItsHands) {
  {
    const HandboxSession session(Connect(server_.remote()), "machines/optimo-1", "token",
                                 std::chrono::minutes(1));
    ASSERT_TRUE(session.status().ok());
    EXPECT_EQ(session.session().name(), "machines/optimo-1/handboxSessions/1");
    EXPECT_EQ(handbox_.deleted(), "");
  }
  EXPECT_EQ(handbox_.deleted(), "machines/optimo-1/handboxSessions/1");
}

// LIVE-7.04: from 1, no gap, in the order of the keys.
TEST_F(HandboxHandsTest, KeysGoOneBehindTheOther) {
  for (const char* key : {"JOB", "1", "2", "ENT"}) hands_.Do({key, v1::KEY_ACTION_TAP});
  Settle();
  const std::vector<v1::PressKeyRequest> pressed = handbox_.Pressed(4);
  EXPECT_EQ(Told(pressed), "1:JOB 2:1 3:2 4:ENT");
  EXPECT_EQ(pressed[0].session(), "machines/optimo-1/handboxSessions/1");
  EXPECT_EQ(pressed[0].control_token(), "token");
  ASSERT_EQ(answers_.size(), 4U);
  EXPECT_EQ(answers_[3].key, "ENT");
  EXPECT_EQ(answers_[3].response.sequence(), 4);
}

// LIVE-7.04: the machine takes its time with a key, and the one that is held is let go meanwhile.
TEST_F(HandboxHandsTest, WhatLetsGoWaitsForNothing) {
  handbox_.Set(false);
  hands_.Do({"X+", v1::KEY_ACTION_PRESS});
  hands_.Do({"X+", v1::KEY_ACTION_RELEASE});
  EXPECT_EQ(Told(handbox_.Pressed(2)), "1:X+ 2:X+");
  handbox_.Set(true);
  Settle();
}

TEST_F(HandboxHandsTest, AHaltForgetsWhatWaits) {
  handbox_.Set(false);
  hands_.Do({"JOB", v1::KEY_ACTION_TAP});
  handbox_.Pressed(1);
  hands_.Do({"START", v1::KEY_ACTION_TAP});
  hands_.Do({"STOP", v1::KEY_ACTION_TAP});
  handbox_.Pressed(2);
  handbox_.Set(true);
  Settle();
  EXPECT_EQ(Told(handbox_.Pressed(2)), "1:JOB 2:STOP");
}

// Pressed and let go before its turn came: nobody hears of it.
TEST_F(HandboxHandsTest, AKeyThatDidNotGoDownDoesNotGoUp) {
  handbox_.Set(false);
  hands_.Do({"JOB", v1::KEY_ACTION_TAP});
  hands_.Do({"X+", v1::KEY_ACTION_PRESS});
  hands_.Beat({"X+"});  // neither of this: the machine would hear of a key that is not down
  hands_.Do({"X+", v1::KEY_ACTION_RELEASE});
  handbox_.Set(true);
  Settle();
  EXPECT_EQ(Told(handbox_.Pressed(1)), "1:JOB");
  EXPECT_TRUE(handbox_.Beats(0).empty());
}

// LIVE-7.05: a beat of before says of a key that it is up.
TEST_F(HandboxHandsTest, AKeyGoesDownBehindTheBeatsOfAnother) {
  handbox_.Set(true, false);
  hands_.Beat({"X+"});
  const std::vector<v1::HeartbeatHandboxRequest> beats = handbox_.Beats(1);
  ASSERT_EQ(beats.size(), 1U);
  EXPECT_EQ(beats[0].number(), 1);
  EXPECT_EQ(beats[0].keys_down(0), "X+");
  EXPECT_GT(beats[0].sent().seconds(), 0);
  hands_.Do({"Y+", v1::KEY_ACTION_PRESS});
  static_cast<void>(hands_.TakeAnswers());
  EXPECT_TRUE(handbox_.Pressed(0).empty());
  handbox_.Set(true, true);
  Settle();
  EXPECT_EQ(Told(handbox_.Pressed(1)), "1:Y+");
}

// The machine has stopped long since when so many have no answer.
TEST_F(HandboxHandsTest, TwentyBeatsMayBeWithoutAnAnswer) {
  handbox_.Set(true, false);
  for (int i = 0; i < 21; ++i) hands_.Beat({"X+"});
  EXPECT_FALSE(hands_.at_rest());
  handbox_.Set(true, true);
  Settle();
  EXPECT_EQ(handbox_.Beats(20).size(), 20U);
  EXPECT_TRUE(answers_.empty());  // nobody is told of beats that were heard
  hands_.Beat({"X+"});
  Settle();
  std::vector<v1::HeartbeatHandboxRequest> beats = handbox_.Beats(21);
  ASSERT_EQ(beats.size(), 21U);
  // The time that an answer took is said with the next beat.
  std::ranges::sort(beats, {}, [](const auto& beat) { return beat.number(); });
  EXPECT_FALSE(beats.front().has_round_trip());
  EXPECT_TRUE(beats.back().has_round_trip());
  EXPECT_EQ(beats.back().number(), 21);
}

TEST_F(HandboxHandsTest, MoreThanAnybodyTypesIsForgotten) {
  handbox_.Set(false);
  for (std::size_t i = 0; i < HandboxHands::kWaitingMax + 10; ++i)
    hands_.Do({"1", v1::KEY_ACTION_TAP});
  handbox_.Set(true);
  Settle();
  EXPECT_EQ(handbox_.Pressed(1).size(), HandboxHands::kWaitingMax + 1);
}

}  // namespace
}  // namespace rmlcell::cli
