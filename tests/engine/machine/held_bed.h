#pragma once

#include <string>

#include "tests/engine/machine/machine_bed.h"

// Runs that are held, on a machine that is moved meanwhile.
namespace rmlcell::machine {

inline constexpr JogKey kHeldXPlus{JogAxis::kX, true};
inline constexpr JogKey kHeldXMinus{JogAxis::kX, false};
inline constexpr JogKey kHeldYPlus{JogAxis::kY, true};
inline constexpr JogKey kHeldZPlus{JogAxis::kZ, true};
inline constexpr JogKey kHeldBPlus{JogAxis::kB, true};

// At 50 mm/s; from home, (21.02, 2201.2, -350) of the tip, in X first.
inline constexpr const char* kCorner =
    "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\n"
    "MOVE (521.02, 2301.2, -350., 0., 0.)\n";

class HeldTest : public MachineTest {
 protected:
  // In REMOTE, stopped at this time, then in MANUAL at 200 mm/s.
  void LoadHeld(const std::string& program, double stopped_s,
                const MachineInput& stop = StopRun{}) {
    Load({program});
    HoldAt(stopped_s, stop);
  }
  void HoldAt(double stopped_s, const MachineInput& stop = StopRun{}) {
    Start();
    GoOn(At(stopped_s));
    Good(stop);
    GoOnFor(10.0);
    ASSERT_EQ(state(), MachineState::kHeld);
    Good(ChangeMode{Mode::kManual});
    Good(ChangeOverride{145.0});
    ASSERT_EQ(state(), MachineState::kHeld);
  }
  void Jog(const JogKey& key, double seconds, JogReference reference = JogReference::kRobot) {
    Good(PressJog{.key = key, .reference = reference});
    EXPECT_EQ(state(), MachineState::kJogging);
    GoOnFor(seconds);
    Good(ReleaseJog{key});
    GoOnFor(1.0);
    EXPECT_EQ(state(), MachineState::kHeld);
  }
  void BackInRemote() {
    Good(ChangeMode{Mode::kRemote});
    Good(ChangeOverride{100.0});
  }
  motion::MachinePoint Tip() const { return machine->status().run.tip.tip; }
  motion::AxisPose Axes() const { return machine->status().run.axes; }
  void GoOnFor(double seconds) { GoOn(machine->time() + At(seconds)); }
};

}  // namespace rmlcell::machine
