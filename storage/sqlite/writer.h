#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "storage/sqlite/change_counts.h"
#include "storage/sqlite/housekeeping.h"
#include "storage/sqlite/sqlite_store.h"
#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

// Writes, one at a time. Operations that wait are run together in one transaction and answered
// after its commit; one that fails is undone alone. A lone operation does not wait for company.
//
// Whoever has the turn may use the connection. It is the writer thread, as long as callers come
// together; a lone caller who finds nobody at work takes the turn and commits by himself, which
// saves two switches between threads, about half as long as a commit itself.
class Writer {
 public:
  struct Options {
    KeepLimits keep;
    std::size_t waiting_operations_max;
    std::size_t waiting_bytes_max;
    std::chrono::microseconds group_window;
    ProgramMemoryOf program_memory;
  };

  // `changed` is called by whoever has the turn after a commit that changed jobs or events.
  Writer(Connection& connection, const Counters& counters, MachineTally::Machines machines,
         const Options& options, Clock clock, std::function<void()> changed);

  // Runs and answers what waits, then stops the thread.
  ~Writer();

  // Whether others are on their way behind an operation: then it is left to the writer thread.
  enum class Company { kNone, kComes };
  // Queues the operation, or runs and answers it. `bytes` is the memory that it holds: when too
  // much waits, it is answered with CellResourceExhausted instead, by this thread. 0: never
  // refused.
  void Post(std::unique_ptr<WriteOperation> operation, std::size_t bytes,
            Company company = Company::kNone);

  // Answers the operation that stands by this number, as one that found nothing; none: nothing is
  // done.
  void EndStanding(std::int64_t number);

  // The same for `work`, from WriteContext& to a Result or Status; `done` is called with what it
  // gave, or with what kept it from becoming durable.
  template <class Work, class Done>
  void Send(Work work, Done done, std::size_t bytes = 0);

  // As of the newest commit.
  JobCounts job_counts() const { return {.queued = queued_jobs_, .running = running_jobs_}; }
  std::vector<MachineJobs> machine_jobs() const { return machine_jobs_.List(); }
  bool any_ready_job() const { return ready_jobs_ > 0; }
  const ChangeCounts& changes() const { return changes_; }

  // Runs `work`, from WriteContext& to a Result or Status, and returns what it gave once it is
  // durable. Also from within an answer: what was queued before is then run first.
  template <class Work>
  auto Do(Work work) -> std::invoke_result_t<Work&, WriteContext&>;

 private:
  struct Pending {
    std::unique_ptr<WriteOperation> operation;
    std::size_t bytes = 0;
    Status status;
    bool wrote = false;   // it changed rows, also when it failed then
    bool barred = false;  // it stood, and made the writes of others fail
    bool stands() const { return status && !barred && operation->StandsAs() != 0; }
  };
  using Batch = std::vector<Pending>;
  class Withdrawal;

  // How an operation that fails is undone. A savepoint for each costs a quarter of the time of a
  // small write, and almost every failure is seen before the first row is touched, where nothing is
  // to undo. So a batch goes without; when one fails later, all of it is rolled back and run again
  // with savepoints.
  enum class Undo { kWithAll, kAlone };
  enum class Outcome { kCommitted, kSpoilt, kLost };

  void Loop();
  bool WaitForWork();
  bool TakeTurnAlone();
  void WorkAlone();
  void AnswerAndTell();
  Batch Take();
  void RunBatch(Batch batch);
  Outcome RunTogether(std::span<Pending> batch, Undo undo);
  Outcome TryBatch(std::span<Pending> batch, Undo undo);
  // An error: the transaction cannot go on. False: all of it has to be undone and run again.
  Result<bool> RunEach(std::span<Pending> batch, WriteContext& context, Undo undo,
                       const Transaction& transaction);
  Result<bool> RunSoundly(Pending& pending, WriteContext& context, Undo undo,
                          const Transaction& transaction);
  Result<bool> RunStanding(std::span<Pending> batch, WriteContext& context, Undo undo,
                           const Transaction& transaction, std::vector<Pending*>& run);
  Status RunOne(Pending& pending, WriteContext& context, Undo undo);
  void Keep(std::span<Pending> batch);
  Status Commit(Transaction& transaction);
  void AnswerStanding(std::int64_t number);
  void AnswerAll();
  void Tidy();
  std::int64_t FenceMark() const;
  Status KeepMarks(const Counters& before, const WriteContext& context);
  void PublishCounts(const WriteContext& context);
  bool LogIsLarge(int pages);
  void CheckpointWhenLarge();
  bool IsIdle();

  using Run = std::function<Status(WriteContext&)>;
  Status RunAndWait(Run run);
  Status RunFromAnswer(std::unique_ptr<WriteOperation> operation);

  const Options options_;
  const Clock clock_;
  const std::function<void()> changed_;
  const Housekeeping housekeeping_;

  // Used by whoever has the turn.
  Connection& connection_;
  Counters counters_;
  std::int64_t fence_mark_;       // as the store has it: none beyond it was given out
  std::deque<Pending> answers_;   // committed or failed, to be answered
  std::deque<Pending> standing_;  // run and not answered: see WriteOperation::StandsAs
  bool untold_ = false;           // watchers do not know yet of a commit
  bool tidy_ = true;              // there may be something to remove
  int pages_at_checkpoint_ = 0;   // size of the log when it was last moved

  ChangeCounts changes_;
  MachineTally machine_jobs_;
  std::atomic<std::int64_t> queued_jobs_;
  std::atomic<std::int64_t> ready_jobs_;
  std::atomic<std::int64_t> running_jobs_;

  std::atomic<std::thread::id> has_turn_{};  // nobody: a thread that is none

  std::mutex mutex_;
  std::condition_variable work_;
  bool turn_taken_ = true;      // guarded by mutex_; at first by the writer thread
  bool chores_ = false;         // guarded by mutex_; a lone caller left some to the writer thread
  std::size_t last_batch_ = 0;  // guarded by mutex_; operations taken together the last time
  std::deque<Pending> queue_;   // guarded by mutex_
  std::size_t waiting_bytes_ = 0;  // guarded by mutex_
  std::size_t wanted_ = 1;         // guarded by mutex_; operations that are worth waking up for
  bool stopping_ = false;          // guarded by mutex_

  std::thread thread_;  // last: it uses all of the above
};

template <class Work, class Done>
void Writer::Send(Work work, Done done, std::size_t bytes) {
  using Given = std::invoke_result_t<Work&, WriteContext&>;
  class Operation final : public WriteOperation {
   public:
    Operation(Work work, Done done) : work_(std::move(work)), done_(std::move(done)) {}
    Status Run(WriteContext& context) override {
      given_.emplace(work_(context));
      return *given_ ? Status() : Status(given_->error());
    }
    void Answer(const Status& status) override {
      if (!status) return done_(Given(status.error()));
      done_(*std::move(given_));
    }

   private:
    Work work_;
    Done done_;
    std::optional<Given> given_;  // of the newest run
  };
  Post(std::make_unique<Operation>(std::move(work), std::move(done)), bytes);
}

template <class Work>
auto Writer::Do(Work work) -> std::invoke_result_t<Work&, WriteContext&> {
  std::optional<std::invoke_result_t<Work&, WriteContext&>> answer;  // of the newest run
  const Status durable = RunAndWait([&](WriteContext& context) -> Status {
    answer.emplace(work(context));
    return *answer ? Status() : Status(answer->error());
  });
  if (!durable) return durable.error();
  return *std::move(answer);
}

}  // namespace rmlcell::storage::sqlite
