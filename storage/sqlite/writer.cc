#include "storage/sqlite/writer.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <string>
#include <utility>

namespace rmlcell::storage::sqlite {
namespace {

// Operations in one transaction at most, so that the first of them is not kept waiting for the last
// of a long queue.
constexpr std::size_t kBatchMax = 1'024;

// Log size at which it is moved into the database file: 16 MiB when the writer has nothing else to
// do, so that a commit seldom has to wait for it; four times that when it is busy, as pages that
// are written over and over are moved once only.
constexpr int kCheckpointPages = 4'096;
constexpr int kCheckpointPagesWhenBusy = 4 * kCheckpointPages;

// A caller that waits for its write on its own stack.
struct Waiter {
  std::mutex mutex;
  std::condition_variable answered;
  bool done = false;
  Status status;
};

class WaitingOperation final : public WriteOperation {
 public:
  WaitingOperation(std::function<Status(WriteContext&)> run, Waiter& waiter)
      : run_(std::move(run)), waiter_(waiter) {}

  Status Run(WriteContext& context) override { return run_(context); }

  void Answer(const Status& status) override {
    // Told under the lock: the waiter, and its mutex, are gone as soon as it sees `done`.
    const std::lock_guard lock(waiter_.mutex);
    waiter_.status = status;
    waiter_.done = true;
    waiter_.answered.notify_one();
  }

 private:
  std::function<Status(WriteContext&)> run_;
  Waiter& waiter_;
};

}  // namespace

// Its answer is given by who has the turn, as all that stands is looked at by nobody else.
class Writer::Withdrawal final : public WriteOperation {
 public:
  Withdrawal(Writer& writer, std::int64_t number) : writer_(writer), number_(number) {}
  Status Run(WriteContext&) override { return {}; }
  void Answer(const Status&) override { writer_.AnswerStanding(number_); }

 private:
  Writer& writer_;
  const std::int64_t number_;
};

Writer::Writer(Connection& connection, const Counters& counters, MachineTally::Machines machines,
               const Options& options, Clock clock, std::function<void()> changed)
    : options_(options),
      clock_(std::move(clock)),
      changed_(std::move(changed)),
      housekeeping_(options.keep),
      connection_(connection),
      counters_(counters),
      fence_mark_(counters.fence),
      changes_(connection.database),
      machine_jobs_(std::move(machines)),
      queued_jobs_(counters.queued_jobs),
      ready_jobs_(counters.queued_jobs - counters.blocked_jobs),
      running_jobs_(counters.running_jobs),
      thread_([this] { Loop(); }) {}

Writer::~Writer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_.notify_one();
  thread_.join();
  for (const Pending& pending : std::exchange(standing_, {})) pending.operation->Answer({});
}

void Writer::Post(std::unique_ptr<WriteOperation> operation, std::size_t bytes, Company company) {
  bool enough = false;
  bool alone = false;
  {
    const std::lock_guard lock(mutex_);
    const bool full = queue_.size() >= options_.waiting_operations_max ||
                      waiting_bytes_ + bytes > options_.waiting_bytes_max;
    // One operation is always taken, however large: else it could never be written.
    if (bytes == 0 || !full || queue_.empty()) {
      waiting_bytes_ += bytes;
      queue_.push_back({.operation = std::move(operation), .bytes = bytes, .status = {}});
    }
    alone = operation == nullptr && company == Company::kNone && TakeTurnAlone();
    // Who has the turn looks at the queue again, unless it waits for callers to come together.
    enough = !alone && queue_.size() >= wanted_ && (!turn_taken_ || wanted_ > 1);
  }
  if (operation != nullptr) {
    operation->Answer(Error{ErrorCode::kCellResourceExhausted,
                            "more writes wait for the disk than the store takes",
                            {}});
    return;
  }
  if (alone) {
    WorkAlone();
  } else if (enough) {
    work_.notify_one();
  }
}

void Writer::EndStanding(std::int64_t number) {
  Post(std::make_unique<Withdrawal>(*this, number), 0, Company::kComes);
}

void Writer::AnswerStanding(std::int64_t number) {
  const auto found = std::ranges::find_if(standing_, [number](const Pending& pending) {
    return pending.operation->StandsAs() == number;
  });
  if (found == standing_.end()) return;
  const Pending pending = std::move(*found);
  standing_.erase(found);
  pending.operation->Answer({});
}

// Under mutex_.
bool Writer::TakeTurnAlone() {
  if (turn_taken_ || stopping_ || chores_ || last_batch_ > 1 || queue_.size() != 1) return false;
  turn_taken_ = true;
  has_turn_ = std::this_thread::get_id();
  return true;
}

void Writer::WorkAlone() {
  RunBatch(Take());
  AnswerAndTell();
  const bool chores = tidy_ || LogIsLarge(kCheckpointPages);
  has_turn_ = std::thread::id();
  bool work = false;
  {
    const std::lock_guard lock(mutex_);
    turn_taken_ = false;
    chores_ = chores_ || chores;
    work = chores_ || stopping_ || !queue_.empty();
  }
  if (work) work_.notify_one();
}

Status Writer::RunAndWait(Run run) {
  Waiter waiter;
  auto operation = std::make_unique<WaitingOperation>(std::move(run), waiter);
  if (std::this_thread::get_id() == has_turn_.load()) return RunFromAnswer(std::move(operation));
  Post(std::move(operation), 0);
  std::unique_lock lock(waiter.mutex);
  waiter.answered.wait(lock, [&] { return waiter.done; });
  return waiter.status;
}

// An answer that writes: there is nobody else who could. What was queued before goes first; its
// answers wait until the one that is being given returns.
Status Writer::RunFromAnswer(std::unique_ptr<WriteOperation> operation) {
  const WriteOperation* const own = operation.get();
  Post(std::move(operation), 0);
  for (;;) {
    RunBatch(Take());
    const auto found = std::ranges::find_if(
        answers_, [own](const Pending& pending) { return pending.operation.get() == own; });
    if (found != answers_.end()) {
      Status status = std::move(found->status);
      answers_.erase(found);
      return status;
    }
  }
}

void Writer::Loop() {
  has_turn_ = std::this_thread::get_id();
  while (WaitForWork()) {
    RunBatch(Take());
    AnswerAndTell();
    Tidy();
    CheckpointWhenLarge();
  }
}

// False: there is nothing more to do, for ever.
bool Writer::WaitForWork() {
  std::unique_lock lock(mutex_);
  if (!tidy_) {
    has_turn_ = std::thread::id();
    turn_taken_ = false;
    work_.wait(lock, [this] { return !turn_taken_ && (!queue_.empty() || chores_ || stopping_); });
    turn_taken_ = true;
    has_turn_ = std::this_thread::get_id();
  }
  chores_ = false;
  // Callers that were answered together come back one by one, and the first of them would get a
  // commit, and a sync of the disk, of its own.
  if (last_batch_ > 1) {
    wanted_ = last_batch_;
    work_.wait_for(lock, options_.group_window,
                   [this] { return queue_.size() >= wanted_ || stopping_; });
    wanted_ = 1;
  }
  return !queue_.empty() || !stopping_;
}

Writer::Batch Writer::Take() {
  Batch batch;
  const std::lock_guard lock(mutex_);
  const std::size_t count = std::min(queue_.size(), kBatchMax);
  batch.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    waiting_bytes_ -= queue_.front().bytes;
    batch.push_back(std::move(queue_.front()));
    queue_.pop_front();
  }
  last_batch_ = count;
  return batch;
}

void Writer::RunBatch(Batch batch) {
  if (batch.empty()) return;
  if (RunTogether(batch, Undo::kWithAll) != Outcome::kLost || batch.size() == 1) return Keep(batch);
  // One of them may be to blame, such as a program that no longer fits on the disk: each for
  // itself.
  for (Pending& pending : batch) {
    const std::span alone(&pending, 1);
    RunTogether(alone, Undo::kAlone);
    Keep(alone);
  }
}

// When one failed in the middle of its writes all is run again, and this time each can be undone
// alone.
Writer::Outcome Writer::RunTogether(std::span<Pending> batch, Undo undo) {
  Outcome outcome = TryBatch(batch, undo);
  while (outcome == Outcome::kSpoilt) outcome = TryBatch(batch, Undo::kAlone);
  return outcome;
}

// To be answered, or to stand. Those that stood and have what they stood for, or failed, are
// answered before those that made it.
void Writer::Keep(std::span<Pending> batch) {
  std::deque<Pending> still;
  const auto keep = [&](Pending& pending) {
    auto& to = pending.stands() ? still : answers_;
    to.push_back(std::move(pending));
  };
  std::ranges::for_each(standing_, keep);
  std::ranges::for_each(batch, keep);
  standing_ = std::move(still);
}

// One transaction. kCommitted: every operation has its own status. Else nothing of it is there;
// when it was lost, every operation has the reason as its status.
Writer::Outcome Writer::TryBatch(std::span<Pending> batch, Undo undo) {
  const Counters before = counters_;
  std::vector<Pending*> stood;
  const auto undo_all = [&](Outcome outcome) {
    counters_ = before;
    for (Pending* pending : stood) {
      pending->operation->Undone();
      pending->status = {};
    }
    return outcome;
  };
  const auto lose = [&](const Error& reason) {
    for (Pending& pending : batch) pending.status = reason;
    return undo_all(Outcome::kLost);
  };
  Result<Transaction> transaction =
      Transaction::Begin(connection_.transactions, Transaction::Kind::kWrite);
  if (!transaction) {
    lose(transaction.error());
    return Outcome::kCommitted;  // not the fault of any of them, and each alone would wait as long
                                 // again
  }
  WriteContext context{.tables = connection_.tables,
                       .counters = counters_,
                       .program_memory = options_.program_memory,
                       .machines = machine_jobs_,
                       .now = {}};
  Result<bool> run = RunEach(batch, context, undo, *transaction);
  if (!run) return lose(run.error());
  if (*run) {
    run = RunStanding(batch, context, undo, *transaction, stood);
    if (!run) {
      // The others shall not suffer for one that waits: without it.
      Pending& to_blame = *stood.back();
      undo_all(Outcome::kSpoilt);
      to_blame.status = run.error();
      to_blame.barred = true;
      return Outcome::kSpoilt;
    }
  }
  if (!*run) return undo_all(Outcome::kSpoilt);
  if (const Status kept = KeepMarks(before, context); !kept) return lose(kept.error());
  if (const Status committed = Commit(*transaction); !committed) return lose(committed.error());
  fence_mark_ = FenceMark();
  PublishCounts(context);
  tidy_ = tidy_ || context.garbage || housekeeping_.IsDue(counters_);
  untold_ = untold_ || context.changed;
  return Outcome::kCommitted;
}

// Those that stand take their turn behind the others.
Result<bool> Writer::RunEach(std::span<Pending> batch, WriteContext& context, Undo undo,
                             const Transaction& transaction) {
  for (Pending& pending : batch) {
    if (pending.operation->StandsAs() != 0) {
      if (!pending.barred) pending.status = {};
      context.ready = true;  // what was ready before it came, too
      continue;
    }
    const Result<bool> run = RunSoundly(pending, context, undo, transaction);
    if (!run || !*run) return run;
  }
  return true;
}

Result<bool> Writer::RunSoundly(Pending& pending, WriteContext& context, Undo undo,
                                const Transaction& transaction) {
  if (const Status sound = RunOne(pending, context, undo); !sound) return sound.error();
  if (pending.status) return true;
  // SQLite has ended the transaction: what followed would each be a transaction of its own.
  if (!transaction.alive()) return Error(pending.status.error());
  return undo == Undo::kAlone || !pending.wrote;
}

// Who has stood longest first, and those of the batch last. Of those that ask for the same only the
// first is run when there is nothing for it. Added to `run`: those that were run; with an error the
// last of them is to blame.
Result<bool> Writer::RunStanding(std::span<Pending> batch, WriteContext& context, Undo undo,
                                 const Transaction& transaction, std::vector<Pending*>& run) {
  std::vector<const WriteOperation*> in_vain;
  const auto give = [&](Pending& pending) -> Result<bool> {
    if (!context.ready || counters_.queued_jobs == counters_.blocked_jobs) return true;
    const WriteOperation& operation = *pending.operation;
    const auto asked = [&](const auto* other) { return operation.AsksAs(*other); };
    if (!pending.stands() || std::ranges::any_of(in_vain, asked)) return true;
    run.push_back(&pending);
    const Result<bool> went = RunSoundly(pending, context, undo, transaction);
    if (went && *went && pending.stands()) in_vain.push_back(&operation);
    return went;
  };
  for (Pending& pending : standing_) {
    if (const Result<bool> went = give(pending); !went || !*went) return went;
  }
  for (Pending& pending : batch) {
    if (const Result<bool> went = give(pending); !went || !*went) return went;
  }
  return true;
}

// Also when it fails the counts are told as changed: a look too many.
Status Writer::Commit(Transaction& transaction) {
  changes_.BeforeCommit();
  Status committed = transaction.Commit();
  changes_.AfterCommit();
  return committed;
}

// An error: the transaction cannot go on.
Status Writer::RunOne(Pending& pending, WriteContext& context, Undo undo) {
  context.now = clock_();
  const Counters before = counters_;
  const std::size_t moves = context.moves.size();
  const std::int64_t changes = connection_.database.total_changes();
  std::optional<Savepoint> savepoint;
  if (undo == Undo::kAlone) {
    Result<Savepoint> begun = Savepoint::Begin(connection_.transactions);
    if (!begun) return begun.error();
    savepoint.emplace(*std::move(begun));
  }
  try {
    pending.status = pending.operation->Run(context);
  } catch (const std::exception& exception) {
    // Out of memory: that write fails, not the process.
    pending.status = Error{ErrorCode::kCellInternal, exception.what(), {}};
  }
  pending.wrote = connection_.database.total_changes() != changes;
  if (!pending.status) {
    counters_ = before;
    context.moves.resize(moves);
  }
  if (!savepoint) return {};
  return pending.status ? savepoint->Keep() : savepoint->Undo();
}

void Writer::AnswerAndTell() {
  AnswerAll();
  if (std::exchange(untold_, false)) changed_();  // after the answers: they are waited for
}

void Writer::AnswerAll() {
  // One by one: an answer may write and so add to the list.
  while (!answers_.empty()) {
    const Pending pending = std::move(answers_.front());
    answers_.pop_front();
    pending.operation->Answer(pending.status);
  }
}

void Writer::Tidy() {
  if (!tidy_) return;
  tidy_ = false;
  const Counters before = counters_;
  const auto slice = [&]() -> Result<bool> {
    Result<Transaction> transaction =
        Transaction::Begin(connection_.transactions, Transaction::Kind::kWrite);
    if (!transaction) return transaction.error();
    WriteContext context{.tables = connection_.tables,
                         .counters = counters_,
                         .program_memory = options_.program_memory,
                         .machines = machine_jobs_,
                         .now = clock_()};
    const Result<bool> more = housekeeping_.RunSlice(context);
    if (!more) return more.error();
    if (const Status kept = KeepMarks(before, context); !kept) return kept.error();
    if (const Status committed = Commit(*transaction); !committed) return committed.error();
    if (context.changed) changed_();
    return more;
  };
  const Result<bool> more = slice();
  // Trouble with the disk is told to those who write; the next write that leaves garbage tries
  // again.
  if (!more) counters_ = before;
  tidy_ = more && *more;
}

// Whoever opens the store next begins behind every fence that was given out, and looks at no
// attempt for it. Many are reserved at once: the mark is one more page to write.
std::int64_t Writer::FenceMark() const {
  constexpr std::int64_t kReserved = 1'000;
  return counters_.fence <= fence_mark_ ? fence_mark_ : counters_.fence + kReserved;
}

Status Writer::KeepMarks(const Counters& before, const WriteContext& context) {
  Tables& tables = connection_.tables;
  for (const auto& [machine, growth] : GrowthOf(context.moves)) {
    if (const Status kept =
            tables.machine_jobs.Set(machine, machine_jobs_.Unfinished(machine) + growth);
        !kept)
      return kept.error();
  }
  const auto keep = [&](std::string_view name, std::int64_t was, std::int64_t is) -> Status {
    return was == is ? Status() : tables.marks.Set(name, is);
  };
  if (const Status kept =
          keep(MarkTable::kFinishedJobs, before.finished_jobs, counters_.finished_jobs);
      !kept)
    return kept.error();
  if (const Status kept =
          keep(MarkTable::kBlockedJobs, before.blocked_jobs, counters_.blocked_jobs);
      !kept)
    return kept.error();
  if (const Status kept =
          keep(MarkTable::kRecordEvents, before.record_events, counters_.record_events);
      !kept)
    return kept.error();
  return keep(MarkTable::kFence, fence_mark_, FenceMark());
}

// Before anybody is told of the change: whoever is, finds it here.
void Writer::PublishCounts(const WriteContext& context) {
  machine_jobs_.Apply(context.moves);
  queued_jobs_ = counters_.queued_jobs;
  ready_jobs_ = counters_.queued_jobs - counters_.blocked_jobs;
  running_jobs_ = counters_.running_jobs;
}

bool Writer::LogIsLarge(int pages) {
  const int now = connection_.database.log_pages();
  if (now < pages_at_checkpoint_) pages_at_checkpoint_ = 0;  // the log began anew
  // After one that a reader kept from its end the next comes as many pages later, not at once.
  return now - pages_at_checkpoint_ >= pages;
}

void Writer::CheckpointWhenLarge() {
  if (!LogIsLarge(IsIdle() ? kCheckpointPages : kCheckpointPagesWhenBusy)) return;
  pages_at_checkpoint_ = connection_.database.log_pages();
  // A failure costs nothing but space; trouble with the disk is told to those who write.
  static_cast<void>(connection_.database.Checkpoint());
}

bool Writer::IsIdle() {
  const std::lock_guard lock(mutex_);
  return queue_.empty();
}

}  // namespace rmlcell::storage::sqlite
