#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "storage/records.h"

namespace rmlcell::storage {

struct NewJob {
  std::string request_id{};    // empty: the store makes one
  std::string request_hash{};
  std::string machine{};
  std::string kind{};
  std::string title{};
  std::string caller{};
  std::string specification{};
  int attempts_max = 2;
  std::vector<NewArtifact> attachments{};  // what the job works on: kept with it, whatever happens to slots
  std::vector<NewEvent> events{};          // written in the transaction that makes the job
};
struct SubmittedJob {
  JobRecord job;
  bool already_there = false;  // the request_id was known: the first job, unchanged
};

// The right to work on a job. A worker that lost it is refused by the fence.
struct Lease {
  std::int64_t job = 0;
  int attempt = 0;
  std::int64_t fence = 0;
  std::string worker{};
  WallTime until{};
};
struct LeasedJob {
  Lease lease;
  JobRecord job;
};

// What becomes of a job whose worker is gone: back to the queue while attempts are left, else the outcome.
// A RUN is never repeated by itself: it becomes kInterrupted with the outcome's code.
struct LossPolicy {
  JobOutcome outcome;
  std::vector<NewEvent> requeued{};  // appended when it goes back to the queue
  std::vector<NewEvent> ended{};     // appended when it ends
};

// Newest first. A page ends where the next begins: pass `next` back as `after`.
struct JobQuery {
  std::string machine{};                // empty: all
  std::optional<JobState> state{};
  std::string kind{};                   // empty: all
  std::string caller{};                 // empty: all
  std::optional<bool> finished{};       // final states only, or unfinished only
  int limit = 50;
  std::int64_t before_id = 0;         // jobs with a smaller id; 0: from the newest
};

// What to write into one slot. All writes of one call are made, or none.
struct ProgramWrite {
  int slot = 0;
  std::string name{};
  std::string object{};
  std::optional<std::string> source{};
  std::string source_name{};
  Revision expected = kAnyRevision;
};

// Everything durable that the cell has. One interface for the embedded store and for a networked one
// that several servers share: nothing here assumes that this process is the only writer.
//
// Thread-safe. What returned success survives a kill at any instruction. A change of a job and its events
// are one transaction. Errors everywhere: CellStoreFailed (9101), CellStoreBusy (9103),
// CellStoreCorrupt (9104); those of a method beyond that are listed with it, and then nothing changed.
class Store {
 public:
  virtual ~Store() = default;

  // --- machines -------------------------------------------------------------------------------------
  virtual Result<std::vector<MachineRecord>> ListMachines() = 0;  // by id
  virtual Result<MachineRecord> GetMachine(std::string_view id) = 0;  // CellUnknownMachine
  // CellEtagMismatch, CellAlreadyExists (expected 0 and it is there), CellUnknownMachine
  virtual Result<MachineRecord> PutMachine(const MachineRecord& machine, Revision expected) = 0;

  // --- programs -------------------------------------------------------------------------------------
  // Slots in order, those after `after_slot`, at most `limit`.
  virtual Result<std::vector<ProgramSummary>> ListPrograms(std::string_view machine, int after_slot,
                                                           int limit) = 0;
  virtual Result<ProgramRecord> GetProgram(std::string_view machine, int slot) = 0;  // CellNotFound
  // Every program with its object and executable: the program memory of the machine for a run.
  virtual Result<std::vector<ProgramRecord>> GetProgramMemory(std::string_view machine) = 0;
  // Replaces objects, deletes their executables, stores schedules. CellEtagMismatch, CellUnknownMachine.
  virtual Result<std::vector<ProgramSummary>> PutPrograms(
      std::string_view machine, const std::vector<ProgramWrite>& programs,
      const std::vector<ScheduleRecord>& schedules) = 0;
  virtual Status DeleteProgram(std::string_view machine, int slot, Revision expected) = 0;
  // Kept only while the object still has `object_revision`; else nothing happens and false is returned.
  virtual Result<bool> PutExecutable(std::string_view machine, int slot, Revision object_revision,
                                     std::string_view executable) = 0;
  virtual Status DeleteExecutable(std::string_view machine, int slot) = 0;  // CellNotFound

  // --- laser schedules ------------------------------------------------------------------------------
  virtual Result<std::vector<ScheduleRecord>> ListSchedules(std::string_view machine) = 0;
  virtual Result<ScheduleRecord> PutSchedule(const ScheduleRecord& schedule, Revision expected) = 0;
  virtual Status DeleteSchedule(std::string_view machine, int number) = 0;

  // --- projects -------------------------------------------------------------------------------------
  virtual Result<std::vector<ProjectRecord>> ListProjects(std::string_view after_id, int limit) = 0;
  virtual Result<ProjectRecord> GetProject(std::string_view id) = 0;
  virtual Result<ProjectRecord> PutProject(const ProjectRecord& project, Revision expected) = 0;
  virtual Status DeleteProject(std::string_view id, Revision expected) = 0;

  // --- jobs -----------------------------------------------------------------------------------------
  // Durable before `done` is called, from a thread of the store: many submissions share one commit.
  // CellRequestIdReused when request_id is known with another request_hash.
  virtual void Submit(NewJob job, std::function<void(Result<SubmittedJob>)> done) = 0;
  Result<SubmittedJob> SubmitAndWait(NewJob job);

  virtual Result<JobRecord> GetJob(std::int64_t id) = 0;
  virtual Result<std::vector<JobRecord>> ListJobs(const JobQuery& query) = 0;
  virtual Result<std::vector<AttemptRecord>> ListAttempts(std::int64_t job) = 0;
  virtual Result<JobCounts> CountJobs() = 0;  // cheap: called for every submission

  // Queued: cancelled at once, with `events`. Running: marked, the holder of the lease ends it.
  // Final: unchanged. Returns the job as it then is.
  virtual Result<JobRecord> RequestCancel(std::int64_t job, const std::vector<NewEvent>& events) = 0;

  // --- leases; all times by the clock of the store -----------------------------------------------------
  // The oldest queued job of one of `kinds`, or nothing. `events` are appended to it.
  virtual Result<std::optional<LeasedJob>> Acquire(std::string_view worker,
                                                   const std::vector<std::string>& kinds,
                                                   std::chrono::milliseconds duration,
                                                   const std::vector<NewEvent>& events) = 0;
  // CellLeaseLost. Returns the job, so that the holder sees cancel_requested.
  virtual Result<JobRecord> Renew(const Lease& lease, std::chrono::milliseconds duration) = 0;
  // CellLeaseLost. `done` gets the last sequence number written.
  virtual void Append(const Lease& lease, std::vector<NewEvent> events,
                      std::function<void(Result<std::int64_t>)> done) = 0;
  Result<std::int64_t> AppendAndWait(const Lease& lease, std::vector<NewEvent> events);
  // Ends the job. CellLeaseLost. Artifacts and events are written with it.
  virtual Result<JobRecord> Finish(const Lease& lease, const JobOutcome& outcome,
                                   const std::vector<NewArtifact>& artifacts,
                                   const std::vector<NewEvent>& events) = 0;
  // Gives the job back to the queue; this attempt does not count. CellLeaseLost.
  virtual Status HandBack(const Lease& lease, const std::vector<NewEvent>& events) = 0;
  // The worker is known to be dead: as if the lease ran out now. CellLeaseLost.
  virtual Result<JobRecord> Abandon(const Lease& lease, const LossPolicy& policy) = 0;
  // Every lease that ran out. Any server may call it at any time. Returns the jobs that changed.
  virtual Result<std::vector<JobRecord>> Expire(const LossPolicy& policy) = 0;

  // --- events and artifacts ----------------------------------------------------------------------------
  virtual Result<std::vector<EventRecord>> JobEvents(std::int64_t job, std::int64_t after_sequence,
                                                     int limit) = 0;
  virtual Result<std::vector<EventRecord>> AllEvents(std::int64_t after_position, int limit) = 0;
  virtual Result<std::int64_t> LastPosition() = 0;
  virtual Result<std::vector<ArtifactRecord>> ListArtifacts(std::int64_t job) = 0;
  virtual Result<ArtifactRecord> GetArtifact(std::int64_t job, std::string_view name) = 0;  // CellNotFound
  virtual Result<std::string> ReadBlob(std::string_view sha256) = 0;  // CellNotFound

  // Called after each commit that wrote events or changed jobs, from a thread of the store: a hint to read
  // the rows, which may come late, twice or for nothing. The returned handle ends it when destroyed.
  class Subscription {
   public:
    virtual ~Subscription() = default;
  };
  virtual std::unique_ptr<Subscription> Watch(std::function<void()> changed) = 0;
};

}  // namespace rmlcell::storage
