#include "server/worker/job_lease.h"

#include <time.h>

#include <algorithm>
#include <optional>

#include "engine/core/units.h"

namespace rmlcell::server {

double ThreadProcessorTime_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

JobLease::JobLease(ServerLine& line, const v1::WorkerAssignment& assignment,
                   const std::atomic<bool>& stopping, ProcessorTime processor_time)
    : line_(line),
      assignment_(assignment),
      stopping_(stopping),
      processor_time_(std::move(processor_time)),
      started_s_(processor_time_()) {}

bool JobLease::IsMine(const v1::WorkerLease& lease) const {
  return lease.job() == assignment_.lease().job() && lease.fence() == assignment_.lease().fence();
}

void JobLease::Take(const v1::WorkResponse& message) {
  if (message.has_stop()) {
    stop_asked_ = true;
  } else if (message.has_release() && IsMine(message.release().lease())) {
    released_ = true;
  } else if (message.has_events_stored() && IsMine(message.events_stored().lease())) {
    events_stored_ = message.events_stored().count();
  } else if (message.has_control() && IsMine(message.control().lease())) {
    if (message.control().kind() == v1::WorkerControl::KIND_FOLLOW_TOOLPATH) {
      toolpath_followed_ = true;
    } else if (message.control().kind() == v1::WorkerControl::KIND_FOLLOW_HEIGHTS) {
      heights_followed_ = true;
    } else {
      orders_.push_back(message.control());
    }
  }
}

void JobLease::Listen(std::chrono::milliseconds patience) {
  while (const std::optional<v1::WorkResponse> message = line_.Receive(patience)) {
    Take(*message);
    if (released_ || has_orders()) return;
  }
}

bool JobLease::over_time() const {
  return processor_time_() - started_s_ > ToSeconds(SimTime(assignment_.budget().processor_ns()));
}

Stop JobLease::StopAsked() {
  while (const std::optional<v1::WorkResponse> message = line_.TryReceive()) Take(*message);
  if (lost()) return Stop::kLost;
  if (hand_back_asked()) return Stop::kHandBack;
  if (std::ranges::count(orders_, v1::WorkerControl::KIND_CANCEL, &v1::WorkerControl::kind) > 0)
    return Stop::kCancel;
  return over_time() ? Stop::kOverTime : Stop::kNone;
}

void JobLease::SendEvents(const v1::WorkerEvents& events) {
  v1::WorkRequest message;
  *message.mutable_events() = events;
  *message.mutable_events()->mutable_lease() = assignment_.lease();
  if (!line_.Send(message)) return;
  events_sent_ += events.events_size();
  while (events_sent_ - events_stored_ > line_.events_window() && !lost() && !has_orders()) {
    if (const std::optional<v1::WorkResponse> answer =
            line_.Receive(std::chrono::milliseconds(100)))
      Take(*answer);
  }
}

void JobLease::SendProgress(const v1::JobProgress& progress) {
  // One that stands is where it was: who follows it is told nothing.
  std::string position = progress.SerializeAsString();
  if (position == position_) return;
  position_ = std::move(position);
  v1::WorkRequest message;
  *message.mutable_heartbeat()->mutable_lease() = assignment_.lease();
  *message.mutable_heartbeat()->mutable_progress() = progress;
  line_.Send(message);
}

void JobLease::SendFinish(v1::WorkerFinish finish) {
  v1::WorkRequest message;
  *message.mutable_finish() = std::move(finish);
  *message.mutable_finish()->mutable_lease() = assignment_.lease();
  line_.Send(message);
}

}  // namespace rmlcell::server
