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
