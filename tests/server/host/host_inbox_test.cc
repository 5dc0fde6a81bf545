// What waits for the thread of a machine, and what that thread does meanwhile.
#include "server/host/host_inbox.h"

#include <gtest/gtest.h>
#include <time.h>

#include <chrono>
#include <functional>
#include <future>
#include <thread>
#include <vector>

#include "server/host/background.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;

v1::HostResponse HeardStop(std::int64_t number) {
  v1::HostResponse message;
  message.mutable_order()->set_number(number);
  message.mutable_order()->mutable_stop();
  return message;
}

// Waits for an hour, or until there is something: then at once.
bool ComesAtOnce(HostInbox& inbox, bool hears) {
  const auto begun = std::chrono::steady_clock::now();
  inbox.Wait(1h, hears);
  return std::chrono::steady_clock::now() - begun < 10min;
}

TEST(HostInbox, GivesWhatCameOnce) {
  HostInbox inbox;
  inbox.Hear(HeardStop(1), 5s);
  EXPECT_EQ(inbox.heard_at(), 5s);
  v1::HostResponse heartbeat;
  heartbeat.mutable_heartbeat();
  inbox.Hear(heartbeat, 6s);  // says that the line stands, and no more
  EXPECT_EQ(inbox.heard_at(), 6s);
  EXPECT_EQ(inbox.TakeMessages().messages.size(), 1U);
  EXPECT_TRUE(inbox.TakeMessages().messages.empty());
  inbox.SetHeardAt(7s);
  EXPECT_EQ(inbox.heard_at(), 7s);
  int done = 0;
  inbox.Later([&] { ++done; });
  for (const auto& work : inbox.TakeWork()) work();
  EXPECT_EQ(done, 1);
  EXPECT_TRUE(inbox.TakeWork().empty());
  EXPECT_FALSE(inbox.TakeJoined());
  inbox.HaveJoined(Error{ErrorCode::kCellNotLive, "nobody", {}});
  const auto joined = inbox.TakeJoined();
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->error().detail, "nobody");
  EXPECT_FALSE(inbox.TakeJoined());
  inbox.LineIsGone();
  EXPECT_TRUE(inbox.line_gone());
  inbox.LineBegins();
  EXPECT_FALSE(inbox.line_gone());
}

TEST(HostInbox, WakesForEachThatComes) {
  HostInbox inbox;
  inbox.Wait(-1s, true);  // not at all
  inbox.Wait(1ms, true);
  inbox.Hear(HeardStop(1), 1s);
  EXPECT_TRUE(ComesAtOnce(inbox, true));
  inbox.Wait(1ms, false);  // messages do not count
  inbox.TakeMessages();
  inbox.Later([] {});
  EXPECT_TRUE(ComesAtOnce(inbox, false));
  inbox.TakeWork();
  inbox.HaveJoined(Error{ErrorCode::kCellNotLive, {}, {}});
  EXPECT_TRUE(ComesAtOnce(inbox, false));
  inbox.TakeJoined();
  // That the line is gone is seen once; a new one is news, too.
  inbox.LineIsGone();
  EXPECT_TRUE(ComesAtOnce(inbox, false));
  inbox.Wait(1ms, false);
  inbox.LineBegins();
  EXPECT_TRUE(ComesAtOnce(inbox, false));
  std::jthread later([&] { inbox.Hear(HeardStop(2), 2s); });
  EXPECT_TRUE(ComesAtOnce(inbox, true));
}

// Whoever waits already is woken by whatever comes.
TEST(HostInbox, WakesWhoWaits) {
  const std::vector<std::function<void(HostInbox&)>> all_that_comes = {
      [](HostInbox& inbox) { inbox.Hear(HeardStop(1), 1s); },
      [](HostInbox& inbox) { inbox.Later([] {}); },
      [](HostInbox& inbox) {
        inbox.HaveJoined(Error{ErrorCode::kCellNotLive, {}, {}});
      },
      [](HostInbox& inbox) { inbox.LineIsGone(); }};
  for (const auto& comes : all_that_comes) {
    HostInbox inbox;
    const std::jthread later([&] {
      EXPECT_TRUE(ComesToRest());  // it waits
      comes(inbox);
    });
    EXPECT_TRUE(ComesAtOnce(inbox, true));
  }
}

TEST(Background, DoesOneThingAtATime) {
  Background background;
  std::promise<void> go_on;
  std::promise<bool> stopped;
  ASSERT_TRUE(background.Do([&](const std::stop_token&) { go_on.get_future().wait(); }));
  EXPECT_FALSE(background.Do([](const std::stop_token&) { ADD_FAILURE(); }));
  go_on.set_value();
  background.Done();
  ASSERT_TRUE(background.Do([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) std::this_thread::yield();
    stopped.set_value(true);
  }));
  background = {};  // asks it to stop, and waits
  EXPECT_EQ(stopped.get_future().wait_for(0s), std::future_status::ready);
}

// Of this thread alone, and not while it rests.
TEST(Background, ProcessorTimeGoesOnWithWork) {
  const double begun = ThreadTime_s();
  EXPECT_GT(begun, 0.0);
  EXPECT_LT(begun, 600.0);
  while (ThreadTime_s() - begun < 0.01) {
  }
  EXPECT_LT(ThreadTime_s() - begun, 60.0);
}

// In seconds, as the system counts it.
TEST(Background, ProcessorTimeIsThatOfTheSystem) {
  const auto by_hand = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec * 1'000'000'000 + time.tv_nsec) / 1e9;
  };
  for (int look = 0; look < 3; ++look) {
    const double before = by_hand();
    const double told = ThreadTime_s();
    EXPECT_GE(told, before - 1e-9);
    EXPECT_LE(told, by_hand() + 1e-9);
  }
}

}  // namespace
}  // namespace rmlcell::server
