#include "server/services/foreign_calls.h"

#include <grpcpp/grpcpp.h>
#include <grpcpp/support/server_interceptor.h>
#include <spdlog/spdlog.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/bridge/findings.h"
#include "server/services/call.h"

namespace rmlcell::server {
namespace {

using grpc::experimental::InterceptionHookPoints;
using grpc::experimental::Interceptor;
using grpc::experimental::InterceptorBatchMethods;
using grpc::experimental::ServerInterceptorFactoryInterface;
using grpc::experimental::ServerRpcInfo;

using AdmitCall = std::function<Result<Caller>(const CallFacts&)>;

class AtTheGate final : public Interceptor {
 public:
  AtTheGate(const AdmitCall& admit, ServerRpcInfo& call) : admit_(admit), call_(call) {}

  void Intercept(InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA))
      Admit(*methods->GetRecvInitialMetadata());
    methods->Proceed();
  }

 private:
  void Admit(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
    const CallFacts facts = FactsOf(call_.method(), *call_.server_context(), metadata);
    const Result<Caller> caller = admit_(facts);
    if (caller) return;
    spdlog::info("{} refused, caller at {}: {}", facts.method, facts.peer,
                 bridge::ErrorText(caller.error()));
    call_.server_context()->TryCancel();
  }

  const AdmitCall& admit_;
  ServerRpcInfo& call_;
};

class Gates final : public ServerInterceptorFactoryInterface {
 public:
  explicit Gates(AdmitCall admit) : admit_(std::move(admit)) {}
  Interceptor* CreateServerInterceptor(ServerRpcInfo* call) override {
    constexpr std::string_view kForeign = "/grpc.";
    if (!std::string_view(call->method()).starts_with(kForeign)) return nullptr;
    return new AtTheGate(admit_, *call);  // gRPC owns it
  }

 private:
  AdmitCall admit_;
};

}  // namespace

void AdmitForeignCalls(grpc::ServerBuilder& builder, AdmitCall admit) {
  std::vector<std::unique_ptr<ServerInterceptorFactoryInterface>> gates;
  gates.push_back(std::make_unique<Gates>(std::move(admit)));
  builder.experimental().SetInterceptorCreators(std::move(gates));
}

}  // namespace rmlcell::server
