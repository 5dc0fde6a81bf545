#include "server/auth/socket_users.h"

#include "engine/core/number_text.h"

namespace rmlcell::server {

void SocketUsers::Note(int descriptor, unsigned user) {
  const std::lock_guard lock(mutex_);
  users_[descriptor] = user;
}

std::optional<unsigned> SocketUsers::Of(std::string_view peer) const {
  if (!peer.starts_with(kPeer)) return {};
  const auto descriptor = ParseInteger(peer.substr(kPeer.size()));
  if (!descriptor) return {};
  const std::lock_guard lock(mutex_);
  const auto found = users_.find(static_cast<int>(*descriptor));
  return found == users_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace rmlcell::server
