#include "server/services/handbox_service.h"

#include <utility>

#include "server/services/handbox_stream.h"
#include "server/services/host_order.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {

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

grpc::ServerBidiReactor<v1::HandboxStreamRequest, v1::HandboxStreamResponse>*
HandboxService::HandboxStream(grpc::CallbackServerContext* context) {
  return MakeHandboxStream(needs_, *context, watch_needs_.hosts, watch_needs_.open);
}

grpc::ServerUnaryReactor* HandboxService::ListTeachEntries(
    grpc::CallbackServerContext* context, const v1::ListTeachEntriesRequest* request,
    v1::ListTeachEntriesResponse* response) {
  return Answer(needs_, context, *request, "HandboxService/ListTeachEntries",
                [this, request, response](const Caller&) {
                  auto listed = taught_.List(*request);
                  if (!listed) return ToGrpcStatus(listed.error());
                  *response = *std::move(listed);
                  return grpc::Status::OK;
                });
}

// The store has the program, the host knows who has control.
grpc::ServerUnaryReactor* HandboxService::UndoTeachEntries(
    grpc::CallbackServerContext* context, const v1::UndoTeachEntriesRequest* request,
    v1::UndoTeachEntriesResponse* response) {
  constexpr std::string_view kMethod = "HandboxService/UndoTeachEntries";
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const Result<Caller> caller = Admit(needs_.gate, *context, kMethod, request);
  const Result<ProgramName> name = ParseProgramName(request->program());
  const Status good = CheckRequest(needs_, *request);
  if (!caller || !name || !good) {
    reactor->Finish(ToGrpcStatus(!caller ? caller.error() : name ? good.error() : name.error()));
    return reactor;
  }
  if (watch_needs_.hosts == nullptr || !watch_needs_.hosts->IsHosted(name->machine)) {
    reactor->Finish(
        ToGrpcStatus(Error{ErrorCode::kCellNotLive, "the machine has no host: enable it", {}}));
    return reactor;
  }
  const auto end = [reactor, kMethod, begin = std::chrono::steady_clock::now(),
                    who = *caller](const grpc::Status& status) {
    LogCall(kMethod, who, status, std::chrono::steady_clock::now() - begin);
    reactor->Finish(status);
  };
  const auto carry = [this, request, response, end, who = caller->identity] {
    auto entry = taught_.TakeBack(*request, who);
    if (!entry) return end(ToGrpcStatus(entry.error()));
    watch_needs_.hosts->TakeStored();
    *response->mutable_entry() = *std::move(entry);
    end(grpc::Status::OK);
  };
  v1::HostOrder order;
  order.set_caller(caller->identity);
  *order.mutable_undo_teaching() = *request;
  watch_needs_.hosts->Ask(name->machine, std::move(order),
                          [this, kMethod, end, carry](const Result<v1::HostOrderAnswer>& answer) {
                            if (!answer) return end(ToGrpcStatus(answer.error()));
                            if (answer->has_refusal()) return end(RefusalOf(*answer));
                            needs_.executor.Post(EndingWhereThrown(kMethod, carry, end));
                          });
  return reactor;
}

grpc::ServerWriteReactor<v1::WatchHandboxResponse>* HandboxService::WatchHandbox(
    grpc::CallbackServerContext* context, const v1::WatchHandboxRequest* request) {
  return OpenStream<v1::WatchHandboxResponse>(
      needs_, *context, *request, "HandboxService/WatchHandbox",
      [&](const Caller&) { return MakeHandboxWatch(watch_needs_, *request); });
}

}  // namespace rmlcell::server
