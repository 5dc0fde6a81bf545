#pragma once

#include <atomic>
#include <map>
#include <string>
#include <utility>

#include "rmlcell/v1/worker.pb.h"
#include "server/worker/heart.h"
#include "server/worker/job_lease.h"
#include "server/worker/server_line.h"

namespace rmlcell::server {

// Works on one assignment: translates, runs in virtual time, tells events and positions, sends
// products and the outcome. Everything that can go wrong with a job ends as its outcome.
class JobRunner {
 public:
  // `stopping` becomes true when the process is to end: the job is handed back.
  JobRunner(ServerLine& line, const std::atomic<bool>& stopping,
            ProcessorTime processor_time = ThreadProcessorTime_s)
      : line_(line),
        stopping_(stopping),
        processor_time_(std::move(processor_time)),
        heart_(line) {}

  // Returns when the lease is over: finished, handed back, or lost. False: the worker is to end.
  bool Work(v1::WorkerAssignment assignment);

 private:
  ServerLine& line_;
  const std::atomic<bool>& stopping_;
  ProcessorTime processor_time_;
  Heart heart_;
};

}  // namespace rmlcell::server
