#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "rmlcell/v1/cell.pb.h"
#include "server/base/steady_clock.h"
#include "server/services/call.h"
#include "server/services/cell_snapshot.h"
#include "server/services/pull_stream.h"
#include "server/services/shared_log.h"
#include "server/services/watch_registry.h"

namespace rmlcell::server {

class EventFeed;

// What watches of the cell work with.
struct CellWatchNeeds {
  Executor& executor;
  OpenStreams& open;
  CellRecords records;
  EventFeed& feed;
  SharedLogs& logs;
  JobFactsBook& facts;
  WatchRegistry& registry;
  std::string instance_id;
  SteadyClock clock = SteadyTime;
  std::chrono::milliseconds bookmark_interval{5000};
};

// One stream over the log of the cell. A snapshot of each subscription first, or, where the client
// comes back with a number of this log, a bookmark; then every event exactly once and in order, and
// what stands for now while no event is to be told. Its messages (rmlcell.v1.WatchCellResponse) are
// serialised: those of events are shared with other watches.
std::shared_ptr<PullStream<grpc::ByteBuffer>> MakeCellWatch(const CellWatchNeeds& needs,
                                                            const v1::WatchCellRequest& request,
                                                            std::string caller);

// The call for one, serialised as it came.
grpc::ServerWriteReactor<grpc::ByteBuffer>* OpenCellWatch(
    const CallNeeds& call, const CellWatchNeeds& needs, const grpc::CallbackServerContext& context,
    const grpc::ByteBuffer& request);

}  // namespace rmlcell::server
