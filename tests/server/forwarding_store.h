#pragma once

#include "storage/store.h"

namespace rmlcell::server {

// Hands every call on to another store. Tests override what shall happen at a certain moment.
class ForwardingStore : public storage::Store {
 public:
  explicit ForwardingStore(storage::Store& store) : store_(store) {}

  Result<std::vector<storage::MachineRecord>> ListMachines() override {
    return store_.ListMachines();
  }
  Result<storage::MachineRecord> GetMachine(std::string_view id) override {
    return store_.GetMachine(id);
  }
  std::uint64_t MachineChanges() const override { return store_.MachineChanges(); }
  std::uint64_t JobChanges(std::int64_t job) const override { return store_.JobChanges(job); }
  Result<storage::MachineRecord> PutMachine(const storage::MachineRecord& machine,
                                            storage::Revision expected,
                                            std::string_view caller) override {
    return store_.PutMachine(machine, expected, caller);
  }
  Status DeleteMachine(std::string_view id, storage::Revision expected,
                       std::string_view caller) override {
    return store_.DeleteMachine(id, expected, caller);
  }
  Result<storage::MachineLease> TakeMachine(const storage::MachineClaim& claim) override {
    return store_.TakeMachine(claim);
  }
  Result<storage::MachineLease> RenewMachine(const storage::MachineLease& lease,
                                             std::string_view server) override {
    return store_.RenewMachine(lease, server);
  }
  Status ReleaseMachine(const storage::MachineLease& lease) override {
    return store_.ReleaseMachine(lease);
  }
  Result<std::vector<storage::MachineLease>> MachineLeases() override {
    return store_.MachineLeases();
  }
  Status AppendMachine(const storage::MachineLease& lease,
                       const storage::MachineWrite& write) override {
    return store_.AppendMachine(lease, write);
  }
  Result<std::int64_t> AddTeachRecord(const storage::TeachRecord& record) override {
    return store_.AddTeachRecord(record);
  }
  Result<std::vector<storage::TeachRecord>> ListTeachRecords(std::string_view machine, int program,
                                                             std::int64_t before,
                                                             int limit) override {
    return store_.ListTeachRecords(machine, program, before, limit);
  }
  Result<std::optional<storage::MachineMark>> GetMachineMark(std::string_view machine) override {
    return store_.GetMachineMark(machine);
  }
  Result<std::vector<storage::ProgramSummary>> ListPrograms(std::string_view machine, int after,
                                                            int limit) override {
    return store_.ListPrograms(machine, after, limit);
  }
  Result<storage::ProgramRecord> GetProgram(std::string_view machine, int slot) override {
    return store_.GetProgram(machine, slot);
  }
  Result<storage::ProgramSummary> GetProgramSummary(std::string_view machine, int slot) override {
    return store_.GetProgramSummary(machine, slot);
  }
  Result<storage::MachineMemory> GetMachineMemory(std::string_view machine,
                                                  const WantsPrograms& wants_programs) override {
    return store_.GetMachineMemory(machine, wants_programs);
  }
  Result<std::vector<storage::ProgramSummary>> PutPrograms(
      std::string_view machine, const std::vector<storage::ProgramWrite>& programs,
      const std::vector<storage::ScheduleRecord>& schedules, std::string_view caller) override {
    return store_.PutPrograms(machine, programs, schedules, caller);
  }
  Status DeleteProgram(std::string_view machine, int slot, storage::Revision expected,
                       std::string_view caller) override {
    return store_.DeleteProgram(machine, slot, expected, caller);
  }
  Result<bool> PutExecutable(std::string_view machine, int slot, storage::Revision object_revision,
                             std::string_view executable, std::string_view caller) override {
    return store_.PutExecutable(machine, slot, object_revision, executable, caller);
  }
  Status DeleteExecutable(std::string_view machine, int slot, std::string_view caller) override {
    return store_.DeleteExecutable(machine, slot, caller);
  }
  Result<std::vector<storage::ScheduleRecord>> ListSchedules(std::string_view machine) override {
    return store_.ListSchedules(machine);
  }
  Result<storage::ScheduleRecord> PutSchedule(const storage::ScheduleRecord& schedule,
                                              storage::Revision expected,
                                              std::string_view caller) override {
    return store_.PutSchedule(schedule, expected, caller);
  }
  Status DeleteSchedule(std::string_view machine, int number, std::string_view caller) override {
    return store_.DeleteSchedule(machine, number, caller);
  }
  Result<std::vector<storage::ProjectRecord>> ListProjects(std::string_view after,
                                                           int limit) override {
    return store_.ListProjects(after, limit);
  }
  Result<storage::ProjectRecord> GetProject(std::string_view id) override {
    return store_.GetProject(id);
  }
  Result<storage::ProjectRecord> PutProject(const storage::ProjectRecord& project,
                                            storage::Revision expected,
                                            std::string_view caller) override {
    return store_.PutProject(project, expected, caller);
  }
  Status DeleteProject(std::string_view id, storage::Revision expected,
                       std::string_view caller) override {
    return store_.DeleteProject(id, expected, caller);
  }
  void Submit(storage::NewJob job,
              std::function<void(Result<storage::SubmittedJob>)> done) override {
    store_.Submit(std::move(job), std::move(done));
  }
  Result<std::optional<storage::JobRecord>> FindSubmitted(std::string_view id,
                                                          std::string_view hash) override {
    return store_.FindSubmitted(id, hash);
  }
  Result<storage::JobRecord> GetJob(std::int64_t id) override { return store_.GetJob(id); }
  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    return store_.ListJobs(query);
  }
  Result<std::vector<storage::AttemptRecord>> ListAttempts(std::int64_t job) override {
    return store_.ListAttempts(job);
  }
  Result<storage::JobCounts> CountJobs() override { return store_.CountJobs(); }
  Result<std::vector<storage::JobStateCount>> CountByState(
      const storage::JobQuery& query) override {
    return store_.CountByState(query);
  }
  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override {
    return store_.UnfinishedJobs();
  }
  Status DeleteJob(std::int64_t id, std::string_view caller) override {
    return store_.DeleteJob(id, caller);
  }
  Result<storage::JobRecord> RequestCancel(std::int64_t job,
                                           const std::vector<storage::NewEvent>& events) override {
    return store_.RequestCancel(job, events);
  }
  Result<storage::JobRecord> HoldBack(std::int64_t job,
                                      const std::vector<storage::NewEvent>& events) override {
    return store_.HoldBack(job, events);
  }
  Result<std::vector<storage::JobRecord>> ActOn(std::span<const std::int64_t> jobs,
                                                storage::QueueAct act,
                                                const EventOf& event) override {
    return store_.ActOn(jobs, act, event);
  }
  Result<storage::JobRecord> LetGo(std::int64_t job,
                                   const std::vector<storage::NewEvent>& events) override {
    return store_.LetGo(job, events);
  }
  Result<storage::JobRecord> Move(std::int64_t job, std::int64_t before,
                                  std::optional<int> priority,
                                  const std::vector<storage::NewEvent>& events) override {
    return store_.Move(job, before, priority, events);
  }
  Result<std::int64_t> CountBefore(std::int64_t job) override { return store_.CountBefore(job); }
  Status PutOrder(std::int64_t job, std::string_view from, std::string_view payload) override {
    return store_.PutOrder(job, from, payload);
  }
  Result<std::vector<storage::TakenOrder>> TakeOrders(std::string_view server) override {
    return store_.TakeOrders(server);
  }
  Result<std::vector<storage::LeasedJob>> AcquireJobs(const storage::JobRequest& request) override {
    return store_.AcquireJobs(request);
  }
  std::int64_t AwaitJobs(storage::JobRequest request,
                         storage::Done<std::vector<storage::LeasedJob>> done) override {
    return store_.AwaitJobs(std::move(request), std::move(done));
  }
  void Withdraw(std::int64_t request) override { store_.Withdraw(request); }
  Result<storage::JobRecord> Renew(const storage::Lease& lease,
                                   std::chrono::milliseconds duration) override {
    return store_.Renew(lease, duration);
  }
  void Append(const storage::Lease& lease, std::vector<storage::NewEvent> events,
              std::function<void(Result<std::int64_t>)> done) override {
    store_.Append(lease, std::move(events), std::move(done));
  }
  Result<storage::JobRecord> Finish(const storage::Lease& lease,
                                    const storage::JobEnd& end) override {
    return store_.Finish(lease, end);
  }
  Result<storage::JobRecord> AddProducts(std::int64_t job,
                                         const storage::LateProducts& products) override {
    return store_.AddProducts(job, products);
  }
  Result<storage::JobRecord> HandBack(const storage::Lease& lease,
                                      const storage::LossPolicy& policy) override {
    return store_.HandBack(lease, policy);
  }
  Result<storage::JobRecord> Abandon(const storage::Lease& lease,
                                     const storage::LossPolicy& policy) override {
    return store_.Abandon(lease, policy);
  }
  Result<std::vector<storage::JobRecord>> Expire(const storage::LossPolicy& policy) override {
    return store_.Expire(policy);
  }
  Result<std::vector<storage::EventRecord>> JobEvents(std::int64_t job, std::int64_t after,
                                                      int limit) override {
    return store_.JobEvents(job, after, limit);
  }
  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t after, int limit) override {
    return store_.AllEvents(after, limit);
  }
  Result<std::int64_t> LastPosition() override { return store_.LastPosition(); }
  Result<std::int64_t> EventsGoneUntil() override { return store_.EventsGoneUntil(); }
  std::string LogId() override { return store_.LogId(); }
  Result<bool> HasPosition(std::string_view log_id, std::int64_t position) override {
    return store_.HasPosition(log_id, position);
  }
  Result<std::vector<storage::ArtifactRecord>> ListArtifacts(std::int64_t job) override {
    return store_.ListArtifacts(job);
  }
  Result<storage::ArtifactRecord> GetArtifact(std::int64_t job, std::string_view name) override {
    return store_.GetArtifact(job, name);
  }
  Result<std::string> ReadArtifact(std::int64_t job, std::string_view name) override {
    return store_.ReadArtifact(job, name);
  }
  Result<std::unique_ptr<storage::BlobReader>> OpenArtifact(std::int64_t job,
                                                            std::string_view name) override {
    return store_.OpenArtifact(job, name);
  }
  Result<std::string> ReadBlob(std::string_view sha256) override { return store_.ReadBlob(sha256); }
  Result<std::unique_ptr<storage::BlobReader>> OpenBlob(std::string_view sha256) override {
    return store_.OpenBlob(sha256);
  }
  Result<std::unique_ptr<storage::BlobWriter>> WriteBlob(std::string_view sha256,
                                                         std::size_t size) override {
    return store_.WriteBlob(sha256, size);
  }
  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override {
    return store_.Watch(std::move(changed));
  }

 protected:
  storage::Store& store_;
};

}  // namespace rmlcell::server
