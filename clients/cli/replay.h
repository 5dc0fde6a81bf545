#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "clients/cli/remote.h"

namespace rmlcell::cli {

struct ReplayRequest {
  std::string what;                  // a file, "jobs/17", "17", "machines/optimo-1"
  std::optional<std::int64_t> from;  // ns of the machine
  std::optional<std::int64_t> to;
  std::string output;  // a file for the recording; empty: it is not kept
};

// Plays what a machine did again, and says whether it comes out the same.
int Replay(const Remote& remote, const ReplayRequest& request);

}  // namespace rmlcell::cli
