#pragma once

#include <string>
#include <vector>

namespace rmlcell::machine {

struct OutputNow {
  std::string name{};
  double value = 0.0;

  bool operator==(const OutputNow&) const = default;
};

// What a machine holds on to outside: what is at its terminals, not the images that a program
// reads (OPT-6.24).
struct MachineOutputs {
  // What is not off: "OL[3]" 1, "OA[1]" 2.5, "shutter" 1 (open), "rotary_table" 90 (degrees).
  std::vector<OutputNow> on{};
  double power_percent = 0.0;  // of a beam that is on
  int laser_schedule = 0;      // that is selected; 0: none
};

}  // namespace rmlcell::machine
