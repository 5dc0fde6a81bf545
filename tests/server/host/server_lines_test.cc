// The lines of a host to the servers of its cell, as a server sees them (live.md 3.06).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/host/further_lines.h"
#include "server/host/host_line.h"
#include "tests/server/host/fake_host_server.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

v1::HostHello HelloOfHost() {
  v1::HostHello hello;
  hello.set_machine("machines/mill-1");
  hello.set_host("workshop/1");
  return hello;
}

class ServerLinesTest : public testing::Test {
 protected:
  ServerLinesTest() : folder_(testing::TempDir() + "/server-lines-" + std::to_string(::getpid())) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ServerLinesTest() override { std::filesystem::remove_all(folder_); }
  FakeHostServer& Server(const std::string& name) {
    return *servers_.emplace_back(std::make_unique<FakeHostServer>("unix:" + folder_ + "/" + name));
  }
  Result<HostLine::Welcome> Join(const FakeHostServer& server) {
    return HostLine::Join(
        server.address(), HelloOfHost(),
        [this](v1::HostResponse message) {
          if (message.has_heartbeat()) return;
          const std::lock_guard lock(mutex_);
          heard_.push_back(std::move(message));
          changed_.notify_all();
        },
        [this] {
          const std::lock_guard lock(mutex_);
          ++gone_;
          changed_.notify_all();
        },
        {.last_words = kLongerThanATest});
  }
  template <class Condition>
  bool Eventually(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kComesWithin, condition);
  }

  const std::string folder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<v1::HostResponse> heard_;
  int gone_ = 0;
  std::vector<std::unique_ptr<FakeHostServer>> servers_;
};

TEST_F(ServerLinesTest, ARefusalHasItsCode) {
  FakeHostServer& server = Server("a");
  for (const auto& [status, code] :
       {std::pair{grpc::StatusCode::UNAUTHENTICATED, ErrorCode::kCellJoinRefused},
        {grpc::StatusCode::ABORTED, ErrorCode::kCellMachineTaken},
        {grpc::StatusCode::NOT_FOUND, ErrorCode::kCellUnknownMachine},
        {grpc::StatusCode::FAILED_PRECONDITION, ErrorCode::kCellVersionMismatch},
        {grpc::StatusCode::INTERNAL, ErrorCode::kCellUnavailable}}) {
    server.Refuse({status, "not you"});
    const auto joined = Join(server);
    ASSERT_FALSE(joined);
    EXPECT_EQ(joined.error().code, code);
    EXPECT_EQ(joined.error().detail, "not you");
  }
}

// Entries in order, of the status the newest; what was queued goes out also at the end.
TEST_F(ServerLinesTest, WhatIsSaidArrives) {
  FakeHostServer& server = Server("a");
  {
    auto joined = Join(server);
    ASSERT_TRUE(joined) << joined.error().detail;
    EXPECT_EQ(joined->message.fence(), 7);
    const auto hello = server.Told(v1::HostRequest::kHello, 1);
    EXPECT_EQ(hello[0].hello().machine(), "machines/mill-1");
    EXPECT_EQ(hello[0].hello().host(), "workshop/1");
    server.Order(5);
    EXPECT_TRUE(Eventually([this] { return !heard_.empty(); }));
    EXPECT_EQ(heard_[0].order().number(), 5);
    v1::MachineStatus status;
    status.set_state(v1::MACHINE_STATE_RUNNING);
    joined->line->SendStatus(status);
    EXPECT_EQ(server.Told(v1::HostRequest::kStatus, 1)[0].status().state(),
              v1::MACHINE_STATE_RUNNING);
    // From time to time an empty message, so that each knows that the other is there.
    const auto heartbeats = server.Told(v1::HostRequest::kHeartbeat, 2);
    EXPECT_EQ(heartbeats[0].heartbeat().number(), 1);
    EXPECT_EQ(heartbeats[1].heartbeat().number(), 2);
    for (std::int64_t number = 1; number <= 20; ++number) {
      v1::HostRequest request;
      request.mutable_answer()->set_number(number);
      joined->line->Send(std::move(request));
    }
  }
  std::vector<std::int64_t> numbers;
  for (const v1::HostRequest& answer : server.Told(v1::HostRequest::kAnswer, 20))
    numbers.push_back(answer.answer().number());
  ASSERT_EQ(numbers.size(), 20U);
  EXPECT_TRUE(std::ranges::is_sorted(numbers));
  EXPECT_EQ(numbers.front(), 1);
  EXPECT_EQ(gone_, 1);
}

TEST_F(ServerLinesTest, TheEndOfTheServerIsHeard) {
  FakeHostServer& server = Server("a");
  auto joined = Join(server);
  ASSERT_TRUE(joined);
  server.EndLine();
  EXPECT_TRUE(Eventually([this] { return gone_ == 1; }));
}

// A server that is not heard any more is told nothing more.
TEST_F(ServerLinesTest, ALineThatIsCutEndsAtOnce) {
  FakeHostServer& server = Server("a");
  auto joined = Join(server);
  ASSERT_TRUE(joined);
  joined->line->Cut();
  EXPECT_TRUE(Eventually([this] { return gone_ == 1; }));
  joined->line.reset();
  server.AwaitEnds(1);
}

class FurtherLinesTest : public ServerLinesTest {
 protected:
  // What comes next.
  WaitingMessages::Taken Next() {
    WaitingMessages::Taken taken;
    EXPECT_TRUE(Eventually([&] {
      taken.Append(lines_.TakeMessages());
      return !taken.messages.empty();
    }));
    return taken;
  }
  std::int64_t NextOrder() {
    const auto taken = Next();
    EXPECT_EQ(taken.messages.size(), 1U);
    return taken.messages[0].order().number();
  }
  // One after the other, each until its line stands.
  void Stand(const std::vector<const FakeHostServer*>& servers) {
    std::vector<std::string> names;
    for (const FakeHostServer* server : servers) {
      names.push_back(server->address());
      lines_.Keep(names, HelloOfHost());
      EXPECT_TRUE(BecomesFresh());
    }
  }
  bool BecomesFresh() {
    return Eventually([&] { return lines_.TakeFresh(); });
  }
  static v1::HostOrderAnswer AnswerTo(std::int64_t number) {
    v1::HostOrderAnswer answer;
    answer.set_number(number);
    return answer;
  }

  int wakes_ = 0;  // by all that came
  FurtherLines lines_{[this] {
                        const std::lock_guard lock(mutex_);
                        ++wakes_;
                        changed_.notify_all();
                      },
                      kLongerThanATest};  // nobody is silent here
};

// By numbers that no other line has; answered where it was asked, once.
TEST_F(FurtherLinesTest, OrdersOfAllServersAreAnswered) {
  FakeHostServer& a = Server("a");
  FakeHostServer& b = Server("b");
  EXPECT_FALSE(lines_.IsHeard());
  Stand({&a, &b});
  for (FakeHostServer* server : {&a, &b})
    EXPECT_EQ(server->Told(v1::HostRequest::kHello, 1)[0].hello().host(), "workshop/1");
  a.Order(5);
  const std::int64_t of_a = NextOrder();
  b.Order(5);
  const std::int64_t of_b = NextOrder();
  EXPECT_EQ(of_a, -1);
  EXPECT_EQ(of_b, -2);
  EXPECT_TRUE(lines_.IsHeard());
  EXPECT_TRUE(lines_.IsAskedFor(of_a));
  EXPECT_TRUE(lines_.IsAskedFor(of_b));
  EXPECT_TRUE(lines_.IsAskedFor(0));  // of the line that stores what the host tells
  EXPECT_FALSE(lines_.IsAskedFor(-3));
  EXPECT_FALSE(lines_.Answer(AnswerTo(0)));
  EXPECT_FALSE(lines_.Answer(AnswerTo(5)));
  EXPECT_TRUE(lines_.Answer(AnswerTo(of_b)));
  EXPECT_EQ(b.Told(v1::HostRequest::kAnswer, 1)[0].answer().number(), 5);
  EXPECT_FALSE(lines_.IsAskedFor(of_b));
  EXPECT_TRUE(lines_.Answer(AnswerTo(of_b)));
  EXPECT_TRUE(lines_.Answer(AnswerTo(of_a)));
  EXPECT_EQ(a.Told(v1::HostRequest::kAnswer, 1).size(), 1U);
  EXPECT_EQ(b.Told(v1::HostRequest::kAnswer, 1).size(), 1U);
}

TEST_F(FurtherLinesTest, AllServersSeeTheMachine) {
  FakeHostServer& a = Server("a");
  FakeHostServer& b = Server("b");
  Stand({&a, &b});
  v1::MachineStatus status;
  status.set_state(v1::MACHINE_STATE_RUNNING);
  lines_.SendStatus(status);
  v1::HandboxPanel panel;
  panel.set_display("P=45");
  lines_.SendPanel(panel);
  for (FakeHostServer* server : {&a, &b}) {
    EXPECT_EQ(server->Told(v1::HostRequest::kStatus, 1)[0].status().state(),
              v1::MACHINE_STATE_RUNNING);
    EXPECT_EQ(server->Told(v1::HostRequest::kPanel, 1)[0].panel().display(), "P=45");
  }
}

// What a server says of itself stays with it; that the host is to end does not.
TEST_F(FurtherLinesTest, OnlyOrdersAndEndsAreHanded) {
  FakeHostServer& a = Server("a");
  lines_.Keep({a.address()}, HelloOfHost());
  v1::HostResponse message;
  message.mutable_heartbeat()->set_number(1);
  a.Tell(message);
  message.mutable_memory();
  a.Tell(message);
  message.mutable_stop();
  a.Tell(message);
  const auto taken = Next();
  ASSERT_EQ(taken.messages.size(), 1U);
  EXPECT_TRUE(taken.messages[0].has_stop());
}

// What a server that is gone has asked for begins nothing; what halts acts all the same. It is
// looked for again, and knows nothing then.
TEST_F(FurtherLinesTest, AServerThatIsGoneAsksForNothing) {
  FakeHostServer& a = Server("a");
  Stand({&a});
  EXPECT_FALSE(lines_.TakeFresh());
  a.Order(1);
  const std::int64_t number = NextOrder();
  a.Order(2);
  v1::HostResponse stop;
  stop.mutable_order()->set_number(3);
  stop.mutable_order()->mutable_stop();
  a.Tell(stop);
  EXPECT_TRUE(Eventually([this] { return wakes_ == 4; }));  // the line and three orders
  a.EndLine();
  a.Told(v1::HostRequest::kHello, 2);
  EXPECT_TRUE(BecomesFresh());
  EXPECT_FALSE(lines_.IsAskedFor(number));
  EXPECT_TRUE(lines_.Answer(AnswerTo(number)));
  const auto taken = Next();
  for (const v1::HostResponse& message : taken.messages) EXPECT_TRUE(message.order().has_stop());
  a.Order(4);
  EXPECT_LT(NextOrder(), number);
}

// However soon it comes.
TEST_F(FurtherLinesTest, AnOrderWithTheWelcomeIsHanded) {
  for (int server = 0; server < 20; ++server) {
    FakeHostServer& quick = Server(std::to_string(server));
    quick.orders_at_once = true;
    lines_.Keep({quick.address()}, HelloOfHost());
    EXPECT_EQ(NextOrder(), -1 - server);
  }
}

// Eight at most; one that is not named any more is left.
TEST_F(FurtherLinesTest, LinesAreThoseThatAreNamed) {
  std::vector<std::string> names;
  for (int server = 0; server < 9; ++server)
    names.push_back(Server(std::to_string(server)).address());
  lines_.Keep(names, HelloOfHost());
  for (int server = 0; server < 8; ++server)
    servers_[static_cast<std::size_t>(server)]->Told(v1::HostRequest::kHello, 1);
  EXPECT_THAT(servers_[8]->Told(v1::HostRequest::kHello, 0), IsEmpty());
  names.erase(names.begin());
  lines_.Keep(names, HelloOfHost());
  servers_[8]->Told(v1::HostRequest::kHello, 1);
  servers_[0]->AwaitEnds(1);
  lines_.Keep({}, HelloOfHost());
  for (std::size_t server = 1; server < 9; ++server) servers_[server]->AwaitEnds(1);
  EXPECT_FALSE(lines_.IsHeard());
}

}  // namespace
}  // namespace rmlcell::server
