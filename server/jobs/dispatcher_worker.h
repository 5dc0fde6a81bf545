#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/dispatcher.h"

// What the dispatcher knows of a worker. Only its own sources include this.
namespace rmlcell::server {

// What becomes of a job: its end, back into the queue, or an attempt that was lost.
using Finished = std::shared_ptr<const storage::JobEnd>;
struct HandBack {
  storage::LossPolicy policy{};
};
struct Lost {
  storage::LossPolicy policy{};
};

// What a worker is at. Touched only by work posted for this worker, which runs in order.
struct Dispatcher::Assignment {
  storage::Lease lease;
  std::chrono::steady_clock::time_point renewed_at;  // the lease may be ours for its time from here
  std::chrono::steady_clock::time_point asked_at;    // to renew it
  std::map<std::string, storage::NewArtifact> artifacts;
  std::int64_t collected_bytes = 0;
  std::int64_t followed_bytes = 0;  // of its toolpath, before its end
  bool over_budget = false;
  std::optional<Closing> closing;  // said, and not stored yet
  bool begun = false;              // the worker has said so
  v1::SourcePlace place;           // where the worker was, as it last said
  // Events that the store does not have yet, and how many it has. They go when nothing else is to
  // be done for the worker, and with the end of the job at the latest.
  std::vector<storage::NewEvent> events;
  std::int64_t events_stored = 0;
  bool events_rest = false;  // the store did not take them a moment ago
};

struct EarlyOrder {
  std::int64_t job = 0;
  JobOrder order{};
};

struct Dispatcher::Worker {
  WorkerId id = 0;
  std::string name;
  std::shared_ptr<WorkerLine> line;
  std::vector<std::string> kinds;
  std::vector<std::string> pools;
  std::optional<Assignment> assignment;
  bool leaving = false;  // it handed its job back, since it ends; as `assignment`
  bool left = false;     // its line is gone, and what it had is settled; likewise

  // Guarded by Dispatcher::mutex_.
  std::deque<std::function<void()>> queue;
  bool working = false;  // somebody does, or awaits, what is in the queue
  bool awaits = false;   // an answer of the store, which comes before the queue
  bool parked = false;   // nobody is at it until the answer comes
  bool gone = false;
  bool idle = true;
  bool rests = false;                  // the store failed it a moment ago
  bool stands = false;                 // the store gives it a job as soon as there is one
  std::int64_t request = 0;            // by which the store knows that, as soon as it has said so
  bool looking = false;                // one may come with the end of its job; for Drain, Control
  std::int64_t job = 0;                // 0: none; for orders
  std::optional<storage::Lease> sent;  // of the same job, from when the assignment has gone out
  std::shared_ptr<RunningToolpath> toolpath;  // of its job, where it is followed
  std::shared_ptr<RunningHeights> heights;    // likewise
  std::vector<EarlyOrder> early_orders;  // for a job that has not gone out; while it looks, any job
};

// An answer that does not come, since what asked for it threw, is an error.
template <class T, class Next>
class Dispatcher::Answer {
 public:
  Answer(Dispatcher& dispatcher, std::shared_ptr<Worker> worker, Next next)
      : dispatcher_(dispatcher), worker_(std::move(worker)), next_(std::move(next)) {}
  ~Answer() {
    if (!given_) Give(Error{ErrorCode::kCellInternal, "the store was not asked", {}});
  }
  Answer(const Answer&) = delete;
  Answer& operator=(const Answer&) = delete;

  void Give(Result<T> answer) {
    given_ = true;
    auto shared = std::make_shared<Result<T>>(std::move(answer));
    dispatcher_.GoOn(worker_, [next = next_, shared] { next(*shared); });
  }

 private:
  Dispatcher& dispatcher_;
  std::shared_ptr<Worker> worker_;
  Next next_;
  bool given_ = false;
};

template <class T, class Next>
storage::Done<T> Dispatcher::Then(const std::shared_ptr<Worker>& worker, Next next) {
  auto answer = std::make_shared<Answer<T, Next>>(*this, worker, std::move(next));
  Await(worker);
  return [answer](Result<T> given) { answer->Give(std::move(given)); };
}

v1::WorkerLease ToProto(const storage::Lease& lease);
// An order for the worker that holds the lease.
v1::WorkResponse ControlMessage(const storage::Lease& lease, const JobOrder& order);

}  // namespace rmlcell::server
