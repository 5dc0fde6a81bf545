#include "server/machines/host_processes.h"

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "server/base/child_process.h"
#include "server/base/names.h"

namespace rmlcell::server {
namespace {

constexpr int kNotMine = 3;  // exit code of a host
constexpr std::chrono::seconds kLookWithoutHosts{5};
constexpr std::chrono::milliseconds kLookAtHosts{50};  // how soon a dead host is noticed

}  // namespace

HostProcesses::HostProcesses(Options options) : options_(std::move(options)) {
  watcher_ = std::jthread([this](const std::stop_token& stop) { Watch(stop); });
}

HostProcesses::~HostProcesses() {
  watcher_.request_stop();
  watcher_.join();
}

Status HostProcesses::Enable(const std::string& machine, std::chrono::milliseconds after) {
  if (const Status program = CheckProgram(options_.program); !program) return program.error();
  if (::mkdir(options_.journals.c_str(), S_IRWXU) != 0 && errno != EEXIST)
    return Error{
        ErrorCode::kCellConfiguration, options_.journals + ": " + std::strerror(errno), {}};
  const std::lock_guard lock(mutex_);
  if (!places_.contains(machine) && places_.size() >= options_.most) {
    return Error{
        ErrorCode::kCellResourceExhausted,
        std::to_string(options_.most) + " machines live, as many as machines.hosts_max allows",
        {}};
  }
  Place& place = places_[machine];
  // The one that was told to end may still be there: that is no failed start.
  if (!std::exchange(place.wanted, true)) place.follows = place.process > 0;
  place.ends.clear();
  if (place.process < 0) {
    place.delay = {};
    place.next_start = options_.clock() + after;
    LookAt(machine, place);
  }
  wanted_.notify_one();
  return {};
}

void HostProcesses::Disable(const std::string& machine) {
  const std::lock_guard lock(mutex_);
  if (const auto found = places_.find(machine); found != places_.end())
    found->second.wanted = false;
}

void HostProcesses::Forget(const std::string& machine) {
  Disable(machine);
  for (const char* kept : {".journal", ".journal.run", ".journal.orphan", ".log"})
    ::unlink((options_.journals + "/" + machine + kept).c_str());
}

bool HostProcesses::IsEnabled(const std::string& machine) const {
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(machine);
  return found != places_.end() && found->second.wanted;
}

void HostProcesses::LookAt(const std::string& machine, Place& place) {
  const auto now = options_.clock();
  int how = 0;
  if (place.process > 0 && ::waitpid(place.process, &how, WNOHANG) == place.process) {
    if (std::exchange(place.follows, false)) {
      place.delay = {};
      place.next_start = now;
    } else {
      place.next_start = now + place.delay.AfterLife(now - place.started);
    }
    place.process = -1;
    // In order, or because the machine is another host's: it is asked for again.
    const bool fine = WIFEXITED(how) && (WEXITSTATUS(how) == 0 || WEXITSTATUS(how) == kNotMine);
    if (place.wanted && !fine) NoteEnd(machine, place, how, now);
  }
  if (place.process > 0 || !place.wanted || now < place.next_start) return;
  if (options_.is_heard && options_.is_heard(machine)) return;
  if (starts_left_ > 0) Start(machine, place);
}

void HostProcesses::Start(const std::string& machine, Place& place) {
  --starts_left_;
  const auto now = options_.clock();
  const Result<pid_t> process = StartChild(
      {options_.program, "--host", MachineName(machine), "--server", options_.server, "--journal",
       options_.journals + "/" + machine + ".journal", "--log-level", options_.log_level,
       "--log-format", options_.log_format},
      {"RMLCELL_JOIN_TOKEN=" + options_.join_token}, options_.journals + "/" + machine + ".log");
  place.started = now;
  place.next_start = now + std::chrono::seconds(1);
  if (!process) {
    spdlog::error("the host of {} cannot be started: {}", machine, process.error().detail);
    return;
  }
  place.process = *process;
}

void HostProcesses::NoteEnd(const std::string& machine, Place& place, int how,
                            std::chrono::steady_clock::time_point now) {
  const std::string with = WIFSIGNALED(how) ? "signal " + std::to_string(WTERMSIG(how))
                                            : "code " + std::to_string(WEXITSTATUS(how));
  spdlog::warn("the host of {} ended with {}", machine, with);
  place.ends.push_back(now);
  while (now - place.ends.front() > kEndsWithin) place.ends.pop_front();
  if (place.ends.size() < kEndsMax) return;
  place.wanted = false;
  given_up_[machine] = "its host ended " + std::to_string(kEndsMax) +
                       " times within a minute, the last time with " + with + "; see " +
                       options_.journals + "/" + machine + ".log, then enable it";
}

void HostProcesses::Watch(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (places_.empty())
      wanted_.wait_for(lock, stop, kLookWithoutHosts, [this] { return !places_.empty(); });
    if (stop.stop_requested()) return;
    starts_left_ = kStartsAtOnce;
    for (auto& [machine, place] : places_) LookAt(machine, place);
    std::erase_if(places_,
                  [](const auto& row) { return !row.second.wanted && row.second.process < 0; });
    const std::map<std::string, std::string> given_up = std::exchange(given_up_, {});
    lock.unlock();
    for (const auto& [machine, why] : given_up) {
      spdlog::error("{}: {}", machine, why);
      if (options_.gave_up) options_.gave_up(machine, why);
    }
    if (options_.look) options_.look();
    lock.lock();
    wanted_.wait_for(lock, stop, kLookAtHosts, [] { return false; });
  }
}

}  // namespace rmlcell::server
