#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "server/auth/caller.h"
#include "server/base/executor.h"
#include "server/services/rpc_status.h"

// The wrapper that every method goes through: it admits the caller, runs the work where it may
// block, turns errors into statuses, and logs. Only service sources include this.
namespace rmlcell::server {

// What a call needs before its own work begins.
struct CallNeeds {
  const Gate& gate;
  Executor& executor;              // the lane of this work: that of the store, or
  Executor& compute;               // that of what keeps a processor busy
  std::int64_t message_bytes_max;  // limits.message_bytes

  // For a method that translates or compares programs: however many are asked for, calls that only
  // read and write the store do not stand behind them.
  CallNeeds Computing() const { return {gate, compute, compute, message_bytes_max}; }
};

CallFacts FactsOf(std::string method, const grpc::ServerContextBase& context,
                  const std::multimap<grpc::string_ref, grpc::string_ref>& metadata);
// `method`: "JobService/SubmitJob". Without a request, of a stream, nothing is known of what the
// call is about.
CallFacts FactsOfCall(const Gate& gate, const grpc::ServerContextBase& context,
                      std::string_view method, const google::protobuf::Message* request);
Result<Caller> Admit(const Gate& gate, const grpc::ServerContextBase& context,
                     std::string_view method, const google::protobuf::Message* request = nullptr);
void LogCall(std::string_view method, const Caller& caller, const grpc::Status& status,
             std::chrono::steady_clock::duration took);

// gRPC refuses an oversized message without a word of ours. It is told to let this much more in, so
// that whoever is a little over gets the code and the advice; larger ones are not worth the memory.
inline constexpr std::int64_t kRefusalBytes = 16 << 20;
// What every request must be, whatever it asks for. Errors: CellTooLarge; CellInvalidArgument
// without a request id where the contract requires one.
Status CheckRequest(const CallNeeds& needs, const google::protobuf::Message& request);

// Bytes of a program or product in one answer; larger ones go by a stream.
inline constexpr std::int64_t kUnaryBytes = 3 << 20;

// Too much waits for this lane already.
Error LaneFull();

// Runs `from_memory(caller)` on the thread of the call, which must not block. A grpc::Status ends
// the call; nothing: `work(caller)`, which returns one, is run on the executor.
template <class FromMemory, class Work>
grpc::ServerUnaryReactor* AnswerFromMemory(const CallNeeds& needs,
                                           grpc::CallbackServerContext* context,
                                           const google::protobuf::Message& request,
                                           std::string_view method, FromMemory from_memory,
                                           Work work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  Result<Caller> caller = Admit(needs.gate, *context, method, &request);
  const Status good = caller ? CheckRequest(needs, request) : Status{};
  if (!caller || !good) {
    reactor->Finish(ToGrpcStatus(caller ? good.error() : caller.error()));
    return reactor;
  }
  if (const std::optional<grpc::Status> known = from_memory(*caller)) {
    LogCall(method, *caller, *known, {});
    reactor->Finish(*known);
    return reactor;
  }
  const bool taken = needs.executor.TryPost(
      [reactor, method, caller = *std::move(caller), work = std::move(work)] {
        const auto begin = std::chrono::steady_clock::now();
        grpc::Status status;
        EndWhereThrown(
            method, [&] { status = work(caller); },
            [&](const grpc::Status& thrown) { status = thrown; });
        LogCall(method, caller, status, std::chrono::steady_clock::now() - begin);
        reactor->Finish(status);
      });
  if (!taken) reactor->Finish(ToGrpcStatus(LaneFull()));
  return reactor;
}

// Runs `at_once(caller)` on the thread of the call, which must not block, then `work(caller)` on
// the executor.
template <class AtOnce, class Work>
grpc::ServerUnaryReactor* AnswerAfter(const CallNeeds& needs, grpc::CallbackServerContext* context,
                                      const google::protobuf::Message& request,
                                      std::string_view method, AtOnce at_once, Work work) {
  return AnswerFromMemory(
      needs, context, request, method,
      [at_once = std::move(at_once)](const Caller& caller) -> std::optional<grpc::Status> {
        at_once(caller);
        return std::nullopt;
      },
      std::move(work));
}

template <class Work>
grpc::ServerUnaryReactor* Answer(const CallNeeds& needs, grpc::CallbackServerContext* context,
                                 const google::protobuf::Message& request, std::string_view method,
                                 Work work) {
  return AnswerAfter(
      needs, context, request, method, [](const Caller&) {}, std::move(work));
}

}  // namespace rmlcell::server
