#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "storage/records.h"

namespace rmlcell::storage {

struct NewJob {
  std::string request_id{};  // empty: the store makes one
  std::string request_hash{};
  std::string machine{};
  std::string family{};
  std::string kind{};
  std::string pool{};
  std::string title{};
  std::string caller{};
  std::vector<std::string> labels{};  // words without blanks, each once
  std::string specification{};
  int attempts_max = 2;
  std::int64_t queued_max = 0;  // refused when so many jobs wait already; 0: never
  int priority = 0;             // kPriorityMin to kPriorityMax
  bool held = false;            // it waits until LetGo()
  std::optional<WallTime> not_before{};
  std::vector<std::int64_t> after{};  // it starts when these have succeeded
  // What the job works on, as artifacts of it: kept with it, whatever happens to slots.
  std::vector<NewArtifact> attachments{};
  std::vector<NewEvent> events{};  // written in the transaction that makes the job
  // Others are on their way from the same caller: this one may wait for them to be written
  // together.
  bool more_come = false;
};
// What becomes of a call that does not wait for the store: `done` is called once, from a thread of
// the store or before the call returns. It does not throw, and is brief, as the next commit waits
// for it; it may call this store.
template <class T>
using Done = std::function<void(Result<T>)>;

struct SubmittedJob {
  JobRecord job;
  bool already_there = false;  // the request_id was known: the first job, as it is by now
};

// The right to work on a job. A worker that lost it is refused by the fence.
struct Lease {
  std::int64_t job = 0;
  int attempt = 0;
  std::int64_t fence = 0;  // grows with every lease that this store ever gave
  std::string worker{};
  WallTime until{};
  std::string server{};  // that gave the job to the worker
};
// What a client asked of a job, for the server that has it. Bytes that only the servers understand.
struct TakenOrder {
  Lease lease;
  std::string payload;
};
struct LeasedJob {
  Lease lease;
  JobRecord job;
};

// What becomes of a job whose worker is gone: back to the queue while attempts are left, else the
// outcome. A RUN is never repeated by itself: it becomes kInterrupted with the outcome's code,
// detail and place.
struct LossPolicy {
  JobOutcome outcome{};                 // final
  std::vector<NewEvent> requeued{};     // appended when it goes back to the queue
  std::vector<NewEvent> ended{};        // appended when it ends
  std::vector<NewEvent> interrupted{};  // appended when it is a RUN
  // Appended when its cancel was requested: it then ends as kCancelled (CellCancelled), whatever
  // attempts are left; a RUN is interrupted all the same. Empty: such a job is treated as any
  // other.
  std::vector<NewEvent> cancelled{};
  // False: the worker never said that it began, so this attempt does not count. Of one job at most
  // kUncountedAttemptsMax are let go so, or what kills each worker at once would do so for ever.
  bool counts = true;
  // A RUN whose machine has certainly not moved for it: given back, it waits again as any other.
  bool not_begun = false;
  bool held = false;  // of such a one: a person lets it go
};
inline constexpr int kUncountedAttemptsMax = 8;  // those that were handed back among them

// Where a page of jobs ends and the next one begins: what decides the place of its last job.
struct JobPlace {
  std::int64_t id = 0;
  JobState state = JobState::kQueued;
  bool blocked = false;
  int priority = 0;
  double place = 0.0;

  bool operator==(const JobPlace&) const = default;
};
inline JobPlace PlaceOf(const JobRecord& job) {
  return {job.id, job.state, job.blocked, job.priority, job.place};
}

enum class JobOrder {
  kNewestFirst,
  kOldestFirst,
  // Those that run, the oldest first; those that wait, in the order in which they will run, and
  // those that have no turn yet behind them; then those that ended, the newest first.
  kQueue,
};

// Which jobs: all that fit. Fields that are empty ask for nothing.
struct JobQuery {
  std::string machine{};
  std::optional<JobState> state{};
  std::string kind{};
  std::string caller{};
  std::optional<bool> finished{};  // final states only, or unfinished only
  // Dear: no index helps to find them.
  std::string family{};
  std::string verdict{};
  std::string label{};
  std::string text{};  // stands in the title, in capitals or not
  std::optional<WallTime> created_from{};
  std::optional<WallTime> created_before{};

  JobOrder order = JobOrder::kNewestFirst;
  int limit = 50;
  std::optional<JobPlace> behind{};  // jobs behind this one, in the order asked for
};

// A content on its way out of the store. May outlive neither the store nor, to its end, the last
// record that names the content.
class BlobReader {
 public:
  virtual ~BlobReader() = default;
  virtual std::size_t size() const = 0;
  // The next part, of at most kChunkBytes; empty at the end. CellStoreCorrupt, also at the end,
  // when all of it is not what it is called; CellNotFound: it was removed meanwhile.
  virtual Result<std::string> Next() = 0;
};

// A content on its way into the store. One that is not finished leaves nothing behind.
class BlobWriter {
 public:
  virtual ~BlobWriter() = default;
  virtual Status Append(std::string_view bytes) = 0;  // CellTooLarge: more than were told
  // The content is kept so long, and with each record that names it; told again, until the later of
  // the two. CellChecksum: the bytes are not those of the name.
  virtual Result<WallTime> Finish(std::chrono::milliseconds kept) = 0;
};

// What a run compiled for a slot of its machine.
struct NewExecutable {
  int slot = 0;
  Revision object_revision = 0;  // kept only while the object still has it (OPT-1.15)
  std::string bytes{};
};

// Who wants to be the host of a machine.
struct MachineClaim {
  std::string machine{};
  std::string host{};
  std::string server{};
  std::chrono::milliseconds duration{0};
  bool pinned = false;
  // The lease as the claimant has seen it, unchanged for longer than it lasts, by a clock of its
  // own: its holder is gone (PG-5.09). Of a pinned one that is not enough.
  std::optional<MachineLease> seen{};
  bool by_hand = false;  // a person takes it, whoever has it
};

// What a host writes about its machine, all of it or nothing.
struct MachineWrite {
  std::vector<NewEvent> events{};     // of the machine, into the log of the cell
  std::optional<MachineMark> mark{};  // its fence and time are those of the write
  // What the job that it runs tells, into the log of that job.
  std::optional<Lease> job{};
  std::vector<NewEvent> job_events{};
};

// The end of a job and all that is written with it.
struct JobEnd {
  JobOutcome outcome{};
  std::vector<NewArtifact> artifacts{};
  std::vector<NewExecutable> executables{};
  std::vector<NewEvent> events{};
  // Of a RUN: where it left its machine, by the host that has it.
  std::optional<MachineLease> machine_lease{};
  MachineWrite machine{};
};

// What is made of a job that has ended.
struct LateProducts {
  std::vector<NewArtifact> artifacts{};
  std::string judgement{};  // as in JobOutcome; empty: it stays as it is
  std::string verdict{};
  std::vector<NewEvent> events{};
};

// What a worker that is free takes.
struct JobRequest {
  std::string worker{};
  std::string server{};  // of the worker; for orders
  std::vector<std::string> kinds{};
  std::vector<std::string> pools{""};
  // Of a RUN: those of these machines; empty: of all.
  std::vector<std::string> run_machines{};
  // This one alone, though a person holds it. CellPrecondition: it waits for its time, or for
  // another job.
  std::optional<std::int64_t> job{};
  int count = 1;
  std::chrono::milliseconds duration{0};  // of each lease
  std::vector<NewEvent> events{};         // appended to each job
};

// A job that is over, and what its worker was given in its place.
struct FinishedJob {
  JobRecord job{};
  std::vector<LeasedJob> next{};
};

enum class QueueAct { kHold, kRelease, kCancel };

// The program memory of a machine and what belongs to it.
struct MachineMemory {
  MachineRecord machine{};
  std::optional<MachineMark> mark{};      // where it stands; none: a new machine
  std::vector<ProgramRecord> programs{};  // by slot, with object and executable, without source
  // Slots that held a program once and are empty now, in order (OPT-1.13: deleting counts as
  // altering).
  std::vector<int> deleted{};
  std::vector<ScheduleRecord> schedules{};  // by number
};

// What the program memory of a machine holds at most: its objects and executables together.
struct ProgramMemoryLimit {
  std::int64_t bytes = 0;
  ErrorCode full = ErrorCode::kCellTooLarge;  // what the machine calls it that there is no room
};
// Nothing: as much as comes. Asked inside a write: it calls no store.
using ProgramMemoryOf = std::function<std::optional<ProgramMemoryLimit>(const MachineRecord&)>;

// Whether a program memory of `before` bytes may become one of `after`. One that is too full
// already, as its limit was another one, may shrink. Errors: `full`.
Status CheckRoom(const std::optional<ProgramMemoryLimit>& limit, std::int64_t before,
                 std::int64_t after);

// What to write into one slot. All writes of one call are made, or none.
struct ProgramWrite {
  int slot = 0;
  std::string name{};
  std::string object{};
  std::optional<std::string> source{};
  std::string source_name{};
  Revision expected = kAnyRevision;
};

// Everything durable that the cell has. One interface for the embedded store and for a networked
// one that several servers share: nothing here assumes that this process is the only writer.
//
// Thread-safe. What returned success survives a kill at any instruction. A change of a job and its
// events are one transaction. After an error nothing is changed.
//
// Errors everywhere: CellStoreFailed (9101), CellStoreBusy (9103), CellStoreCorrupt (9104),
// CellTooLarge (9007, a field beyond what the store can hold); those of a method beyond that are
// listed with it. What belongs to one machine gives CellUnknownMachine, what belongs to one job
// CellNotFound, when there is no such machine or job.
//
// An `expected` revision that does not fit gives CellEtagMismatch; 0 when the record is there
// CellAlreadyExists; above 0 when it is not there CellNotFound (of a machine: CellUnknownMachine).
// `limit` is the largest number of rows given; below 1 there are none.
//
// Every change of a record is an event of the log of the cell, in the transaction of the change;
// `caller` is who made it.
class Store {
 public:
  virtual ~Store() = default;

  // --- machines
  virtual Result<std::vector<MachineRecord>> ListMachines() = 0;  // by id
  virtual Result<MachineRecord> GetMachine(std::string_view id) = 0;
  // Grows with every change of a machine: what was read of them after it was asked for stands as
  // long as it is the same, and not 0; that says that one is being changed. From memory; whoever
  // was told of a change, or has read it, finds it here.
  virtual std::uint64_t MachineChanges() const = 0;
  // The revision and times of `machine` are not looked at. CellInvalidArgument: no id.
  virtual Result<MachineRecord> PutMachine(const MachineRecord& machine, Revision expected,
                                           std::string_view caller = {}) = 0;
  // With its programs and schedules. Jobs that have ended stay. A machine of this id that is made
  // later goes on counting the revisions. CellUnknownMachine; CellPrecondition: jobs wait for it or
  // run.
  virtual Status DeleteMachine(std::string_view id, Revision expected,
                               std::string_view caller = {}) = 0;

  // --- machines that live: one host for each
  // Given when nobody has it, to the host that has it already (the fence stays), and to one that
  // has seen that the holder is gone, or that a person sends; then with a new fence.
  // CellUnknownMachine; CellMachineTaken, with the holder; CellInvalidArgument: no host or
  // duration.
  virtual Result<MachineLease> TakeMachine(const MachineClaim& claim) = 0;
  // One renewal more, through this server. CellLeaseLost.
  virtual Result<MachineLease> RenewMachine(const MachineLease& lease, std::string_view server) = 0;
  virtual Status ReleaseMachine(const MachineLease& lease) = 0;   // CellLeaseLost
  virtual Result<std::vector<MachineLease>> MachineLeases() = 0;  // those that are held, by machine
  // CellLeaseLost, also of the job; CellTooLarge: kMachineMarkBytesMax, an event;
  // CellInvalidArgument: a mark that is not newer than the one that is there. Older ones may be
  // left out.
  virtual Status AppendMachine(const MachineLease& lease, const MachineWrite& write) = 0;
  // Keeps what was taught: returns its number; that of `record` is not looked at. The oldest ones
  // go, beyond kTeachRecordsKept.
  virtual Result<std::int64_t> AddTeachRecord(const TeachRecord& record) = 0;
  // Those before `before` (0: all), the newest first; `program` 0: of all.
  virtual Result<std::vector<TeachRecord>> ListTeachRecords(std::string_view machine, int program,
                                                            std::int64_t before, int limit) = 0;
  // Nothing: no host has ever said. CellUnknownMachine.
  virtual Result<std::optional<MachineMark>> GetMachineMark(std::string_view machine) = 0;

  // --- programs
  // Slots in order, those after `after_slot`.
  virtual Result<std::vector<ProgramSummary>> ListPrograms(std::string_view machine, int after_slot,
                                                           int limit) = 0;
  virtual Result<ProgramRecord> GetProgram(std::string_view machine, int slot) = 0;  // CellNotFound
  // Without its bytes. CellNotFound.
  virtual Result<ProgramSummary> GetProgramSummary(std::string_view machine, int slot) = 0;
  // What a run needs of its machine, all as it was at one moment. `wants_programs` is asked once,
  // with the machine; where it says no, or nothing is there to ask, programs and deleted slots are
  // left out. It does not call this store.
  using WantsPrograms = std::function<bool(const MachineRecord&)>;
  virtual Result<MachineMemory> GetMachineMemory(std::string_view machine,
                                                 const WantsPrograms& wants_programs) = 0;
  // Replaces objects, deletes the executables of these slots and no others (OPT-1.12, OPT-1.13),
  // stores schedules (whatever is there; their `machine` is not looked at). Summaries in the order
  // of `programs`. CellInvalidArgument: a slot or number out of range or twice; CellTooLarge:
  // kProgramBytesMax; ProgramMemoryLimit::full.
  virtual Result<std::vector<ProgramSummary>> PutPrograms(
      std::string_view machine, const std::vector<ProgramWrite>& programs,
      const std::vector<ScheduleRecord>& schedules, std::string_view caller = {}) = 0;
  // The executable goes with it (OPT-1.12). CellNotFound.
  virtual Status DeleteProgram(std::string_view machine, int slot, Revision expected,
                               std::string_view caller = {}) = 0;
  // Kept only while the object still has `object_revision` (OPT-1.15); else nothing happens and
  // false is returned, also when there is no object. The revision stays as it is.
  // ProgramMemoryLimit::full.
  virtual Result<bool> PutExecutable(std::string_view machine, int slot, Revision object_revision,
                                     std::string_view executable, std::string_view caller = {}) = 0;
  // The object stays (OPT-1.14). CellNotFound: no program, or no executable.
  virtual Status DeleteExecutable(std::string_view machine, int slot,
                                  std::string_view caller = {}) = 0;

  // --- laser schedules
  virtual Result<std::vector<ScheduleRecord>> ListSchedules(
      std::string_view machine) = 0;  // by number
  // CellInvalidArgument: number out of range.
  virtual Result<ScheduleRecord> PutSchedule(const ScheduleRecord& schedule, Revision expected,
                                             std::string_view caller = {}) = 0;
  virtual Status DeleteSchedule(std::string_view machine, int number,
                                std::string_view caller = {}) = 0;  // CellNotFound

  // --- projects
  // By id, those after `after_id`.
  virtual Result<std::vector<ProjectRecord>> ListProjects(std::string_view after_id, int limit) = 0;
  virtual Result<ProjectRecord> GetProject(std::string_view id) = 0;  // CellNotFound
  // As PutMachine.
  virtual Result<ProjectRecord> PutProject(const ProjectRecord& project, Revision expected,
                                           std::string_view caller = {}) = 0;
  virtual Status DeleteProject(std::string_view id, Revision expected,
                               std::string_view caller = {}) = 0;  // CellNotFound

  // --- jobs
  // Durable before `done` is called: many submissions share one commit. Attachments are hashed and
  // compressed by the calling thread before that. CellRequestIdReused when request_id is known with
  // another request_hash; CellNotFound: an attachment names content that is not there;
  // CellInvalidArgument: attempts_max below 1, an attachment's name twice, a priority out of range;
  // CellNotFound and CellPrecondition: a job of `after` that there is not, or that has ended
  // otherwise; CellTooLarge: an event beyond kEventPayloadBytesMax; CellResourceExhausted:
  // queued_max jobs wait and the request_id is new; or too many writes wait already, told at once
  // by the calling thread.
  virtual void Submit(NewJob job, Done<SubmittedJob> done) = 0;
  virtual Result<SubmittedJob> SubmitAndWait(NewJob job);
  // The job that this request made, or nothing. CellRequestIdReused, as of Submit().
  virtual Result<std::optional<JobRecord>> FindSubmitted(std::string_view request_id,
                                                         std::string_view request_hash) = 0;

  virtual Result<JobRecord> GetJob(std::int64_t id) = 0;
  // The same as MachineChanges, of one job and what it left; what it waits for depends on others.
  // Jobs may share it.
  virtual std::uint64_t JobChanges(std::int64_t job) const = 0;
  virtual Result<std::vector<JobRecord>> ListJobs(const JobQuery& query) = 0;
  virtual Result<std::vector<AttemptRecord>> ListAttempts(std::int64_t job) = 0;  // by number
  virtual Result<JobCounts> CountJobs() = 0;  // cheap: called for every submission
  // Of the jobs that fit, whatever the query says of states, order and page; states without jobs
  // are left out. Dear: all of them are looked at.
  virtual Result<std::vector<JobStateCount>> CountByState(const JobQuery& query) = 0;
  // By id of the machine; those without such jobs are left out.
  virtual Result<std::vector<MachineJobs>> UnfinishedJobs() = 0;
  // With its events, attempts and products; whoever asks for its events is told that they are gone.
  // CellNotFound; CellPrecondition: it has not ended.
  virtual Status DeleteJob(std::int64_t id, std::string_view caller = {}) = 0;

  // Queued: cancelled at once (CellCancelled), with `events`. Running: marked, without events; the
  // holder of the lease ends it. Final: unchanged. Returns the job as it then is.
  virtual Result<JobRecord> RequestCancel(std::int64_t job,
                                          const std::vector<NewEvent>& events) = 0;
  virtual void SendRequestCancel(std::int64_t job, std::vector<NewEvent> events,
                                 Done<JobRecord> done);

  // --- the queue: jobs that wait and no others (CellPrecondition). `events` are appended.
  // Of those that are ready the one of the highest priority starts first, then the oldest; Move()
  // gives a job another place.
  //
  // It does not start until it is let go.
  virtual Result<JobRecord> HoldBack(std::int64_t job, const std::vector<NewEvent>& events) = 0;
  // The same, or a cancel, of many in one transaction: of those that wait, or have not ended, and
  // that it changes; the others, and jobs that are gone, are left out. `event` says what is told of
  // a job, as it was before. Returns those that changed, without their specification. Not more than
  // a few hundred, or other writes wait.
  using EventOf = std::function<NewEvent(const JobRecord&)>;
  virtual Result<std::vector<JobRecord>> ActOn(std::span<const std::int64_t> jobs, QueueAct act,
                                               const EventOf& event) = 0;
  // It waits no longer for a person: neither held back nor for jobs that did not succeed.
  virtual Result<JobRecord> LetGo(std::int64_t job, const std::vector<NewEvent>& events) = 0;
  // How many of the jobs that wait for the same workers, and are ready, start before this one.
  // Dear: they are counted. CellPrecondition: it does not wait.
  virtual Result<std::int64_t> CountBefore(std::int64_t job) = 0;
  // In front of `before`, with its priority (CellNotFound; CellPrecondition: it does not wait in
  // the same pool for the same kind of worker); 0: behind all
  // others of its priority, which is `priority` from now on where it is given.
  virtual Result<JobRecord> Move(std::int64_t job, std::int64_t before, std::optional<int> priority,
                                 const std::vector<NewEvent>& events) = 0;

  // --- leases; all times by the clock of the store
  // Each call has a form that does not wait, Send...(): a server uses no other, or a store that is
  // away for half a minute holds up all its threads. Jobs come without their specification there,
  // but those of AwaitJobs(). A store that never makes anybody wait leaves them as they are.
  //
  // A job has at most one holder. A lease that ran out stays its holder's until Expire() takes it:
  // work that was done is kept while nobody else has begun it.
  //
  // The first of the queue that are ready and fit, as many as are asked for or fewer. One may have
  // cancel_requested, when an earlier holder gave it back: the new one ends it. A machine runs one
  // RUN at a time.
  virtual Result<std::vector<LeasedJob>> AcquireJobs(const JobRequest& request) = 0;
  // The same for who has time: while there is none the request stands, and the transaction that
  // makes a job one that can begin leases it as well, so that both cost one wait for the disk.
  // Who asked before that hears of it before whoever made the job, unless he made it in an answer.
  // Returns what Withdraw() knows the request by.
  virtual std::int64_t AwaitJobs(JobRequest request, Done<std::vector<LeasedJob>> done) = 0;
  // `done` is then called with nothing, unless it has been called or is to be; so is that of each
  // request that stands when the store goes.
  virtual void Withdraw(std::int64_t request) = 0;
  // One job of the common pool, or nothing.
  Result<std::optional<LeasedJob>> Acquire(std::string_view worker,
                                           const std::vector<std::string>& kinds,
                                           std::chrono::milliseconds duration,
                                           const std::vector<NewEvent>& events);
  // Until `duration` from now, 366 days at most. CellLeaseLost. Returns the job without its
  // specification, so that the holder sees cancel_requested.
  virtual Result<JobRecord> Renew(const Lease& lease, std::chrono::milliseconds duration) = 0;
  virtual void SendRenew(const Lease& lease, std::chrono::milliseconds duration,
                         Done<JobRecord> done);
  // CellLeaseLost, CellTooLarge, CellResourceExhausted. `done` gets the last sequence number
  // written, and is called as that of Submit(). What is appended under one lease is written in the
  // order of the calls.
  virtual void Append(const Lease& lease, std::vector<NewEvent> events,
                      Done<std::int64_t> done) = 0;
  virtual Result<std::int64_t> AppendAndWait(const Lease& lease, std::vector<NewEvent> events);
  // Ends the job, in one transaction: whoever reads its last event finds its artifacts and
  // executables, and the machine where the run left it. CellLeaseLost, also of the machine;
  // CellNotFound: an artifact names content that is not there;
  // CellInvalidArgument: a state that is not final, an artifact's name that the job has already;
  // CellTooLarge: an executable beyond kProgramBytesMax.
  virtual Result<JobRecord> Finish(const Lease& lease, const JobEnd& end) = 0;
  // `next`: a worker that is done asks for more, and gets it in the same transaction; that nothing
  // could be leased does not keep the end from being stored.
  virtual void SendFinish(const Lease& lease, std::shared_ptr<const JobEnd> end,
                          std::optional<JobRequest> next, Done<FinishedJob> done);
  // Products that come behind the end of a job, made of what it left; `events` are appended.
  // CellNotFound; CellPrecondition: it has not ended; CellInvalidArgument: a name that the job has.
  virtual Result<JobRecord> AddProducts(std::int64_t job, const LateProducts& products) = 0;
  // Gives the job back to the queue; this attempt does not count. A RUN is interrupted, unless the
  // policy says that it has not begun: it may have moved its machine. Returns the job as it then
  // is. CellLeaseLost.
  virtual Result<JobRecord> HandBack(const Lease& lease, const LossPolicy& policy) = 0;
  virtual void SendHandBack(const Lease& lease, LossPolicy policy, Done<JobRecord> done);
  // The worker is known to be dead: as if the lease ran out now. CellLeaseLost.
  virtual Result<JobRecord> Abandon(const Lease& lease, const LossPolicy& policy) = 0;
  virtual void SendAbandon(const Lease& lease, LossPolicy policy, Done<JobRecord> done);
  // Every lease that ran out, and every job whose time has come may start; contents that were kept
  // for a time are let go behind it. Any server may call it
  // at any time. Returns the jobs that changed; one that cannot be read does not keep the others
  // from going on. It may take nothing for a while after the store was lost and found again:
  // whoever could not renew meanwhile gets time to.
  virtual Result<std::vector<JobRecord>> Expire(const LossPolicy& policy) = 0;

  // --- orders: whichever server a client asks, the one whose worker has the job hears of it
  // For the holder of the lease; gone with the lease. CellPrecondition: no other server than `from`
  // has the job.
  virtual Status PutOrder(std::int64_t job, std::string_view from, std::string_view payload) = 0;
  // Those for leases of this server, in the order in which they were put, each once. Cheap where
  // there are none: called a few times a second.
  virtual Result<std::vector<TakenOrder>> TakeOrders(std::string_view server) = 0;

  // --- events and artifacts
  // In order, those after the number given. CellEventsGone when some of these were removed (a store
  // may be told to bound what it keeps): from JobRecord::events_gone_until and EventsGoneUntil() on
  // all are there. Those of a job that was deleted by itself are left out without a word but that
  // it was deleted, which comes behind them.
  virtual Result<std::vector<EventRecord>> JobEvents(std::int64_t job, std::int64_t after_sequence,
                                                     int limit) = 0;
  virtual Result<std::vector<EventRecord>> AllEvents(std::int64_t after_position, int limit) = 0;
  virtual Result<std::int64_t> LastPosition() = 0;     // of all events ever written; 0: none
  virtual Result<std::int64_t> EventsGoneUntil() = 0;  // a position; 0: all are there
  // Names this log as it goes on from the opening of the store. Who keeps a position keeps this
  // with it.
  virtual std::string LogId() = 0;
  // Whether a position that was seen under this id stands in this log. False: it is of another log,
  // or of what was lost when a backup was put back.
  virtual Result<bool> HasPosition(std::string_view log_id, std::int64_t position) = 0;
  virtual Result<std::vector<ArtifactRecord>> ListArtifacts(std::int64_t job) = 0;  // by name
  virtual Result<ArtifactRecord> GetArtifact(std::int64_t job, std::string_view name) = 0;
  // The bytes of an artifact; piece by piece in the memory of a few chunks. Errors: of
  // GetArtifact().
  virtual Result<std::string> ReadArtifact(std::int64_t job, std::string_view name) = 0;
  virtual Result<std::unique_ptr<BlobReader>> OpenArtifact(std::int64_t job,
                                                           std::string_view name) = 0;

  // --- contents by their SHA-256: all but the small ones that a job has alone
  virtual Result<std::string> ReadBlob(std::string_view sha256) = 0;  // CellNotFound
  // Piece by piece. CellNotFound.
  virtual Result<std::unique_ptr<BlobReader>> OpenBlob(std::string_view sha256) = 0;
  // For a content of that name (64 hexadecimal digits) and size. CellInvalidArgument: no such name;
  // CellTooLarge: kProgramBytesMax.
  virtual Result<std::unique_ptr<BlobWriter>> WriteBlob(std::string_view sha256,
                                                        std::size_t size) = 0;

  // Called after each commit that wrote events or changed jobs, from a thread of the store and
  // under no lock: a hint to read the rows, which may come twice or for nothing, and a second late,
  // also where the store was lost meanwhile. It may call this store and does not throw. The
  // returned handle ends it when destroyed, also from inside the call; from elsewhere that waits
  // for a call that is under way, so hold no lock there that the call takes. The handle may outlive
  // the store.
  class Subscription {
   public:
    virtual ~Subscription() = default;
  };
  [[nodiscard]] virtual std::unique_ptr<Subscription> Watch(std::function<void()> changed) = 0;
};

}  // namespace rmlcell::storage
