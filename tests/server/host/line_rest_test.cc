// How often a host and its server show each other that they are there (live.md 3.06, 3.12).
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "server/host/host_line.h"
#include "tests/server/host/fake_host_server.h"

namespace rmlcell::server {
namespace {

// All heartbeats are those of its statuses.
class LineAtRest : public testing::Test {
 protected:
  static constexpr std::chrono::hours kNever{1};
  LineAtRest() : folder_(testing::TempDir() + "/line-at-rest-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    server_ = std::make_unique<FakeHostServer>("unix:" + folder_ + "/a");
    auto joined = HostLine::Join(
        server_->address(), {},
        [this](const v1::HostResponse& message) {
          const std::lock_guard lock(mutex_);
          if (message.has_heartbeat() && message.heartbeat().number() == number_) ++heard_;
          changed_.notify_all();
        },
        [] {}, {.heartbeat = kNever, .heartbeat_at_rest = kNever});
    EXPECT_TRUE(joined) << joined.error().detail;
    line_ = std::move(joined->line);
  }
  ~LineAtRest() override {
    line_.reset();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  // The server has answered, with this number.
  void Answer(std::int64_t number) {
    std::unique_lock lock(mutex_);
    number_ = number;
    heard_ = 0;
    v1::HostResponse beat;
    beat.mutable_heartbeat()->set_number(number);
    server_->Tell(beat);
    EXPECT_TRUE(changed_.wait_for(lock, kComesWithin, [this] { return heard_ > 0; }));
  }
  // Tells where the machine stands, and waits until what is said behind that has come, too.
  void TellStatus(v1::MachineState state) {
    v1::MachineStatus status;
    status.set_state(state);
    line_->SendStatus(status);
    server_->Told(v1::HostRequest::kStatus, ++statuses_);
    v1::HostRequest answer;
    answer.mutable_answer()->set_number(static_cast<std::int64_t>(statuses_));
    line_->Send(answer);
    server_->Told(v1::HostRequest::kAnswer, statuses_);
  }
  std::size_t Heartbeats() { return server_->Told(v1::HostRequest::kHeartbeat, 0).size(); }

  const std::string folder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t number_ = 0;
  int heard_ = 0;
  std::size_t statuses_ = 0;
  std::unique_ptr<FakeHostServer> server_;
  std::unique_ptr<HostLine> line_;
};

// A server that takes a status for a heartbeat needs no other one, while the machine is at rest.
TEST_F(LineAtRest, AStatusThatIsAnsweredIsAHeartbeat) {
  Answer(0);
  TellStatus(v1::MACHINE_STATE_IDLE);
  const std::size_t before = Heartbeats();
  for (int status = 0; status < 6; ++status) {
    Answer(0);
    TellStatus(v1::MACHINE_STATE_IDLE);
  }
  EXPECT_EQ(Heartbeats(), before);
}

// One that does not gets a heartbeat behind each.
TEST_F(LineAtRest, AStatusThatIsNotAnsweredIsNone) {
  for (int status = 0; status < 6; ++status) {
    Answer(1);
    TellStatus(v1::MACHINE_STATE_IDLE);
  }
  EXPECT_EQ(Heartbeats(), 6U);
}

// LIVE-3.16: what a moving machine tells is no heartbeat and needs none; that it begins or ends to
// move does.
TEST_F(LineAtRest, AStatusOfWhatMovesIsNone) {
  for (int status = 0; status < 2; ++status) TellStatus(v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Heartbeats(), 0U);
  TellStatus(v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Heartbeats(), 1U);
  for (int status = 0; status < 2; ++status) TellStatus(v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Heartbeats(), 2U);
}

// One answer is for one status.
TEST_F(LineAtRest, AnAnswerCountsOnce) {
  Answer(0);
  TellStatus(v1::MACHINE_STATE_IDLE);
  const std::size_t before = Heartbeats();
  for (int status = 0; status < 6; ++status) TellStatus(v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Heartbeats(), before + 6);
}

}  // namespace
}  // namespace rmlcell::server
