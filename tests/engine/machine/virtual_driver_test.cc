// A virtual machine along a clock: live.md 3.
#include "engine/machine/virtual_driver.h"

#include <gtest/gtest.h>

#include "engine/families/families.h"
#include "engine/machine/observer.h"
#include "engine/machine/parameters.h"

namespace rmlcell::machine {
namespace {

SimTime Clock(double seconds) { return FromSeconds(1000.0 + seconds); }

class VirtualDriverTest : public testing::Test {
 protected:
  void Load(const std::string& text) {
    const MachineFamily& family = *families::FindFamily("optimo");
    const Parameters parameters = *MakeParameters(family, "standard", {});
    Translation made = family.Translate({.name = "a.S", .bytes = text}, parameters, {});
    ASSERT_TRUE(made.ok);
    MachineMemory memory;
    memory.programs[1].object = Bytes::Of(ObjectOf(std::move(made), text));
    driver = std::make_unique<VirtualDriver>(
        *Machine::Make(family, parameters, std::move(memory), {}, nobody), Clock(0.0));
  }
  // In turns as a host has them.
  void GoOn(double from, double to) {
    for (int turn = 1; turn <= 20 * (to - from); ++turn) driver->Pump(Clock(from + 0.05 * turn));
    driver->Pump(Clock(to));
  }
  double Time() const { return ToSeconds(driver->status().time); }

  RunObserver nobody;
  std::unique_ptr<VirtualDriver> driver;
};

// LIVE-3.11: the factor holds from where it is set; a standing machine's time goes on, too.
TEST_F(VirtualDriverTest, ItsTimeFollowsTheClock) {
  Load("DELAY 10\n");
  EXPECT_EQ(driver->Pump(Clock(2.0)), Progress::kReached);
  EXPECT_EQ(Time(), 2.0);
  EXPECT_TRUE(driver->SetFactor(Clock(3.0), 10.0));
  EXPECT_EQ(Time(), 3.0);
  EXPECT_TRUE(driver->Start(Clock(3.5), {.program = 1}));
  GoOn(3.5, 4.0);
  EXPECT_EQ(Time(), 13.0);
  EXPECT_EQ(driver->status().run.time, FromSeconds(5.0));
  EXPECT_TRUE(driver->SetFactor(Clock(4.0), 0.1));
  GoOn(4.0, 14.0);
  EXPECT_EQ(Time(), 14.0);
  GoOn(14.0, 23.95);
  EXPECT_TRUE(driver->Order(Clock(24.0), StopRun{}));  // stamped when it acts
  EXPECT_EQ(driver->status().run.time, FromSeconds(7.0));
  EXPECT_EQ(driver->status().state, MachineState::kHeld);
  for (const double factor : {0.05, 101.0, -1.0})
    EXPECT_FALSE(driver->SetFactor(Clock(24.0), factor)) << factor;
  const Status refused = driver->SetFactor(Clock(24.0), 100.5);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(refused.error().detail, "a factor of 100.5: it is 0.1 to 100");
  EXPECT_EQ(driver->factor(), 0.1);
  EXPECT_TRUE(driver->SetFactor(Clock(24.0), 100.0));
  EXPECT_EQ(driver->factor(), 100.0);
  EXPECT_TRUE(driver->capabilities().inputs);
}

// LIVE-3.14: what cannot be done in time is done all the same, and its time goes on from there. The
// loop takes no time: a turn is 20,000 instructions.
TEST_F(VirtualDriverTest, LateByMoreThanItMakesUpFor) {
  Load(
      "VI[1] = 0\nVI[2] = 0\n10 VI[1] = VI[1] + 1\nIF VI[1] < 30000 THEN 10\nDELAY 1\nVI[2] = 1\n");
  EXPECT_TRUE(driver->Start(Clock(0.0), {.program = 1}));
  EXPECT_EQ(driver->Pump(Clock(0.05)), Progress::kMoreWork);
  EXPECT_EQ(driver->Pump(Clock(0.1)), Progress::kMoreWork);
  EXPECT_EQ(driver->TakeLost(), SimTime(0));  // it may still make up for that
  EXPECT_EQ(driver->Pump(Clock(0.15)), Progress::kMoreWork);
  EXPECT_EQ(Time(), 0.0);
  EXPECT_EQ(driver->TakeLost(), FromSeconds(0.15));
  double clock = 0.15;
  while (driver->Pump(Clock(clock)) == Progress::kMoreWork) {
  }
  GoOn(clock, clock + 0.95);
  driver->Pump(Clock(clock + 1.0) - SimTime(1));
  EXPECT_EQ(driver->machine().ReadVariable("VI[2]")->text, "0");
  driver->Pump(Clock(clock + 1.0));
  EXPECT_EQ(driver->machine().ReadVariable("VI[2]")->text, "1");
  EXPECT_EQ(driver->TakeLost(), SimTime(0));
}

// LIVE-3.14: twenty seconds in which nobody called are no time of a machine that runs, and of one
// that stands they are.
TEST_F(VirtualDriverTest, NeverJumpsInARun) {
  Load("DELAY 10\n");
  driver->Pump(Clock(20.0));
  EXPECT_EQ(Time(), 20.0);
  EXPECT_EQ(driver->TakeLost(), SimTime(0));
  EXPECT_TRUE(driver->Start(Clock(20.0), {.program = 1}));
  driver->Pump(Clock(20.05));
  driver->Pump(Clock(40.05));
  EXPECT_EQ(Time(), 20.05);
  EXPECT_EQ(driver->TakeLost(), FromSeconds(20.0));
  driver->Pump(Clock(40.1));
  EXPECT_EQ(Time(), 20.1);
}

// LIVE-3.14: 100 ms behind the time for which whoever drives it may sleep are made up for; more are
// not.
TEST_F(VirtualDriverTest, ItIsLateByWhatComesBehindASleep) {
  Load("DELAY 10\n");
  EXPECT_TRUE(driver->Start(Clock(20.0), {.program = 1}));
  const SimTime begun = driver->machine().time();
  driver->Pump(Clock(20.1255));
  EXPECT_EQ(driver->machine().time(), begun + FromSeconds(0.1255));
  driver->Pump(Clock(20.251) + SimTime(1));
  EXPECT_EQ(driver->machine().time(), begun + FromSeconds(0.1255));
  EXPECT_EQ(driver->TakeLost(), FromSeconds(0.1255) + SimTime(1));
}

// LIVE-5.04: as long as it waits its time stands, none of that is lost, and none is made up for.
TEST_F(VirtualDriverTest, TimeThatItWaitsIsNoneOfIts) {
  Load("DELAY 10\n");
  EXPECT_TRUE(driver->Start(Clock(1.0), {.program = 1}));
  const SimTime begun = driver->machine().time();
  driver->Wait(true, Clock(1.0));
  driver->Pump(Clock(1.04));
  driver->Pump(Clock(9.0));
  EXPECT_EQ(driver->machine().time(), begun);
  driver->Wait(false, Clock(9.0));
  driver->Pump(Clock(9.05));
  EXPECT_EQ(driver->machine().time(), begun + FromSeconds(0.05));
  EXPECT_EQ(driver->TakeLost(), SimTime(0));
}

// The same when nobody called meanwhile; and not to wait when it does not is nothing.
TEST_F(VirtualDriverTest, WaitsWithoutATurn) {
  Load("DELAY 10\n");
  EXPECT_TRUE(driver->Start(Clock(1.0), {.program = 1}));
  const SimTime begun = driver->machine().time();
  driver->Wait(true, Clock(1.0));
  driver->Wait(false, Clock(9.0));
  driver->Pump(Clock(9.05));
  EXPECT_EQ(driver->machine().time(), begun + FromSeconds(0.05));
  driver->Wait(false, Clock(9.08));
  driver->Pump(Clock(9.1));
  EXPECT_EQ(driver->machine().time(), begun + FromSeconds(0.1));
  EXPECT_EQ(driver->TakeLost(), SimTime(0));
}

// LIVE-3.14, LF-5: nor by hand: a key does not run on while nobody called.
TEST_F(VirtualDriverTest, NeverJumpsByHand) {
  Load("DELAY 10\n");
  EXPECT_TRUE(driver->Order(Clock(1.0), ChangeMode{Mode::kManual}));
  EXPECT_TRUE(driver->Order(Clock(1.0), PressJog{}));
  GoOn(1.0, 1.5);
  EXPECT_EQ(Time(), 1.5);
  driver->Pump(Clock(21.5));
  EXPECT_EQ(Time(), 1.5);
  EXPECT_TRUE(driver->Order(Clock(21.5), ReleaseJog{}));
  GoOn(21.5, 22.0);
  driver->Pump(Clock(32.0));
  EXPECT_EQ(Time(), 12.0);
}

}  // namespace
}  // namespace rmlcell::machine
