#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "server/web/resource_source.h"

namespace grpc {
class Channel;
}

namespace rmlcell::web {

struct WebOptions {
  std::string address = "127.0.0.1";  // a literal address, or "localhost"
  int port = 50080;                   // 0: any free one, see WebServer::port()
  int io_threads = 1;                 // one serves thousands of streams; 1 to 64
  int blocking_threads = 4;           // for ResourceSource; 1 to 64

  std::size_t call_bytes_max = std::size_t{4} << 20U;      // body of a call: gRPC's own default
  std::size_t upload_bytes_max = std::size_t{256} << 20U;  // program upload by URL
  std::size_t header_bytes_max = std::size_t{32} << 10U;   // request line and headers
  std::size_t connections_max = 2000;                      // more get 503

  // To read a header, the body of a call, or 64 KiB of an upload.
  std::chrono::milliseconds read_timeout{30'000};
  std::chrono::milliseconds idle_timeout{120'000};  // between requests of one connection
  // Without any progress of a write: the reader is stuck. It may come back and resume.
  std::chrono::milliseconds write_timeout{120'000};
  std::chrono::milliseconds quiet_interval{
      15'000};  // a comment line on event streams that are quiet
  // For a client that was refused to come to its end, and for the answer of one that ended its
  // sending.
  std::chrono::milliseconds linger_timeout{2000};
  // For the server to say how it is; /healthz answers that it is not well when it does not.
  std::chrono::milliseconds health_timeout{2000};

  std::vector<std::string> host_names;  // names, besides loopback and `address`, that Host may have
  std::vector<std::string> origins;     // foreign pages that may call: "http://localhost:5173"
  std::vector<std::string> forwarded_headers = {"authorization", "x-request-id"};
  std::string secret;   // becomes the metadata rmlcell-web-secret: proves that the gateway speaks
  std::string web_dir;  // serves the page from this folder instead of the binary, for work on it
};

// One request, when its answer has ended.
struct WebLogEntry {
  std::string peer;
  std::string method;
  std::string path;  // without the query, which may hold data
  std::string request_id;
  int http_status = 0;  // 0: the client left before there was an answer
  std::size_t bytes_sent = 0;
  std::chrono::microseconds duration{0};
  bool finished = true;  // false: broken off by the client or by Stop
};
using WebLogger = std::function<void(const WebLogEntry&)>;
// Why connections cannot be taken, such as for want of descriptors: they wait, and each time of
// waiting is told once. Runs on a thread of the gateway.
using WaitTeller = std::function<void(const std::string& why)>;

// The web port: every unary and server-streaming method of every service in the process, in the
// forms of platform.md section 3, by descriptors alone; resources at stable URLs; /healthz; the
// page at "/".
//
// Metadata that each call carries: rmlcell-web-secret, rmlcell-web-peer, and the forwarded headers.
// No header of a browser whose name begins with "rmlcell-" is ever sent on.
//
// To stop: let health say NOT_SERVING, StopAccepting(), end the streams from their handlers
// (UNAVAILABLE becomes an event "reconnect"), Stop(), and only then the gRPC server.
class WebServer {
 public:
  // `channel` leads to the gRPC server and has GRPC_ARG_MAX_RECEIVE_MESSAGE_LENGTH -1, or large
  // answers fail. `resources` outlives the WebServer. `logger` runs on threads of the gateway and
  // must be thread-safe; it may be empty. Errors: CellPortUsed, CellConfiguration.
  static Result<std::unique_ptr<WebServer>> Start(WebOptions options,
                                                  std::shared_ptr<grpc::Channel> channel,
                                                  ResourceSource& resources, WebLogger logger = {},
                                                  WaitTeller tell_waits = {});

  // Stops at once, as Stop(0).
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const;

  // Connections that are open now, for metrics.
  std::size_t connections() const;

  // No new connection, no further request on those that are there; requests under way go on.
  void StopAccepting();

  // Waits up to `grace` for requests under way, then cancels their calls and closes. Returns when
  // every call has ended and every thread is joined. May be called again.
  void Stop(std::chrono::milliseconds grace);

 private:
  struct Core;
  explicit WebServer(std::unique_ptr<Core> core);
  std::unique_ptr<Core> core_;
};

}  // namespace rmlcell::web
