// What a worker is given, and what comes of it: leases, events, products, ends.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/events/event_feed.h"
#include "server/jobs/assignment.h"
#include "server/jobs/dispatcher_worker.h"
#include "server/jobs/running_heights.h"
#include "server/jobs/running_toolpath.h"
#include "server/records/job_messages.h"
#include "storage/jobs/job_rules.h"
#include "storage/trouble.h"

namespace rmlcell::server {
namespace {

// What a worker may send over its budget until it has noticed.
constexpr std::int64_t kOutputSlack = 1 << 20;

// What the worker told before it was lost.
void PutBefore(const std::vector<storage::NewEvent>& events, storage::LossPolicy& policy) {
  for (std::vector<storage::NewEvent>* list :
       {&policy.requeued, &policy.ended, &policy.interrupted, &policy.cancelled})
    list->insert(list->begin(), events.begin(), events.end());
}

bool SameLease(const storage::Lease& lease, const v1::WorkerLease& other) {
  return lease.job == other.job() && lease.attempt == other.attempt() &&
         lease.fence == other.fence();
}

}  // namespace

v1::WorkerLease ToProto(const storage::Lease& lease) {
  v1::WorkerLease message;
  message.set_job(lease.job);
  message.set_attempt(lease.attempt);
  message.set_fence(lease.fence);
  return message;
}

v1::WorkResponse ControlMessage(const storage::Lease& lease, const JobOrder& order) {
  v1::WorkResponse message;
  v1::WorkerControl& control = *message.mutable_control();
  *control.mutable_lease() = ToProto(lease);
  control.set_kind(order.kind);
  control.set_value(order.value);
  control.set_caller(order.caller);
  control.set_request_id(order.request_id);
  return message;
}

// It waits in the store: the transaction that makes a job ready gives it to it.
void Dispatcher::Assign(const std::shared_ptr<Worker>& worker) {
  if (worker->assignment) return;
  std::optional<storage::JobRequest> request;
  {
    const std::lock_guard lock(mutex_);
    // One that was given a job a moment ago may not know of it yet.
    if (!worker->stands && worker->job == 0) request = Wants(*worker);
    if (!request) return;
    worker->stands = true;
    worker->request = 0;
    ++standing_;
  }
  std::int64_t number = 0;
  try {
    number = store_.AwaitJobs(*std::move(request),
                              [this, worker](Result<std::vector<storage::LeasedJob>> leased) {
                                try {
                                  Stood(worker, std::move(leased));
                                } catch (const std::exception& error) {
                                  // What it was given is given to another when its lease ends.
                                  spdlog::error("worker {}: {}", worker->name, error.what());
                                  worker->line->Close(Error{ErrorCode::kCellInternal, {}, {}});
                                }
                                StandsNoMore();
                              });
  } catch (const std::exception& error) {
    Stood(worker, Error{ErrorCode::kCellInternal, error.what(), {}});
    return StandsNoMore();
  }
  bool in_vain = false;
  {
    const std::lock_guard lock(mutex_);
    worker->request = number;
    in_vain = worker->stands && (worker->gone || draining_);
  }
  if (in_vain) store_.Withdraw(number);
}

// On a thread of the store, before anybody else hears of the job: orders for it find its worker.
void Dispatcher::Stood(const std::shared_ptr<Worker>& worker,
                       Result<std::vector<storage::LeasedJob>> leased) {
  const bool found = leased && !leased->empty();
  {
    const std::lock_guard lock(mutex_);
    worker->stands = false;
    if (found) Has(*worker, leased->front().lease.job);
  }
  if (found) {
    auto job = std::make_shared<const storage::LeasedJob>(std::move(leased->front()));
    Post(worker, [this, worker, job] { Assigned(worker, *job); });
  } else {
    if (!leased) spdlog::error("no job could be leased: {}", bridge::ErrorText(leased.error()));
    Rest(*worker);
  }
}

void Dispatcher::StandsNoMore() {
  const std::lock_guard lock(mutex_);
  --standing_;
  changed_.notify_all();  // under the lock: it may be gone right after
}

void Dispatcher::Has(Worker& worker, std::int64_t job) {
  std::erase_if(worker.early_orders, [job](const EarlyOrder& early) { return early.job != job; });
  worker.looking = false;
  worker.idle = false;
  if (!HasWork()) to_look_at_.notify_all();
  worker.job = job;
}

// It asks again in a moment; one that is gone, or is to ask no more, does not.
void Dispatcher::Rest(Worker& worker) {
  const std::lock_guard lock(mutex_);
  if (worker.gone || draining_) return;
  worker.rests = true;
  later_ = true;
  to_look_at_.notify_all();
}

std::optional<storage::JobRequest> Dispatcher::Wants(const Worker& worker) const {
  if (worker.leaving || worker.gone || worker.rests || draining_) return std::nullopt;
  return storage::JobRequest{.worker = worker.name,
                             .server = server_,
                             .kinds = worker.kinds,
                             .pools = worker.pools,
                             .duration = std::chrono::milliseconds(config_.workers_lease_ms),
                             .events = {StateEvent(storage::JobState::kRunning)}};
}

// What the worker would take with the end of its job; nothing: it takes none. It looks until it has
// one or HasNotFound().
std::optional<storage::JobRequest> Dispatcher::Look(Worker& worker) {
  const std::lock_guard lock(mutex_);
  std::optional<storage::JobRequest> request = Wants(worker);
  worker.looking = request.has_value();
  return request;
}

void Dispatcher::HasNotFound(Worker& worker) {
  {
    const std::lock_guard lock(mutex_);
    worker.looking = false;
    worker.early_orders.clear();
  }
  changed_.notify_all();
}

void Dispatcher::Assigned(const std::shared_ptr<Worker>& worker, const storage::LeasedJob& leased) {
  worker->assignment.emplace();
  worker->assignment->lease = leased.lease;
  worker->assignment->renewed_at = worker->assignment->asked_at = clock_();
  {
    const std::lock_guard lock(mutex_);
    Has(*worker, leased.lease.job);
  }
  changed_.notify_all();
  if (worker->left) return Lose(worker);  // it went as it was given the job
  Begin(worker, leased);
}

void Dispatcher::Begin(const std::shared_ptr<Worker>& worker, const storage::LeasedJob& job) {
  // A job whose cancel came while its first worker gave it back: there is nothing to begin.
  if (job.job.cancel_requested) return EndWithoutWork(worker, storage::CancelledOutcome());
  // Its request was answered as it was withdrawn: the worker is not troubled with it.
  if (draining_) return GiveBack(worker);
  spdlog::debug("{} attempt {} goes to worker {}", JobName(job.lease.job), job.lease.attempt,
                worker->name);
  if (const Status sent = SendAssignment(*worker, job); !sent) {
    if (storage::IsTroubleOfTheStore(sent.error())) return RestWithoutWork(worker, sent.error());
    // The job itself cannot be worked on: it fails, and the worker is free for the next.
    return EndWithoutWork(worker, {.state = storage::JobState::kFailed,
                                   .code = sent.error().code,
                                   .detail = sent.error().detail});
  }
  // A worker that was told to stop before the job came to it drops the job and ends.
  if (draining_) GiveBack(worker);
}

void Dispatcher::EndWithoutWork(const std::shared_ptr<Worker>& worker,
                                const storage::JobOutcome& how) {
  worker->assignment->begun = true;  // as far as anybody could
  const v1::Outcome outcome = ToProto(how);
  Close(worker, std::make_shared<const storage::JobEnd>(storage::JobEnd{
                    .outcome = OutcomeOf(outcome), .events = {EndedEvent(outcome)}}));
}

// The job is as good as before, and its attempt does not count.
void Dispatcher::RestWithoutWork(const std::shared_ptr<Worker>& worker, const Error& trouble) {
  spdlog::warn("{} goes back, its programs cannot be read: {}",
               JobName(worker->assignment->lease.job), bridge::ErrorText(trouble));
  Rest(*worker);  // first, or this worker would be given it again at once
  storage::LossPolicy policy = LossOf(StoppedOutcome(), {}, "its programs could not be read");
  policy.requeued = {StateEvent(storage::JobState::kQueued)};
  Close(worker, HandBack{std::move(policy)});
}

void Dispatcher::Close(const std::shared_ptr<Worker>& worker, Closing how) {
  worker->assignment->closing = std::move(how);
  // Before anybody reads that it is over.
  TakeNoOrders(*worker, worker->assignment->lease.job);
  StoreClosing(worker);
}

// A store that is away for a moment throws nothing away: while the lease may be ours what becomes
// of the job is told it again and again. Then an end counts as an attempt that was lost, so that a
// full disk does not leave the job without an owner.
void Dispatcher::StoreClosing(const std::shared_ptr<Worker>& worker) {
  const Assignment& assignment = *worker->assignment;
  const storage::Lease& lease = assignment.lease;
  if (const auto* end = std::get_if<Finished>(&*assignment.closing)) {
    // The next job comes with the same commit.
    auto then = Then<storage::FinishedJob>(worker, [this, worker](const auto& finished) {
      if (!finished) return Closed(worker, finished.error(), {});
      Closed(worker, finished->job, finished->next);
    });
    return store_.SendFinish(lease, *end, Look(*worker), std::move(then));
  }
  auto then = Then<storage::JobRecord>(
      worker, [this, worker](const auto& job) { Closed(worker, job, {}); });
  if (const auto* back = std::get_if<HandBack>(&*assignment.closing)) {
    store_.SendHandBack(lease, back->policy, std::move(then));
  } else {
    store_.SendAbandon(lease, std::get<Lost>(*assignment.closing).policy, std::move(then));
  }
}

// `next`: what the worker was given with the end of the job.
void Dispatcher::Closed(const std::shared_ptr<Worker>& worker,
                        const Result<storage::JobRecord>& job,
                        const std::vector<storage::LeasedJob>& next) {
  if (next.empty()) HasNotFound(*worker);
  Assignment& assignment = *worker->assignment;
  const std::string name = JobName(assignment.lease.job);
  const auto* end = std::get_if<Finished>(&*assignment.closing);
  if (job && end != nullptr) {
    const std::optional<ErrorCode> code = (*end)->outcome.code;
    spdlog::info("{} {} {}", name, v1::Job::State_Name(ToProto(job->state)),
                 code ? CodeText(*code) : std::string());
  }
  if (!job) {
    spdlog::warn("{} of worker {}: {}", name, worker->name, bridge::ErrorText(job.error()));
    if (MayStillHold(assignment, job.error())) return TryLater(worker);
    if (end != nullptr && job.error().code != ErrorCode::kCellLeaseLost) {
      // What cannot be stored at all may be one of them.
      if (!storage::IsTroubleOfTheStore(job.error())) assignment.events.clear();
      return Lose(worker);
    }
  }
  EndAssignment(*worker, job && end != nullptr);
  // One that is gone by now loses it at once: that it left is the next thing that is said of it.
  if (!next.empty()) return Assigned(worker, next.front());
  Assign(worker);
}

bool Dispatcher::MayStillHold(const Assignment& assignment, const Error& trouble) const {
  return storage::IsTroubleOfTheStore(trouble) &&
         clock_() - assignment.renewed_at < std::chrono::milliseconds(config_.workers_lease_ms);
}

void Dispatcher::TryLater(const std::shared_ptr<Worker>& worker) {
  const std::lock_guard lock(mutex_);
  trying_later_.push_back(worker);
  later_ = true;
  to_look_at_.notify_all();
}

// What the store did not take a moment ago.
void Dispatcher::TryAgain() {
  std::vector<std::shared_ptr<Worker>> trying;
  std::vector<std::shared_ptr<Worker>> rested;
  {
    const std::lock_guard lock(mutex_);
    trying.swap(trying_later_);
    for (const auto& [id, worker] : workers_) {
      if (std::exchange(worker->rests, false)) rested.push_back(worker);
    }
  }
  for (const auto& worker : trying) {
    Post(worker, [this, worker] {
      if (!worker->assignment) return Assign(worker);
      worker->assignment->events_rest = false;
      if (worker->assignment->closing) StoreClosing(worker);
    });
  }
  for (const auto& worker : rested) Post(worker, [this, worker] { Assign(worker); });
}

void Dispatcher::GiveBack(const std::shared_ptr<Worker>& worker) {
  const Assignment& assignment = *worker->assignment;
  storage::LossPolicy policy = LossOf(StoppedOutcome(), assignment.place, "its worker stops");
  policy.requeued = {StateEvent(storage::JobState::kQueued)};
  PutBefore(assignment.events, policy);
  worker->leaving = true;
  Close(worker, HandBack{std::move(policy)});
}

Status Dispatcher::SendAssignment(Worker& worker, const storage::LeasedJob& leased) {
  Result<AssignmentMessages> made = MakeAssignment(store_, config_, leased);
  if (!made) return made.error();
  *made->first.mutable_assignment()->mutable_lease() = ToProto(leased.lease);
  worker.line->Send(std::move(made->first));
  for (auto& [slot, bytes] : made->programs) worker.line->SendProgram(slot, std::move(bytes));
  const std::lock_guard lock(mutex_);
  worker.sent = leased.lease;
  for (const EarlyOrder& early : std::exchange(worker.early_orders, {})) {
    if (early.job == leased.lease.job) worker.line->Send(ControlMessage(leased.lease, early.order));
  }
  return {};
}

void Dispatcher::Handle(const std::shared_ptr<Worker>& worker, v1::WorkRequest& message) {
  const auto holds = [&](const v1::WorkerLease& lease) {
    const bool its_own = worker->assignment && SameLease(worker->assignment->lease, lease);
    if (its_own) worker->assignment->begun = true;
    return its_own;
  };
  // What comes when it is said already what becomes of the job is not heard.
  const auto works = [&](const v1::WorkerLease& lease) {
    return holds(lease) && !worker->assignment->closing;
  };
  switch (message.message_case()) {
    case v1::WorkRequest::kHeartbeat:
      if (!holds(message.heartbeat().lease())) break;
      Heartbeat(worker, message.heartbeat());
      break;
    case v1::WorkRequest::kEvents:
      if (!works(message.events().lease())) break;
      for (const v1::JobEvent& event : message.events().events())
        worker->assignment->events.push_back(ToRecord(event));
      break;
    case v1::WorkRequest::kArtifact:
      if (works(message.artifact().lease())) Collect(*worker, *message.mutable_artifact());
      break;
    case v1::WorkRequest::kToolpath:
      if (works(message.toolpath().lease())) TakeToolpath(*worker, message.toolpath());
      break;
    case v1::WorkRequest::kHeights:
      if (works(message.heights().lease())) TakeHeights(*worker, message.heights());
      break;
    case v1::WorkRequest::kFinish:
      if (works(message.finish().lease())) Finish(worker, *message.mutable_finish());
      break;
    case v1::WorkRequest::kHandBack:
      // It gives back since it ends: others take the job.
      if (works(message.hand_back().lease())) GiveBack(worker);
      break;
    case v1::WorkRequest::kHello:
    case v1::WorkRequest::MESSAGE_NOT_SET:
      break;
  }
}

void Dispatcher::Heartbeat(const std::shared_ptr<Worker>& worker,
                           const v1::WorkerHeartbeat& heartbeat) {
  Assignment& assignment = *worker->assignment;
  if (heartbeat.has_progress()) {
    v1::JobProgress progress = heartbeat.progress();
    assignment.place = progress.place();
    progress.set_job(JobName(assignment.lease.job));
    progress.set_attempt(assignment.lease.attempt);
    feed_.Publish(JobName(assignment.lease.job), progress.SerializeAsString());
  }
  const auto third = std::chrono::milliseconds(config_.workers_lease_ms / 3);
  const auto now = clock_();
  if (now - assignment.asked_at < third) return;
  assignment.asked_at = now;
  store_.SendRenew(
      assignment.lease, std::chrono::milliseconds(config_.workers_lease_ms),
      Then<storage::JobRecord>(worker, [this, worker](const auto& job) { Renewed(worker, job); }));
}

void Dispatcher::Renewed(const std::shared_ptr<Worker>& worker,
                         const Result<storage::JobRecord>& job) {
  Assignment& assignment = *worker->assignment;
  const storage::Lease& lease = assignment.lease;
  if (job) {
    assignment.renewed_at = assignment.asked_at;
    // Another server may have been asked to cancel it.
    if (job->cancel_requested)
      worker->line->Send(ControlMessage(lease, {.kind = v1::WorkerControl::KIND_CANCEL}));
    return;
  }
  if (job.error().code != ErrorCode::kCellLeaseLost) return;
  spdlog::warn("worker {} lost its lease of {}", worker->name, JobName(lease.job));
  EndAssignment(*worker, false);
  Assign(worker);
}

// A worker waits until its events are durable. A store that is away for a moment gets them again,
// all in their order; when they cannot be made durable the worker is told to forget the job, or it
// would wait for ever.
void Dispatcher::StoreEvents(const std::shared_ptr<Worker>& worker) {
  const Assignment& assignment = *worker->assignment;
  const std::size_t count = assignment.events.size();
  store_.Append(assignment.lease, assignment.events,
                Then<std::int64_t>(worker, [this, worker, count](const auto& written) {
                  EventsStored(worker, count, written);
                }));
}

void Dispatcher::EventsStored(const std::shared_ptr<Worker>& worker, std::size_t count,
                              const Result<std::int64_t>& written) {
  Assignment& assignment = *worker->assignment;
  if (!written) {
    spdlog::warn("events of {}: {}", JobName(assignment.lease.job),
                 bridge::ErrorText(written.error()));
    if (!MayStillHold(assignment, written.error())) {
      assignment.events.clear();
      return Lose(worker);
    }
    assignment.events_rest = true;
    return TryLater(worker);
  }
  assignment.events.erase(assignment.events.begin(),
                          assignment.events.begin() + static_cast<std::ptrdiff_t>(count));
  assignment.events_stored += static_cast<std::int64_t>(count);
  v1::WorkResponse message;
  *message.mutable_events_stored()->mutable_lease() = ToProto(assignment.lease);
  message.mutable_events_stored()->set_count(assignment.events_stored);
  worker->line->Send(std::move(message));
}

void Dispatcher::TakeToolpath(Worker& worker, const v1::WorkerToolpath& toolpath) {
  Assignment& assignment = *worker.assignment;
  assignment.followed_bytes += static_cast<std::int64_t>(toolpath.frames().size());
  if (assignment.followed_bytes > config_.limit_output_bytes + kOutputSlack) {
    assignment.over_budget = true;  // as in Collect
    return;
  }
  std::shared_ptr<RunningToolpath> followed;
  {
    const std::lock_guard lock(mutex_);
    followed = worker.toolpath;
  }
  if (followed) followed->Add(toolpath.frames(), toolpath.open_block());
}

void Dispatcher::TakeHeights(Worker& worker, const v1::WorkerHeights& heights) {
  std::shared_ptr<RunningHeights> followed;
  {
    const std::lock_guard lock(mutex_);
    followed = worker.heights;
  }
  if (followed) followed->Add(heights);
}

void Dispatcher::Collect(Worker& worker, v1::WorkerArtifact& artifact) {
  Assignment& assignment = *worker.assignment;
  assignment.collected_bytes += static_cast<std::int64_t>(artifact.chunk().size());
  if (!assignment.artifacts.contains(artifact.name())) {
    assignment.collected_bytes +=
        static_cast<std::int64_t>(sizeof(storage::NewArtifact) + artifact.name().size());
  }
  // The worker keeps to the job's budget; this bound holds against a worker that does not.
  if (assignment.collected_bytes > config_.limit_output_bytes + kOutputSlack) {
    assignment.over_budget = true;
    assignment.artifacts.clear();
    return;
  }
  storage::NewArtifact& made = assignment.artifacts[artifact.name()];
  made.name = artifact.name();
  made.media_type = artifact.media_type();
  made.bytes += artifact.chunk();
}

void Dispatcher::Finish(const std::shared_ptr<Worker>& worker, v1::WorkerFinish& finish) {
  Assignment& assignment = *worker->assignment;
  for (v1::WorkerArtifact& artifact : *finish.mutable_artifacts()) Collect(*worker, artifact);
  if (assignment.over_budget) {
    *finish.mutable_outcome() = ToProto(storage::JobOutcome{
        .state = storage::JobState::kFailed, .code = ErrorCode::kCellOutputBudget, .detail = {}});
  }
  for (const v1::JobEvent& event : finish.events()) assignment.events.push_back(ToRecord(event));
  storage::JobEnd end{.outcome = OutcomeOf(finish.outcome()), .events = assignment.events};
  end.events.push_back(EndedEvent(finish.outcome()));
  for (auto& [name, artifact] : assignment.artifacts) end.artifacts.push_back(std::move(artifact));
  for (v1::LinkedExecutable& made : *finish.mutable_executables()) {
    if (made.content().size() > storage::kProgramBytesMax) continue;
    end.executables.push_back(
        {made.slot(), made.object_revision(), std::move(*made.mutable_content())});
  }
  Close(worker, std::make_shared<const storage::JobEnd>(std::move(end)));
}

void Dispatcher::EndAssignment(Worker& worker, bool stored) {
  const storage::Lease lease = worker.assignment->lease;
  worker.assignment.reset();
  feed_.Forget(JobName(lease.job));
  TakeNoOrders(worker, lease.job);  // before the worker hears of it
  std::shared_ptr<RunningToolpath> toolpath;
  std::shared_ptr<RunningHeights> heights;
  {
    const std::lock_guard lock(mutex_);
    toolpath.swap(worker.toolpath);
    heights.swap(worker.heights);
  }
  if (toolpath) toolpath->End(stored);
  if (heights) heights->End(stored);
  v1::WorkResponse message;
  *message.mutable_release()->mutable_lease() = ToProto(lease);
  message.mutable_release()->set_stored(stored);
  worker.line->Send(std::move(message));
  {
    const std::lock_guard lock(mutex_);
    worker.idle = true;
  }
  changed_.notify_all();
}

// Those for its next job, which may be leased already, wait for that.
void Dispatcher::TakeNoOrders(Worker& worker, std::int64_t job) {
  const std::lock_guard lock(mutex_);
  worker.job = 0;
  worker.sent.reset();
  std::erase_if(worker.early_orders, [job](const EarlyOrder& early) { return early.job == job; });
}

void Dispatcher::Lose(const std::shared_ptr<Worker>& worker) {
  const Assignment& assignment = *worker->assignment;
  const std::string attempt = "attempt " + std::to_string(assignment.lease.attempt);
  storage::LossPolicy policy =
      LossOf(WorkerDiedOutcome(), assignment.place,
             assignment.begun ? "the worker of " + attempt + " died"
                              : "the worker of " + attempt + " died before it began");
  policy.counts = assignment.begun;
  PutBefore(assignment.events, policy);
  Close(worker, Lost{std::move(policy)});
}

}  // namespace rmlcell::server
