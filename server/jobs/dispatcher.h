#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "rmlcell/v1/worker.pb.h"
#include "server/base/secret.h"
#include "server/base/steady_clock.h"
#include "storage/store.h"

namespace rmlcell::server {

class EventFeed;
class Executor;
class RunningHeights;
class RunningToolpath;
struct Config;

// The line to one worker, as the dispatcher sees it: no gRPC here. Never blocks; after Close
// nothing is sent.
class WorkerLine {
 public:
  virtual ~WorkerLine() = default;
  virtual void Send(v1::WorkResponse message) = 0;
  // The bytes of one program, cut into messages as the line takes them.
  virtual void SendProgram(int slot, std::shared_ptr<const std::string> bytes) = 0;
  virtual void Close(const Error& why) = 0;
};

struct HandBack;
struct Lost;
using Closing = std::variant<std::shared_ptr<const storage::JobEnd>, HandBack, Lost>;

// What a client wants of a job that runs.
struct JobOrder {
  v1::WorkerControl::Kind kind{};
  double value = 0.0;  // of an override, percent
  std::string caller{};
  std::string request_id{};
};

// Leases jobs to workers, takes their events and results, and sees to it that no job is lost with
// its worker (design.md section 3, steps 3 to 9). A lease is held by one worker; what a worker
// sends after it lost its lease is refused by the fence.
//
// Thread-safe; calls from the lines return at once: messages of one worker are worked through in
// order on the executor. Lock order: mutex_, then that of a line.
class Dispatcher {
 public:
  Dispatcher(storage::Store& store, EventFeed& feed, const Config& config, Executor& executor,
             std::string join_token, SteadyClock clock = SteadyTime);
  ~Dispatcher();
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  using WorkerId = std::int64_t;
  // Errors: CellJoinRefused, CellVersionMismatch.
  Result<WorkerId> Join(std::shared_ptr<WorkerLine> line, const v1::WorkerHello& hello);
  void Receive(WorkerId worker, v1::WorkRequest message);
  void Leave(WorkerId worker);  // the line is gone: its job is attempted again by its policy

  // Orders for a job that runs, here or at another server of the store, which hears of it within a
  // second. CellPrecondition when no worker has it.
  Status Control(std::int64_t job, const JobOrder& order);
  // The same without a look into the store, and never blocking: an order to stop waits for nothing.
  // False: no worker of this server is known to have it, which Control finds out.
  bool OrderAtOnce(std::int64_t job, const JobOrder& order);

  // The toolpath of a job that a worker of this server has, as it is made; null: none has it.
  std::shared_ptr<RunningToolpath> FollowToolpath(std::int64_t job);
  // Likewise what is left of its block.
  std::shared_ptr<RunningHeights> FollowHeights(std::int64_t job);

  // Ends a job: at once when it waits, else through its worker.
  Result<storage::JobRecord> Cancel(std::int64_t job, std::string_view caller,
                                    std::string_view request_id = {});
  // Tells the worker of a job that runs, here or at another server, that it is to be cancelled.
  void TellCancel(const storage::JobRecord& job, std::string_view caller,
                  std::string_view request_id = {});

  // Gives out no more work and asks for what is under way to be handed back. Returns when that is
  // done, or after `patience`. For good: leases are not looked after any more.
  void Drain(std::chrono::milliseconds patience);

  // Waits until nothing of it is under way on the executor and, behind Drain(), no request of it
  // stands in the store. Precondition of the last one: nobody calls it any more.
  void Settle();

  int workers() const;

 private:
  struct Worker;
  struct Assignment;
  template <class T, class Next>
  class Answer;

  void Post(const std::shared_ptr<Worker>& worker, std::function<void()> work);
  std::function<void()> NextWork(const std::shared_ptr<Worker>& worker);
  void Work(const std::shared_ptr<Worker>& worker);
  // What came of a call of the store, as the next thing that is done for the worker; until then
  // nothing is. To be called from work for this worker, for the last thing in it.
  template <class T, class Next>
  storage::Done<T> Then(const std::shared_ptr<Worker>& worker, Next next);
  void Await(const std::shared_ptr<Worker>& worker);
  void GoOn(const std::shared_ptr<Worker>& worker, std::function<void()> next);
  void Assign(const std::shared_ptr<Worker>& worker);
  void Stood(const std::shared_ptr<Worker>& worker, Result<std::vector<storage::LeasedJob>> leased);
  void StandsNoMore();
  void Has(Worker& worker, std::int64_t job);  // precondition: mutex_ is held
  void WithdrawAll();
  std::optional<storage::JobRequest> Wants(const Worker& worker) const;  // likewise
  std::optional<storage::JobRequest> Look(Worker& worker);
  void HasNotFound(Worker& worker);
  void Rest(Worker& worker);
  void BeginWork(const std::shared_ptr<Worker>& worker);
  void Assigned(const std::shared_ptr<Worker>& worker, const storage::LeasedJob& leased);
  void Begin(const std::shared_ptr<Worker>& worker, const storage::LeasedJob& job);
  void EndWithoutWork(const std::shared_ptr<Worker>& worker, const storage::JobOutcome& how);
  void GiveBack(const std::shared_ptr<Worker>& worker);
  Status SendAssignment(Worker& worker, const storage::LeasedJob& leased);
  // Precondition: mutex_ is held. False: no worker is known to have the job.
  bool OrderHolder(std::int64_t job, const JobOrder& order);
  void Handle(const std::shared_ptr<Worker>& worker, v1::WorkRequest& message);
  void Heartbeat(const std::shared_ptr<Worker>& worker, const v1::WorkerHeartbeat& heartbeat);
  void Renewed(const std::shared_ptr<Worker>& worker, const Result<storage::JobRecord>& job);
  void StoreEvents(const std::shared_ptr<Worker>& worker);
  void EventsStored(const std::shared_ptr<Worker>& worker, std::size_t count,
                    const Result<std::int64_t>& written);
  template <class Running>
  std::shared_ptr<Running> Follow(std::int64_t job, std::shared_ptr<Running> Worker::*followed,
                                  v1::WorkerControl::Kind order);
  void TakeHeights(Worker& worker, const v1::WorkerHeights& heights);
  void TakeToolpath(Worker& worker, const v1::WorkerToolpath& toolpath);
  void Collect(Worker& worker, v1::WorkerArtifact& artifact);
  void Finish(const std::shared_ptr<Worker>& worker, v1::WorkerFinish& finish);
  void RestWithoutWork(const std::shared_ptr<Worker>& worker, const Error& trouble);
  void Close(const std::shared_ptr<Worker>& worker, Closing how);
  void StoreClosing(const std::shared_ptr<Worker>& worker);
  void Closed(const std::shared_ptr<Worker>& worker, const Result<storage::JobRecord>& job,
              const std::vector<storage::LeasedJob>& next);
  void TryAgain();
  void EndAssignment(Worker& worker, bool stored);
  void TakeNoOrders(Worker& worker, std::int64_t job);  // its job is over
  void Lose(const std::shared_ptr<Worker>& worker);
  void EndThreads();
  void LookAtOrders(const std::stop_token& stop);
  void LookAtTimes(const std::stop_token& stop);
  void EndLeases();
  void TakeOrders();
  bool HasWork() const;  // precondition: mutex_ is held
  bool MayStillHold(const Assignment& assignment, const Error& trouble) const;
  void TryLater(const std::shared_ptr<Worker>& worker);
  std::shared_ptr<Worker> Find(WorkerId id) const;

  storage::Store& store_;
  EventFeed& feed_;
  const Config& config_;
  Executor& executor_;
  std::string join_token_;
  const std::string server_ = RandomText();  // what the store knows this server by
  SteadyClock clock_;
  std::atomic<bool> draining_ = false;

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;     // for who waits until there is nothing more to do
  std::condition_variable_any to_look_at_;  // a first job, or later_
  std::map<WorkerId, std::shared_ptr<Worker>> workers_;
  WorkerId next_worker_ = 1;
  std::size_t at_work_ = 0;   // guarded by mutex_; workers that something is done or awaited for,
                              // and calls that begin it
  std::size_t standing_ = 0;  // guarded by mutex_; requests that the store has not answered
  std::vector<std::shared_ptr<Worker>> trying_later_;  // guarded by mutex_; gone ones, too
  bool later_ = false;  // guarded by mutex_; something is to be tried again in a moment
  std::jthread orders_;
  std::jthread times_;  // its own thread: it waits for the store
};

}  // namespace rmlcell::server
