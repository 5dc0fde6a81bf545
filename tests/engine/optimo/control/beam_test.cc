// The tables of beam.h, cell by cell.
#include "engine/optimo/machine/beam.h"

#include <gtest/gtest.h>

#include <vector>

namespace rmlcell::optimo {
namespace {

constexpr machine::PowerBySpeed kPower{.constant_percent = 80.0};

Beam InStage(BeamStage stage, const Beam& from) {
  switch (stage) {
    case BeamStage::kOff:
      break;
    case BeamStage::kOn:
      return from.On(kPower);
    case BeamStage::kTaken:
      return from.Taken();
    case BeamStage::kHeld:
      return from.On(kPower).Held();
  }
  return from;
}

// Every way to be in that stage: with the shutter as it was found, opened by an earlier cut, or
// closed by the door, which stands open or is closed again.
std::vector<Beam> AllIn(BeamStage stage, Laser laser) {
  const Beam fresh(laser);
  const Beam used = fresh.On(kPower).Off();
  std::vector<Beam> all;
  for (const Beam& before : {fresh, used}) {
    const Beam beam = InStage(stage, before);
    all.push_back(beam);
    if (stage == BeamStage::kOn) continue;  // the door takes the beam
    all.push_back(beam.DoorOpened());
    all.push_back(beam.DoorOpened().DoorClosed());
  }
  return all;
}

constexpr BeamStage kStages[] = {BeamStage::kOff, BeamStage::kOn, BeamStage::kTaken,
                                 BeamStage::kHeld};
constexpr Laser kLasers[] = {Laser::kArrow, Laser::kEfa51};

struct Row {
  BeamStage stage, on, off, taken, held, door_opened, door_closed, returned, shut_down;
};
constexpr auto kOff = BeamStage::kOff;
constexpr auto kOn = BeamStage::kOn;
constexpr auto kTaken = BeamStage::kTaken;
constexpr auto kHeld = BeamStage::kHeld;
constexpr Row kRows[] = {
    // stage  On  Off  Taken  Held  DoorOpened  DoorClosed  Returned  ShutDown
    {kOff, kOn, kOff, kTaken, kOff, kOff, kOff, kOff, kOff},
    {kOn, kOn, kOff, kTaken, kHeld, kHeld, kOn, kOn, kOff},
    {kTaken, kOn, kOff, kTaken, kTaken, kTaken, kTaken, kTaken, kOff},
    {kHeld, kOn, kOff, kTaken, kHeld, kHeld, kHeld, kOn, kOff},
};

TEST(Beam, GoesWhereItsTableHas) {
  for (const Row& row : kRows) {
    for (const Laser laser : kLasers) {
      for (const Beam& beam : AllIn(row.stage, laser)) {
        SCOPED_TRACE(static_cast<int>(row.stage));
        SCOPED_TRACE(beam.door_open() ? "door open" : "door closed");
        EXPECT_EQ(beam.stage(), row.stage);
        EXPECT_EQ(beam.On(kPower).stage(), beam.door_open() ? kHeld : row.on);
        EXPECT_EQ(beam.Off().stage(), row.off);
        EXPECT_EQ(beam.Taken().stage(), row.taken);
        EXPECT_EQ(beam.Held().stage(), row.held);
        EXPECT_EQ(beam.DoorOpened().stage(), row.door_opened);
        EXPECT_EQ(beam.DoorClosed().stage(), row.door_closed);
        EXPECT_EQ(beam.Returned().stage(), beam.door_open() ? row.stage : row.returned);
        EXPECT_EQ(beam.ShutDown().stage(), row.shut_down);
      }
    }
  }
}

// OPT-3.14, OPT-3.62: of an ARROW the beam opens the shutter, which stays open behind it; only the
// door and the end close it.
TEST(Beam, TheShutterOfAnArrow) {
  const Beam closed(Laser::kArrow);
  const Beam open = closed.On(kPower).Off();
  const Beam by_door = open.DoorOpened();
  ASSERT_EQ(closed.shutter(), Shutter::kClosed);
  ASSERT_EQ(open.shutter(), Shutter::kOpen);
  ASSERT_EQ(by_door.shutter(), Shutter::kClosedByDoor);
  const Beam again = by_door.DoorClosed();
  for (const Beam& beam : {closed, open, by_door, again}) {
    const Shutter was = beam.shutter();
    EXPECT_EQ(beam.Off().shutter(), was);
    EXPECT_EQ(beam.Taken().shutter(), was);
    EXPECT_EQ(beam.Held().shutter(), was);
    EXPECT_EQ(beam.DoorClosed().shutter(), was);
    EXPECT_EQ(beam.ShutDown().shutter(), Shutter::kClosed);
    EXPECT_EQ(beam.DoorOpened().shutter(), was == Shutter::kClosed ? was : Shutter::kClosedByDoor);
  }
  for (const Beam& beam : {closed, open, again}) {
    EXPECT_EQ(beam.On(kPower).shutter(), Shutter::kOpen);
    EXPECT_EQ(beam.On(kPower).Off().shutter(), Shutter::kOpen);
    EXPECT_EQ(beam.On(kPower).Taken().shutter(), Shutter::kOpen);
    EXPECT_EQ(beam.On(kPower).Held().shutter(), Shutter::kOpen);
    EXPECT_EQ(beam.On(kPower).DoorOpened().shutter(), Shutter::kClosedByDoor);
    EXPECT_EQ(beam.On(kPower).ShutDown().shutter(), Shutter::kClosed);
  }
  EXPECT_EQ(closed.Returned().shutter(), Shutter::kClosed);
  EXPECT_EQ(open.Returned().shutter(), Shutter::kOpen);
  EXPECT_EQ(again.Returned().shutter(), Shutter::kOpen);
  EXPECT_EQ(by_door.Returned().shutter(), Shutter::kClosedByDoor);
  EXPECT_EQ(by_door.On(kPower).shutter(), Shutter::kClosedByDoor);
  EXPECT_EQ(closed.DoorOpened().On(kPower).shutter(), Shutter::kClosed);
  // What comes on behind an open door opens its shutter at START.
  EXPECT_EQ(closed.DoorOpened().On(kPower).DoorClosed().Returned().shutter(), Shutter::kOpen);
}

// OPT-3.15: of an EFA-51 beam and shutter are one, in whatever stage and through whatever happens.
// OPT-3.17: of either the beam is on behind an open shutter only, and that is open behind a closed
// door only.
TEST(Beam, IsOnBehindAnOpenShutterAndAClosedDoor) {
  for (const Laser laser : kLasers) {
    for (const BeamStage stage : kStages) {
      for (const Beam& beam : AllIn(stage, laser)) {
        for (const Beam& next :
             {beam, beam.On(kPower), beam.Off(), beam.Taken(), beam.Held(), beam.DoorOpened(),
              beam.DoorClosed(), beam.Returned(), beam.ShutDown()}) {
          EXPECT_TRUE(!next.on() || next.shutter_open());
          EXPECT_FALSE(next.shutter_open() && next.door_open());
          EXPECT_TRUE(laser == Laser::kArrow || next.on() == next.shutter_open());
        }
      }
    }
  }
}

// OPT-B.56: START has something to bring back while the beam is held or the door closed the
// shutter.
TEST(Beam, WaitsForStart) {
  const Beam fresh(Laser::kArrow);
  EXPECT_FALSE(fresh.waits_for_start());
  EXPECT_FALSE(fresh.DoorOpened().waits_for_start());
  EXPECT_FALSE(fresh.On(kPower).waits_for_start());
  EXPECT_FALSE(fresh.On(kPower).Taken().Held().waits_for_start());
  EXPECT_TRUE(fresh.On(kPower).Held().waits_for_start());
  EXPECT_TRUE(fresh.On(kPower).Off().DoorOpened().waits_for_start());
  EXPECT_TRUE(fresh.On(kPower).Off().DoorOpened().DoorClosed().waits_for_start());
  EXPECT_FALSE(fresh.On(kPower).DoorOpened().DoorClosed().Returned().waits_for_start());
}

// OPT-3.62, OPT-3.21: it comes back with its power, or that of the pierce that ended meanwhile.
TEST(Beam, KeepsItsPower) {
  const Beam held = Beam(Laser::kArrow).On(kPower).Held();
  EXPECT_EQ(held.Returned().power(), kPower);
  constexpr machine::PowerBySpeed kRamp{.percent_per_mm_s = 1.5};
  EXPECT_EQ(held.WithPower(kRamp).stage(), BeamStage::kHeld);
  EXPECT_EQ(held.WithPower(kRamp).Returned().power(), kRamp);
}

}  // namespace
}  // namespace rmlcell::optimo
