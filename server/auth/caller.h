#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "server/auth/access.h"
#include "server/auth/socket_users.h"

namespace rmlcell::server {

// Who calls. Every method gets one from the gate and from nowhere else.
struct Caller {
  std::string identity;  // "local"
  Permissions permissions{};
  std::string peer;  // address, for the log; of the browser when the call came over the web port
  std::optional<unsigned> user{};  // of the computer, at the other end of a unix socket
  std::string request_id;          // for the log: the client's own, or empty
};

// How a call came in.
enum class Transport { kTcp, kUnixSocket, kInProcess };

// What is known of a call before it is admitted. Keys are lower case, as gRPC sends them.
struct CallFacts {
  std::string method;  // "/rmlcell.v1.JobService/SubmitJob"
  std::string peer;
  std::multimap<std::string, std::string> metadata{};
  Transport transport = Transport::kTcp;
  std::string certificate{};  // of the client, PEM; empty: it showed none
  std::string resource{};  // what the call is about, as the request names it; empty: the cell, or a
                           // stream whose messages say it
};

// The one place that admits or refuses calls, whatever way they came in: TCP, unix socket, or the
// web gateway over its channel. For now every caller is the local one, since the server listens on
// loopback and unix sockets only.
class Gate {
 public:
  // `web_secret` is known to this process alone: what the gateway says about a browser counts only
  // with it, so that no client can make up a web caller. `local`: what the local caller may do.
  explicit Gate(std::string web_secret, Permissions local = AdministratorPermissions())
      : web_secret_(std::move(web_secret)), local_(local) {}

  // Errors: CellUnauthenticated, CellPermission; that also for a method that states no access.
  Result<Caller> Admit(const CallFacts& call) const;
  // From now on.
  void SetLocal(Permissions local);
  // Called when rights have changed, for those who have long streams open
  // (OpenStreams::AskAgain). Before the first call is admitted.
  void OnChange(std::function<void()> changed) { changed_ = std::move(changed); }
  // What a method asks for; null: it states nothing.
  const v1::Access* AccessOf(std::string_view method) const { return access_.Find(method); }

  const std::string& web_secret() const { return web_secret_; }
  SocketUsers& socket_users() { return socket_users_; }

 private:
  std::string web_secret_;
  mutable std::mutex mutex_;
  Permissions local_;  // guarded by mutex_
  std::function<void()> changed_;
  AccessTable access_;
  SocketUsers socket_users_;
};

}  // namespace rmlcell::server
