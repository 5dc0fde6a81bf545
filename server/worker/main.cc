#include <absl/synchronization/mutex.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/units.h"
#include "proto/bridge/findings.h"
#include "server/base/log.h"
#include "server/base/this_computer.h"
#include "server/base/version.h"
#include "server/host/host_process.h"
#include "server/worker/job_runner.h"
#include "server/worker/replayed_products.h"
#include "server/worker/server_line.h"

namespace {

using namespace rmlcell;          // NOLINT: this file is the wiring of the worker
using namespace rmlcell::server;  // NOLINT

std::atomic<bool> stopping = false;
std::atomic<double> processor_limit_s = 0.0;  // of the job under way; 0: none
std::atomic<double> processor_begin_s = 0.0;
clockid_t job_clock;

double JobProcessorTime_s() {
  timespec time{};
  clock_gettime(job_clock, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

// A job that hangs inside one step cannot end itself. Long after its budget the process is ended,
// and the server attempts the job again by its policy.
void Guard() {
  for (;;) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const double limit = processor_limit_s;
    if (limit > 0.0 && JobProcessorTime_s() - processor_begin_s > limit * 1.5 + 10.0) {
      spdlog::critical("the job does not end although its processor time is used up");
      _exit(70);
    }
  }
}

// "hall-3/4711": unique among the workers of all computers.
std::string OwnName() { return NameOfComputer() + "/" + std::to_string(::getpid()); }

// A server that is away, or of another version, leaves it to the next.
Result<std::unique_ptr<ServerLine>> JoinFirst(const std::vector<std::string>& servers,
                                              const std::string& token, const std::string& name,
                                              const std::string& pool) {
  Result<std::unique_ptr<ServerLine>> line = Error{ErrorCode::kCellUsage, "no --server", {}};
  for (const std::string& server : servers) {
    line = ServerLine::Join({.server = server, .join_token = token, .name = name, .pool = pool});
    if (line) break;
    if (servers.size() > 1) spdlog::warn("{}: {}", server, bridge::ErrorText(line.error()));
  }
  return line;
}

struct Options {
  std::vector<std::string> servers = {"127.0.0.1:50051"};
  std::string name = OwnName();
  std::string pool{};
  std::string host{};  // a machine: its host, and no worker
  std::string journal{};
  std::string recording{};  // to be played, in place of all that
  std::string into{};
  std::string log_level = "info";
  std::string log_format = "text";
};

void Add(CLI::App& app, Options& options) {
  app.set_version_flag("--version", std::string(kVersion));
  app.add_option("--server", options.servers,
                 "host:port or unix:/path; of several the first that takes the worker");
  app.add_option("--name", options.name, "unique among the workers of the server");
  app.add_option(
         "--pool", options.pool,
         "takes \"paced\" jobs only (simulations with a pace), or \"computing\" ones; else all")
      ->check(CLI::IsMember({"paced", "computing"}));
  auto* journal =
      app.add_option("--journal", options.journal, "of a host: the file that it keeps on its disk");
  app.add_option("--host", options.host,
                 "machines/ID: the host of this machine that lives, in place of a worker")
      ->needs(journal);
  auto* into = app.add_option("--into", options.into, "a folder, with --products");
  app.add_option("--products", options.recording,
                 "plays this recording of a run again, makes its report and pictures, and ends")
      ->needs(into);
  app.add_option("--log-level", options.log_level);
  app.add_option("--log-format", options.log_format, "text or json");
  app.footer("The join token of the server is taken from the environment: RMLCELL_JOIN_TOKEN.");
}

// Its jobs, one after the other, until it is told to end.
void WorkOn(ServerLine& line) {
  pthread_getcpuclockid(pthread_self(), &job_clock);
  std::thread(Guard).detach();
  JobRunner runner(line, stopping);
  while (!stopping && !line.gone()) {
    std::optional<v1::WorkResponse> message = line.Receive(std::chrono::milliseconds(200));
    if (!message) continue;
    if (message->has_stop()) break;
    if (!message->has_assignment()) continue;
    processor_begin_s = JobProcessorTime_s();
    processor_limit_s = ToSeconds(SimTime(message->assignment().budget().processor_ns()));
    const bool go_on = runner.Work(std::move(*message->mutable_assignment()));
    processor_limit_s = 0.0;
    if (!go_on) break;
  }
  line.Close();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"An engine worker: joins a server and works on its jobs.", "rmlcell-worker"};
  Options options;
  Add(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 64;
  }
  const bool hosts = !options.host.empty();
  const bool plays = !options.recording.empty();
  if (const Status log = StartLog(hosts   ? "host of " + options.host
                                  : plays ? "products of " + options.recording
                                          : options.name,
                                  options.log_level, options.log_format, {});
      !log)
    return 69;
  ::signal(SIGPIPE, SIG_IGN);
  // As in the server: the packaged absl would keep the order of all locks that are held.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  // Only noted: the job is handed back by the thread that works on it.
  struct sigaction action {};
  action.sa_handler = [](int) { stopping = true; };
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  const char* given = std::getenv("RMLCELL_JOIN_TOKEN");
  const std::string token = given != nullptr ? given : "";
  int code = 0;
  if (plays) {
    // What moves or waits goes first.
    if (::nice(10) == -1) spdlog::debug("it runs at the priority of the others");
    const Status made = MakeProducts(options.recording, options.into);
    if (!made) spdlog::error("{}", bridge::ErrorText(made.error()));
    code = made ? 0 : 1;
  } else if (hosts) {
    // gRPC looks every few seconds after lines that nobody reads; each line here has its reader,
    // and the timer is a third of what a machine that stands costs. LIVE-10.20
    ::setenv("GRPC_CLIENT_CHANNEL_BACKUP_POLL_INTERVAL_MS", "0", 0);
    code = RunHost({.server = options.servers.front(),
                    .join_token = token,
                    .machine = options.host,
                    .journal = options.journal},
                   stopping);
  } else {
    const auto line = JoinFirst(options.servers, token, options.name, options.pool);
    if (!line) {
      spdlog::error("{}", bridge::ErrorText(line.error()));
      return 69;
    }
    WorkOn(**line);
    spdlog::debug("worker {} ends", options.name);
  }
  spdlog::shutdown();
  // Static destructors of gRPC may wait for threads that wait for the server: there is nothing to
  // save.
  _exit(code);
}
