#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include "proto/bridge/findings.h"
#include "server/base/config.h"
#include "server/base/executor.h"
#include "server/base/names.h"
#include "server/base/secret.h"
#include "server/base/version.h"
#include "server/events/event_feed.h"
#include "server/jobs/dispatcher_worker.h"
#include "server/jobs/running_heights.h"
#include "server/jobs/running_toolpath.h"
#include "server/records/job_messages.h"

namespace rmlcell::server {
namespace {

// Events that a worker may send before the first of them is durable.
constexpr int kEventsWindow = 256;
// What the store did not take or give.
constexpr std::chrono::milliseconds kTimesLookedAtAfter{1000};
constexpr std::chrono::milliseconds kStoreAskedAgainAfter{100};
// While jobs run. A server does not hear at once what is asked of another one.
constexpr std::chrono::milliseconds kOrdersLookedForAfter{200};

void SendStop(WorkerLine& line) {
  v1::WorkResponse message;
  message.mutable_stop()->set_reason("the server stops");
  line.Send(std::move(message));
}

}  // namespace

Dispatcher::Dispatcher(storage::Store& store, EventFeed& feed, const Config& config,
                       Executor& executor, std::string join_token, SteadyClock clock)
    : store_(store),
      feed_(feed),
      config_(config),
      executor_(executor),
      join_token_(std::move(join_token)),
      clock_(std::move(clock)) {
  orders_ = std::jthread([this](const std::stop_token& stop) { LookAtOrders(stop); });
  times_ = std::jthread([this](const std::stop_token& stop) { LookAtTimes(stop); });
}

Dispatcher::~Dispatcher() {
  draining_ = true;
  EndThreads();
  Settle();
}

Result<Dispatcher::WorkerId> Dispatcher::Join(std::shared_ptr<WorkerLine> line,
                                              const v1::WorkerHello& hello) {
  if (!KnowsSecret(hello.join_token(), join_token_))
    return Error{ErrorCode::kCellJoinRefused, {}, {}};
  if (hello.version() != kVersion) {
    return Error{ErrorCode::kCellVersionMismatch,
                 "the worker is " + hello.version() + ", the server " + std::string(kVersion),
                 {}};
  }
  auto worker = std::make_shared<Worker>();
  worker->name = hello.worker();
  worker->line = std::move(line);
  if (hello.pool().empty()) {
    worker->pools = {"", std::string(kPacedPool)};
  } else {
    worker->pools = {hello.pool() == kComputingWorkers ? "" : hello.pool()};
  }
  for (const int kind : hello.kinds()) {
    if (kind == v1::JOB_KIND_CHECK) worker->kinds.emplace_back("CHECK");
    if (kind == v1::JOB_KIND_SIMULATE) worker->kinds.emplace_back("SIMULATE");
  }
  v1::WorkResponse message;
  *message.mutable_welcome()->mutable_lease() =
      google::protobuf::util::TimeUtil::MillisecondsToDuration(config_.workers_lease_ms);
  message.mutable_welcome()->set_events_window(kEventsWindow);
  worker->line->Send(std::move(message));
  {
    const std::lock_guard lock(mutex_);
    worker->id = next_worker_++;
    workers_.emplace(worker->id, worker);
  }
  spdlog::info("worker {} joined (process {})", worker->name, hello.process_id());
  if (draining_) SendStop(*worker->line);
  Post(worker, [this, worker] { Assign(worker); });
  return worker->id;
}

std::shared_ptr<Dispatcher::Worker> Dispatcher::Find(WorkerId id) const {
  const std::lock_guard lock(mutex_);
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : found->second;
}

void Dispatcher::Receive(WorkerId id, v1::WorkRequest message) {
  const std::shared_ptr<Worker> worker = Find(id);
  if (worker == nullptr) return;
  auto shared = std::make_shared<v1::WorkRequest>(std::move(message));
  Post(worker, [this, worker, shared] { Handle(worker, *shared); });
}

void Dispatcher::Leave(WorkerId id) {
  std::shared_ptr<Worker> worker;
  std::int64_t request = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto found = workers_.find(id);
    if (found == workers_.end()) return;
    worker = found->second;
    worker->gone = true;
    if (worker->stands) request = worker->request;
    workers_.erase(found);
  }
  Post(worker, [this, worker] {
    worker->left = true;
    changed_.notify_all();
    // What it finished is stored without it.
    if (!worker->assignment || worker->assignment->closing) return;
    spdlog::warn("worker {} is gone in the middle of {}", worker->name,
                 JobName(worker->assignment->lease.job));
    Lose(worker);
  });
  if (request != 0) store_.Withdraw(request);
}

int Dispatcher::workers() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(workers_.size());
}

// Runs `work` after everything posted for this worker before, never two at once.
void Dispatcher::Post(const std::shared_ptr<Worker>& worker, std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    worker->queue.push_back(std::move(work));
    if (worker->working) return;
    worker->working = true;
    at_work_ += 2;
  }
  BeginWork(worker);
}

// Precondition: this call counts in at_work_. Whoever settles and then lets the executor go waits
// until the thread that posts, which may be one of the store, is out of it.
void Dispatcher::BeginWork(const std::shared_ptr<Worker>& worker) {
  executor_.Post([this, worker] { Work(worker); });
  const std::lock_guard lock(mutex_);
  --at_work_;
  changed_.notify_all();
}

// The next thing to do for a worker, or nothing, when its turn is over.
std::function<void()> Dispatcher::NextWork(const std::shared_ptr<Worker>& worker) {
  const std::lock_guard lock(mutex_);
  if (worker->awaits) {
    worker->parked = true;
    return {};
  }
  if (!worker->queue.empty()) {
    std::function<void()> next = std::move(worker->queue.front());
    worker->queue.pop_front();
    return next;
  }
  const std::optional<Assignment>& at = worker->assignment;
  if (at && !at->events.empty() && !at->events_rest && !at->closing)
    return [this, worker] { StoreEvents(worker); };
  worker->working = false;
  --at_work_;
  changed_.notify_all();
  return {};
}

void Dispatcher::Work(const std::shared_ptr<Worker>& worker) {
  while (const std::function<void()> next = NextWork(worker)) {
    try {
      next();
    } catch (const std::exception& error) {
      // A part of what it told may be missing: it leaves, and its job is attempted again.
      spdlog::error("worker {}: {}", worker->name, error.what());
      worker->line->Close(Error{ErrorCode::kCellInternal, {}, {}});
    }
  }
}

void Dispatcher::Await(const std::shared_ptr<Worker>& worker) {
  const std::lock_guard lock(mutex_);
  worker->awaits = true;
}

// The work that asked for the answer may still be at its end: then its thread goes on with `next`.
void Dispatcher::GoOn(const std::shared_ptr<Worker>& worker, std::function<void()> next) {
  {
    const std::lock_guard lock(mutex_);
    worker->queue.push_front(std::move(next));
    worker->awaits = false;
    if (!std::exchange(worker->parked, false)) return;
    ++at_work_;
  }
  BeginWork(worker);
}

// Leases that ran out, and jobs whose time has come.
void Dispatcher::LookAtTimes(const std::stop_token& stop) {
  const auto interval = std::min<std::chrono::milliseconds>(
      std::chrono::milliseconds(config_.workers_lease_ms / 2), kTimesLookedAtAfter);
  std::mutex mutex;
  std::condition_variable_any stopped;
  while (!stop.stop_requested()) {
    EndLeases();
    std::unique_lock lock(mutex);
    stopped.wait_for(lock, stop, interval, [] { return false; });
  }
}

void Dispatcher::LookAtOrders(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    TakeOrders();
    {
      std::unique_lock lock(mutex_);
      const bool working = HasWork();
      const auto changed = [&] { return later_ || HasWork() != working; };
      if (working) {
        to_look_at_.wait_for(lock, stop, kOrdersLookedForAfter, changed);
      } else {
        to_look_at_.wait(lock, stop, changed);
      }
      if (!later_) continue;
      to_look_at_.wait_for(lock, stop, kStoreAskedAgainAfter, [] { return false; });
      later_ = false;
    }
    TryAgain();
  }
}

bool Dispatcher::HasWork() const {
  return std::ranges::any_of(workers_, [](const auto& row) { return row.second->job != 0; });
}

// What clients of other servers ask of the jobs of this one.
void Dispatcher::TakeOrders() {
  {
    const std::lock_guard lock(mutex_);
    if (!HasWork()) return;
  }
  const auto orders = store_.TakeOrders(server_);
  if (!orders) {
    spdlog::warn("orders of other servers: {}", bridge::ErrorText(orders.error()));
    return;
  }
  for (const storage::TakenOrder& taken : *orders) {
    v1::WorkerControl control;
    if (!control.ParseFromString(taken.payload)) continue;  // of a newer server
    const JobOrder order{.kind = control.kind(),
                         .value = control.value(),
                         .caller = control.caller(),
                         .request_id = control.request_id()};
    const std::lock_guard lock(mutex_);
    OrderHolder(taken.lease.job, order);
  }
}

void Dispatcher::EndLeases() {
  const auto expired =
      store_.Expire(LossOf(WorkerDiedOutcome(), {}, "the lease of its worker ran out"));
  if (!expired) {
    spdlog::error("leases could not be looked at: {}", bridge::ErrorText(expired.error()));
    return;
  }
  for (const storage::JobRecord& job : *expired)
    spdlog::warn("the lease of {} ran out", JobName(job.id));
}

bool Dispatcher::OrderAtOnce(std::int64_t job, const JobOrder& order) {
  const std::lock_guard lock(mutex_);
  return OrderHolder(job, order);
}

// Before the job itself has gone out an order waits for it.
bool Dispatcher::OrderHolder(std::int64_t job, const JobOrder& order) {
  for (const auto& [id, worker] : workers_) {
    if (worker->job != job) continue;
    if (worker->sent) {
      worker->line->Send(ControlMessage(*worker->sent, order));
    } else {
      worker->early_orders.push_back({job, order});
    }
    return true;
  }
  return false;
}

template <class Running>
std::shared_ptr<Running> Dispatcher::Follow(std::int64_t job,
                                            std::shared_ptr<Running> Worker::*followed,
                                            v1::WorkerControl::Kind order) {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, worker] : workers_) {
    if (worker->job != job) continue;
    std::shared_ptr<Running>& running = *worker.*followed;
    if (running == nullptr) {
      running = std::make_shared<Running>();
      OrderHolder(job, {.kind = order});
    }
    return running;
  }
  return nullptr;
}

std::shared_ptr<RunningToolpath> Dispatcher::FollowToolpath(std::int64_t job) {
  return Follow(job, &Worker::toolpath, v1::WorkerControl::KIND_FOLLOW_TOOLPATH);
}

std::shared_ptr<RunningHeights> Dispatcher::FollowHeights(std::int64_t job) {
  return Follow(job, &Worker::heights, v1::WorkerControl::KIND_FOLLOW_HEIGHTS);
}

Status Dispatcher::Control(std::int64_t job, const JobOrder& order) {
  const auto record = store_.GetJob(job);
  if (!record) return record.error();
  const bool runs = record->state == storage::JobState::kRunning;
  if (runs && record->kind == storage::kRunKind)
    return Error{ErrorCode::kCellNotLive, "no machine is heard of that runs " + JobName(job), {}};
  if (runs && OrderAtOnce(job, order)) return {};
  // Perhaps another server has it; one that waits, or has ended, nobody has.
  const Status put =
      store_.PutOrder(job, server_, ControlMessage({}, order).control().SerializeAsString());
  if (put || put.error().code != ErrorCode::kCellPrecondition) return put;
  // The store has written this by now, so that whoever stood for the job there has heard of it. Who
  // looks for a further one may have leased it a moment ago, and not have said so.
  if (runs) {
    const std::lock_guard lock(mutex_);
    if (OrderHolder(job, order)) return {};
    bool may_come = false;
    for (const auto& [id, worker] : workers_) {
      if (!worker->looking) continue;
      worker->early_orders.push_back({job, order});
      may_come = true;
    }
    if (may_come) return {};
  }
  return Error{ErrorCode::kCellPrecondition, JobName(job) + " does not run", {}};
}

Result<storage::JobRecord> Dispatcher::Cancel(std::int64_t job, std::string_view caller,
                                              std::string_view request_id) {
  auto cancelled = store_.RequestCancel(job, {By(caller, CancelledEvent())});
  if (cancelled) TellCancel(*cancelled, caller, request_id);
  return cancelled;
}

void Dispatcher::TellCancel(const storage::JobRecord& job, std::string_view caller,
                            std::string_view request_id) {
  if (job.state != storage::JobState::kRunning) return;
  // When the worker finishes at this moment there is nobody to tell, and nothing to do.
  (void)Control(job.id, {.kind = v1::WorkerControl::KIND_CANCEL,
                         .caller = std::string(caller),
                         .request_id = std::string(request_id)});
}

void Dispatcher::Drain(std::chrono::milliseconds patience) {
  draining_ = true;
  WithdrawAll();
  std::vector<std::shared_ptr<Worker>> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, worker] : workers_) all.push_back(worker);
  }
  for (const auto& worker : all) SendStop(*worker->line);
  {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [this] {
      return std::ranges::all_of(workers_, [](const auto& row) {
        return row.second->idle && !row.second->looking && !row.second->stands;
      });
    });
  }
  // From here on nothing is posted but what lines still say.
  EndThreads();
}

void Dispatcher::WithdrawAll() {
  std::vector<std::int64_t> requests;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, worker] : workers_) {
      if (worker->stands && worker->request != 0) requests.push_back(worker->request);
    }
  }
  for (const std::int64_t request : requests) store_.Withdraw(request);
}

void Dispatcher::EndThreads() {
  for (std::jthread* thread : {&orders_, &times_}) {
    thread->request_stop();
    if (thread->joinable()) thread->join();
  }
}

void Dispatcher::Settle() {
  if (draining_) WithdrawAll();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return at_work_ == 0 && (standing_ == 0 || !draining_); });
}

}  // namespace rmlcell::server
