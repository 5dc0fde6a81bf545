#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/hand_motion.h"

namespace rmlcell::machine {

enum class CoverAct {
  kNone,       // nothing
  kPause,      // it comes to rest, and goes on when the cover is closed and somebody resumes it
  kEmergency,  // as an emergency stop
};

// What is to be seen at the machine itself: the handbox of an Optimo, the panel of a mill.
struct Panel {
  // One line, as wide as the display is; empty: it has none.
  std::string display{};
  bool flashing = false;  // the display, to ask for something
  // Those that are lit, by the names that stand beside them: "CYCLE", "POWER".
  std::vector<std::string_view> lamps{};
  // What the display tells in place of its default text.
  std::optional<ErrorCode> message{};
  // How far axes run on when a jog key of a handbox is let go; none: its keys move nothing now.
  std::optional<RunOn> run_on{};

  bool operator==(const Panel&) const = default;
};

}  // namespace rmlcell::machine
