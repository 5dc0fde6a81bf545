#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "storage/sqlite/ends_under_way.h"
#include "storage/sqlite/reader_pool.h"
#include "storage/sqlite/request_ids.h"
#include "storage/sqlite/sqlite_store.h"
#include "storage/sqlite/staging_thread.h"
#include "storage/sqlite/store_files.h"
#include "storage/sqlite/watchers.h"
#include "storage/sqlite/writer.h"

namespace rmlcell::storage::sqlite {

// What must not yet be done to a record: see Store on `expected`. `current` is empty when there is
// none.
Status CheckRevision(std::optional<Revision> current, Revision expected, const std::string& what,
                     ErrorCode when_missing = ErrorCode::kCellNotFound);
// All programs and schedules of a machine that goes.
Status RemoveMemory(WriteContext& context, std::string_view machine, std::string_view caller);

class StagedEnd;

// Reads go to the pool, writes to the writer; the rules of jobs stand in job_life.h.
class SqliteStore final : public Store {
 public:
  struct Parts {
    StoreLock lock;
    Clock clock;
    std::unique_ptr<Connection> connection;
    std::unique_ptr<ReaderPool> readers;
    Counters counters;
    MachineTally::Machines machines;
    std::string log_id;
    Writer::Options writer;
  };
  explicit SqliteStore(Parts parts);

  Result<std::vector<MachineRecord>> ListMachines() override;
  Result<MachineRecord> GetMachine(std::string_view id) override;
  std::uint64_t MachineChanges() const override { return writer_.changes().OfMachines(); }
  Result<MachineRecord> PutMachine(const MachineRecord& machine, Revision expected,
                                   std::string_view caller) override;
  Status DeleteMachine(std::string_view id, Revision expected, std::string_view caller) override;
  Result<MachineLease> TakeMachine(const MachineClaim& claim) override;
  Result<MachineLease> RenewMachine(const MachineLease& lease, std::string_view server) override;
  Status ReleaseMachine(const MachineLease& lease) override;
  Result<std::vector<MachineLease>> MachineLeases() override;
  Status AppendMachine(const MachineLease& lease, const MachineWrite& write) override;
  Result<std::int64_t> AddTeachRecord(const TeachRecord& record) override;
  Result<std::vector<TeachRecord>> ListTeachRecords(std::string_view machine, int program,
                                                    std::int64_t before, int limit) override;
  Result<std::optional<MachineMark>> GetMachineMark(std::string_view machine) override;

  Result<std::vector<ProgramSummary>> ListPrograms(std::string_view machine, int after_slot,
                                                   int limit) override;
  Result<ProgramRecord> GetProgram(std::string_view machine, int slot) override;
  Result<ProgramSummary> GetProgramSummary(std::string_view machine, int slot) override;
  Result<MachineMemory> GetMachineMemory(std::string_view machine,
                                         const WantsPrograms& wants_programs) override;
  Result<std::vector<ProgramSummary>> PutPrograms(std::string_view machine,
                                                  const std::vector<ProgramWrite>& programs,
                                                  const std::vector<ScheduleRecord>& schedules,
                                                  std::string_view caller) override;
  Status DeleteProgram(std::string_view machine, int slot, Revision expected,
                       std::string_view caller) override;
  Result<bool> PutExecutable(std::string_view machine, int slot, Revision object_revision,
                             std::string_view executable, std::string_view caller) override;
  Status DeleteExecutable(std::string_view machine, int slot, std::string_view caller) override;

  Result<std::vector<ScheduleRecord>> ListSchedules(std::string_view machine) override;
  Result<ScheduleRecord> PutSchedule(const ScheduleRecord& schedule, Revision expected,
                                     std::string_view caller) override;
  Status DeleteSchedule(std::string_view machine, int number, std::string_view caller) override;

  Result<std::vector<ProjectRecord>> ListProjects(std::string_view after_id, int limit) override;
  Result<ProjectRecord> GetProject(std::string_view id) override;
  Result<ProjectRecord> PutProject(const ProjectRecord& project, Revision expected,
                                   std::string_view caller) override;
  Status DeleteProject(std::string_view id, Revision expected, std::string_view caller) override;

  void Submit(NewJob job, Done<SubmittedJob> done) override;
  Result<SubmittedJob> SubmitAndWait(NewJob job) override;
  Result<std::optional<JobRecord>> FindSubmitted(std::string_view request_id,
                                                 std::string_view request_hash) override;
  Result<JobRecord> GetJob(std::int64_t id) override;
  std::uint64_t JobChanges(std::int64_t job) const override { return writer_.changes().OfJob(job); }
  Result<std::vector<JobRecord>> ListJobs(const JobQuery& query) override;
  Result<std::vector<AttemptRecord>> ListAttempts(std::int64_t job) override;
  Result<JobCounts> CountJobs() override;
  Result<std::vector<JobStateCount>> CountByState(const JobQuery& query) override;
  Result<std::vector<MachineJobs>> UnfinishedJobs() override;
  Status DeleteJob(std::int64_t id, std::string_view caller) override;
  Result<JobRecord> RequestCancel(std::int64_t job, const std::vector<NewEvent>& events) override;
  void SendRequestCancel(std::int64_t job, std::vector<NewEvent> events,
                         Done<JobRecord> done) override;

  Result<JobRecord> HoldBack(std::int64_t job, const std::vector<NewEvent>& events) override;
  Result<JobRecord> LetGo(std::int64_t job, const std::vector<NewEvent>& events) override;
  Result<std::vector<JobRecord>> ActOn(std::span<const std::int64_t> jobs, QueueAct act,
                                       const EventOf& event) override;
  Result<JobRecord> Move(std::int64_t job, std::int64_t before, std::optional<int> priority,
                         const std::vector<NewEvent>& events) override;

  Result<std::int64_t> CountBefore(std::int64_t job) override;
  Status PutOrder(std::int64_t job, std::string_view from, std::string_view payload) override;
  Result<std::vector<TakenOrder>> TakeOrders(std::string_view server) override;
  Result<std::vector<LeasedJob>> AcquireJobs(const JobRequest& request) override;
  std::int64_t AwaitJobs(JobRequest request, Done<std::vector<LeasedJob>> done) override;
  void Withdraw(std::int64_t request) override;
  Result<JobRecord> Renew(const Lease& lease, std::chrono::milliseconds duration) override;
  void SendRenew(const Lease& lease, std::chrono::milliseconds duration,
                 Done<JobRecord> done) override;
  void Append(const Lease& lease, std::vector<NewEvent> events, Done<std::int64_t> done) override;
  Result<std::int64_t> AppendAndWait(const Lease& lease, std::vector<NewEvent> events) override;
  Result<JobRecord> Finish(const Lease& lease, const JobEnd& end) override;
  Result<JobRecord> AddProducts(std::int64_t job, const LateProducts& products) override;
  void SendFinish(const Lease& lease, std::shared_ptr<const JobEnd> end,
                  std::optional<JobRequest> next, Done<FinishedJob> done) override;
  Result<JobRecord> HandBack(const Lease& lease, const LossPolicy& policy) override;
  void SendHandBack(const Lease& lease, LossPolicy policy, Done<JobRecord> done) override;
  Result<JobRecord> Abandon(const Lease& lease, const LossPolicy& policy) override;
  void SendAbandon(const Lease& lease, LossPolicy policy, Done<JobRecord> done) override;
  Result<std::vector<JobRecord>> Expire(const LossPolicy& policy) override;

  Result<std::vector<EventRecord>> JobEvents(std::int64_t job, std::int64_t after_sequence,
                                             int limit) override;
  Result<std::vector<EventRecord>> AllEvents(std::int64_t after_position, int limit) override;
  Result<std::int64_t> LastPosition() override;
  Result<std::int64_t> EventsGoneUntil() override;
  std::string LogId() override { return log_id_; }
  Result<bool> HasPosition(std::string_view log_id, std::int64_t position) override;
  Result<std::vector<ArtifactRecord>> ListArtifacts(std::int64_t job) override;
  Result<ArtifactRecord> GetArtifact(std::int64_t job, std::string_view name) override;
  Result<std::string> ReadArtifact(std::int64_t job, std::string_view name) override;
  Result<std::unique_ptr<BlobReader>> OpenArtifact(std::int64_t job,
                                                   std::string_view name) override;
  Result<std::string> ReadBlob(std::string_view sha256) override;
  Result<std::unique_ptr<BlobReader>> OpenBlob(std::string_view sha256) override;
  Result<std::unique_ptr<BlobWriter>> WriteBlob(std::string_view sha256, std::size_t size) override;

  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override;

 private:
  void SendStaged(const Lease& lease, std::shared_ptr<const JobEnd> end,
                  std::shared_ptr<const StagedEnd> staged, const std::optional<JobRequest>& next,
                  Done<FinishedJob> done);
  // `job` with its specification, read on this thread.
  Result<JobRecord> WithSpecification(Result<JobRecord> job);

  // Destroyed from the last to the first: the writer answers what waits while all else is there.
  const StoreLock lock_;
  const Clock clock_;
  const std::string log_id_;
  RequestIds request_ids_;
  // Closed after the readers: the last one to close moves the log into the file, and a reader may
  // not.
  const std::unique_ptr<Connection> connection_;
  const std::unique_ptr<ReaderPool> readers_;
  Watchers watchers_;
  EndsUnderWay ends_;
  std::atomic<std::int64_t> last_request_ = 0;  // of those that stand
  Writer writer_;
  StagingThread staging_;
};

}  // namespace rmlcell::storage::sqlite
