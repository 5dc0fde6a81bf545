// When a host tells where its machine is (live.md 3.16).
#include "server/host/status_rhythm.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;

// LIVE-3.16: one every 51 ms, as long as a server can tell them.
TEST(StatusRhythm, KeepsItsTurns) {
  StatusRhythm rhythm;
  rhythm.Told(1'000ms, 51ms);
  EXPECT_FALSE(rhythm.IsDue(1'050ms));
  EXPECT_TRUE(rhythm.IsDue(1'051ms));
  rhythm.Told(1'052ms, 51ms);  // a little late: the next one is not
  EXPECT_EQ(rhythm.due(), 1'102ms);
  rhythm.Told(1'105ms, 51ms);
  EXPECT_EQ(rhythm.due(), 1'155ms);
  rhythm.Told(1'250ms, 51ms);  // so late that its turns are over
  EXPECT_EQ(rhythm.due(), 1'301ms);
}

// LIVE-10.21: what is told out of its turn waits at the server for up to 50 ms, and nothing that is
// told behind it waits there.
TEST(StatusRhythm, WhatIsToldOutOfItsTurnMakesNoneLate) {
  StatusRhythm rhythm;
  rhythm.Told(1'000ms, 51ms);
  rhythm.Told(1'008ms, 51ms);  // something changed; it is shown at 1,050
  EXPECT_EQ(rhythm.due(), 1'101ms);
  for (int i = 9; i < 50; ++i) rhythm.Told(1'000ms + std::chrono::milliseconds(i), 51ms);
  EXPECT_EQ(rhythm.due(), 1'101ms);  // the newest of them alone is shown
  rhythm.Told(1'101ms, 51ms);
  EXPECT_EQ(rhythm.due(), 1'152ms);
}

// What begins to move is not as slow as it was when it stood.
TEST(StatusRhythm, IsThatOfTheNewState) {
  StatusRhythm rhythm;
  rhythm.Told(1'000ms, 1s);
  EXPECT_EQ(rhythm.due(), 2'000ms);
  rhythm.Told(1'300ms, 50ms);
  EXPECT_EQ(rhythm.due(), 1'350ms);
}

}  // namespace
}  // namespace rmlcell::server
