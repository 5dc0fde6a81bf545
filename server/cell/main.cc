#include <signal.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <future>
#include <map>
#include <thread>

#include "proto/bridge/findings.h"
#include "server/base/config.h"
#include "server/base/log.h"
#include "server/base/version.h"
#include "server/cell/cell.h"

extern char** environ;

namespace {

using namespace rmlcell;          // NOLINT: this file is the wiring of the server
using namespace rmlcell::server;  // NOLINT

constexpr double kPatienceBehindTimeout_s = 1.0;
constexpr std::chrono::seconds kPatienceForLog{1};

std::map<std::string, std::string> Environment() {
  std::map<std::string, std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const char* equals = std::strchr(*entry, '=');
    if (equals != nullptr)
      variables.emplace(std::string(*entry, static_cast<std::size_t>(equals - *entry)), equals + 1);
  }
  return variables;
}

// sysexits.h: 78 a wrong configuration, 69 unavailable.
int Refuse(const Error& error) {
  std::fprintf(stderr, "rmlcelld: %s\n", bridge::ErrorText(error).c_str());
  return error.code == ErrorCode::kCellConfiguration || error.code == ErrorCode::kCellUnsafeListen
             ? 78
             : 69;
}

// Defaults, then the file, then the environment, then flags: each over the one before.
Status Configure(const std::string& file, const std::map<std::string, std::string>& flags,
                 Config& config) {
  const auto environment = Environment();
  if (!file.empty()) {
    if (const Status read = ReadConfigFile(file, config); !read) return read.error();
  }
  if (const Status read = ReadConfigEnvironment(environment, config); !read) return read.error();
  for (const ConfigKey& key : ConfigKeys()) {
    const auto found = flags.find(std::string(key.name));
    if (found == flags.end()) continue;
    if (const Status set = key.set(config, found->second); !set) {
      return Error{
          ErrorCode::kCellConfiguration, "--" + found->first + " " + set.error().detail, {}};
    }
  }
  if (config.state_directory.empty()) config.state_directory = DefaultStateDirectory(environment);
  return ValidateConfig(config);
}

// All that was acknowledged is on the disk: a call that does not end keeps nobody from stopping,
// nor does a log that nobody reads.
void EndIn(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  std::thread([] {
    std::this_thread::sleep_for(kPatienceForLog);
    _exit(0);
  }).detach();
  spdlog::error("a call does not end; stopping without it");
  spdlog::shutdown();
  _exit(0);
}

// Signals are taken by a thread of its own, and only there: a handler must not stop a server. The
// one that ends it.
std::future<int> SignalToEnd(double patience_s) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::promise<int> told;
  std::future<int> signal_to_end = told.get_future();
  std::thread([signals, patience_s, told = std::move(told)]() mutable {
    int signal = 0;
    sigwait(&signals, &signal);
    told.set_value(signal);
    EndIn(patience_s);
  }).detach();
  return signal_to_end;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The machine-cell server.", "rmlcelld"};
  app.set_version_flag("--version", std::string(kVersion));
  app.footer(R"(examples:
  rmlcelld                                    on loopback, with defaults: gRPC 50051, web 50080
  rmlcelld --config /etc/rmlcell/rmlcell.toml
  rmlcelld --print-config > rmlcell.toml      the effective configuration, with every key explained
  rmlcelld --listen.grpc unix:/run/cell.sock --listen.web ""

Every key of the configuration is a flag too, and a variable of the environment: RMLCELL_WORKERS_COUNT.)");
  std::string file;
  bool print = false;
  app.add_option("--config", file, "configuration file (TOML)")->envname("RMLCELL_CONFIG");
  app.add_flag("--print-config", print, "print the effective configuration and end");
  std::map<std::string, std::string> flags;
  for (const ConfigKey& key : ConfigKeys()) {
    const std::string name(key.name);
    app.add_option_function<std::string>(
           "--" + name, [&flags, name](const std::string& value) { flags[name] = value; },
           std::string(key.text))
        ->group("Configuration");
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  Config config;
  if (const Status configured = Configure(file, flags, config); !configured)
    return Refuse(configured.error());
  if (print) {
    std::fputs(PrintConfig(config).c_str(), stdout);
    return 0;
  }
  if (const Status log = StartLog("rmlcelld", config.log_level, config.log_format, config.log_file);
      !log) {
    return Refuse(log.error());
  }
  for (const std::string& hint : MistypedVariables(Environment())) spdlog::warn("{}", hint);
  std::future<int> signal_to_end =
      SignalToEnd(config.shutdown_timeout_s + kPatienceBehindTimeout_s);
  ::signal(SIGPIPE, SIG_IGN);
  // Who starts the server may ignore it, and then nobody would hear how a process of ours ended.
  ::signal(SIGCHLD, SIG_DFL);

  Result<std::unique_ptr<Cell>> cell = Cell::Start(config);
  if (!cell) return Refuse(cell.error());
  for (const std::string& address : (*cell)->grpc_addresses()) spdlog::info("gRPC on {}", address);
  if (!(*cell)->web_address().empty()) spdlog::info("web on http://{}/", (*cell)->web_address());
  spdlog::info("rmlcelld {} is ready, store in {}", kVersion, config.state_directory);
  spdlog::info("stopping on {}", strsignal(signal_to_end.get()));
  (*cell)->Stop();
  spdlog::info("stopped");
  spdlog::shutdown();
  // gRPC takes a second or more to end its own threads; nothing of ours is left to do.
  _exit(0);
}
