#pragma once

#include <string>

#include "clients/cli/remote.h"

namespace rmlcell::cli {

struct HandboxRequest {
  std::string machine;
  std::string take_over;  // why control is taken from whoever has it; empty: it is not
};

// The handbox of a machine that lives, on the whole terminal, until a person quits. LIVE-7.11
int Handbox(const Remote& remote, const HandboxRequest& request);

}  // namespace rmlcell::cli
