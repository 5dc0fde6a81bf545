#include "clients/cli/held_keys.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rmlcell::cli {
namespace {

using std::chrono::milliseconds;

// A terminal and its clock.
class HeldKeysTest : public testing::Test {
 protected:
  const HandboxKey& Key(std::string_view typed) const { return *HandboxKeyTyped(typed); }
  // "X+ tap, X+ press"
  static std::string Told(const std::vector<KeyStroke>& strokes) {
    std::string told;
    for (const KeyStroke& stroke : strokes) {
      told += (told.empty() ? "" : ", ") + stroke.key;
      told += stroke.action == v1::KEY_ACTION_TAP     ? " tap"
              : stroke.action == v1::KEY_ACTION_PRESS ? " press"
                                                      : " release";
    }
    return told;
  }
  std::string Typed(std::string_view typed) { return Told(held_.Typed(Key(typed), now_)); }
  std::string Expired() { return Told(held_.Expire(now_)); }
  void Pass(int time_ms) { now_ += milliseconds(time_ms); }

  HeldKeys held_;
  HeldKeys::Time now_{milliseconds(1'000'000)};
};

// LIVE-7.11: there is a press, the delay of the keyboard, repeats, and nothing.
TEST_F(HeldKeysTest, AKeyIsDownWhileItRepeats) {
  EXPECT_EQ(Typed("x"), "X+ tap");
  Pass(500);
  EXPECT_EQ(Expired(), "");
  EXPECT_EQ(Typed("x"), "X+ tap");
  EXPECT_TRUE(held_.down().empty());
  Pass(33);
  EXPECT_EQ(Typed("x"), "X+ press");
  for (int i = 0; i < 10; ++i) {
    Pass(i % 2 == 0 ? 33 : 140);  // the line is not even
    EXPECT_EQ(Expired(), "");
    EXPECT_EQ(Typed("x"), "");
    EXPECT_EQ(held_.down(), std::set<std::string>{"X+"});
  }
  EXPECT_FALSE(held_.by_mouse());
  Pass(150);
  EXPECT_EQ(Expired(), "");
  Pass(1);
  EXPECT_EQ(Expired(), "X+ release");
  EXPECT_TRUE(held_.down().empty());
  EXPECT_EQ(Expired(), "");
}

// Whoever touches a key again and again does not hold it.
TEST_F(HeldKeysTest, TapsMoveNothing) {
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(Typed("x"), "X+ tap");
    EXPECT_EQ(Expired(), "");
    Pass(151);
  }
  EXPECT_EQ(Typed("X"), "X- tap");
  Pass(30);
  EXPECT_EQ(Typed("x"), "X+ tap");
}

// As late as that it is a repeat, and a moment later a tap.
TEST_F(HeldKeysTest, ARepeatComesWithin150Milliseconds) {
  Typed("x");
  Pass(150);
  EXPECT_EQ(Typed("x"), "X+ press");
  EXPECT_EQ(Typed("y"), "X+ release, Y+ tap");
  Pass(151);
  EXPECT_EQ(Typed("y"), "Y+ tap");
  EXPECT_EQ(Typed("r"), "REC tap");
  Pass(750);
  EXPECT_EQ(Typed("r"), "");
  Pass(751);
  EXPECT_EQ(Typed("r"), "REC tap");
}

// A key that was let go begins anew, also when it is typed at once.
TEST_F(HeldKeysTest, AKeyThatWasLetGoBeginsAnew) {
  Typed("x");
  Pass(30);
  EXPECT_EQ(Typed("x"), "X+ press");
  Pass(151);
  EXPECT_EQ(Expired(), "X+ release");
  EXPECT_EQ(Typed("x"), "X+ tap");
  Pass(30);
  EXPECT_EQ(Typed("x"), "X+ press");
}

TEST_F(HeldKeysTest, AnotherKeyLetsGo) {
  Typed("x");
  Pass(30);
  Typed("x");
  EXPECT_EQ(Typed("Spc"), "X+ release, STOP tap");
  EXPECT_EQ(Told(held_.MouseDown(Key("y"), now_)), "Y+ press");
  EXPECT_EQ(Typed("Spc"), "Y+ release, STOP tap");
  Typed("x");
  Pass(30);
  EXPECT_EQ(Typed("x"), "X+ press");
  EXPECT_EQ(Told(held_.MouseDown(Key("z"), now_)), "X+ release, Z+ press");
  EXPECT_EQ(Told(held_.LetGo()), "Z+ release");
  EXPECT_EQ(Told(held_.LetGo()), "");
}

// REC twice because a finger rests on it would teach two points; digits come as fast as they do.
TEST_F(HeldKeysTest, WhatRepeatsIsPressedOnceWhereTwiceDoesHarm) {
  EXPECT_EQ(Typed("r"), "REC tap");
  for (const int later_ms : {660, 40, 40, 740}) {
    Pass(later_ms);
    EXPECT_EQ(Typed("r"), "");
  }
  Pass(751);
  EXPECT_EQ(Typed("r"), "REC tap");
  EXPECT_EQ(Typed("s"), "START tap");
  EXPECT_EQ(Typed("r"), "REC tap");
  EXPECT_EQ(Typed("1") + ", " + Typed("1"), "1 tap, 1 tap");
  EXPECT_EQ(Typed("+") + ", " + Typed("+"), "OVERRIDE_PLUS tap, OVERRIDE_PLUS tap");
}

// LIVE-7.05: of a line that is cut no release comes, and no answer either.
TEST_F(HeldKeysTest, AMouseHoldsWhileTheTerminalAnswers) {
  EXPECT_EQ(Told(held_.MouseDown(Key("s"), now_)), "START tap");
  EXPECT_EQ(Told(held_.MouseUp()), "");
  EXPECT_EQ(Told(held_.MouseDown(Key("x"), now_)), "X+ press");
  EXPECT_TRUE(held_.by_mouse());
  for (int i = 0; i < 20; ++i) {
    Pass(200);
    EXPECT_EQ(Expired(), "");
    held_.TerminalAnswers(now_);
  }
  EXPECT_EQ(Told(held_.MouseUp()), "X+ release");
  EXPECT_FALSE(held_.unanswered());
  held_.MouseDown(Key("Hom"), now_);
  Pass(201);
  EXPECT_EQ(Expired(), "HOME release");
  EXPECT_TRUE(held_.unanswered());
  held_.TerminalAnswers(now_);
  EXPECT_TRUE(held_.down().empty());  // it is to be pressed anew
  EXPECT_EQ(Told(held_.MouseUp()), "");
  held_.MouseDown(Key("x"), now_);
  EXPECT_FALSE(held_.unanswered());
}

TEST_F(HeldKeysTest, KeyboardAndMouseOnOneKeyAreOneHand) {
  held_.MouseDown(Key("x"), now_);
  EXPECT_EQ(Typed("x"), "");
  Pass(30);
  EXPECT_EQ(Typed("x"), "");
  EXPECT_EQ(Told(held_.MouseUp()), "X+ release");
}

}  // namespace
}  // namespace rmlcell::cli
