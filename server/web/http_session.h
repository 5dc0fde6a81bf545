#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/web/gateway.h"
#include "server/web/session_table.h"

// Private to http_session.cc and web_server.cc: the only two files that know Asio.
namespace rmlcell::web {

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
