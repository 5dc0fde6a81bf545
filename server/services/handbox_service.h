#pragma once

#include "rmlcell/v1/handbox.grpc.pb.h"
#include "server/machines/teach_book.h"
#include "server/services/call.h"
#include "server/services/handbox_watch.h"

namespace rmlcell::server {

// The handbox of a machine that lives: whoever has control presses its keys, anybody may look.
class HandboxService final : public v1::HandboxService::CallbackService {
 public:
  HandboxService(CallNeeds needs, HandboxWatchNeeds watch)
      : needs_(needs), watch_needs_(watch), taught_(watch.store) {}

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

  grpc::ServerBidiReactor<v1::HandboxStreamRequest, v1::HandboxStreamResponse>* HandboxStream(
      grpc::CallbackServerContext* context) override;

  grpc::ServerUnaryReactor* ListTeachEntries(grpc::CallbackServerContext* context,
                                             const v1::ListTeachEntriesRequest* request,
                                             v1::ListTeachEntriesResponse* response) override;
  grpc::ServerUnaryReactor* UndoTeachEntries(grpc::CallbackServerContext* context,
                                             const v1::UndoTeachEntriesRequest* request,
                                             v1::UndoTeachEntriesResponse* response) override;

 private:
  template <class Request, class Response, class Fill, class Take>
  grpc::ServerUnaryReactor* Order(grpc::CallbackServerContext* context, const Request* request,
                                  const std::string& machine, Response* response,
                                  std::string_view method, Fill fill, Take take);

  CallNeeds needs_;
  HandboxWatchNeeds watch_needs_;
  TeachBook taught_;
};

}  // namespace rmlcell::server
