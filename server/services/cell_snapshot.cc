#include "server/services/cell_snapshot.h"

#include <algorithm>
#include <map>

#include "server/base/names.h"
#include "server/jobs/job_book.h"
#include "server/machines/hosts.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"
#include "storage/trouble.h"

namespace rmlcell::server {
namespace {

v1::RecordChange ChangeOf(const storage::EventRecord& event) {
  if (event.kind == storage::kCreated) return v1::RECORD_CHANGE_CREATED;
  if (event.kind == storage::kUpdated) return v1::RECORD_CHANGE_UPDATED;
  if (event.kind == storage::kDeleted) return v1::RECORD_CHANGE_DELETED;
  return v1::RECORD_CHANGE_UNSPECIFIED;
}

Status AddNewestJobs(const CellRecords& records, const storage::JobQuery& query,
                     v1::CellSnapshot& snapshot) {
  auto newest = records.jobs.Newest(query);
  if (!newest) return newest.error();
  for (v1::Job& job : *newest) *snapshot.add_jobs() = std::move(job);
  const auto counts = records.jobs.Count(query);
  if (!counts) return counts.error();
  *snapshot.mutable_counts() = {counts->begin(), counts->end()};
  return {};
}

Status AddNamedJobs(const CellRecords& records,
                    const google::protobuf::RepeatedPtrField<std::string>& names,
                    v1::CellSnapshot& snapshot) {
  std::map<v1::Job::State, std::int64_t> counts;
  for (const std::string& name : names) {
    Result<v1::Job> job = records.jobs.Get(name);
    if (!job && job.error().code == ErrorCode::kCellNotFound) continue;  // it may come, or is gone
    if (!job) return job.error();
    counts[job->state()] += 1;
    *snapshot.add_jobs() = *std::move(job);
  }
  for (const auto& [state, jobs] : counts) {
    v1::JobCount& count = *snapshot.add_counts();
    count.set_state(state);
    count.set_jobs(jobs);
  }
  return {};
}

Status AddJobs(const CellRecords& records, const CellSubscription& subscription,
               v1::CellSnapshot& snapshot) {
  const auto& names = subscription.wanted().jobs().names();
  return names.empty() ? AddNewestJobs(records, subscription.query(), snapshot)
                       : AddNamedJobs(records, names, snapshot);
}

Status AddMachines(const CellRecords& records, const CellSubscription& subscription,
                   v1::CellSnapshot& snapshot) {
  const auto machines = records.store.ListMachines();
  if (!machines) return machines.error();
  const auto unfinished = records.store.UnfinishedJobs();
  if (!unfinished) return unfinished.error();
  const auto& names = subscription.wanted().machines().names();
  for (const storage::MachineRecord& machine : *machines) {
    if (names.empty() || std::ranges::find(names, MachineName(machine.id)) != names.end()) {
      v1::Machine& made = *snapshot.add_machines();
      made = ToProto(machine);
      *made.mutable_status() = StatusOf(records.hosts, machine, *unfinished);
    }
  }
  return {};
}

Status AddProjects(const CellRecords& records, const CellSubscription& subscription,
                   v1::CellSnapshot& snapshot) {
  const auto& names = subscription.wanted().projects().names();
  v1::ListProjectsRequest request;
  do {
    auto page = records.projects.List(request);
    if (!page) return page.error();
    for (v1::Project& project : *page->mutable_projects()) {
      if (names.empty() || std::ranges::find(names, project.name()) != names.end())
        *snapshot.add_projects() = std::move(project);
    }
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return {};
}

// False: it could not be read.
bool SetMachine(const CellRecords& records, const storage::EventRecord& event,
                v1::MachineChanged& changed) {
  changed.set_change(ChangeOf(event));
  changed.mutable_machine()->set_name(event.resource);
  if (changed.change() == v1::RECORD_CHANGE_DELETED) return true;
  const auto id = ParseMachineName(event.resource);
  const auto machine =
      id ? records.store.GetMachine(*id) : Result<storage::MachineRecord>(id.error());
  if (!machine) return !storage::IsTroubleOfTheStore(machine.error());
  *changed.mutable_machine() = ToProto(*machine);
  changed.mutable_machine()->clear_status();
  return true;
}

bool SetProgram(const CellRecords& records, const storage::EventRecord& event,
                v1::ProgramEvent& changed) {
  changed.set_change(ChangeOf(event));
  changed.mutable_program()->set_name(event.resource);
  if (changed.change() == v1::RECORD_CHANGE_DELETED) return true;
  auto program = records.programs.Get(event.resource);
  if (!program) return !storage::IsTroubleOfTheStore(program.error());
  *changed.mutable_program() = *std::move(program);
  return true;
}

bool SetSchedule(const CellRecords& records, const storage::EventRecord& event,
                 v1::ProgramEvent& changed) {
  changed.set_change(ChangeOf(event));
  changed.mutable_laser_schedule()->set_name(event.resource);
  if (changed.change() == v1::RECORD_CHANGE_DELETED) return true;
  const auto name = ParseScheduleName(event.resource);
  if (!name) return true;
  const auto schedules = records.store.ListSchedules(name->machine);
  if (!schedules) return !storage::IsTroubleOfTheStore(schedules.error());
  const auto found = std::ranges::find(*schedules, name->number, &storage::ScheduleRecord::number);
  if (found != schedules->end()) *changed.mutable_laser_schedule() = ToProto(*found);
  return true;
}

bool SetProject(const CellRecords& records, const storage::EventRecord& event,
                v1::ProjectEvent& changed) {
  changed.set_change(ChangeOf(event));
  changed.mutable_project()->set_name(event.resource);
  if (changed.change() == v1::RECORD_CHANGE_DELETED) return true;
  auto project = records.projects.Get(event.resource);
  if (!project) return !storage::IsTroubleOfTheStore(project.error());
  *changed.mutable_project() = WithoutContent(*std::move(project));
  return true;
}

}  // namespace

Result<v1::CellSnapshot> SnapshotOf(const CellRecords& records,
                                    const CellSubscription& subscription) {
  v1::CellSnapshot snapshot;
  Status added;
  switch (subscription.wanted().what_case()) {
    case v1::Subscription::kJobs:
      added = AddJobs(records, subscription, snapshot);
      break;
    case v1::Subscription::kMachines:
      added = AddMachines(records, subscription, snapshot);
      break;
    case v1::Subscription::kProjects:
      added = AddProjects(records, subscription, snapshot);
      break;
    default:
      break;
  }
  if (!added) return added.error();
  return snapshot;
}

ReadEvent EventOf(const CellRecords& records, const storage::EventRecord& event) {
  ReadEvent read;
  v1::CellEvent& made = read.event;
  made.set_sequence(event.position);
  made.set_resource(event.job > 0 ? JobName(event.job) : event.resource);
  *made.mutable_time() = ToProto(event.at);
  made.set_caller(event.caller);
  if (event.job > 0) {
    *made.mutable_job() = ToProto(event);
  } else if (event.resource.starts_with("jobs/")) {
    made.set_job_deleted(true);
  } else if (event.resource.starts_with("projects/")) {
    read.whole = SetProject(records, event, *made.mutable_project());
  } else if (event.resource.find("/programs/") != std::string::npos) {
    read.whole = SetProgram(records, event, *made.mutable_program());
  } else if (event.resource.find("/laserSchedules/") != std::string::npos) {
    read.whole = SetSchedule(records, event, *made.mutable_program());
  } else if (event.kind == kMachineEvent) {
    read.whole = made.mutable_machine()->ParseFromString(event.payload);
  } else {
    read.whole = SetMachine(records, event, *made.mutable_machine()->mutable_changed());
  }
  return read;
}

}  // namespace rmlcell::server
