#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clients/cli/held_keys.h"

namespace rmlcell::cli {
namespace held_keys_signs {
namespace {

using std::chrono::milliseconds;

class HeldKeysSigns : public testing::Test {
 protected:
  using Strokes = std::vector<KeyStroke>;

  static const HandboxKey& Key(std::string_view typed) { return *HandboxKeyTyped(typed); }
  static Strokes Tap(std::string key) { return {{std::move(key), v1::KEY_ACTION_TAP}}; }
  static Strokes Press(std::string key) { return {{std::move(key), v1::KEY_ACTION_PRESS}}; }
  static Strokes Release(std::string key) { return {{std::move(key), v1::KEY_ACTION_RELEASE}}; }
  Strokes Typed(std::string_view typed) { return held_.Typed(Key(typed), now_); }
  void Pass(int time_ms) { now_ += milliseconds(time_ms); }

  HeldKeys held_;
  HeldKeys::Time now_{milliseconds(1'000'000)};
};

// LIVE-7.05: what is told of the last key does not outlive the next one.
TEST_F(HeldKeysSigns, AKeyThatIsTypedEndsTheWantOfAnAnswer) {
  held_.MouseDown(Key("x"), now_);
  Pass(201);
  EXPECT_EQ(held_.Expire(now_), Release("X+"));
  EXPECT_TRUE(held_.unanswered());
  EXPECT_EQ(Typed("y"), Tap("Y+"));
  EXPECT_FALSE(held_.unanswered());
}

// No answer is wanting while no key is down by the mouse.
TEST_F(HeldKeysSigns, WithoutAKeyNoAnswerIsWanting) {
  Pass(5000);
  EXPECT_EQ(held_.Expire(now_), Strokes());
  EXPECT_FALSE(held_.unanswered());
  held_.MouseDown(Key("x"), now_);
  EXPECT_EQ(held_.down(), std::set<std::string>{"X+"});
  EXPECT_EQ(held_.MouseUp(), Release("X+"));
  EXPECT_FALSE(held_.by_mouse());
  Pass(5000);
  EXPECT_EQ(held_.Expire(now_), Strokes());
  EXPECT_FALSE(held_.unanswered());
}

// LIVE-7.11: the repeats that count are those behind the mouse.
TEST_F(HeldKeysSigns, BehindTheMouseAKeyBeginsAnew) {
  EXPECT_EQ(Typed("x"), Tap("X+"));
  EXPECT_EQ(held_.MouseDown(Key("y"), now_), Press("Y+"));
  EXPECT_EQ(held_.MouseUp(), Release("Y+"));
  Pass(30);
  EXPECT_EQ(Typed("x"), Tap("X+"));
  Pass(30);
  EXPECT_EQ(Typed("x"), Press("X+"));
}

// The screen asks what expired many times while a finger rests on REC.
TEST_F(HeldKeysSigns, WhatIsPressedOnceStaysSoWhileTimePasses) {
  EXPECT_EQ(Typed("r"), Tap("REC"));
  Pass(500);
  EXPECT_EQ(held_.Expire(now_), Strokes());
  Pass(160);
  EXPECT_EQ(Typed("r"), Strokes());
}

}  // namespace
}  // namespace held_keys_signs
}  // namespace rmlcell::cli
