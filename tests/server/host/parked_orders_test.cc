// Orders that wait until it is on the disk that they are about to act (live.md 3.21).
#include "server/host/parked_orders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "server/host/waiting_messages.h"
#include "tests/server/host/parked_order.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::chrono::nanoseconds kUntil{1'000};

v1::HostOrder ParkedMode(std::int64_t number) {
  v1::HostOrder order;
  order.set_number(number);
  order.mutable_mode();
  return order;
}
v1::HostOrder ParkedPanelKey(std::int64_t number) {
  v1::HostOrder order;
  order.set_number(number);
  order.mutable_panel_key();
  return order;
}
std::vector<std::int64_t> ParkedNumbers(const std::vector<v1::HostOrder>& orders) {
  std::vector<std::int64_t> numbers;
  for (const v1::HostOrder& order : orders) numbers.push_back(order.number());
  return numbers;
}

// LIVE-2.05: what has not begun yet is stopped; of an order for a job that job alone.
TEST(ParkedOrders, WhatBeginsIsTakenOnce) {
  ParkedOrders parked;
  const ParkedOrders::Pointer mode = parked.Add(ParkedMode(1), kUntil);
  const ParkedOrders::Pointer run = parked.Add(ParkedRun(2, "jobs/17"), kUntil);
  const ParkedOrders::Pointer other = parked.Add(ParkedRun(3, "jobs/18"), kUntil);
  const ParkedOrders::Pointer start = parked.Add(ParkedStart(4), kUntil);
  EXPECT_TRUE(parked.HasJob("jobs/17"));
  EXPECT_FALSE(parked.HasJob("jobs/19"));
  EXPECT_THAT(ParkedNumbers(parked.TakeMotions("jobs/17")), ElementsAre(2));
  EXPECT_TRUE(run->over);
  EXPECT_FALSE(other->over);
  EXPECT_FALSE(parked.HasJob("jobs/17"));
  EXPECT_TRUE(parked.HasJob("jobs/18"));
  EXPECT_THAT(ParkedNumbers(parked.TakeMotions("")), ElementsAre(3, 4));
  EXPECT_THAT(ParkedNumbers(parked.TakeMotions("")), IsEmpty());
  EXPECT_TRUE(other->over);
  EXPECT_TRUE(start->over);
  EXPECT_FALSE(mode->over);
}

// A disk that does not answer: each is refused when its time is over, and once.
TEST(ParkedOrders, WhatIsLateIsTakenOnce) {
  ParkedOrders parked;
  const ParkedOrders::Pointer first = parked.Add(ParkedMode(1), kUntil);
  const ParkedOrders::Pointer begun = parked.Add(ParkedMode(2), kUntil);
  const ParkedOrders::Pointer later = parked.Add(ParkedMode(3), kUntil * 2);
  begun->over = true;
  EXPECT_THAT(ParkedNumbers(parked.TakeLate(kUntil - std::chrono::nanoseconds(1))), IsEmpty());
  EXPECT_FALSE(first->over);
  EXPECT_THAT(ParkedNumbers(parked.TakeLate(kUntil)), ElementsAre(1));
  EXPECT_TRUE(first->over);
  EXPECT_FALSE(later->over);
  EXPECT_THAT(ParkedNumbers(parked.TakeLate(kUntil * 2)), ElementsAre(3));
  EXPECT_THAT(ParkedNumbers(parked.TakeLate(kUntil * 3)), IsEmpty());
}

// What has acted, or was given up, is kept no longer than until the next look.
TEST(ParkedOrders, WhatIsOverIsKeptNoLonger) {
  ParkedOrders parked;
  std::weak_ptr<ParkedOrders::Parked> over;
  {
    const ParkedOrders::Pointer one = parked.Add(ParkedMode(1), kUntil);
    one->over = true;
    over = one;
  }
  EXPECT_FALSE(over.expired());
  EXPECT_THAT(parked.TakeLate(kUntil - std::chrono::nanoseconds(1)), IsEmpty());
  EXPECT_TRUE(over.expired());
  {
    const ParkedOrders::Pointer late = parked.Add(ParkedMode(2), kUntil);
    over = late;
  }
  EXPECT_THAT(ParkedNumbers(parked.TakeLate(kUntil)), ElementsAre(2));
  EXPECT_TRUE(over.expired());
}

// LIVE-7.04: keys wait for one that is on its way to the disk.
TEST(ParkedOrders, AKeyIsKnown) {
  ParkedOrders parked;
  parked.Add(ParkedMode(1), kUntil);
  EXPECT_FALSE(parked.HasKey());
  const ParkedOrders::Pointer panel = parked.Add(ParkedPanelKey(2), kUntil);
  EXPECT_TRUE(parked.HasKey());
  panel->over = true;
  EXPECT_FALSE(parked.HasKey());
  v1::HostOrder key;
  key.mutable_key();
  parked.Add(key, kUntil);
  EXPECT_TRUE(parked.HasKey());
}

// Numbers above 0 are of the line that is gone; those of the other servers stay.
TEST(ParkedOrders, ALineThatIsGoneTakesItsOwn) {
  ParkedOrders parked;
  const ParkedOrders::Pointer own = parked.Add(ParkedMode(1), kUntil);
  const ParkedOrders::Pointer none = parked.Add(ParkedMode(0), kUntil);
  const ParkedOrders::Pointer other = parked.Add(ParkedMode(-1), kUntil);
  const ParkedOrders::Pointer over = parked.Add(ParkedMode(-2), kUntil);
  over->over = true;
  parked.ForgetLine();
  EXPECT_TRUE(own->over);
  EXPECT_FALSE(none->over);
  EXPECT_FALSE(other->over);
  EXPECT_TRUE(over->over);
  parked.ForgetAll();
  EXPECT_TRUE(none->over);
  EXPECT_TRUE(other->over);
}

// LIVE-3.10: what was taken leaves room for as many again, of either kind.
TEST(WaitingRoom, IsThereAgain) {
  WaitingMessages waiting;
  const auto fill = [&waiting] {
    v1::HostResponse start;
    start.mutable_order()->mutable_start();
    v1::HostResponse stop;
    stop.mutable_order()->mutable_stop();
    for (int i = 0; i < 256; ++i) {
      waiting.Add(start);
      waiting.Add(stop);
    }
  };
  for (int round = 0; round < 2; ++round) {
    fill();
    const WaitingMessages::Taken taken = waiting.Take();
    EXPECT_EQ(taken.messages.size(), 512U) << round;
    EXPECT_TRUE(taken.stops.empty()) << round;
    EXPECT_TRUE(taken.refused.empty()) << round;
  }
}

}  // namespace
}  // namespace rmlcell::server
