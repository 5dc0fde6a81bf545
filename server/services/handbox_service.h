#pragma once

#include "rmlcell/v1/handbox.grpc.pb.h"
#include "server/services/handbox_watch.h"
#include "server/services/later.h"

namespace rmlcell::server {

// The handbox of a machine that lives: whoever has control presses its keys, anybody may look.
class HandboxService final : public v1::HandboxService::CallbackService {
 public:
  HandboxService(CallNeeds needs, HandboxWatchNeeds watch) : needs_(needs), watch_needs_(watch) {}

  grpc::ServerUnaryReactor* CreateHandboxSession(grpc::CallbackServerContext* context,
                                                 const v1::CreateHandboxSessionRequest* request,
                                                 v1::HandboxSession* response) override;
  grpc::ServerUnaryReactor* PressKey(grpc::CallbackServerContext* context,
                                     const v1::PressKeyRequest* request,
                                     v1::PressKeyResponse* response) override;
  grpc::ServerUnaryReactor* HeartbeatHandbox(grpc::CallbackServerContext* context,
                                             const v1::HeartbeatHandboxRequest* request,
                                             v1::HeartbeatResponse* response) override;
  grpc::ServerUnaryReactor* DeleteHandboxSession(grpc::CallbackServerContext* context,
                                                 const v1::DeleteHandboxSessionRequest* request,
                                                 google::protobuf::Empty* response) override;
  grpc::ServerWriteReactor<v1::WatchHandboxResponse>* WatchHandbox(
      grpc::CallbackServerContext* context, const v1::WatchHandboxRequest* request) override;

  RMLCELL_LATER_BOTH("HandboxService", HandboxStream)
  RMLCELL_LATER("HandboxService", ListTeachEntries, v1::ListTeachEntriesResponse)
  RMLCELL_LATER("HandboxService", UndoTeachEntries, v1::UndoTeachEntriesResponse)

 private:
  template <class Request, class Response, class Fill, class Take>
  grpc::ServerUnaryReactor* Order(grpc::CallbackServerContext* context, const Request* request,
                                  const std::string& machine, Response* response,
                                  std::string_view method, Fill fill, Take take);

  CallNeeds needs_;
  HandboxWatchNeeds watch_needs_;
};

}  // namespace rmlcell::server
