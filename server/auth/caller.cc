#include "server/auth/caller.h"

#include <algorithm>

#include "server/base/secret.h"

namespace rmlcell::server {
namespace {

// Longer ids are cut: they go into every line of the log.
constexpr std::size_t kRequestIdShown = 64;

std::string Value(const std::multimap<std::string, std::string>& metadata, const std::string& key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? std::string() : found->second;
}

}  // namespace

Result<Caller> Gate::Admit(const CallFacts& call) const {
  const v1::Access* access = access_.Find(call.method);
  if (access == nullptr)
    return Error{ErrorCode::kCellPermission, call.method + " states no permission", {}};
  Caller caller{.identity = "local", .permissions = {}, .peer = call.peer, .request_id = {}};
  {
    const std::lock_guard lock(mutex_);
    caller.permissions = local_;
  }
  if (call.transport == Transport::kUnixSocket) {
    caller.user = socket_users_.Of(call.peer);
    if (caller.user) caller.peer = "unix:user " + std::to_string(*caller.user);
  }
  if (KnowsSecret(Value(call.metadata, "rmlcell-web-secret"), web_secret_)) {
    caller.peer = "web:" + Value(call.metadata, "rmlcell-web-peer");
    caller.user.reset();  // it is the gateway's
  }
  caller.request_id = Value(call.metadata, "x-request-id").substr(0, kRequestIdShown);
  std::ranges::replace_if(
      caller.request_id, [](unsigned char c) { return c < 0x20 || c > 0x7E; }, '?');
  if (access->permission() != v1::PERMISSION_NONE &&
      !caller.permissions.Has(access->permission())) {
    return Error{ErrorCode::kCellPermission, call.method, {}};
  }
  return caller;
}

void Gate::SetLocal(Permissions local) {
  {
    const std::lock_guard lock(mutex_);
    local_ = local;
  }
  if (changed_) changed_();
}

}  // namespace rmlcell::server
