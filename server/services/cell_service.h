#pragma once

#include <string>

#include "rmlcell/v1/cell.grpc.pb.h"
#include "server/services/later.h"
#include "storage/store.h"

namespace rmlcell::server {

class Dispatcher;
struct Config;

class CellService final : public v1::CellService::CallbackService {
 public:
  CellService(CallNeeds needs, storage::Store& store, const Dispatcher& dispatcher,
              const Config& config, std::string instance_id);

  grpc::ServerUnaryReactor* GetCell(grpc::CallbackServerContext* context,
                                    const v1::GetCellRequest* request, v1::Cell* response) override;

  RMLCELL_LATER_READ("CellService", WatchCell)
  RMLCELL_LATER("CellService", UpdateWatch, google::protobuf::Empty)

 private:
  CallNeeds needs_;
  storage::Store& store_;
  const Dispatcher& dispatcher_;
  const Config& config_;
  std::string instance_id_;
  storage::WallTime started_at_;
};

}  // namespace rmlcell::server
