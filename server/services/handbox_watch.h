#pragma once

#include <memory>

#include "rmlcell/v1/handbox.pb.h"
#include "server/services/pull_stream.h"
#include "storage/store.h"

namespace rmlcell::server {

class EventFeed;
class Hosts;

struct HandboxWatchNeeds {
  Executor& executor;
  OpenStreams& open;
  storage::Store& store;
  EventFeed& feed;
  Hosts* hosts = nullptr;  // null: no machine lives
};

// What is to be seen at the handbox of a machine, now and whenever it changes; latest wins.
// LIVE-7.02. Ends with CellNotLive for a machine without one, or that does not live.
std::shared_ptr<PullStream<v1::WatchHandboxResponse>> MakeHandboxWatch(
    const HandboxWatchNeeds& needs, const v1::WatchHandboxRequest& request);

}  // namespace rmlcell::server
