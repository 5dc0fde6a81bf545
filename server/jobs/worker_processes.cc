#include "server/jobs/worker_processes.h"

#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include <memory>
#include <set>
#include <vector>

#include "server/base/child_process.h"
#include "server/base/restart_delay.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kLook{20};  // how soon a dead worker is noticed

}  // namespace

Result<std::unique_ptr<WorkerProcesses>> WorkerProcesses::Start(Options options) {
  if (options.count + options.further_count > 0) {
    if (const Status program = CheckProgram(options.program); !program) return program.error();
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
  const Result<pid_t> process = StartChild(words, {"RMLCELL_JOIN_TOKEN=" + options_.join_token});
  if (process) return *process;
  spdlog::error("worker {} cannot be started: {}", number, process.error().detail);
  return -1;
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
