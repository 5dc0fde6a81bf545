#pragma once

#include <set>
#include <string>
#include <vector>

#include "rmlcell/v1/handbox.pb.h"
#include "rmlcell/v1/machine_status.pb.h"

namespace rmlcell::cli {

// What a screen with a handbox shows.
struct HandboxView {
  v1::HandboxPanel panel{};
  v1::MachineStatus status{};
  std::set<std::string> down{};  // keys that are held here
  std::string note{};            // what came of the last key, where there is something to say
  bool flash = false;            // what flashes is dark now
  bool marks = true;             // bold and reversed; else plain characters alone
  int rows = 24;
  int columns = 80;
};

// Large enough for the buttons; else it says so, and no button is to be seen.
bool HasRoom(const HandboxView& view);

// One string for each line of the terminal, without line ends. The same view gives the same lines.
std::vector<std::string> HandboxLines(const HandboxView& view);

// What a terminal is sent so that it shows `now` in place of `before`, line by line.
std::string Redrawn(const std::vector<std::string>& before, const std::vector<std::string>& now);

}  // namespace rmlcell::cli
