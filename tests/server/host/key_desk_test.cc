// Keys that come over a line, in whatever order, and who holds them (live.md 7).
#include "server/host/key_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using Turn = KeyDesk::Turn;

v1::HostOrderAnswer Answer(std::int64_t number) {
  v1::HostOrderAnswer answer;
  answer.set_number(number);
  return answer;
}

// LIVE-7.04: what is missing is waited for, 8 at most; what has acted gets its first answer.
TEST(KeyDeskTest, NumbersWithoutAGap) {
  KeyDesk desk;
  EXPECT_EQ(desk.Look(1, false), Turn::kActs);
  EXPECT_EQ(desk.Look(2, false), Turn::kWaits);
  EXPECT_EQ(desk.Look(9, false), Turn::kWaits);
  EXPECT_EQ(desk.Look(10, false), Turn::kTooLate);  // nine are missing
  desk.Take(1, Answer(100));
  EXPECT_EQ(desk.Look(1, false), Turn::kAnswered);
  EXPECT_EQ(desk.AnswerOf(1).number(), 100);
  EXPECT_EQ(desk.Look(2, false), Turn::kActs);
}

// LIVE-7.04: what lets go acts whatever is missing, and those before it still count.
TEST(KeyDeskTest, LettingGoWaitsForNothing) {
  KeyDesk desk;
  EXPECT_EQ(desk.Look(3, true), Turn::kActs);
  desk.Release("X+", 3);
  desk.Take(3, Answer(3));
  EXPECT_TRUE(desk.IsReleased("X+", 1));
  EXPECT_FALSE(desk.IsReleased("X+", 4));
  EXPECT_FALSE(desk.IsReleased("Y+", 1));
  EXPECT_EQ(desk.Look(1, false), Turn::kActs);
  desk.Take(1, Answer(1));
  desk.Take(2, Answer(2));
  EXPECT_EQ(desk.Look(4, false), Turn::kActs);
  desk.Release("", 7);
  EXPECT_TRUE(desk.IsReleased("Y+", 6));
}

// LIVE-7.04: all orders of six messages, each sent twice: each acts once, and at the end no key is
// down that was released.
TEST(KeyDeskTest, AnyOrderOfSixMessages) {
  struct Message {
    std::int64_t number;
    const char* key;
    bool releases;
  };
  const std::array<Message, 6> sent = {{{1, "X+", false},
                                        {2, "X+", true},
                                        {3, "Y-", false},
                                        {4, "X+", false},
                                        {5, "Y-", true},
                                        {6, "X+", true}}};
  std::array<std::size_t, 6> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  do {
    KeyDesk desk;
    std::set<std::string> down;
    std::array<int, 6> acted{};
    const auto come = [&](std::size_t which) {
      const Message& message = sent[which];
      if (desk.Look(message.number, message.releases) != Turn::kActs) return;
      ++acted[which];
      if (message.releases) {
        desk.Release(message.key, message.number);
        down.erase(message.key);
      } else if (!desk.IsReleased(message.key, message.number)) {
        down.insert(message.key);
      }
      desk.Take(message.number, Answer(message.number));
    };
    for (const std::size_t which : order) {
      come(which);
      come(which);
    }
    for (int again = 0; again < 6; ++again) {
      for (std::size_t which = 0; which < sent.size(); ++which) come(which);
    }
    ASSERT_THAT(acted, testing::Each(1));
    ASSERT_THAT(down, IsEmpty());
  } while (std::ranges::next_permutation(order).found);
}

class DeadManTest : public testing::Test {
 protected:
  bool Beat(std::set<std::string> keys, std::chrono::milliseconds delay = 0ms) {
    return dead_man_.Hear(++number_, keys, (now_.wall - delay).time_since_epoch(), now_);
  }
  void Pass(std::chrono::milliseconds time) {
    now_.steady += time;
    now_.wall += time;
  }

  DeadMan dead_man_;
  HostTime now_{.steady = 1h, .wall = WallTime(std::chrono::hours(24 * 365 * 50))};
  std::int64_t number_ = 0;
};

// LIVE-7.05: 150 ms without a word.
TEST_F(DeadManTest, SilenceLetsGo) {
  dead_man_.Press("X+", now_);
  Pass(150ms);
  EXPECT_THAT(dead_man_.LetGo(now_), IsEmpty());
  Pass(1ms);
  EXPECT_THAT(dead_man_.LetGo(now_), ElementsAre("X+"));
  EXPECT_FALSE(dead_man_.holds());
  EXPECT_THAT(dead_man_.LetGo(now_), IsEmpty());
}

// LIVE-7.06: a release that names no key is one of all of them, those that were stopped, too.
TEST_F(DeadManTest, AReleaseWithoutANameIsOfEveryKey) {
  dead_man_.Press("X+", now_);
  dead_man_.Press("Y+", now_);
  dead_man_.Lose();
  EXPECT_TRUE(dead_man_.IsStopped("X+"));
  dead_man_.Release("");
  EXPECT_FALSE(dead_man_.holds());
  EXPECT_FALSE(dead_man_.IsStopped("X+"));
  EXPECT_FALSE(dead_man_.IsStopped("Y+"));
}

TEST_F(DeadManTest, WhoIsHeardHoldsOn) {
  dead_man_.Press("X+", now_);
  dead_man_.Press("Y-", now_);
  for (int i = 0; i < 20; ++i) {
    Pass(50ms);
    EXPECT_TRUE(Beat({"X+", "Y-"}));
    EXPECT_THAT(dead_man_.LetGo(now_), IsEmpty());
  }
  // LIVE-7.05: a beat that leaves a key out lets that one go.
  Pass(50ms);
  EXPECT_TRUE(Beat({"Y-"}));
  EXPECT_THAT(dead_man_.LetGo(now_), ElementsAre("X+"));
  EXPECT_TRUE(dead_man_.holds());
  dead_man_.Release("Y-");
  EXPECT_FALSE(dead_man_.holds());
}

// LIVE-7.05: a line that stalls and bursts: beats that are more than 100 ms later than the fastest
// count for nothing, and neither do those that were overtaken.
TEST_F(DeadManTest, ABurstOfOldWordsHoldsNothing) {
  dead_man_.Press("X+", now_);
  Pass(40ms);
  EXPECT_TRUE(Beat({"X+"}, 20ms));
  Pass(130ms);
  EXPECT_FALSE(Beat({"X+"}, 121ms));
  EXPECT_TRUE(Beat({"X+"}, 120ms));
  EXPECT_FALSE(dead_man_.Hear(1, {"X+"}, now_.wall.time_since_epoch(), now_));
  Pass(150ms);
  EXPECT_FALSE(Beat({"X+"}, 250ms));
  Pass(1ms);
  EXPECT_THAT(dead_man_.LetGo(now_), ElementsAre("X+"));
}

// The clock of a client may say anything.
TEST_F(DeadManTest, TheClockOfTheClientIsItsOwn) {
  dead_man_.Press("X+", now_);
  EXPECT_TRUE(Beat({"X+"}, -1h));
  Pass(100ms);
  EXPECT_TRUE(Beat({"X+"}, -1h + 100ms));
  EXPECT_FALSE(Beat({"X+"}, -1h + 101ms));
}

class LineSpeedTest : public testing::Test {
 protected:
  void Beats(int count, std::chrono::nanoseconds delay,
             std::optional<std::chrono::nanoseconds> round_trip = {}) {
    for (int i = 0; i < count; ++i) {
      now_.steady += 50ms;
      speed_.Hear(delay, round_trip, now_);
    }
  }
  bool IsSlow() const { return speed_.WhySlow(now_).has_value(); }

  LineSpeed speed_;
  HostTime now_{.steady = 1h, .wall = {}};
};

// LIVE-7.05: up to 40 ms; by three beats, so that one tells nothing.
TEST_F(LineSpeedTest, ALineThatIsSteadyAndSlowIsFound) {
  EXPECT_FALSE(IsSlow());
  Beats(8, 40ms);
  EXPECT_FALSE(IsSlow());
  speed_ = {};
  Beats(2, 41ms);
  EXPECT_FALSE(IsSlow());
  Beats(1, 41ms);
  EXPECT_TRUE(IsSlow());
  EXPECT_THAT(*speed_.WhySlow(now_), testing::HasSubstr("41 ms"));
  Beats(1, 39ms);
  EXPECT_FALSE(IsSlow());
}

// What the client measured needs no clock: it counts alone.
TEST_F(LineSpeedTest, TheWayThereAndBackCountsAlone) {
  Beats(4, 500ms, 80ms);
  EXPECT_FALSE(IsSlow());
  speed_ = {};
  Beats(2, 0ms, 81ms);
  EXPECT_FALSE(IsSlow());
  Beats(1, 0ms, 81ms);
  EXPECT_TRUE(IsSlow());
}

// Clocks that are not of one time tell nothing of a line.
TEST_F(LineSpeedTest, AnotherClockIsNoSlowLine) {
  Beats(8, 1s);
  EXPECT_FALSE(IsSlow());
  speed_ = {};
  Beats(8, -1h);
  EXPECT_FALSE(IsSlow());
}

// It may be faster later on: after 2 s without a beat nothing is known of it.
TEST_F(LineSpeedTest, IsForgotten) {
  Beats(8, 60ms);
  now_.steady += 2s;
  EXPECT_TRUE(IsSlow());
  now_.steady += 1ms;
  EXPECT_FALSE(IsSlow());
  Beats(2, 60ms);
  EXPECT_FALSE(IsSlow());
}

// LIVE-7.04: each of 64 that came behind a gap is known; of more nothing is noted, so that a client
// that leaves gaps for ever costs no memory.
TEST(KeyDeskTest, BehindAGapSoManyAreKnown) {
  KeyDesk desk;
  for (std::int64_t number = 66; number >= 3; --number) desk.Take(number, Answer(number));
  for (const std::int64_t known : {3, 40, 66}) EXPECT_EQ(desk.Look(known, true), Turn::kAnswered);
  desk.Take(2, Answer(2));
  EXPECT_EQ(desk.Look(2, true), Turn::kActs);
}

}  // namespace
}  // namespace rmlcell::server
