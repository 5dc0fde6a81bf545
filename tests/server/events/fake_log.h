#pragma once

#include <algorithm>
#include <mutex>

#include "storage/store.h"

namespace rmlcell::server {

// A store that is nothing but a log of events: it counts its reads, and can fail or lose its
// beginning. Thread-safe.
class FakeLog final : public storage::Store {
 public:
  // Appends events of one job and tells the watcher, as a commit does.
  void Write(std::int64_t job, int count) {
    {
      const std::lock_guard lock(mutex_);
      for (int i = 0; i < count; ++i)
        events_.push_back({.position = ++last_, .job = job, .sequence = last_});
    }
    Hint();
  }
  // The next event has a position so much higher than it would have: a shared log has gaps.
  void LeaveGap(std::int64_t width) {
    const std::lock_guard lock(mutex_);
    last_ += width;
  }
  // Removes all events up to the last one, as housekeeping may before they were read.
  void ForgetAll() {
    const std::lock_guard lock(mutex_);
    events_.clear();
    gone_ = last_;
  }
  void Fail(bool failing) {
    const std::lock_guard lock(mutex_);
    failing_ = failing;
  }
  void Hint() {
    const std::lock_guard calling(calling_);
    std::function<void()> changed;
    {
      const std::lock_guard lock(mutex_);
      changed = changed_;
    }
    if (changed) changed();
  }
  int reads() const {
    const std::lock_guard lock(mutex_);
    return reads_;
  }

  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t after, int limit) override {
    const std::lock_guard lock(mutex_);
    ++reads_;
    if (failing_) return No();
    if (after < gone_) return Error{ErrorCode::kCellEventsGone, {}, {}};
    const auto first =
        std::ranges::upper_bound(events_, after, {}, &storage::EventRecord::position);
    const auto count = std::min<std::ptrdiff_t>(limit, events_.end() - first);
    return std::vector<storage::EventRecord>(first, first + count);
  }
  Result<std::int64_t> LastPosition() override {
    const std::lock_guard lock(mutex_);
    return last_;
  }
  Result<std::int64_t> EventsGoneUntil() override {
    const std::lock_guard lock(mutex_);
    return gone_;
  }
  std::string LogId() override { return "a log of a test"; }
  Result<bool> HasPosition(std::string_view, std::int64_t) override { return No(); }
  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override {
    class Handle final : public Subscription {
     public:
      explicit Handle(FakeLog& log) : log_(log) {}
      // As of a real store: no call is under way, or comes, when it is gone.
      ~Handle() override {
        const std::lock_guard calling(log_.calling_);
        const std::lock_guard lock(log_.mutex_);
        log_.changed_ = nullptr;
      }

     private:
      FakeLog& log_;
    };
    const std::lock_guard lock(mutex_);
    changed_ = std::move(changed);
    return std::make_unique<Handle>(*this);
  }

  // What a log does not have.
  Result<std::vector<storage::MachineRecord>> ListMachines() override { return No(); }
  Result<storage::MachineRecord> GetMachine(std::string_view) override { return No(); }
  std::uint64_t MachineChanges() const override { return 0; }
  std::uint64_t JobChanges(std::int64_t) const override { return 0; }
  Result<storage::MachineRecord> PutMachine(const storage::MachineRecord&, storage::Revision,
                                            std::string_view) override {
    return No();
  }
  Status DeleteMachine(std::string_view, storage::Revision, std::string_view) override {
    return No();
  }
  Result<storage::MachineLease> TakeMachine(const storage::MachineClaim&) override { return No(); }
  Result<storage::MachineLease> RenewMachine(const storage::MachineLease&,
                                             std::string_view) override {
    return No();
  }
  Status ReleaseMachine(const storage::MachineLease&) override { return No(); }
  Result<std::vector<storage::MachineLease>> MachineLeases() override { return No(); }
  Status AppendMachine(const storage::MachineLease&, const storage::MachineWrite&) override {
    return No();
  }
  Result<std::int64_t> AddTeachRecord(const storage::TeachRecord&) override { return No(); }
  Result<std::vector<storage::TeachRecord>> ListTeachRecords(std::string_view, int, std::int64_t,
                                                             int) override {
    return No();
  }
  Result<std::optional<storage::MachineMark>> GetMachineMark(std::string_view) override {
    return No();
  }
  Result<std::vector<storage::ProgramSummary>> ListPrograms(std::string_view, int, int) override {
    return No();
  }
  Result<storage::ProgramRecord> GetProgram(std::string_view, int) override { return No(); }
  Result<storage::ProgramSummary> GetProgramSummary(std::string_view, int) override { return No(); }
  Result<storage::MachineMemory> GetMachineMemory(std::string_view, const WantsPrograms&) override {
    return No();
  }
  Result<std::vector<storage::ProgramSummary>> PutPrograms(
      std::string_view, const std::vector<storage::ProgramWrite>&,
      const std::vector<storage::ScheduleRecord>&, std::string_view) override {
    return No();
  }
  Status DeleteProgram(std::string_view, int, storage::Revision, std::string_view) override {
    return No();
  }
  Result<bool> PutExecutable(std::string_view, int, storage::Revision, std::string_view,
                             std::string_view) override {
    return No();
  }
  Status DeleteExecutable(std::string_view, int, std::string_view) override { return No(); }
  Result<std::vector<storage::ScheduleRecord>> ListSchedules(std::string_view) override {
    return No();
  }
  Result<storage::ScheduleRecord> PutSchedule(const storage::ScheduleRecord&, storage::Revision,
                                              std::string_view) override {
    return No();
  }
  Status DeleteSchedule(std::string_view, int, std::string_view) override { return No(); }
  Result<std::vector<storage::ProjectRecord>> ListProjects(std::string_view, int) override {
    return No();
  }
  Result<storage::ProjectRecord> GetProject(std::string_view) override { return No(); }
  Result<storage::ProjectRecord> PutProject(const storage::ProjectRecord&, storage::Revision,
                                            std::string_view) override {
    return No();
  }
  Status DeleteProject(std::string_view, storage::Revision, std::string_view) override {
    return No();
  }
  void Submit(storage::NewJob, std::function<void(Result<storage::SubmittedJob>)> done) override {
    done(No());
  }
  Result<std::optional<storage::JobRecord>> FindSubmitted(std::string_view,
                                                          std::string_view) override {
    return No();
  }
  Result<storage::JobRecord> GetJob(std::int64_t) override { return No(); }
  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery&) override {
    return No();
  }
  Result<std::vector<storage::AttemptRecord>> ListAttempts(std::int64_t) override { return No(); }
  Result<storage::JobCounts> CountJobs() override { return No(); }
  Result<std::vector<storage::JobStateCount>> CountByState(const storage::JobQuery&) override {
    return No();
  }
  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override { return No(); }
  Status DeleteJob(std::int64_t, std::string_view) override { return No(); }
  Result<storage::JobRecord> RequestCancel(std::int64_t,
                                           const std::vector<storage::NewEvent>&) override {
    return No();
  }
  Result<storage::JobRecord> HoldBack(std::int64_t,
                                      const std::vector<storage::NewEvent>&) override {
    return No();
  }
  Result<std::vector<storage::JobRecord>> ActOn(std::span<const std::int64_t>, storage::QueueAct,
                                                const EventOf&) override {
    return No();
  }
  Result<storage::JobRecord> LetGo(std::int64_t, const std::vector<storage::NewEvent>&) override {
    return No();
  }
  Result<storage::JobRecord> Move(std::int64_t, std::int64_t, std::optional<int>,
                                  const std::vector<storage::NewEvent>&) override {
    return No();
  }
  Result<std::int64_t> CountBefore(std::int64_t) override { return No(); }
  Status PutOrder(std::int64_t, std::string_view, std::string_view) override { return No(); }
  Result<std::vector<storage::TakenOrder>> TakeOrders(std::string_view) override { return No(); }
  Result<std::vector<storage::LeasedJob>> AcquireJobs(const storage::JobRequest&) override {
    return No();
  }
  std::int64_t AwaitJobs(storage::JobRequest,
                         storage::Done<std::vector<storage::LeasedJob>> done) override {
    done(No());
    return 0;
  }
  void Withdraw(std::int64_t) override {}
  Result<storage::JobRecord> Renew(const storage::Lease&, std::chrono::milliseconds) override {
    return No();
  }
  void Append(const storage::Lease&, std::vector<storage::NewEvent>,
              std::function<void(Result<std::int64_t>)> done) override {
    done(No());
  }
  Result<storage::JobRecord> Finish(const storage::Lease&, const storage::JobEnd&) override {
    return No();
  }
  Result<storage::JobRecord> AddProducts(std::int64_t, const storage::LateProducts&) override {
    return No();
  }
  Result<storage::JobRecord> HandBack(const storage::Lease&, const storage::LossPolicy&) override {
    return No();
  }
  Result<storage::JobRecord> Abandon(const storage::Lease&, const storage::LossPolicy&) override {
    return No();
  }
  Result<std::vector<storage::JobRecord>> Expire(const storage::LossPolicy&) override {
    return No();
  }
  Result<std::vector<storage::EventRecord>> JobEvents(std::int64_t, std::int64_t, int) override {
    return No();
  }
  Result<std::vector<storage::ArtifactRecord>> ListArtifacts(std::int64_t) override { return No(); }
  Result<storage::ArtifactRecord> GetArtifact(std::int64_t, std::string_view) override {
    return No();
  }
  Result<std::string> ReadArtifact(std::int64_t, std::string_view) override { return No(); }
  Result<std::unique_ptr<storage::BlobReader>> OpenArtifact(std::int64_t,
                                                            std::string_view) override {
    return No();
  }
  Result<std::string> ReadBlob(std::string_view) override { return No(); }
  Result<std::unique_ptr<storage::BlobReader>> OpenBlob(std::string_view) override { return No(); }
  Result<std::unique_ptr<storage::BlobWriter>> WriteBlob(std::string_view, std::size_t) override {
    return No();
  }

 private:
  static Error No() { return {ErrorCode::kCellStoreFailed, "not in a log", {}}; }

  std::mutex calling_;  // before mutex_
  mutable std::mutex mutex_;
  std::vector<storage::EventRecord> events_;
  std::int64_t last_ = 0;
  std::int64_t gone_ = 0;
  bool failing_ = false;
  int reads_ = 0;
  std::function<void()> changed_;
};

}  // namespace rmlcell::server
