#include "server/worker/heart.h"

#include <chrono>

namespace rmlcell::server {

Heart::Heart(ServerLine& line) : line_(line), thread_([this] { Run(); }) {}

Heart::~Heart() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_one();
  thread_.join();
}

void Heart::BeatFor(const v1::WorkerLease& lease) {
  v1::WorkRequest beat;
  *beat.mutable_heartbeat()->mutable_lease() = lease;
  line_.Send(beat);  // from here on the attempt counts
  const std::lock_guard lock(mutex_);
  beat_ = std::move(beat);
}

void Heart::Rest() {
  const std::lock_guard lock(mutex_);
  beat_.reset();
}

void Heart::Run() {
  const std::chrono::milliseconds third(line_.lease_ms() / 3);
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, third, [this] { return stopping_; })) {
    if (beat_) line_.Send(*beat_);
  }
}

}  // namespace rmlcell::server
