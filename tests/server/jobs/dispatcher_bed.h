#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "server/base/config.h"
#include "server/base/executor.h"
#include "server/base/version.h"
#include "server/events/event_feed.h"
#include "server/jobs/dispatcher.h"
#include "server/records/job_messages.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {

inline constexpr std::string_view kToken = "the token";
// The line to a worker, as seen from its end. Thread-safe.
class FakeLine final : public WorkerLine {
 public:
  void Send(v1::WorkResponse message) override;
  void SendProgram(int slot, std::shared_ptr<const std::string> bytes) override;
  void Close(const Error&) override { closed = true; }

  // The next message of this kind; those of other kinds that came before it are dropped. An empty
  // one when none comes within `patience`.
  v1::WorkResponse Next(v1::WorkResponse::MessageCase kind,
                        std::chrono::milliseconds patience = kPatience);
  // Whether a message of this kind is there now; nothing is dropped.
  bool Has(v1::WorkResponse::MessageCase kind);
  std::map<int, std::string> programs();
  std::atomic<bool> closed = false;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<v1::WorkResponse> messages_;
  std::map<int, std::string> programs_;
};

v1::WorkerHello Hello(const std::string& name);

// A worker that does what the test says.
class FakeWorker {
 public:
  FakeWorker(Dispatcher& dispatcher, const std::string& name)
      : FakeWorker(dispatcher, Hello(name)) {}
  FakeWorker(Dispatcher& dispatcher, const v1::WorkerHello& hello);

  FakeLine& line() { return *line_; }

  // Waits for a job and takes it. False: none came.
  bool Take(std::chrono::milliseconds patience = kPatience);
  // Whether a job is there to be taken now. Says that none comes only after
  // DispatcherBed::LookAgain.
  bool HasJob() { return line_->Has(v1::WorkResponse::kAssignment); }
  const v1::WorkerAssignment& assignment() const { return assignment_; }
  std::int64_t job() const { return assignment_.lease().job(); }

  void Heartbeat();
  void Position(std::int64_t time_ns);
  void Events(int count, const std::string& text = "text");
  void Artifact(const std::string& name, const std::string& bytes);
  // One that comes with the end.
  void SmallArtifact(const std::string& name, const std::string& bytes);
  void Toolpath(const std::string& frames, const std::string& open_block);
  void Heights(const v1::WorkerHeights& heights);
  void Finish(v1::Outcome::Kind kind = v1::Outcome::KIND_COMPLETED,
              const std::map<int, std::string>& executables = {},
              const std::vector<std::string>& last_told = {});
  void HandBack();
  void Leave() { dispatcher_.Leave(id_); }
  // After it said that it began with its job: this attempt counts.
  void BeginAndLeave() {
    Heartbeat();
    Leave();
  }

  // What the server says about the lease: stored, lost; nothing when it does not say.
  std::optional<bool> Released();
  v1::WorkerControl Ordered();

 private:
  v1::WorkerFinish small_;  // products that go with the end
  void Send(v1::WorkRequest message) { dispatcher_.Receive(id_, std::move(message)); }

  Dispatcher& dispatcher_;
  std::shared_ptr<FakeLine> line_ = std::make_shared<FakeLine>();
  Dispatcher::WorkerId id_ = 0;
  v1::WorkerAssignment assignment_;
};

// A store that does something more around a call.
class HookedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  // Set before the dispatcher is made.
  std::function<void()> after_acquire;   // before the dispatcher hears of the job
  std::function<void()> before_machine;  // an assignment is made from it
  std::function<void()> before_orders;   // of other servers are looked for
  // So many of the next calls fail, as on a full disk.
  std::atomic<int> finishes_that_fail = 0;
  std::atomic<int> renewals_that_fail = 0;
  std::atomic<int> acquires_that_fail = 0;
  std::atomic<int> machines_that_fail = 0;
  std::atomic<int> appends_that_fail = 0;
  std::atomic<int> losses_that_fail = 0;  // hand-backs and abandons
  std::atomic<int> finishes_that_throw = 0;
  // Ends are kept until Answer() and not written, as by a store that is not there for a while.
  std::atomic<bool> keeps_ends = false;
  std::atomic<int> ends_kept = 0;
  std::atomic<int> standing = 0;    // requests that were not answered
  std::atomic<int> next_given = 0;  // jobs that came with the end of another one
  // Answers that came, counted before the dispatcher hears of them: Settle() is behind that.
  std::atomic<int> renewals = 0;
  // Calls that have returned.
  std::atomic<int> sweeps = 0;
  std::atomic<int> jobs_read = 0;
  std::atomic<int> hints = 0;       // told to the dispatcher and to the feed
  std::atomic<int> orders_put = 0;  // for other servers; counted as they come

  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override {
    return store_.Watch([this, changed = std::move(changed)] {
      changed();
      ++hints;
    });
  }

  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    ++jobs_read;
    return store_.GetJob(id);
  }
  Status PutOrder(std::int64_t job, std::string_view from, std::string_view payload) override {
    ++orders_put;
    return store_.PutOrder(job, from, payload);
  }
  Result<std::vector<storage::TakenOrder>> TakeOrders(std::string_view server) override {
    if (before_orders) before_orders();
    return store_.TakeOrders(server);
  }
  Result<storage::MachineMemory> GetMachineMemory(std::string_view id,
                                                  const WantsPrograms& wants_programs) override {
    if (before_machine) before_machine();
    if (Fails(machines_that_fail)) return FullDisk();
    return store_.GetMachineMemory(id, wants_programs);
  }
  std::int64_t AwaitJobs(storage::JobRequest request,
                         storage::Done<std::vector<storage::LeasedJob>> done) override {
    if (Fails(acquires_that_fail)) {
      done(FullDisk());
      return 0;
    }
    const std::int64_t number = store_.AwaitJobs(
        std::move(request), [this, done](Result<std::vector<storage::LeasedJob>> leased) {
          if (after_acquire && leased && !leased->empty()) after_acquire();
          done(std::move(leased));
          --standing;
        });
    ++standing;
    return number;
  }
  void SendRenew(const storage::Lease& lease, std::chrono::milliseconds duration,
                 storage::Done<storage::JobRecord> done) override {
    if (Fails(renewals_that_fail)) {
      ++renewals;
      return done(FullDisk());
    }
    store_.SendRenew(lease, duration, [this, done](Result<storage::JobRecord> job) {
      ++renewals;
      done(std::move(job));
    });
  }
  void Append(const storage::Lease& lease, std::vector<storage::NewEvent> events,
              storage::Done<std::int64_t> done) override {
    if (Fails(appends_that_fail)) return done(FullDisk());
    store_.Append(lease, std::move(events), std::move(done));
  }
  void SendFinish(const storage::Lease& lease, std::shared_ptr<const storage::JobEnd> end,
                  std::optional<storage::JobRequest> next,
                  storage::Done<storage::FinishedJob> done) override {
    if (Fails(finishes_that_fail)) return done(FullDisk());
    if (Fails(finishes_that_throw)) throw std::bad_alloc();
    auto answer = [this, looked = next.has_value(), done](Result<storage::FinishedJob> finished) {
      const bool found = finished && !finished->next.empty();
      if (found) ++next_given;
      if (looked && found && after_acquire) after_acquire();
      done(std::move(finished));
    };
    if (!keeps_ends) return store_.SendFinish(lease, std::move(end), next, std::move(answer));
    {
      const std::lock_guard lock(kept_mutex_);
      kept_.push_back(
          [this, lease, end, next, answer] { store_.SendFinish(lease, end, next, answer); });
    }
    ++ends_kept;
  }
  void SendHandBack(const storage::Lease& lease, storage::LossPolicy policy,
                    storage::Done<storage::JobRecord> done) override {
    if (Fails(losses_that_fail)) return done(FullDisk());
    store_.SendHandBack(lease, std::move(policy), std::move(done));
  }
  void SendAbandon(const storage::Lease& lease, storage::LossPolicy policy,
                   storage::Done<storage::JobRecord> done) override {
    if (Fails(losses_that_fail)) return done(FullDisk());
    store_.SendAbandon(lease, std::move(policy), std::move(done));
  }
  void Answer() {
    keeps_ends = false;
    const std::lock_guard lock(kept_mutex_);
    for (const auto& kept : std::exchange(kept_, {})) kept();
  }

  Result<std::vector<storage::JobRecord>> Expire(const storage::LossPolicy& policy) override {
    auto expired = store_.Expire(policy);
    ++sweeps;
    return expired;
  }

 private:
  std::mutex kept_mutex_;
  std::vector<std::function<void()>> kept_;  // guarded by kept_mutex_

  // In one step: a test may say at any moment that no more are to fail.
  static bool Fails(std::atomic<int>& left) {
    int was = left;
    while (was > 0 && !left.compare_exchange_weak(was, was - 1)) continue;
    return was > 0;
  }
  static Error FullDisk() { return {ErrorCode::kCellStoreFailed, "the disk is full", {}}; }
};

// A dispatcher with all that it needs, made when it is asked for first and ended as Cell::Stop
// does.
class DispatcherBed {
 public:
  DispatcherBed() { config.workers_lease_ms = 60'000; }
  ~DispatcherBed() { End(); }
  DispatcherBed(const DispatcherBed&) = delete;
  DispatcherBed& operator=(const DispatcherBed&) = delete;

  Dispatcher& dispatcher();
  EventFeed& feed();
  void End();

  storage::JobRecord Job(std::int64_t id) { return Must(server.store().GetJob(id)); }
  bool Becomes(std::int64_t id, storage::JobState state) {
    return Eventually([&] { return Job(id).state == state; });
  }
  // Moves the clock of the store and that of the dispatcher.
  void Advance(std::chrono::milliseconds by);
  // That of the dispatcher alone: in the store no lease runs out, however soon it looks for that.
  void AdvanceDispatcher(std::chrono::milliseconds by) { steady_.Advance(by); }
  // Waits until what was posted for workers is worked through.
  void Settle();
  // Keeps every thread of the executor busy until the handle is destroyed.
  [[nodiscard]] std::shared_ptr<void> Occupy();
  // Each idle worker has looked for a job when this returns, and waits for one: what it was not
  // given until then it is not given.
  void LookAgain();
  // Waits until leases were looked at by the clock as it is now.
  bool Swept();

  // Kinds of the events of a job, and the code of the last one when it tells the end.
  std::vector<v1::JobEvent> Events(std::int64_t id);

  ServerBed server;
  HookedStore hooks{server.store()};
  Config config;

 private:
  static constexpr int kThreads = 4;

  TestSteadyClock steady_;
  std::unique_ptr<Executor> executor_;
  std::unique_ptr<EventFeed> feed_;
  std::unique_ptr<Dispatcher> dispatcher_;
};

}  // namespace rmlcell::server
