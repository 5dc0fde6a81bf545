// Jobs, leases, events and artifacts.
#include <algorithm>
#include <exception>
#include <span>

#include "storage/content.h"
#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/executable_life.h"
#include "storage/sqlite/job_changes.h"
#include "storage/sqlite/job_life.h"
#include "storage/sqlite/queue_life.h"
#include "storage/sqlite/sqlite_store_impl.h"

namespace rmlcell::storage::sqlite {
namespace {

Error EventsGone(const std::string& what, std::int64_t until) {
  return Error{ErrorCode::kCellEventsGone,
               "those " + what + " up to " + std::to_string(until) + " were removed; watch from " +
                   std::to_string(until),
               {}};
}

std::size_t BytesOf(const std::vector<NewEvent>& events) {
  std::size_t bytes = 0;
  for (const NewEvent& event : events) bytes += sizeof(event) + event.payload.size();
  return bytes;
}

// A job with all that is made ready on the thread of the caller.
class Submission {
 public:
  explicit Submission(NewJob job) : job_(std::move(job)) {}
  Submission(const Submission&) = delete;
  Submission& operator=(const Submission&) = delete;

  Status Prepare(Writer& writer, RequestIds& ids, const Clock& clock) {
    contents_.request_id = job_.request_id.empty() ? ids.Make(clock()) : job_.request_id;
    staged_.reserve(job_.attachments.size() + 1);
    if (const Status specification = Stage(StagedContent::Make(
            writer, job_.specification, StagedContent::Place::kRecordWhenSmall));
        !specification)
      return specification.error();
    contents_.specification = &staged_.back().content();
    for (const NewArtifact& attachment : job_.attachments) {
      if (const Status attached = Stage(StagedContent::Of(writer, attachment)); !attached)
        return attached.error();
      contents_.attachments.push_back(&staged_.back().content());
    }
    return {};
  }

  Result<SubmittedJob> Run(WriteContext& context) { return SubmitJob(context, job_, contents_); }

  // After the last Run(): what the answer needs is moved from the request, not copied.
  void Complete(SubmittedJob& submitted) {
    if (!submitted.already_there) submitted.job.specification = std::move(job_.specification);
  }

  std::size_t bytes() const {
    std::size_t bytes = sizeof(*this) + job_.specification.size() + BytesOf(job_.events);
    for (const NewArtifact& attachment : job_.attachments) {
      bytes += sizeof(attachment) + attachment.bytes.size();
    }
    return bytes;
  }

 private:
  Status Stage(Result<StagedContent> content) {
    if (!content) return content.error();
    staged_.push_back(*std::move(content));
    return {};
  }

  NewJob job_;
  std::vector<StagedContent> staged_;
  JobContents contents_{};
};

class SubmitOperation final : public WriteOperation {
 public:
  SubmitOperation(NewJob job, Done<SubmittedJob> done)
      : submission_(std::move(job)), done_(std::move(done)) {}

  Submission& submission() { return submission_; }

  Status Run(WriteContext& context) override {
    submitted_ = submission_.Run(context);
    return submitted_ ? Status() : Status(submitted_.error());
  }

  void Answer(const Status& status) override {
    if (!status) return done_(status.error());
    submission_.Complete(*submitted_);
    done_(std::move(submitted_));
  }

 private:
  Submission submission_;
  Done<SubmittedJob> done_;
  Result<SubmittedJob> submitted_ = SubmittedJob{};
};

// Of a job that is leased: damage is met when somebody works on it.
void ReadSpecification(WriteContext& context, JobRecord& job) {
  if (!CompleteJob(context.tables, job, context.now)) job.specification.clear();
}

// A worker that waits for a job.
class StandingRequest final : public WriteOperation {
 public:
  StandingRequest(std::int64_t number, JobRequest request, Done<std::vector<LeasedJob>> done)
      : number_(number), request_(std::move(request)), done_(std::move(done)) {}

  Status Run(WriteContext& context) override {
    Result<std::vector<LeasedJob>> leased = LeaseJobs(context, request_);
    if (!leased) return leased.error();
    leased_ = *std::move(leased);
    for (LeasedJob& one : leased_) ReadSpecification(context, one.job);
    return {};
  }
  void Answer(const Status& status) override {
    if (!status) return done_(status.error());
    done_(std::move(leased_));
  }
  std::int64_t StandsAs() const override { return leased_.empty() ? number_ : 0; }
  void Undone() override { leased_.clear(); }
  bool AsksAs(const WriteOperation& other) const override {
    const auto* request = dynamic_cast<const StandingRequest*>(&other);
    return request != nullptr && request->request_.kinds == request_.kinds &&
           request->request_.pools == request_.pools &&
           request->request_.run_machines == request_.run_machines &&
           request->request_.job == request_.job;
  }

 private:
  const std::int64_t number_;
  const JobRequest request_;
  Done<std::vector<LeasedJob>> done_;
  std::vector<LeasedJob> leased_;  // of the newest run
};

// What is written ahead piece by piece, and takes as long as the disk does.
bool IsLarge(const JobEnd& end) {
  return std::ranges::any_of(end.artifacts,
                             [](const NewArtifact& a) { return a.bytes.size() > kChunkBytes; }) ||
         std::ranges::any_of(end.executables,
                             [](const NewExecutable& e) { return e.bytes.size() > kChunkBytes; });
}

}  // namespace

// The contents of a job's end, made ready on the thread that prepares it.
class StagedEnd {
 public:
  StagedEnd() = default;
  StagedEnd(const StagedEnd&) = delete;
  StagedEnd& operator=(const StagedEnd&) = delete;

  Status Prepare(Writer& writer, const JobEnd& end) {
    staged_.reserve(end.artifacts.size() + end.executables.size());
    if (const Status added = Add(writer, end.artifacts); !added) return added.error();
    for (const NewExecutable& executable : end.executables) {
      if (const Status added = Add(StageExecutable(writer, executable.bytes)); !added)
        return added.error();
    }
    return {};
  }

  Status Prepare(Writer& writer, const LateProducts& products) {
    staged_.reserve(products.artifacts.size());
    return Add(writer, products.artifacts);
  }

  Result<JobRecord> Run(WriteContext& context, std::int64_t job,
                        const LateProducts& products) const {
    return AddLateProducts(context, job, products, artifacts_);
  }

  Result<JobRecord> Run(WriteContext& context, const Lease& lease, const JobEnd& end) const {
    const std::span executables = std::span(staged_).subspan(artifacts_.size());
    Result<JobRecord> job = FinishJob(context, lease, end, artifacts_);
    for (std::size_t i = 0; job && i < executables.size(); ++i) {
      const NewExecutable& made = end.executables[i];
      const auto kept = PutExecutableBlob(context, job->machine, made.slot, made.object_revision,
                                          executables[i].content(), WithoutRoom::kDropped, {});
      if (!kept) return kept.error();
    }
    return job;
  }

 private:
  Status Add(Writer& writer, const std::vector<NewArtifact>& artifacts) {
    for (const NewArtifact& artifact : artifacts) {
      if (const Status added = Add(StagedContent::Of(writer, artifact)); !added)
        return added.error();
      artifacts_.push_back(&staged_.back().content());
    }
    return {};
  }
  Status Add(Result<StagedContent> content) {
    if (!content) return content.error();
    staged_.push_back(*std::move(content));
    return {};
  }

  std::vector<StagedContent> staged_;
  std::vector<const PreparedContent*> artifacts_;
};

SqliteStore::SqliteStore(Parts parts)
    : lock_(std::move(parts.lock)),
      clock_(parts.clock),
      log_id_(std::move(parts.log_id)),
      connection_(std::move(parts.connection)),
      readers_(std::move(parts.readers)),
      writer_(*connection_, parts.counters, std::move(parts.machines), parts.writer,
              std::move(parts.clock), [this] { watchers_.Notify(); }) {}

void SqliteStore::Submit(NewJob job, Done<SubmittedJob> done) {
  const auto company = job.more_come ? Writer::Company::kComes : Writer::Company::kNone;
  auto operation = std::make_unique<SubmitOperation>(std::move(job), std::move(done));
  const Status prepared = operation->submission().Prepare(writer_, request_ids_, clock_);
  if (!prepared) return operation->Answer(prepared);
  const std::size_t bytes = operation->submission().bytes();
  writer_.Post(std::move(operation), bytes, company);
}

Result<SubmittedJob> SqliteStore::SubmitAndWait(NewJob job) {
  Submission submission(std::move(job));
  if (const Status prepared = submission.Prepare(writer_, request_ids_, clock_); !prepared)
    return prepared.error();
  Result<SubmittedJob> submitted =
      writer_.Do([&](WriteContext& context) { return submission.Run(context); });
  if (submitted) submission.Complete(*submitted);
  return submitted;
}

Result<std::optional<JobRecord>> SqliteStore::FindSubmitted(std::string_view request_id,
                                                            std::string_view request_hash) {
  return readers_->Read([&](Tables& tables) -> Result<std::optional<JobRecord>> {
    Result<std::optional<JobRow>> known = tables.jobs.FindByRequest(request_id);
    if (!known) return known.error();
    if (!*known) return std::optional<JobRecord>();
    JobRecord& job = (*known)->job;
    if (job.request_hash != request_hash) return RequestIdReused(job.id);
    if (const Status whole = CompleteJob(tables, job, clock_()); !whole) return whole.error();
    return std::optional<JobRecord>(std::move(job));
  });
}

Result<JobRecord> SqliteStore::GetJob(std::int64_t id) {
  return readers_->Read([&](Tables& tables) -> Result<JobRecord> {
    Result<JobRow> row = GetRow(tables, id);
    if (!row) return row.error();
    if (const Status whole = CompleteJob(tables, row->job, clock_()); !whole) return whole.error();
    return std::move(row->job);
  });
}

Result<std::vector<JobRecord>> SqliteStore::ListJobs(const JobQuery& query) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<JobRecord>> {
    Result<std::vector<JobRecord>> jobs = tables.jobs.List(query);
    if (!jobs) return jobs.error();
    for (JobRecord& job : *jobs) {
      if (const Status whole = CompleteJob(tables, job, clock_()); !whole) return whole.error();
    }
    return jobs;
  });
}

Result<std::vector<AttemptRecord>> SqliteStore::ListAttempts(std::int64_t job) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<AttemptRecord>> {
    const Result<JobRow> row = GetRow(tables, job);
    if (!row) return row.error();
    return tables.attempts.List(job);
  });
}

Result<JobCounts> SqliteStore::CountJobs() { return writer_.job_counts(); }

Result<std::vector<JobStateCount>> SqliteStore::CountByState(const JobQuery& query) {
  return readers_->Read([&](Tables& tables) { return tables.jobs.CountByState(query); });
}

Result<std::vector<MachineJobs>> SqliteStore::UnfinishedJobs() { return writer_.machine_jobs(); }

Status SqliteStore::DeleteJob(std::int64_t id, std::string_view caller) {
  return writer_.Do([&](WriteContext& context) { return RemoveEndedJob(context, id, caller); });
}

Result<JobRecord> SqliteStore::RequestCancel(std::int64_t job,
                                             const std::vector<NewEvent>& events) {
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return CancelJob(context, job, events); }));
}

void SqliteStore::SendRequestCancel(std::int64_t job, std::vector<NewEvent> events,
                                    Done<JobRecord> done) {
  writer_.Send([job, events = std::move(events)](
                   WriteContext& context) { return CancelJob(context, job, events); },
               std::move(done));
}

Result<JobRecord> SqliteStore::HoldBack(std::int64_t job, const std::vector<NewEvent>& events) {
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return HoldJobBack(context, job, events); }));
}

Result<std::vector<JobRecord>> SqliteStore::ActOn(std::span<const std::int64_t> jobs, QueueAct act,
                                                  const EventOf& event) {
  return writer_.Do([&](WriteContext& context) { return ActOnJobs(context, jobs, act, event); });
}

Result<JobRecord> SqliteStore::LetGo(std::int64_t job, const std::vector<NewEvent>& events) {
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return LetJobGo(context, job, events); }));
}

Result<JobRecord> SqliteStore::Move(std::int64_t job, std::int64_t before,
                                    std::optional<int> priority,
                                    const std::vector<NewEvent>& events) {
  return WithSpecification(writer_.Do(
      [&](WriteContext& context) { return MoveJob(context, job, before, priority, events); }));
}

Result<std::int64_t> SqliteStore::CountBefore(std::int64_t job) {
  return readers_->Read([&](Tables& tables) { return sqlite::CountBefore(tables, job); });
}

Status SqliteStore::PutOrder(std::int64_t job, std::string_view from, std::string_view payload) {
  return writer_.Do(
      [&](WriteContext& context) { return PutJobOrder(context, job, from, payload); });
}

Result<std::vector<TakenOrder>> SqliteStore::TakeOrders(std::string_view server) {
  const Result<bool> any = readers_->Read([](Tables& tables) { return tables.orders.Any(); });
  if (!any) return any.error();
  if (!*any) return std::vector<TakenOrder>();
  return writer_.Do([&](WriteContext& context) { return TakeJobOrders(context, server); });
}

Result<std::vector<LeasedJob>> SqliteStore::AcquireJobs(const JobRequest& request) {
  // Most who ask find nothing, and that must not keep the writer busy. One that is asked for by its
  // number may be held.
  if (!request.job && !writer_.any_ready_job()) return std::vector<LeasedJob>();
  Result<std::vector<LeasedJob>> leased =
      writer_.Do([&](WriteContext& context) { return LeaseJobs(context, request); });
  if (!leased) return leased;
  for (LeasedJob& one : *leased) {
    Result<JobRecord> whole = WithSpecification(std::move(one.job));
    if (!whole) return whole.error();
    one.job = *std::move(whole);
  }
  return leased;
}

std::int64_t SqliteStore::AwaitJobs(JobRequest request, Done<std::vector<LeasedJob>> done) {
  const std::int64_t number = ++last_request_;
  writer_.Post(std::make_unique<StandingRequest>(number, std::move(request), std::move(done)), 0);
  return number;
}

void SqliteStore::Withdraw(std::int64_t request) { writer_.EndStanding(request); }

Result<JobRecord> SqliteStore::Renew(const Lease& lease, std::chrono::milliseconds duration) {
  return writer_.Do([&](WriteContext& context) { return RenewLease(context, lease, duration); });
}

void SqliteStore::SendRenew(const Lease& lease, std::chrono::milliseconds duration,
                            Done<JobRecord> done) {
  writer_.Send(
      [lease, duration](WriteContext& context) { return RenewLease(context, lease, duration); },
      std::move(done));
}

void SqliteStore::Append(const Lease& lease, std::vector<NewEvent> events,
                         Done<std::int64_t> done) {
  const std::size_t bytes = sizeof(lease) + BytesOf(events);
  writer_.Send([lease, events = std::move(events)](
                   WriteContext& context) { return AppendEvents(context, lease, events); },
               std::move(done), bytes);
}

Result<std::int64_t> SqliteStore::AppendAndWait(const Lease& lease, std::vector<NewEvent> events) {
  return writer_.Do([&](WriteContext& context) { return AppendEvents(context, lease, events); });
}

Result<JobRecord> SqliteStore::Finish(const Lease& lease, const JobEnd& end) {
  StagedEnd staged;
  if (const Status made = staged.Prepare(writer_, end); !made) return made.error();
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return staged.Run(context, lease, end); }));
}

Result<JobRecord> SqliteStore::AddProducts(std::int64_t job, const LateProducts& products) {
  StagedEnd staged;
  if (const Status made = staged.Prepare(writer_, products); !made) return made.error();
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return staged.Run(context, job, products); }));
}

void SqliteStore::SendFinish(const Lease& lease, std::shared_ptr<const JobEnd> end,
                             std::optional<JobRequest> next, Done<FinishedJob> done) {
  if (!IsLarge(*end)) {
    const auto staged = std::make_shared<StagedEnd>();
    if (const Status made = staged->Prepare(writer_, *end); !made) return done(made.error());
    return SendStaged(lease, std::move(end), staged, std::move(next), std::move(done));
  }
  const auto holder = std::make_shared<const EndsUnderWay::Holder>(ends_, lease.fence);
  staging_.Post(
      [this, lease, end = std::move(end), next = std::move(next), holder, done = std::move(done)] {
        std::shared_ptr<StagedEnd> staged;
        std::optional<Error> failed;
        try {
          staged = std::make_shared<StagedEnd>();
          if (const Status made = staged->Prepare(writer_, *end); !made) failed = made.error();
        } catch (const std::exception& error) {
          failed = Error{ErrorCode::kCellStoreFailed, error.what(), {}};
        }
        if (failed) return done(*std::move(failed));
        SendStaged(lease, end, staged, next,
                   [holder, done](Result<FinishedJob> job) { done(std::move(job)); });
      });
}

// A job of the queue that cannot be leased would undo the end with it: then the end goes alone.
void SqliteStore::SendStaged(const Lease& lease, std::shared_ptr<const JobEnd> end,
                             std::shared_ptr<const StagedEnd> staged,
                             const std::optional<JobRequest>& next, Done<FinishedJob> done) {
  const auto work = [lease, end, staged, next](WriteContext& context) -> Result<FinishedJob> {
    Result<JobRecord> job = staged->Run(context, lease, *end);
    if (!job) return job.error();
    FinishedJob finished{.job = *std::move(job)};
    if (!next) return finished;
    Result<std::vector<LeasedJob>> leased = LeaseJobs(context, *next);
    if (!leased) return leased.error();
    for (LeasedJob& one : *leased) ReadSpecification(context, one.job);
    finished.next = *std::move(leased);
    return finished;
  };
  if (!next) return writer_.Send(work, std::move(done));
  writer_.Send(work, [this, lease, end, staged, done](Result<FinishedJob> finished) {
    if (finished || finished.error().code == ErrorCode::kCellLeaseLost)
      return done(std::move(finished));
    SendStaged(lease, end, staged, {}, done);
  });
}

Result<JobRecord> SqliteStore::HandBack(const Lease& lease, const LossPolicy& policy) {
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return HandBackJob(context, lease, policy); }));
}

void SqliteStore::SendHandBack(const Lease& lease, LossPolicy policy, Done<JobRecord> done) {
  writer_.Send([lease, policy = std::move(policy)](
                   WriteContext& context) { return HandBackJob(context, lease, policy); },
               std::move(done));
}

Result<JobRecord> SqliteStore::Abandon(const Lease& lease, const LossPolicy& policy) {
  return WithSpecification(
      writer_.Do([&](WriteContext& context) { return AbandonJob(context, lease, policy); }));
}

void SqliteStore::SendAbandon(const Lease& lease, LossPolicy policy, Done<JobRecord> done) {
  writer_.Send([lease, policy = std::move(policy)](
                   WriteContext& context) { return AbandonJob(context, lease, policy); },
               std::move(done));
}

// One write for each lease: a job that cannot be read must not keep the others from going on.
Result<std::vector<JobRecord>> SqliteStore::Expire(const LossPolicy& policy) {
  if (!IsFinal(policy.outcome.state)) {
    return Error{ErrorCode::kCellInvalidArgument, "an outcome has to be final", {}};
  }
  const WallTime now = clock_();
  const Result<bool> due = readers_->Read([&](Tables& tables) -> Result<bool> {
    const Result<std::vector<std::int64_t>> jobs = tables.queue.Due(now);
    if (!jobs) return jobs.error();
    return !jobs->empty();
  });
  if (!due) return due.error();
  if (*due) {
    const Status gone = writer_.Do([](WriteContext& context) { return LetDueJobsGo(context); });
    if (!gone) return gone.error();
  }
  const auto upload = readers_->Read([&](Tables& tables) { return tables.uploads.FirstDue(now); });
  if (!upload) return upload.error();
  if (*upload) {
    const Status tidy = writer_.Do([](WriteContext& context) -> Status {
      context.garbage = true;  // tidying forgets them
      return {};
    });
    if (!tidy) return tidy.error();
  }
  const Result<std::vector<Lease>> leases =
      readers_->Read([&](Tables& tables) { return tables.leases.RunOut(now); });
  if (!leases) return leases.error();
  std::vector<JobRecord> changed;
  std::optional<Error> failure;
  for (const Lease& lease : *leases) {
    if (ends_.Has(lease.fence)) continue;
    Result<std::optional<JobRecord>> job =
        writer_.Do([&](WriteContext& context) { return ExpireLease(context, lease, policy); });
    if (!job) {
      failure = job.error();
    } else if (*job) {
      Result<JobRecord> whole = WithSpecification(**std::move(job));
      changed.push_back(*std::move(whole));
    }
  }
  if (failure && changed.empty()) return *failure;
  return changed;
}

Result<std::vector<EventRecord>> SqliteStore::JobEvents(std::int64_t job,
                                                        std::int64_t after_sequence, int limit) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<EventRecord>> {
    const Result<JobRow> row = GetRow(tables, job);
    if (!row) return row.error();
    const std::int64_t gone = row->job.events_gone_until;
    if (after_sequence < gone) return EventsGone("of job " + std::to_string(job), gone);
    return tables.events.OfJob(job, after_sequence, std::max(limit, 0));
  });
}

Result<std::vector<EventRecord>> SqliteStore::AllEvents(std::int64_t after_position, int limit) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<EventRecord>> {
    const Result<std::int64_t> gone = tables.marks.Get(MarkTable::kEventsGoneUntil);
    if (!gone) return gone.error();
    if (after_position < *gone) return EventsGone("at positions", *gone);
    return tables.events.All(after_position, std::max(limit, 0));
  });
}

Result<std::int64_t> SqliteStore::LastPosition() {
  return readers_->Read([](Tables& tables) -> Result<std::int64_t> {
    const Result<std::int64_t> there = tables.events.LastPosition();
    if (!there) return there.error();
    const Result<std::int64_t> mark = tables.marks.Get(MarkTable::kPosition);
    if (!mark) return mark.error();
    return std::max(*there, *mark);
  });
}

Result<std::int64_t> SqliteStore::EventsGoneUntil() {
  return readers_->Read(
      [](Tables& tables) { return tables.marks.Get(MarkTable::kEventsGoneUntil); });
}

Result<bool> SqliteStore::HasPosition(std::string_view log_id, std::int64_t position) {
  const Result<std::int64_t> last = LastPosition();
  if (!last) return last.error();
  return readers_->Read([&](Tables& tables) -> Result<bool> {
    const Result<std::optional<std::int64_t>> end = tables.log_parts.EndOf(log_id);
    if (!end) return end.error();
    return *end && position <= std::min(**end, *last);
  });
}

std::unique_ptr<Store::Subscription> SqliteStore::Watch(std::function<void()> changed) {
  return watchers_.Add(std::move(changed));
}

Result<JobRecord> SqliteStore::WithSpecification(Result<JobRecord> job) {
  if (!job) return job.error();
  const Status whole =
      readers_->Read([&](Tables& tables) -> Status { return CompleteJob(tables, *job, clock_()); });
  // The change is durable by now, and that is what the caller has to know. Whoever needs the
  // specification meets the damage with GetJob().
  if (!whole) job->specification.clear();
  return job;
}

}  // namespace rmlcell::storage::sqlite
