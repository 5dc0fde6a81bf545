#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <set>

#include "server/web/gateway.h"

// Private to http_session.cc and web_server.cc: the only two files that know Asio.
namespace rmlcell::web {

class HttpSession;

// The connections that are open, so that they can be counted, told to end and waited for.
// Thread-safe.
class SessionTable {
 public:
  void Add(HttpSession* session);
  void Remove(HttpSession* session);
  std::size_t size() const;

  // Lets every session end: at once, or when the request under way is answered.
  void EndAll(bool at_once);
  // True when all are gone in time.
  bool WaitUntilEmpty(std::chrono::milliseconds patience);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::set<HttpSession*>
      sessions_;  // guarded by mutex_; a session removes itself before it is freed
};

struct SessionSetting {
  const Gateway& gateway;
  const WebLogger& logger;
  SessionTable& table;
  const std::atomic<bool>& draining;  // no further requests
};

// Serves one connection until it ends; the session owns itself. `refused`: there are too many, it
// gets a polite 503.
void StartSession(const SessionSetting& setting, boost::asio::ip::tcp::socket socket, bool refused);

}  // namespace rmlcell::web
