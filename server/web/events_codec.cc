// Server-sent events: for EventSource, fetch and `curl -N`.
#include <google/protobuf/descriptor.h>

#include "rmlcell/v1/cell.pb.h"
#include "server/web/event_texts.h"
#include "server/web/rpc_codec.h"

namespace rmlcell::web {
namespace {

// How long EventSource waits before it comes back, ms. Short, since a stopping server is back soon.
constexpr std::string_view kRetry = "retry: 2000\n";

class Events : public RpcCodec {
 public:
  Events(const RpcRoute& route, EventTexts& texts) : route_(route), texts_(texts) {}

  bool streams() const override { return true; }

  HttpResponse Head() const override {
    HttpResponse response;
    AddNoCache(response);
    response.headers.emplace_back("Content-Type", "text/event-stream; charset=utf-8");
    response.headers.emplace_back("X-Accel-Buffering", "no");  // nginx would hold events back
    return response;
  }

  // However busy the cell is, a stream is no call for each event.
  std::string Asked(std::string request) const override {
    if (route_.method->input_type() != v1::WatchCellRequest::descriptor()) return request;
    v1::WatchCellRequest batched;
    batched.set_batched(true);
    return request + batched.SerializeAsString();  // the last one of a field counts
  }

  Result<std::string> Message(std::string_view bytes) override {
    const Result<EventTexts::Text> text = texts_.Of(*route_.method->output_type(), bytes);
    return text ? Result<std::string>(**text) : text.error();
  }

  // A server that stops says so: the client comes back with the last id, nothing is lost.
  std::string End(const RpcStatus& status, const HeaderList&) override {
    if (status.ok()) return "event: end\ndata: {}\n\n";
    if (status.code == kCodeUnavailable) {
      return std::string(kRetry) + "event: reconnect\ndata: " + PlainErrorJson(status) + "\n\n";
    }
    return "event: error\ndata: " + PlainErrorJson(status) + "\n\n";
  }

  std::string_view Quiet() const override { return ": quiet\n\n"; }

  HttpResponse Whole(const RpcStatus& status, std::string_view, const HeaderList&,
                     const HeaderList&) override {
    return Refusal({.status = status, .headers = {}});
  }

  // Before the call an error has its HTTP status: EventSource then stops coming back.
  HttpResponse Refusal(const RpcRefusal& refusal) override {
    return JsonRefusal(refusal, route_.connect_client);
  }

 private:
  RpcRoute route_;
  EventTexts& texts_;
};

}  // namespace

std::unique_ptr<RpcCodec> MakeEvents(const RpcRoute& route, EventTexts& texts) {
  return std::make_unique<Events>(route, texts);
}

}  // namespace rmlcell::web
