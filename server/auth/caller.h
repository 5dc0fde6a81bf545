#pragma once

#include <map>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::server {

enum class Role { kViewer, kProgrammer, kOperator, kAdmin };

// Who calls. Every method gets one from the gate and from nowhere else.
struct Caller {
  std::string identity;  // "local"
  Role role = Role::kViewer;
  std::string peer;  // address, for the log; of the browser when the call came over the web port
  std::string request_id;  // for the log: the client's own, or empty
};

// What is known of a call before it is admitted. Keys are lower case, as gRPC sends them.
struct CallFacts {
  std::string method;  // "/rmlcell.v1.JobService/SubmitJob"
  std::string peer;
  std::multimap<std::string, std::string> metadata;
};

// The one place that admits or refuses calls, whatever way they came in: TCP, unix socket, or the
// web gateway over its channel. For now every caller is the local administrator, since the server
// listens on loopback and unix sockets only.
class Gate {
 public:
  // `web_secret` is known to this process alone: what the gateway says about a browser counts only
  // with it, so that no client can make up a web caller.
  explicit Gate(std::string web_secret) : web_secret_(std::move(web_secret)) {}

  // Errors: CellUnauthenticated, CellPermission.
  Result<Caller> Admit(const CallFacts& call) const;

  const std::string& web_secret() const { return web_secret_; }

 private:
  std::string web_secret_;
};

}  // namespace rmlcell::server
