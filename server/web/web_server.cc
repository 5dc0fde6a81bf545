#include "server/web/web_server.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/write.hpp>
#include <future>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/letters.h"
#include "server/web/http_session.h"
#include "server/web/refused_connection.h"

namespace rmlcell::web {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr int kThreadsMax = 64;
// Connections beyond the limit that are told so and waited for; more are told and closed at once.
constexpr std::size_t kRefusalsMax = 100;
constexpr std::chrono::milliseconds kAcceptPause{100};  // when the process is out of descriptors
constexpr std::chrono::minutes kEver{10};

Result<tcp::endpoint> EndpointOf(const WebOptions& options) {
  error_code error;
  const std::string address = options.address == "localhost" ? "127.0.0.1" : options.address;
  const asio::ip::address parsed = asio::ip::make_address(address, error);
  if (error || options.port < 0 || options.port > 65535) {
    return Error{ErrorCode::kCellConfiguration,
                 "web address " + options.address + ":" + std::to_string(options.port) +
                     " is no literal address with a port",
                 {}};
  }
  return tcp::endpoint(parsed, static_cast<unsigned short>(options.port));
}

// Says that there are too many and closes, waiting for nothing.
void RefuseAtOnce(tcp::socket socket) {
  error_code error;
  socket.non_blocking(true, error);
  // It fits the buffer of a socket that is new.
  asio::write(socket, asio::buffer(TooManyConnectionsText()), error);
  // What is left unread makes the system break the connection, and the client may then not see the
  // answer: a request that has come already is read.
  std::array<char, 4096> unread{};
  for (int i = 0; i < 16 && !error; ++i) socket.read_some(asio::buffer(unread), error);
  socket.shutdown(asio::socket_base::shutdown_send, error);
}

GuardRules RulesOf(const WebOptions& options) {
  GuardRules rules{.address = options.address,
                   .host_names = options.host_names,
                   .origins = options.origins,
                   .forwarded = options.forwarded_headers,
                   .secret = options.secret};
  for (std::string& name : rules.forwarded) name = LowerCase(name);
  return rules;
}

}  // namespace

struct WebServer::Core {
  Core(WebOptions options, std::shared_ptr<grpc::Channel> channel, ResourceSource& resources,
       WebLogger web_logger, WaitTeller wait_teller)
      : gateway{.options = options,
                .rules = RulesOf(options),
                .page = StaticPage(options.web_dir),
                .channel = std::move(channel),
                .resources = &resources,
                .run_blocking = {},
                .run_computing = {}},
        logger(std::move(web_logger)),
        tell_waits(std::move(wait_teller)),
        io(std::clamp(options.io_threads, 1, kThreadsMax)),
        blocking(static_cast<std::size_t>(std::clamp(options.blocking_threads, 1, kThreadsMax))),
        acceptor(asio::make_strand(io)),
        accept_pause(acceptor.get_executor()) {
    gateway.run_blocking = [this](std::function<void()> task) {
      asio::post(blocking, std::move(task));
    };
    gateway.run_computing = [this](std::function<void()> task) {
      asio::post(computing, std::move(task));
    };
  }

  Status Listen() {
    const Result<tcp::endpoint> endpoint = EndpointOf(gateway.options);
    if (!endpoint) return endpoint.error();
    error_code error;
    acceptor.open(endpoint->protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(*endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (!error) port = acceptor.local_endpoint(error).port();
    if (!error) return {};
    return Error{ErrorCode::kCellPortUsed,
                 "web port " + gateway.options.address + ":" +
                     std::to_string(gateway.options.port) + ": " + error.message(),
                 {}};
  }

  void Accept() {
    acceptor.async_accept(asio::make_strand(io), [this](error_code error, auto socket) {
      if (draining) return;
      if (error) {
        if (!std::exchange(waits, true) && tell_waits) tell_waits(error.message());
        accept_pause.expires_after(kAcceptPause);
        accept_pause.async_wait([this](error_code stopped) {
          if (!stopped && !draining) Accept();
        });
        return;
      }
      waits = false;
      const std::size_t open = table.size();
      const bool refused = open >= gateway.options.connections_max;
      if (open < gateway.options.connections_max + kRefusalsMax) {
        StartSession({gateway, logger, table, draining}, tcp::socket(std::move(socket)), refused);
      } else {
        RefuseAtOnce(tcp::socket(std::move(socket)));
      }
      Accept();
    });
  }

  void RunThreads() {
    work.emplace(io.get_executor());
    const int count = std::clamp(gateway.options.io_threads, 1, kThreadsMax);
    for (int i = 0; i < count; ++i) threads.emplace_back([this] { io.run(); });
  }

  void StopAccepting() {
    if (draining.exchange(true)) return;
    std::promise<void> closed;
    asio::post(acceptor.get_executor(), [&] {
      error_code ignored;
      acceptor.close(ignored);
      accept_pause.cancel();
      closed.set_value();
    });
    closed.get_future().wait();
    table.EndAll(false);
  }

  void Stop(std::chrono::milliseconds grace) {
    if (threads.empty()) return;
    StopAccepting();
    if (!table.WaitUntilEmpty(grace)) {
      table.EndAll(true);
      // Calls end as soon as they are cancelled, and what blocks in ResourceSource is waited for.
      while (!table.WaitUntilEmpty(kEver)) {
      }
    }
    work.reset();
    computing.join();
    blocking.join();
    for (std::thread& thread : threads) thread.join();
    threads.clear();
  }

  Gateway gateway;
  WebLogger logger;
  WaitTeller tell_waits;
  bool waits = false;  // connections cannot be taken, which was told; of the strand of `acceptor`
  SessionTable table;
  std::atomic<bool> draining = false;
  int port = 0;
  asio::io_context io;
  asio::thread_pool blocking;
  asio::thread_pool computing{1};  // pictures of programs: one after the other
  tcp::acceptor acceptor;
  asio::steady_timer accept_pause;
  std::optional<asio::executor_work_guard<asio::io_context::executor_type>> work;
  std::vector<std::thread> threads;
};

WebServer::WebServer(std::unique_ptr<Core> core) : core_(std::move(core)) {}

Result<std::unique_ptr<WebServer>> WebServer::Start(WebOptions options,
                                                    std::shared_ptr<grpc::Channel> channel,
                                                    ResourceSource& resources, WebLogger logger,
                                                    WaitTeller tell_waits) {
  auto core = std::make_unique<Core>(std::move(options), std::move(channel), resources,
                                     std::move(logger), std::move(tell_waits));
  if (const Status status = core->Listen(); !status) return status.error();
  core->Accept();
  core->RunThreads();
  return std::unique_ptr<WebServer>(new WebServer(std::move(core)));
}

WebServer::~WebServer() { Stop(std::chrono::milliseconds(0)); }

int WebServer::port() const { return core_->port; }

std::size_t WebServer::connections() const { return core_->table.size(); }

void WebServer::StopAccepting() { core_->StopAccepting(); }

void WebServer::Stop(std::chrono::milliseconds grace) { core_->Stop(grace); }

}  // namespace rmlcell::web
