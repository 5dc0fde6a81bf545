#include "server/services/handbox_service.h"

#include <utility>

#include "server/services/host_order.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {
namespace {

// "machines/optimo-1" of "machines/optimo-1/handboxSessions/3".
std::string MachineOfSession(const std::string& session) {
  return session.substr(0, session.find("/handboxSessions/"));
}

}  // namespace

template <class Request, class Response, class Fill, class Take>
grpc::ServerUnaryReactor* HandboxService::Order(grpc::CallbackServerContext* context,
                                                const Request* request, const std::string& machine,
                                                Response* response, std::string_view method,
                                                Fill fill, Take take) {
  return OrderOfHost({needs_, watch_needs_.store, watch_needs_.hosts}, context, request, machine,
                     response, method, fill, take);
}

grpc::ServerUnaryReactor* HandboxService::CreateHandboxSession(
    grpc::CallbackServerContext* context, const v1::CreateHandboxSessionRequest* request,
    v1::HandboxSession* response) {
  return Order(
      context, request, request->machine(), response, "HandboxService/CreateHandboxSession",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_create_session() = asked; },
      [](v1::HostOrderAnswer& answer, v1::HandboxSession& session) {
        session = std::move(*answer.mutable_session());
      });
}

grpc::ServerUnaryReactor* HandboxService::PressKey(grpc::CallbackServerContext* context,
                                                   const v1::PressKeyRequest* request,
                                                   v1::PressKeyResponse* response) {
  return Order(
      context, request, MachineOfSession(request->session()), response, "HandboxService/PressKey",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_key() = asked; },
      [](v1::HostOrderAnswer& answer, v1::PressKeyResponse& pressed) {
        pressed = std::move(*answer.mutable_key());
      });
}

grpc::ServerUnaryReactor* HandboxService::HeartbeatHandbox(
    grpc::CallbackServerContext* context, const v1::HeartbeatHandboxRequest* request,
    v1::HeartbeatResponse* response) {
  return Order(
      context, request, MachineOfSession(request->session()), response,
      "HandboxService/HeartbeatHandbox",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_handbox_heartbeat() = asked; },
      [](v1::HostOrderAnswer& answer, v1::HeartbeatResponse& heard) {
        heard = std::move(*answer.mutable_heartbeat());
      });
}

grpc::ServerUnaryReactor* HandboxService::DeleteHandboxSession(
    grpc::CallbackServerContext* context, const v1::DeleteHandboxSessionRequest* request,
    google::protobuf::Empty* response) {
  return Order(
      context, request, MachineOfSession(request->name()), response,
      "HandboxService/DeleteHandboxSession",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_delete_session() = asked; },
      [](v1::HostOrderAnswer&, google::protobuf::Empty&) {});
}

grpc::ServerWriteReactor<v1::WatchHandboxResponse>* HandboxService::WatchHandbox(
    grpc::CallbackServerContext* context, const v1::WatchHandboxRequest* request) {
  return OpenStream<v1::WatchHandboxResponse>(
      needs_, *context, *request, "HandboxService/WatchHandbox",
      [&](const Caller&) { return MakeHandboxWatch(watch_needs_, *request); });
}

}  // namespace rmlcell::server
