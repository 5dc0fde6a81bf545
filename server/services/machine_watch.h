#pragma once

#include <memory>
#include <string>

#include "rmlcell/v1/machine.pb.h"
#include "server/base/steady_clock.h"
#include "server/services/pull_stream.h"
#include "storage/store.h"

namespace rmlcell::server {

class EventFeed;
class Hosts;

struct MachineWatchNeeds {
  Executor& executor;
  OpenStreams& open;
  storage::Store& store;
  EventFeed& feed;
  std::string instance_id;
  SteadyClock clock = SteadyTime;
  const Hosts* hosts = nullptr;  // none: machines stand as their jobs tell
};

// The status of one machine, now and whenever it changes. Ends with CellUnknownMachine when it is
// deleted.
std::shared_ptr<PullStream<v1::WatchMachineResponse>> MakeMachineWatch(
    const MachineWatchNeeds& needs, const v1::WatchMachineRequest& request);

}  // namespace rmlcell::server
