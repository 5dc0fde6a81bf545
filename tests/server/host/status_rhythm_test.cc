// When a host tells where its machine is (live.md 3.16).
#include "server/host/status_rhythm.h"

#include <gtest/gtest.h>

namespace rmlcell::server {
namespace {

using namespace std::chrono_literals;

// LIVE-3.16: one every 50 ms stays so behind one that came late. LIVE-10.21: one out of its turn is
// followed by none that a server would have to put off.
TEST(StatusRhythm, KeepsItsTurns) {
  StatusRhythm rhythm;
  rhythm.Told(1'000ms, 50ms);
  EXPECT_FALSE(rhythm.IsDue(1'049ms));
  EXPECT_TRUE(rhythm.IsDue(1'050ms));
  rhythm.Told(1'053ms, 50ms);
  EXPECT_EQ(rhythm.due(), 1'100ms);
  rhythm.Told(1'070ms, 50ms);  // something changed
  EXPECT_EQ(rhythm.due(), 1'120ms);
  rhythm.Told(1'250ms, 50ms);  // so late that its turns are over
  EXPECT_EQ(rhythm.due(), 1'300ms);
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
