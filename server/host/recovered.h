#pragma once

#include <vector>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_machine.h"

namespace rmlcell::server {

// The newest state that is durable, and what was told before it that the store does not have.
struct Recovered {
  bool known = false;
  v1::MachineMark mark{};
  std::vector<v1::JournalEntry> untold{};
  // "jobs/17": a job that was about to begin behind the mark; empty: none was.
  std::string begins{};
  bool begins_at_step = false;  // where another one was cut off, which the mark tells of
};

Recovered RecoveredFrom(const v1::HostWelcome& welcome, std::vector<v1::JournalEntry> journal);

// All that a host takes over of it.
HostMachine::Setup SetupOf(Recovered found);

}  // namespace rmlcell::server
