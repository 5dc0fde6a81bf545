#include "server/services/handbox_stream.h"

#include <memory>
#include <utility>

#include "server/base/names.h"
#include "server/machines/hosts.h"
#include "server/services/answered_stream.h"

namespace rmlcell::server {
namespace {

using KeyAnswers = AnsweredStream<v1::HandboxStreamRequest, v1::HandboxStreamResponse>;

class HandboxStream final : public KeyAnswers {
 public:
  HandboxStream(const CallNeeds& needs, Hosts* hosts, OpenStreams& open, CallFacts facts,
                Caller caller)
      : KeyAnswers(needs, open, "HandboxService/HandboxStream", std::move(facts),
                   std::move(caller)),
        hosts_(hosts) {}

 private:
  void Take(std::shared_ptr<v1::HandboxStreamRequest> request, Answer answer) override {
    const auto refuse = [&answer](const Error& error) {
      v1::HandboxStreamResponse response;
      *response.mutable_refusal() = bridge::ToErrorDetail(error);
      answer(std::move(response));
    };
    if (const Status good = CheckRequest(needs(), *request); !good) return refuse(good.error());
    v1::HostOrder order;
    order.set_caller(caller().identity);
    std::string session;
    if (request->has_key()) {
      session = request->key().session();
      *order.mutable_key() = std::move(*request->mutable_key());
    } else if (request->has_heartbeat()) {
      session = request->heartbeat().session();
      *order.mutable_handbox_heartbeat() = std::move(*request->mutable_heartbeat());
    } else {
      return refuse({ErrorCode::kCellInvalidArgument, "a message says nothing", {}});
    }
    const Result<std::string> machine = ParseMachineName(MachineOfSession(session));
    if (!machine) return refuse(machine.error());
    if (hosts_ == nullptr || !hosts_->IsHosted(*machine))
      return refuse({ErrorCode::kCellNotLive, "the machine has no host: enable it", {}});
    hosts_->Ask(*machine, std::move(order),
                [answer = std::move(answer)](Result<v1::HostOrderAnswer> given) {
                  v1::HandboxStreamResponse response;
                  if (!given) {
                    *response.mutable_refusal() = bridge::ToErrorDetail(given.error());
                  } else if (given->has_refusal()) {
                    *response.mutable_refusal() = given->refusal();
                  } else if (given->has_key()) {
                    *response.mutable_key() = std::move(*given->mutable_key());
                  } else {
                    *response.mutable_heartbeat() = std::move(*given->mutable_heartbeat());
                  }
                  answer(std::move(response));
                });
  }

  Hosts* hosts_;
};

}  // namespace

std::string MachineOfSession(const std::string& session) {
  return session.substr(0, session.find("/handboxSessions/"));
}

grpc::ServerBidiReactor<v1::HandboxStreamRequest, v1::HandboxStreamResponse>* MakeHandboxStream(
    const CallNeeds& needs, grpc::CallbackServerContext& context, Hosts* hosts, OpenStreams& open) {
  return BeginAnsweredStream<v1::HandboxStreamRequest, v1::HandboxStreamResponse>(
      needs, context, "HandboxService/HandboxStream", [&](CallFacts facts, const Caller& caller) {
        return std::make_shared<HandboxStream>(needs, hosts, open, std::move(facts), caller);
      });
}

}  // namespace rmlcell::server
