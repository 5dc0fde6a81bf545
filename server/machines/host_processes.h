#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "engine/core/result.h"
#include "server/base/restart_delay.h"
#include "server/base/steady_clock.h"

namespace rmlcell::server {

// Hosts of virtual machines that this server starts: one process for each machine that is enabled,
// and another one for each that dies, more and more slowly. They are not ended with the server.
// Thread-safe.
class HostProcesses {
 public:
  struct Options {
    std::string program{};     // path of rmlcell-worker
    std::string server{};      // address that they connect to
    std::string join_token{};  // handed over in the environment, not on the command line
    std::string journals{};    // folder of their journals; made where it is missing
    std::size_t most = 100;    // machines at the same time
    std::string log_level{};
    std::string log_format{};
    // Whether a host of the machine is heard, wherever it came from: then none is started.
    std::function<bool(const std::string& machine)> is_heard{};
    std::function<void()> look{};  // called from time to time, while there are hosts
    // Told when none is started any more, because too many have died: until a person enables it.
    std::function<void(const std::string& machine, const std::string& why)> gave_up{};
    SteadyClock clock = SteadyTime;
  };
  // So many that died within that time are enough. LIVE-3.01
  static constexpr std::size_t kEndsMax = 5;
  static constexpr std::chrono::seconds kEndsWithin{60};
  // So that those that are there go on undisturbed when a server with many begins.
  static constexpr int kStartsAtOnce = 4;

  explicit HostProcesses(Options options);
  ~HostProcesses();  // the processes live on
  HostProcesses(const HostProcesses&) = delete;
  HostProcesses& operator=(const HostProcesses&) = delete;

  // A process for the machine, now and whenever there is none; `after`: not before.
  // Errors: CellConfiguration, the program is not there; CellResourceExhausted.
  Status Enable(const std::string& machine, std::chrono::milliseconds after = {});
  // None any more; one that is there goes when its line tells it to.
  void Disable(const std::string& machine);
  // The machine is gone: so is what its host kept.
  void Forget(const std::string& machine);
  bool IsEnabled(const std::string& machine) const;

 private:
  struct Place {
    pid_t process = -1;
    bool wanted = true;
    bool follows = false;  // its last one was told to end, and the next comes at once
    std::chrono::steady_clock::time_point started{};
    std::chrono::steady_clock::time_point next_start{};
    RestartDelay delay{};
    std::deque<std::chrono::steady_clock::time_point> ends{};  // the newest
  };
  void Watch(const std::stop_token& stop);
  // Preconditions: mutex_ is held.
  void LookAt(const std::string& machine, Place& place);
  void Start(const std::string& machine, Place& place);
  void NoteEnd(const std::string& machine, Place& place, int how,
               std::chrono::steady_clock::time_point now);

  const Options options_;
  mutable std::mutex mutex_;
  std::map<std::string, Place> places_;          // by id of the machine; guarded by mutex_
  int starts_left_ = kStartsAtOnce;              // in this round; guarded by mutex_
  std::map<std::string, std::string> given_up_;  // and why; not told yet; guarded by mutex_
  std::condition_variable_any wanted_;
  std::jthread watcher_;
};

}  // namespace rmlcell::server
