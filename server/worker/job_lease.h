#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "rmlcell/v1/worker.pb.h"
#include "server/worker/server_line.h"

namespace rmlcell::server {

// Why work on a job should end where it is, the most pressing first.
enum class Stop {
  kNone,
  kLost,      // the lease is another's, or the line is gone: nothing counts any more
  kHandBack,  // this process is to end: another does the job
  kCancel,
  kOverTime,  // of the processor
};

// Seconds of processor time that the calling thread has used, from any point on.
using ProcessorTime = std::function<double()>;
double ThreadProcessorTime_s();

// The lease on one job: what the server orders while it lasts, and what goes out for it. For the
// thread that works on the job.
class JobLease {
 public:
  // All outlive this. The time of the processor counts from here. `stopping` becomes true when the
  // process is to end.
  JobLease(ServerLine& line, const v1::WorkerAssignment& assignment,
           const std::atomic<bool>& stopping, ProcessorTime processor_time);

  // Takes in a message; one that is of another lease changes nothing.
  void Take(const v1::WorkResponse& message);
  // Takes in what comes, up to an order: what is there, and what arrives within `patience`.
  void Listen(std::chrono::milliseconds patience);

  // Orders wait until the run is between two steps: they come in while the run itself tells of an
  // event. Those that were not taken yet, in order.
  bool has_orders() const { return !orders_.empty(); }
  std::vector<v1::WorkerControl> TakeOrders() { return std::exchange(orders_, {}); }

  // Somebody follows the toolpath: it is to be sent as it is made.
  bool toolpath_followed() const { return toolpath_followed_; }

  // Somebody looks at what is left of the block: what changes is to be sent.
  bool heights_followed() const { return heights_followed_; }

  bool lost() const { return released_ || line_.gone(); }
  bool stop_asked() const { return stop_asked_; }  // by the server: the process is to end
  bool hand_back_asked() const { return stopping_ || stop_asked_; }
  bool over_time() const;
  // Whether to end, for work that is no run and has nobody who takes its orders.
  Stop StopAsked();

  // At most a window of events is under way: a store that is slow slows the run, not the memory. An
  // order does not wait for the store: with one there, the run comes to where it is carried out.
  void SendEvents(const v1::WorkerEvents& events);
  void SendProgress(const v1::JobProgress& progress);
  void SendFinish(v1::WorkerFinish finish);

 private:
  bool IsMine(const v1::WorkerLease& lease) const;

  ServerLine& line_;
  const v1::WorkerAssignment& assignment_;
  const std::atomic<bool>& stopping_;
  ProcessorTime processor_time_;
  double started_s_;      // of the processor
  std::string position_;  // that was sent last
  std::int64_t events_sent_ = 0;
  std::int64_t events_stored_ = 0;
  std::vector<v1::WorkerControl> orders_;  // not carried out yet
  bool toolpath_followed_ = false;
  bool heights_followed_ = false;
  bool released_ = false;
  bool stop_asked_ = false;
};

}  // namespace rmlcell::server
