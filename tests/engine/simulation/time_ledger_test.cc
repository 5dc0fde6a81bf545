#include "engine/simulation/report/time_ledger.h"

#include <gtest/gtest.h>

#include <vector>

namespace rmlcell::simulation {
namespace {

class TimeLedgerTest : public testing::Test {
 protected:
  TimeLedger::Gap At(int step) const {
    TimeLedger::Gap now;
    now.place.step = step;
    return now;
  }
  std::vector<TimeLedger::Gap> counted;
  TimeLedger ledger{[this](const TimeLedger::Gap& gap) { counted.push_back(gap); }};
};

TEST_F(TimeLedgerTest, WhatFollowsEachOtherIsClaimedWhole) {
  EXPECT_EQ(ledger.Claim(SimTime(0), SimTime(10), At(1)), SimTime(10));
  EXPECT_EQ(ledger.Claim(SimTime(10), SimTime(15), At(1)), SimTime(5));
  ledger.Close();
  EXPECT_TRUE(counted.empty());
  EXPECT_EQ(ledger.reached(), SimTime(15));
}

// LIVE-6.09: of a run that begins at a step what lies before is nobody's.
TEST_F(TimeLedgerTest, WhatLiesBeforeTheBeginIsNotCounted) {
  ledger.BeginAt(SimTime(100));
  EXPECT_EQ(ledger.Claim(SimTime(103), SimTime(110), At(1)), SimTime(7));
  ledger.Close();
  ASSERT_EQ(counted.size(), 1u);
  EXPECT_EQ(counted[0].start, SimTime(100));
  EXPECT_EQ(counted[0].length(), SimTime(3));
  EXPECT_EQ(ledger.counted(), SimTime(10));
}

TEST_F(TimeLedgerTest, TimeThatNobodyClaimsIsCountedAtTheEnd) {
  ledger.Leave(SimTime(4), At(1));
  ledger.Leave(SimTime(6), At(2));
  EXPECT_EQ(ledger.Claim(SimTime(9), SimTime(10), At(2)), SimTime(1));
  EXPECT_TRUE(counted.empty());
  ledger.Close();
  ASSERT_EQ(counted.size(), 2u);
  EXPECT_EQ(counted[0].place.step, 1);
  EXPECT_EQ(counted[0].length(), SimTime(4));
  EXPECT_EQ(counted[1].place.step, 2);
  EXPECT_EQ(counted[1].length(), SimTime(5));  // [4, 9]
}

// What follows without a change is one gap; a beam, a halt or another place makes a new one.
TEST_F(TimeLedgerTest, GapsOfOneKindAreOne) {
  TimeLedger::Gap now = At(1);
  ledger.Leave(SimTime(1), now);
  ledger.Leave(SimTime(2), now);
  now.beam_on = true;
  ledger.Leave(SimTime(4), now);
  now.halted = true;
  ledger.Leave(SimTime(7), now);
  now.place.step = 2;
  ledger.Leave(SimTime(11), now);
  EXPECT_EQ(ledger.Claim(SimTime(11), SimTime(12), now), SimTime(1));
  ledger.Leave(SimTime(17), now);
  ledger.Leave(SimTime(13), now);  // that was already
  EXPECT_EQ(ledger.reached(), SimTime(17));
  ledger.Close();
  std::vector<SimTime> lengths;
  for (const TimeLedger::Gap& gap : counted) lengths.push_back(gap.length());
  EXPECT_EQ(lengths,
            (std::vector<SimTime>{SimTime(2), SimTime(2), SimTime(3), SimTime(4), SimTime(5)}));
  EXPECT_FALSE(counted[0].beam_on);
  EXPECT_TRUE(counted[1].beam_on);
  EXPECT_FALSE(counted[1].halted);
  EXPECT_TRUE(counted[2].halted);
  EXPECT_EQ(counted[2].place.step, 1);
  EXPECT_EQ(counted[3].place.step, 2);
  EXPECT_EQ(counted[4].start, SimTime(12));
}

// motion.md 6, /NEXT: a DELAY [2, 5] is told before the motion [0, 9] behind it.
TEST_F(TimeLedgerTest, OverlapsAreCountedOnce) {
  EXPECT_EQ(ledger.Claim(SimTime(2), SimTime(5), At(1)), SimTime(3));
  EXPECT_EQ(ledger.Claim(SimTime(0), SimTime(9), At(1)), SimTime(6));
  ledger.Close();
  EXPECT_TRUE(counted.empty());
  EXPECT_EQ(ledger.Claim(SimTime(3), SimTime(9), At(1)), SimTime(0));
}

TEST_F(TimeLedgerTest, PartOfAGapIsClaimed) {
  ledger.Leave(SimTime(10), At(1));
  EXPECT_EQ(ledger.Claim(SimTime(3), SimTime(7), At(1)), SimTime(4));
  ledger.Close();
  ASSERT_EQ(counted.size(), 2u);
  EXPECT_EQ(counted[0].end, SimTime(3));
  EXPECT_EQ(counted[1].start, SimTime(7));
}

// Bounded: with many gaps open the oldest is counted as it is; nothing is lost or counted twice.
TEST_F(TimeLedgerTest, ManyGaps) {
  SimTime claimed{0};
  for (int k = 0; k < 100; ++k) {
    claimed += ledger.Claim(SimTime(10 * k + 5), SimTime(10 * k + 10), At(k));
  }
  EXPECT_EQ(claimed, SimTime(500));
  EXPECT_EQ(counted.size(), 84u);
  claimed += ledger.Claim(SimTime(0), SimTime(1000), At(100));
  for (const TimeLedger::Gap& gap : counted) claimed += gap.length();
  ledger.Close();
  EXPECT_EQ(claimed, SimTime(1000));
}

}  // namespace
}  // namespace rmlcell::simulation
