#include "server/web/health_exchange.h"

#include <utility>

#include "grpc/health/v1/health.pb.h"
#include "server/web/rpc_call.h"
#include "server/web/rpc_codec.h"

namespace rmlcell::web {
namespace {

class HealthExchange : public Exchange, public std::enable_shared_from_this<HealthExchange> {
 public:
  HealthExchange(const Gateway& gateway, std::shared_ptr<Connection> connection)
      : gateway_(gateway), connection_(connection), poster_(std::move(connection)) {}

  void Start() override {
    const std::shared_ptr<HealthExchange> self = shared_from_this();
    call_ = RpcCall::Start(
        gateway_.channel,
        {.method = "/grpc.health.v1.Health/Check",
         .message = {},
         .metadata = {{"rmlcell-web-secret", gateway_.rules.secret}},
         .timeout = gateway_.options.health_timeout},
        {.on_message =
             [self](std::string bytes) {
               self->poster_->Post([self, bytes = std::move(bytes)] { self->TakeMessage(bytes); });
             },
         .on_end = [self](RpcCallEnd) { self->poster_->Post([self] { self->TakeEnd(); }); }});
    call_->ReadNext();
  }

  void OnGone() override {
    if (call_) call_->Cancel();
    connection_.reset();
  }

 private:
  void TakeMessage(const std::string& bytes) {
    grpc::health::v1::HealthCheckResponse response;
    if (response.ParseFromString(bytes)) status_ = response.status();
    if (call_) call_->ReadNext();
  }

  void TakeEnd() {
    call_.reset();
    if (!connection_) return;
    const bool serving = status_ == grpc::health::v1::HealthCheckResponse::SERVING;
    HttpResponse response{.status = serving ? 200 : 503, .headers = {}, .body = {}, .length = {}};
    AddNoCache(response);
    response.headers.emplace_back("Content-Type", "application/json");
    response.body = std::string("{\"status\":\"") + (serving ? "SERVING" : "NOT_SERVING") + "\"}\n";
    std::exchange(connection_, nullptr)->Send(std::move(response));
  }

  const Gateway& gateway_;
  std::shared_ptr<Connection> connection_;
  std::shared_ptr<Connection> poster_;
  std::shared_ptr<RpcCall> call_;
  grpc::health::v1::HealthCheckResponse::ServingStatus status_ =
      grpc::health::v1::HealthCheckResponse::UNKNOWN;
};

}  // namespace

std::shared_ptr<Exchange> MakeHealthExchange(const Gateway& gateway, const HttpRequest&,
                                             std::shared_ptr<Connection> connection) {
  return std::make_shared<HealthExchange>(gateway, std::move(connection));
}

}  // namespace rmlcell::web
