// The table of ride_protocol.h, cell by cell. motion.md section 6.
#include "engine/motion/ride/ride_protocol.h"

#include <gtest/gtest.h>

namespace rmlcell::motion {
namespace {

enum class State { kGo, kHold, kStop, kHoldAtRest, kStopAtRest };

RideProtocol In(State state, HoldRamp ramp) {
  RideProtocol ride(ramp);
  if (state == State::kHold || state == State::kHoldAtRest) ride.Hold();
  if (state == State::kStop || state == State::kStopAtRest) ride.Stop();
  if (state == State::kHoldAtRest || state == State::kStopAtRest) ride.Rest();
  return ride;
}

struct Row {
  State state;
  bool may_hold;
  bool may_stop;
  bool comes_to_rest;
  bool resumes_anew;   // START acts: of a ramp that is planned anew
  bool resumes_stays;  // of one that stays
  bool overrides_anew;
  bool overrides_stays;
};
constexpr Row kRows[] = {
    // state             hold   stop   rests  START         override now
    {State::kGo, true, true, false, false, false, true, true},
    {State::kHold, false, true, true, true, false, true, false},
    {State::kStop, false, false, true, false, false, false, false},
    {State::kHoldAtRest, false, false, false, true, true, false, false},
    {State::kStopAtRest, false, false, false, true, true, false, false},
};

TEST(RideProtocol, AsksForWhatItsTableHas) {
  for (const Row& row : kRows) {
    for (const HoldRamp ramp : {HoldRamp::kStays, HoldRamp::kPlannedAnew}) {
      const bool anew = ramp == HoldRamp::kPlannedAnew;
      RideProtocol ride = In(row.state, ramp);
      EXPECT_EQ(ride.may_hold(), row.may_hold);
      EXPECT_EQ(ride.may_stop(), row.may_stop);
      EXPECT_EQ(ride.comes_to_rest(), row.comes_to_rest);
      EXPECT_EQ(ride.may_resume(), anew ? row.resumes_anew : row.resumes_stays);
      EXPECT_EQ(ride.Override(), anew ? row.overrides_anew : row.overrides_stays);
    }
  }
}

// An override that had to wait is told once, by the START that takes it over.
TEST(RideProtocol, KeepsAnOverrideUntilStart) {
  RideProtocol ride = In(State::kStop, HoldRamp::kStays);
  EXPECT_FALSE(ride.Override());
  ride.Rest();
  EXPECT_TRUE(ride.Resume());
  EXPECT_TRUE(ride.goes());
  EXPECT_FALSE(ride.Resume());  // nothing was held: nothing changes
  EXPECT_TRUE(ride.Override());
  EXPECT_FALSE(ride.Resume());
}

TEST(RideProtocol, StopsOutOfAHold) {
  RideProtocol ride = In(State::kHold, HoldRamp::kPlannedAnew);
  ride.Stop();
  EXPECT_EQ(ride.intent(), RideIntent::kStop);
  EXPECT_FALSE(ride.may_resume());
  ride.Rest();
  ride.Resume();
  EXPECT_EQ(ride.intent(), RideIntent::kGo);
}

// A ride that is over holds nothing back, whatever it was to do.
TEST(RideProtocol, FinishLeavesNothing) {
  for (const Row& row : kRows) {
    RideProtocol ride = In(row.state, HoldRamp::kStays);
    EXPECT_EQ(!ride.Override(), ride.Finish());
    EXPECT_TRUE(ride.goes());
    EXPECT_TRUE(ride.may_hold());
    EXPECT_FALSE(ride.comes_to_rest());
  }
}

}  // namespace
}  // namespace rmlcell::motion
