#pragma once

#include "engine/motion/jog/jog_drive.h"

namespace rmlcell::machine {

// How a machine that stands can be moved by hand: axes X Y Z A B, mm and rad.
struct HandMotion {
  motion::JogMachine machine{};
  motion::AxisValues plus{};   // speed of each key; 0: the machine has no such axis
  motion::AxisValues minus{};  // likewise, without sign
  motion::AxisValues least{};  // way of a key that is pressed and released at once
  bool tool_z_down = false;    // jog along the tool is reversed, Jog::tool_z_down

  // The faster one of each axis.
  motion::AxisValues key_speeds() const { return plus.cwiseMax(minus); }
};

// How far axes run on when a key is let go. LIVE-8.01
struct RunOn {
  double mm = 0.0;
  double rad = 0.0;

  bool operator==(const RunOn&) const = default;
};

}  // namespace rmlcell::machine
