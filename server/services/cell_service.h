#pragma once

#include <string>

#include "rmlcell/v1/cell.grpc.pb.h"
#include "server/services/call.h"
#include "server/services/cell_watch.h"
#include "storage/store.h"

namespace rmlcell::server {

class Dispatcher;
struct Config;

// WatchCell gives bytes: messages of events are made once for all who watch.
class CellService final
    : public v1::CellService::WithRawCallbackMethod_WatchCell<v1::CellService::CallbackService> {
 public:
  // `watch.records.store` is the store of the cell.
  CellService(CallNeeds needs, CellWatchNeeds watch, const Dispatcher& dispatcher,
              const Config& config);

  grpc::ServerUnaryReactor* GetCell(grpc::CallbackServerContext* context,
                                    const v1::GetCellRequest* request, v1::Cell* response) override;

  grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchCell(grpc::CallbackServerContext* context,
                                                        const grpc::ByteBuffer* request) override;
  grpc::ServerUnaryReactor* UpdateWatch(grpc::CallbackServerContext* context,
                                        const v1::UpdateWatchRequest* request,
                                        google::protobuf::Empty* response) override;

 private:
  CallNeeds needs_;
  CellWatchNeeds watch_needs_;
  const Dispatcher& dispatcher_;
  const Config& config_;
  storage::WallTime started_at_;
  std::string page_etag_;
};

}  // namespace rmlcell::server
