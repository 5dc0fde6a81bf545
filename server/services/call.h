#pragma once

#include <grpcpp/grpcpp.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <string>
#include <utility>

#include "server/auth/caller.h"
#include "server/executor.h"
#include "server/services/rpc_status.h"

// The wrapper that every method goes through: it admits the caller, runs the work where it may block,
// turns errors into statuses, and logs. Only service sources include this.
namespace rmlcell::server {

// What a call needs before its own work begins.
struct CallRoom {
  const Gate& gate;
  Executor& executor;
};

Result<Caller> Admit(const Gate& gate, const grpc::ServerContextBase& context, std::string_view method);
void LogCall(std::string_view method, const Caller& caller, const grpc::Status& status,
             std::chrono::steady_clock::duration took);

// Runs `work(caller)`, which returns a grpc::Status, on the executor and finishes the call with it.
template <class Work>
grpc::ServerUnaryReactor* Answer(const CallRoom& room, grpc::CallbackServerContext* context,
                                 std::string_view method, Work work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  Result<Caller> caller = Admit(room.gate, *context, method);
  if (!caller) {
    reactor->Finish(ToGrpcStatus(caller.error()));
    return reactor;
  }
  room.executor.Post([reactor, method, caller = std::move(*caller), work = std::move(work)] {
    const auto begin = std::chrono::steady_clock::now();
    grpc::Status status;
    try {
      status = work(caller);
    } catch (const std::exception& error) {
      spdlog::error("{}: an exception left its folder: {}", method, error.what());
      status = ToGrpcStatus(Error{ErrorCode::kCellInternal, {}, {}});
    }
    LogCall(method, caller, status, std::chrono::steady_clock::now() - begin);
    reactor->Finish(status);
  });
  return reactor;
}

// A method of a later version.
grpc::ServerUnaryReactor* NotYet(const CallRoom& room, grpc::CallbackServerContext* context,
                                 std::string_view method);

}  // namespace rmlcell::server
