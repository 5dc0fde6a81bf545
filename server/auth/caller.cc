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
  Caller caller{.identity = "local", .role = Role::kAdmin, .peer = call.peer, .request_id = {}};
  if (KnowsSecret(Value(call.metadata, "rmlcell-web-secret"), web_secret_)) {
    caller.peer = "web:" + Value(call.metadata, "rmlcell-web-peer");
  }
  caller.request_id = Value(call.metadata, "x-request-id").substr(0, kRequestIdShown);
  std::ranges::replace_if(
      caller.request_id, [](unsigned char c) { return c < 0x20 || c > 0x7E; }, '?');
  return caller;
}

}  // namespace rmlcell::server
