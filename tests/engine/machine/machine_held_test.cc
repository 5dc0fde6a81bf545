// A held run on a machine that keys move meanwhile: the run stays open, is asked for where it
// stands, and goes on from there.
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <sstream>

#include "tests/engine/machine/held_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

// LIVE-2.10: HELD + jog is JOGGING, at rest HELD again; the run stays open, and the status shows
// where the axes are.
TEST_F(HeldTest, KeysMoveTheMachineAndTheRunStaysOpen) {
  LoadHeld(kCorner, 5.0);
  const motion::AxisPose held = Axes();
  const std::int64_t run = machine->status().open->number;
  Good(PressJog{.key = kHeldYPlus});
  EXPECT_EQ(state(), MachineState::kJogging);
  GoOnFor(1.0);
  EXPECT_NEAR(machine->status().run.tip_speed_mm_s, 200.0, 1e-9);
  EXPECT_NEAR(Axes().column.y(), held.column.y() + 185.0, 1e-9);
  EXPECT_EQ(machine->status().open->number, run);
  EXPECT_NEAR(machine->run_on()->mm, 15.0, 1e-9);
  Good(ReleaseJog{kHeldYPlus});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_NEAR(Axes().column.y(), held.column.y() + 200.0, 1e-9);
  EXPECT_EQ(Axes().column.x(), held.column.x());
  EXPECT_EQ(machine->status().open->number, run);
  EXPECT_TRUE(machine->TakeRunsOver().empty());
}

// LIVE-5.06: the console is asked, with the displacement; accepted, the MOVE goes from where the
// machine stands to its old end (OPT-6.42).
TEST_F(HeldTest, ResumeAsksAndThenGoesFromThere) {
  LoadHeld(kCorner, 5.0);
  Jog(kHeldYPlus, 1.0);
  Jog(kHeldBPlus, 0.5);
  BackInRemote();
  const std::string refused = Refused(ResumeRun{});
  EXPECT_THAT(refused, HasSubstr("CELL-E9425 it was moved in Y by 200.000 mm, B by "));
  EXPECT_THAT(refused, HasSubstr(" rad"));
  EXPECT_EQ(state(), MachineState::kHeld);
  const motion::MachinePoint from = Tip();
  Good(ResumeRun{.accept_displaced = true});
  EXPECT_EQ(state(), MachineState::kRunning);
  const motion::MachinePoint to(521.02, 2201.2, -350.0);
  GoOnFor(2.0);
  const motion::MachineVector way = (to - from).normalized();
  const motion::MachineVector gone = Tip() - from;
  EXPECT_GT(gone.norm(), 50.0);
  EXPECT_NEAR(gone.cross(way).norm(), 0.0, 1e-3);  // targets are floats
  EXPECT_EQ(machine->status().run.place.step, 4);
  while (machine->status().run.place.step == 4) GoOnFor(0.001);
  EXPECT_NEAR((Tip() - to).norm(), 0.0, 0.1);
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR((Tip() - motion::MachinePoint(521.02, 2301.2, -350.0)).norm(), 0.0, 1e-3);
  EXPECT_NEAR(Axes().b_rad, 0.0, 1e-9);
}

// LIVE-5.06: what stands where it was is not asked for; nor is what is moved back.
TEST_F(HeldTest, MovedBackNobodyIsAsked) {
  LoadHeld(kCorner, 5.0);
  Jog(kHeldXPlus, 0.5);
  Jog(kHeldXMinus, 0.5);
  BackInRemote();
  Good(ResumeRun{});
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// LIVE-5.06: a hundredth of a millimetre is nothing, more is.
TEST_F(HeldTest, HowFarIsAsked) {
  LoadHeld(kCorner, 5.0);
  Good(ChangeOverride{10.0});  // 0.25 mm/s
  Jog(kHeldXPlus, 0.02);
  BackInRemote();
  Good(ResumeRun{});
  LoadHeld(kCorner, 5.0);
  Good(ChangeOverride{10.0});
  Jog(kHeldXPlus, 0.06);
  BackInRemote();
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9425 it was moved in X by 0.015 mm"));
}

// LIVE-5.06: each axis that was moved is named, in its unit; 200 mm/s, 40 % of a turn in a second.
TEST_F(HeldTest, EveryAxisThatWasMovedIsNamed) {
  LoadHeld(kCorner, 5.0);
  for (const JogAxis axis : {JogAxis::kX, JogAxis::kY, JogAxis::kZ, JogAxis::kA, JogAxis::kB})
    Jog({axis, true}, 0.5);
  BackInRemote();
  EXPECT_EQ(Refused(ResumeRun{}),
            "CELL-E9425 it was moved in X by 100.000 mm, Y by 100.000 mm, Z by 100.000 mm, A by "
            "1.2566 rad, B by 1.2566 rad");
}

// LIVE-5.06: the START key at the machine asks nothing.
TEST_F(HeldTest, TheStartKeyAsksNothing) {
  Load({kCorner});
  Good(ChangeMode{Mode::kCycle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(5.0));
  Good(ChangeMode{Mode::kManual});
  GoOnFor(20.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  Jog(kHeldZPlus, 1.0);
  Good(ChangeMode{Mode::kCycle});
  ASSERT_TRUE(machine->PressKey("START"));
  EXPECT_EQ(state(), MachineState::kRunning);
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// OPT-4.17, OPT-6.42: behind a HOLD, between two MOVEs, the next one begins where the machine
// stands.
TEST_F(HeldTest, TheNextMoveBeginsWhereItStands) {
  Load({kCorner});
  Good(ChangeMode{Mode::kCycle});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(5.0));
  Good(HoldRun{});
  GoOnFor(20.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_NEAR((Tip() - motion::MachinePoint(521.02, 2201.2, -350.0)).norm(), 0.0, 1e-3);
  Good(ChangeMode{Mode::kManual});
  Good(ChangeOverride{145.0});
  Jog(kHeldXPlus, 1.0);
  Good(ChangeMode{Mode::kCycle});
  Good(ResumeRun{.source = StartSource::kPanel});
  GoOnFor(0.5);
  EXPECT_EQ(machine->status().run.place.step, 5);
  const motion::MachineVector way = motion::MachineVector(-200.0, 100.0, 0.0).normalized();
  const motion::MachineVector gone = Tip() - motion::MachinePoint(721.02, 2201.2, -350.0);
  EXPECT_GT(gone.norm(), 5.0);
  EXPECT_NEAR(gone.cross(way).norm(), 0.0, 1e-3);  // targets are floats
}

// OPT-6.42: an arc goes from the new position to the old end through the old via point.
TEST_F(HeldTest, AnArcGoesThroughItsViaPoint) {
  LoadHeld(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (500., 2000., -350., 0., 0.)\n"
      "PATH CIR\nMOVE (700., 2000., -350., 0., 0.)/VIA (600., 2100., -350., 0., 0.)\n",
      14.0);
  EXPECT_EQ(machine->status().run.place.step, 6);
  ASSERT_GT(Tip().x(), 500.0);
  Jog(kHeldXMinus, 0.5);
  BackInRemote();
  const motion::MachinePoint from = Tip();
  Good(ResumeRun{.accept_displaced = true});
  // The circle through `from`, (600, 2100) and (700, 2000): its centre lies on x - y = -1400.
  const double fx = from.x();
  const double fy = from.y();
  // (x - fx)^2 + (y - fy)^2 = (x - 700)^2 + (y - 2000)^2 with y = x + 1400.
  const double left = 2.0 * (700.0 - fx) + 2.0 * (2000.0 - fy);
  const double right =
      700.0 * 700.0 - fx * fx + 2000.0 * 2000.0 - fy * fy - 2.0 * 1400.0 * (2000.0 - fy);
  const double cx = right / left;
  const motion::MachinePoint centre(cx, cx + 1400.0, -350.0);
  const double radius = (from - centre).norm();
  double nearest = 1e9;
  for (int n = 0; n < 2000 && machine->open_run() != nullptr; ++n) {
    EXPECT_NEAR((Tip() - centre).norm(), radius, 1e-2);
    nearest = std::min(nearest, (Tip() - motion::MachinePoint(600.0, 2100.0, -350.0)).norm());
    GoOnFor(0.01);
  }
  EXPECT_LT(nearest, 0.5);
  EXPECT_NEAR((Tip() - motion::MachinePoint(700.0, 2000.0, -350.0)).norm(), 0.0, 1e-3);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// LIVE-5.06: a hole goes back to where it was left, and on round it.
TEST_F(HeldTest, AHoleGoesBackToWhereItWasLeft) {
  LoadHeld(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (500., 2000., -350., 0., 0.)\nPATH HOLE (50.)\n"
      "MOVE (600., 2000., -350., 0., 0.)/VIA (600., 2000., -300., 0., 0.)\n",
      14.5);
  const motion::MachinePoint left = Tip();
  const motion::MachinePoint centre(600.0, 2000.0, -350.0);
  ASSERT_NEAR((left - centre).norm(), 50.0, 1e-6);
  Jog(kHeldZPlus, 0.5);
  Jog(kHeldXPlus, 0.5);
  BackInRemote();
  const motion::MachinePoint from = Tip();
  Good(ResumeRun{.accept_displaced = true});
  const motion::MachineVector way = (left - from).normalized();
  while ((Tip() - from).norm() < 0.9 * (left - from).norm()) {
    EXPECT_NEAR((Tip() - from).cross(way).norm(), 0.0, 1e-6);
    GoOnFor(0.01);
    ASSERT_NE(machine->open_run(), nullptr);
  }
  while ((Tip() - left).norm() > 1e-3) {
    GoOnFor(0.001);
    ASSERT_NE(machine->open_run(), nullptr);
  }
  while (machine->open_run() != nullptr) {
    EXPECT_NEAR((Tip() - centre).norm(), 50.0, 0.01);
    GoOnFor(0.01);
  }
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// OPT-B.08, OPT-6.42: a way from there that leaves the travel is an alarm, and nothing moves. The
// column goes up to Y 3,100; from (453, 3085) the circle goes up to Y 3,119.
TEST_F(HeldTest, AWayThatLeavesTheTravelIsAnAlarm) {
  LoadHeld(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (500., 2790., -350., 0., 0.)\n"
      "PATH CIR\nMOVE (1100., 2790., -350., 0., 0.)/VIA (800., 3090., -350., 0., 0.)\n",
      26.0);
  ASSERT_EQ(machine->status().run.place.step, 6);
  Jog(kHeldXMinus, 2.0);
  BackInRemote();
  const motion::AxisPose at = Axes();
  Good(ResumeRun{.accept_displaced = true});
  GoOnFor(1.0);
  EXPECT_EQ(Axes(), at);
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.code, ErrorCode::kTargetOutOfTravel);
  EXPECT_EQ(over.outcome.place.step, 6);
}

// LIVE-2.10: RESUME while it jogs, or comes to rest, is refused; ABORT ends the run, and it comes
// to rest.
TEST_F(HeldTest, WhatIsPossibleMeanwhile) {
  LoadHeld(kCorner, 5.0);
  Good(PressJog{.key = kHeldYPlus});
  GoOnFor(1.0);
  EXPECT_THAT(Refused(ResumeRun{.source = StartSource::kPanel}), HasSubstr("CELL-E9421"));
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9421"));
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9421"));
  Good(ReleaseJog{kHeldYPlus});
  EXPECT_THAT(Refused(ResumeRun{.accept_displaced = true}), HasSubstr("CELL-E94"));
  GoOnFor(1.0);
  Good(PressJog{.key = kHeldYPlus});
  GoOnFor(1.0);
  const double y = Axes().column.y();
  Good(AbortRun{});
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(Axes().column.y(), y + 15.0, 1e-9);
}

// LIVE-2.10: a key that was let go brakes: meanwhile nothing goes on, in REMOTE neither.
TEST_F(HeldTest, NothingGoesOnWhileAKeyStillBrakes) {
  LoadHeld(kCorner, 5.0);
  Good(PressJog{.key = kHeldYPlus});
  GoOnFor(1.0);
  Good(ReleaseJog{kHeldYPlus});
  BackInRemote();
  ASSERT_EQ(state(), MachineState::kStopping);
  EXPECT_EQ(Refused(ResumeRun{.accept_displaced = true}),
            "CELL-E9421 the machine is STOPPING: it moves by hand; release the keys first");
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{.accept_displaced = true});
  EXPECT_EQ(state(), MachineState::kRunning);
}

// LIVE-2.10: an emergency stop freezes it where it is and ends the run.
TEST_F(HeldTest, AnEmergencyStopEndsBoth) {
  LoadHeld(kCorner, 5.0);
  Good(PressJog{.key = kHeldYPlus});
  GoOnFor(1.0);
  const motion::AxisPose at = Axes();
  Good(EmergencyStop{});
  EXPECT_EQ(state(), MachineState::kAlarm);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kFailed);
  GoOnFor(1.0);
  EXPECT_EQ(Axes(), at);
}

// LIVE-3.23: a mark has the axes where they are.
TEST_F(HeldTest, AMarkHasTheAxesWhereTheyAre) {
  LoadHeld(kCorner, 5.0);
  Good(PressJog{.key = kHeldYPlus});
  GoOnFor(1.0);
  const motion::AxisPose at = Axes();
  const std::string mark = machine->Save();
  Load({kCorner}, mark);
  EXPECT_EQ(Axes(), at);
}

// LIVE-6.05: where a run is on its way to a step, the way is the one that was looked at.
TEST_F(HeldTest, OnTheWayToAStepNothingIsMoved) {
  Load({kCorner});
  Good(StartAtStep{.program = 1, .target = {.at = {1, 5}}, .acknowledged = {"clamps"}});
  GoOnFor(0.5);
  ASSERT_TRUE(machine->status().run.approaching);
  Good(StopRun{});
  GoOnFor(5.0);
  Good(ChangeMode{Mode::kManual});
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(PressJog{.key = kHeldYPlus}), HasSubstr("CELL-E9421"));
  // LIVE-7.03: a key that is pressed and let go at once is refused as well.
  const Result<KeyAnswer> tap = machine->PressKey("Y+");
  ASSERT_TRUE(tap);
  EXPECT_EQ(tap->message, ErrorCode::kKeyNotEnabled);
}

// LIVE-5.06, LIVE-3.11, OPT-4.49: whatever is stopped and moved where, by keys, HOME or ZERO, the
// axes never jump, the run comes to its end, and nothing depends on how time is divided.
class HeldAnywhereTest : public HeldTest {
 protected:
  int below(unsigned n) { return static_cast<int>(random_() % n); }

  std::string Program() {
    std::ostringstream program;
    program << "COORD ABSOL\nSPEED " << 15 + below(40) << "\n";
    for (int n = 0; n < 6; ++n) {
      const double x = 300.0 + below(600);
      const double y = 1800.0 + below(600);
      const double b = 0.001 * below(800);
      const std::string pose = ", " + std::to_string(y) + ", -400., 0., " + std::to_string(b) + ")";
      switch (below(5)) {
        case 0:
          program << "PATH LIN\nMOVE (" << x << pose << (below(2) != 0 ? "/FLY\n" : "\n");
          break;
        case 1:
          program << "PATH PTP\nMOVE (" << x << pose << (below(2) != 0 ? "/FLY\n" : "\n");
          break;
        case 2:
          program << "PATH CIR\nMOVE (" << x << pose << "/VIA (" << x + 150.0 << ", " << y + 70.0
                  << ", -380., 0., 0.)\n";
          break;
        case 3:
          program << "PATH HOLE (40.)\nMOVE (" << x << ", " << y << ", -400., 0., 0.)/VIA (" << x
                  << ", " << y << ", -300., 0., 0.)\n";
          break;
        default:
          program << "PATH LIN\nMOVE (" << x << pose << "/NEXT\nVI[2] = VI[2] + 1\n";
          break;
      }
    }
    program << "PATH LIN\nMOVE (500., 2000., -400., 0., 0.)\n";
    return program.str();
  }

  // A jog key, HOME or ZERO; sometimes another override on the way, and a STOP.
  void MoveByHand(double part_s) {
    const int which = below(4);
    const JogKey key{static_cast<JogAxis>(below(5)), below(2) != 0};
    const KeyAction press = KeyAction::kPress;
    if (which < 2) {
      Good(PressJog{.key = key, .reference = static_cast<JogReference>(below(3))});
    } else if (which == 2) {
      EXPECT_FALSE(machine->PressKey("HOME", press)->message);
    } else {
      Good(ZeroAxes{});
    }
    GoOnSmoothly(0.001 * below(700), part_s);
    if (below(3) == 0) Good(ChangeOverride{40.0 + below(100)});
    GoOnSmoothly(0.001 * below(which < 2 ? 100 : 9000), part_s);
    if (below(4) == 0) Good(StopRun{});
    if (which < 2) {
      Good(ReleaseJog{key});
    } else if (which == 2) {
      EXPECT_TRUE(machine->PressKey("HOME", KeyAction::kRelease));
    }
    made_ += machine->Save();
    GoOnSmoothly(which == 3 ? 80.0 : 1.0, part_s);
    made_ += machine->Save();
    EXPECT_EQ(state(), MachineState::kHeld);
  }

  // The marks on the way, where it ends, and when.
  std::string Run(unsigned seed, double part_s) {
    random_.seed(seed);
    made_.clear();
    const std::string program = Program();
    Load({program});
    const bool cycle = seed % 2 == 0;  // HOLD there, STOP in REMOTE
    const StartSource source = cycle ? StartSource::kPanel : StartSource::kConsole;
    if (cycle) Good(ChangeMode{Mode::kCycle});
    Good(StartRun{.program = 1, .source = source});
    GoOnSmoothly(0.001 * (500 + below(20000)), part_s);
    if (machine->open_run() == nullptr) return "over";
    Good(ChangeMode{Mode::kManual});
    Good(ChangeOverride{70.0 + below(70)});
    GoOnSmoothly(20.0, part_s);
    if (state() != MachineState::kHeld) return "over";
    for (int n = below(3); n >= 0; --n) MoveByHand(part_s);
    Good(ChangeMode{cycle ? Mode::kCycle : Mode::kRemote});
    Good(ResumeRun{.source = source, .accept_displaced = true});
    GoOnSmoothly(400.0, part_s);
    const RunOver over = Over();
    const bool arc = over.outcome.code == ErrorCode::kTargetOutOfTravel;
    EXPECT_TRUE(over.outcome.kind == OutcomeKind::kCompleted || arc)
        << seed << " " << over.outcome.detail << "\n"
        << program;
    std::ostringstream end;
    end.precision(12);
    const motion::AxisPose at = Axes();
    end << made_ << over.lasted.count() << " " << at.column.transpose() << " " << at.a_rad << " "
        << at.b_rad;
    return end.str();
  }
  void GoOnSmoothly(double seconds, double part_s) {
    const SimTime until = machine->time() + At(seconds);
    while (machine->time() < until) {
      const motion::AxisPose before = Axes();
      const double dt = std::min(part_s, ToSeconds(until - machine->time()));
      GoOn(machine->time() + std::max(At(dt), SimTime(1)));
      const motion::AxisPose after = Axes();
      // No axis is faster than 1,000 mm/s: VMAX is 500 and a head of 300 mm turns beside it.
      if ((after.column - before.column).norm() > 2000.0 * dt + 1e-6) {
        ADD_FAILURE() << "a jump of " << (after.column - before.column).norm() << " mm in " << dt;
        return;
      }
    }
  }

 private:
  std::mt19937 random_;
  std::string made_;
};

TEST_F(HeldAnywhereTest, NothingJumpsAndNothingDependsOnHowTimeIsDivided) {
  int moved = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const std::string one = Run(seed, 0.02);
    const std::string other = Run(seed, 0.33);
    EXPECT_EQ(one, other) << seed;
    if (one != "over") ++moved;
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_GT(moved, 30);
}

// LIVE-8.03: of a mill nobody knows that it can be moved in a pause.
class HeldMillTest : public MachineTest {
 protected:
  HeldMillTest() : MachineTest("rml1") {}
};

TEST_F(HeldMillTest, AMillIsNotMoved) {
  Load({"PA;PU1000,1000;!NR;PU2000,2000;"});
  Start();
  GoOn(At(20.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(PressJog{.key = kHeldXPlus}), HasSubstr("CELL-E9421"));
  Good(ResumeRun{});
  GoOn(At(40.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// LIVE-5.06: so is a turn by more than 0.0001 rad: at 10 % the head turns by 0.05 % of a turn in a
// second.
TEST_F(HeldTest, HowFarATurnIsAsked) {
  LoadHeld(kCorner, 5.0);
  Good(ChangeOverride{10.0});
  Jog(kHeldBPlus, 0.02);
  BackInRemote();
  Good(ResumeRun{});
  LoadHeld(kCorner, 5.0);
  Good(ChangeOverride{10.0});
  Jog(kHeldBPlus, 0.5);
  BackInRemote();
  EXPECT_EQ(Refused(ResumeRun{}), "CELL-E9425 it was moved in B by 0.0016 rad");
  LoadHeld(kCorner, 5.0);
  Good(ChangeOverride{10.0});
  Jog(kHeldBPlus, 0.05);  // 0.00016 rad
  BackInRemote();
  EXPECT_EQ(Refused(ResumeRun{}), "CELL-E9425 it was moved in B by 0.0002 rad");
}

// LIVE-5.06: it is asked once: not of the next hold, nor of the next run. LIVE-6.01: who simulates
// the run knows nothing of it, so that it has no base any more.
TEST_F(HeldTest, ADisplacementIsAskedOnce) {
  LoadHeld(kCorner, 5.0);
  EXPECT_TRUE(machine->base());
  Jog(kHeldYPlus, 1.0);
  BackInRemote();
  Good(ResumeRun{.accept_displaced = true});
  EXPECT_FALSE(machine->base());
  GoOnFor(2.0);
  Good(StopRun{});
  GoOnFor(5.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{});
  EXPECT_EQ(state(), MachineState::kRunning);

  LoadHeld(kCorner, 5.0);
  Jog(kHeldYPlus, 1.0);
  Good(AbortRun{});
  Over();
  BackInRemote();
  Start();
  GoOnFor(3.0);
  Good(StopRun{});
  GoOnFor(5.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{});
  EXPECT_EQ(state(), MachineState::kRunning);
}

}  // namespace
}  // namespace rmlcell::machine
