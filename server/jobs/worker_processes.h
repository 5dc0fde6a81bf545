#pragma once

#include <sys/types.h>

#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "engine/core/result.h"
#include "server/base/steady_clock.h"

namespace rmlcell::server {

// The engine workers that the server starts itself: so many processes of one pool and so many of
// another, and another one for each that dies. One that dies again and again at once is started
// more and more slowly.
class WorkerProcesses {
 public:
  struct Options {
    std::string program;     // path of rmlcell-worker
    std::string server;      // address that they connect to
    std::string join_token;  // handed over in the environment, not on the command line
    std::string log_level;
    std::string log_format;
    int count = 1;
    std::string pool{};  // of these; empty: of all
    std::string further_pool{};
    int further_count = 0;
    SteadyClock clock = SteadyTime;
  };

  // Error: CellConfiguration when the program is not there.
  static Result<std::unique_ptr<WorkerProcesses>> Start(Options options);
  ~WorkerProcesses();
  WorkerProcesses(const WorkerProcesses&) = delete;
  WorkerProcesses& operator=(const WorkerProcesses&) = delete;

  // Those that end from now on stay away: the server stops.
  void StartNoMore();
  // Asks all to end, then kills what is still there after `patience`.
  void Stop(std::chrono::milliseconds patience);

 private:
  explicit WorkerProcesses(Options options) : options_(std::move(options)) {}
  pid_t Spawn(int number) const;
  void Watch(const std::stop_token& stop);

  Options options_;
  std::mutex mutex_;
  std::map<pid_t, int> alive_;  // process -> number
  std::jthread watcher_;
};

}  // namespace rmlcell::server
