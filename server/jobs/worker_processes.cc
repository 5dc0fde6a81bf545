#include "server/jobs/worker_processes.h"

#include <signal.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <set>
#include <vector>

#include "server/jobs/restart_delay.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kLook{20};  // how soon a dead worker is noticed

}  // namespace

Result<std::unique_ptr<WorkerProcesses>> WorkerProcesses::Start(Options options) {
  if (options.count + options.further_count > 0) {
    struct stat file {};
    int failed =
        ::access(options.program.c_str(), X_OK) != 0 || ::stat(options.program.c_str(), &file) != 0
            ? errno
            : 0;
    if (failed == 0 && !S_ISREG(file.st_mode)) failed = EACCES;
    if (failed != 0) {
      return Error{ErrorCode::kCellConfiguration,
                   "workers.program " + options.program + ": " + std::strerror(failed),
                   {}};
    }
  }
  std::unique_ptr<WorkerProcesses> processes(new WorkerProcesses(std::move(options)));
  processes->watcher_ =
      std::jthread([raw = processes.get()](const std::stop_token& stop) { raw->Watch(stop); });
  return processes;
}

WorkerProcesses::~WorkerProcesses() { Stop(std::chrono::milliseconds(0)); }

pid_t WorkerProcesses::Spawn(int number) const {
  std::vector<std::string> words = {options_.program,   "--server",         options_.server,
                                    "--log-level",      options_.log_level, "--log-format",
                                    options_.log_format};
  const std::string& pool = number > options_.count ? options_.further_pool : options_.pool;
  if (!pool.empty()) words.insert(words.end(), {"--pool", pool});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // Not on the command line, which every user of the host can read.
  std::string token = "RMLCELL_JOIN_TOKEN=" + options_.join_token;
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::strncmp(*entry, "RMLCELL_", 8) != 0) environment.push_back(*entry);
  }
  environment.push_back(token.data());
  environment.push_back(nullptr);
  pid_t process = -1;
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A group of its own: Ctrl-C at the terminal reaches the server, which stops its workers in
  // order.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  // Sockets of the server stay with it: a copy in a worker would keep a port taken, or a connection
  // of a client open, after the server closed it.
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  const int failed = posix_spawn(&process, options_.program.c_str(), &actions, &attributes,
                                 arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) {
    spdlog::error("worker {} cannot be started: {}", number, std::strerror(failed));
    return -1;
  }
  return process;
}

void WorkerProcesses::Watch(const std::stop_token& stop) {
  struct Place {
    pid_t process = -1;
    std::chrono::steady_clock::time_point started;
    std::chrono::steady_clock::time_point next_start;
    RestartDelay delay;
  };
  std::vector<Place> places(static_cast<std::size_t>(options_.count + options_.further_count));
  while (!stop.stop_requested()) {
    const auto now = options_.clock();
    for (std::size_t i = 0; i < places.size(); ++i) {
      Place& place = places[i];
      int how = 0;
      if (place.process > 0 && ::waitpid(place.process, &how, WNOHANG) == place.process) {
        {
          const std::lock_guard lock(mutex_);
          alive_.erase(place.process);
        }
        if (WIFSIGNALED(how)) {
          spdlog::warn("worker process {} was ended by signal {}", place.process, WTERMSIG(how));
        } else {
          spdlog::warn("worker process {} ended with {}", place.process, WEXITSTATUS(how));
        }
        place.next_start = now + place.delay.AfterLife(now - place.started);
        place.process = -1;
      }
      if (place.process < 0 && now >= place.next_start) {
        place.process = Spawn(static_cast<int>(i) + 1);
        place.started = now;
        place.next_start = now + std::chrono::seconds(1);
        if (place.process > 0) {
          const std::lock_guard lock(mutex_);
          alive_[place.process] = static_cast<int>(i);
        }
      }
    }
    std::this_thread::sleep_for(kLook);
  }
}

void WorkerProcesses::StartNoMore() {
  if (!watcher_.joinable()) return;
  watcher_.request_stop();
  watcher_.join();
}

void WorkerProcesses::Stop(std::chrono::milliseconds patience) {
  StartNoMore();
  std::map<pid_t, int> alive;
  {
    const std::lock_guard lock(mutex_);
    alive.swap(alive_);
  }
  const auto until = options_.clock() + patience;
  for (const auto& [process, number] : alive) ::kill(process, SIGTERM);
  while (!alive.empty()) {
    std::erase_if(alive,
                  [](const auto& row) { return ::waitpid(row.first, nullptr, WNOHANG) != 0; });
    if (alive.empty()) break;
    if (options_.clock() >= until) {
      for (const auto& [process, number] : alive) ::kill(process, SIGKILL);
      for (const auto& [process, number] : alive) ::waitpid(process, nullptr, 0);
      break;
    }
    std::this_thread::sleep_for(kLook);
  }
}

}  // namespace rmlcell::server
