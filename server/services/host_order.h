#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "server/base/names.h"
#include "server/machines/hosts.h"
#include "server/services/call.h"
#include "server/services/host_refusal.h"
#include "storage/store.h"

namespace rmlcell::server {

// Adds to an order what the store has; on a thread that may wait for it.
using HostOrderPrepare = std::function<Status(v1::HostOrder&)>;

struct HostOrderNeeds {
  const CallNeeds& needs;
  storage::Store& store;
  Hosts* hosts = nullptr;      // null: no machine lives
  HostOrderPrepare prepare{};  // none: nothing is missing
};

// One order to the host of a machine, whose name the request has. `fill` puts the request into the
// order, `take` the answer into the response. Without `prepare` nothing of it waits for the store.
template <class Request, class Response, class Fill, class Take>
grpc::ServerUnaryReactor* OrderOfHost(const HostOrderNeeds& of,
                                      grpc::CallbackServerContext* context, const Request* request,
                                      const std::string& machine_name, Response* response,
                                      std::string_view method, Fill fill, Take take) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const auto refuse = [reactor](const Error& error) {
    reactor->Finish(ToGrpcStatus(error));
    return reactor;
  };
  const Result<Caller> caller = Admit(of.needs.gate, *context, method, request);
  if (!caller) return refuse(caller.error());
  if (const Status good = CheckRequest(of.needs, *request); !good) return refuse(good.error());
  const Result<std::string> machine = ParseMachineName(machine_name);
  if (!machine) return refuse(machine.error());
  if (of.hosts == nullptr || !of.hosts->IsHosted(*machine)) {
    // Without a host there is time to look whether there is such a machine.
    const bool taken = of.needs.executor.TryPost([&store = of.store, reactor, id = *machine] {
      const auto known = store.GetMachine(id);
      reactor->Finish(ToGrpcStatus(
          known ? Error{ErrorCode::kCellNotLive, "the machine has no host: enable it", {}}
                : known.error()));
    });
    return taken ? reactor : refuse(LaneFull());
  }
  v1::HostOrder order;
  order.set_caller(caller->identity);
  fill(order, *request);
  const auto begin = std::chrono::steady_clock::now();
  const auto answered = [reactor, response, method, take, begin,
                         who = *caller](Result<v1::HostOrderAnswer> answer) {
    grpc::Status status;
    if (!answer) {
      status = ToGrpcStatus(answer.error());
    } else if (answer->has_refusal()) {
      status = RefusalOf(*answer);
    } else {
      take(*answer, *response);
    }
    LogCall(method, who, status, std::chrono::steady_clock::now() - begin);
    reactor->Finish(status);
  };
  if (!of.prepare) {
    of.hosts->Ask(*machine, std::move(order), answered);
    return reactor;
  }
  const bool taken = of.needs.executor.TryPost(
      [hosts = of.hosts, prepare = of.prepare, machine = *machine, order, answered]() mutable {
        const Status prepared = prepare(order);
        if (!prepared) return answered(prepared.error());
        hosts->Ask(machine, std::move(order), answered);
      });
  return taken ? reactor : refuse(LaneFull());
}

}  // namespace rmlcell::server
