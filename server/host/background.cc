#include "server/host/background.h"

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <utility>

namespace rmlcell::server {
namespace {

constexpr int kNice = 10;

}  // namespace

bool Background::Do(std::function<void(const std::stop_token&)> work) {
  if (std::exchange(busy_, true)) return false;
  thread_ = std::jthread([work = std::move(work)](const std::stop_token& stop) {
    // Of this thread alone.
    static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice));
    work(stop);
  });
  return true;
}

double ThreadTime_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace rmlcell::server
