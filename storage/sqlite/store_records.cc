// Machines and projects.
#include <algorithm>

#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/host_life.h"
#include "storage/sqlite/job_life.h"
#include "storage/sqlite/sqlite_store_impl.h"

namespace rmlcell::storage::sqlite {
namespace {

Error NoProject(std::string_view id) {
  return Error{ErrorCode::kCellNotFound, "project " + std::string(id), {}};
}

template <class Record>
void SetStamp(Record& record, const Stamp& stamp) {
  record.revision = stamp.revision;
  record.created_at = stamp.created_at;
  record.updated_at = stamp.updated_at;
}

std::string_view Change(bool there_before) { return there_before ? kUpdated : kCreated; }

Result<Stamp> PutMachineRow(WriteContext& context, const MachineRecord& machine, Revision expected,
                            std::string_view caller) {
  const Result<std::optional<MachineTable::Facts>> found = context.tables.machines.Find(machine.id);
  if (!found) return found.error();
  const std::optional<MachineTable::Facts>& before = *found;
  if (const Status fits =
          CheckRevision(before ? std::optional(before->revision) : std::nullopt, expected,
                        "machine " + machine.id, ErrorCode::kCellUnknownMachine);
      !fits)
    return fits.error();
  Revision last = before ? before->revision : 0;
  if (!before) {
    const Result<Revision> buried =
        context.tables.buried.DigUp(BuriedTable::Kind::kMachine, "", machine.id);
    if (!buried) return buried.error();
    last = *buried;
  }
  const Stamp stamp{.revision = last + 1,
                    .created_at = before ? before->created_at : context.now,
                    .updated_at = context.now};
  if (const Status put = context.tables.machines.Put(machine, stamp); !put) return put.error();
  if (const Status noted =
          NoteRecord(context, MachineName(machine.id), Change(before.has_value()), caller);
      !noted)
    return noted.error();
  return stamp;
}

Status RemoveMachine(WriteContext& context, std::string_view id, Revision expected,
                     std::string_view caller) {
  Tables& tables = context.tables;
  const Result<std::optional<MachineTable::Facts>> found = tables.machines.Find(id);
  if (!found) return found.error();
  if (!*found) return Error{ErrorCode::kCellUnknownMachine, std::string(id), {}};
  const MachineTable::Facts& before = **found;
  if (const Status fits = CheckRevision(before.revision, expected, "machine " + std::string(id));
      !fits)
    return fits.error();
  if (UnfinishedOf(context, std::string(id)) > 0) {
    return Error{ErrorCode::kCellPrecondition,
                 "jobs wait for machine " + std::string(id) + " or run; cancel them first",
                 {}};
  }
  if (const Status memory = RemoveMemory(context, id, caller); !memory) return memory.error();
  if (const Status removed = tables.machines.Remove(id); !removed) return removed.error();
  if (const Status buried =
          tables.buried.Bury(BuriedTable::Kind::kMachine, "", id, before.revision);
      !buried)
    return buried.error();
  if (const Status forgotten = ForgetHost(context, id); !forgotten) return forgotten.error();
  if (const Status forgotten = tables.taught.Remove(id); !forgotten) return forgotten.error();
  return NoteRecord(context, MachineName(id), kDeleted, caller);
}

Result<Stamp> PutProjectRow(WriteContext& context, const ProjectRecord& project, Revision expected,
                            const PreparedContent& body, std::string_view caller) {
  const Result<std::optional<ProjectTable::Facts>> found = context.tables.projects.Find(project.id);
  if (!found) return found.error();
  const std::optional<ProjectTable::Facts>& before = *found;
  if (const Status fits = CheckRevision(before ? std::optional(before->revision) : std::nullopt,
                                        expected, "project " + project.id);
      !fits)
    return fits.error();
  Revision last = before ? before->revision : 0;
  if (!before) {
    const Result<Revision> buried =
        context.tables.buried.DigUp(BuriedTable::Kind::kProject, "", project.id);
    if (!buried) return buried.error();
    last = *buried;
  }
  const Stamp stamp{.revision = last + 1,
                    .created_at = before ? before->created_at : context.now,
                    .updated_at = context.now};
  const Result<ContentColumns> columns = context.tables.blobs.Put(body);
  if (!columns) return columns.error();
  if (const Status put = context.tables.projects.Put(project, stamp, *columns); !put)
    return put.error();
  if (before) {
    if (const Status dropped = context.tables.blobs.Drop(before->body_blob); !dropped)
      return dropped.error();
  }
  context.garbage = true;
  if (const Status noted =
          NoteRecord(context, ProjectName(project.id), Change(before.has_value()), caller);
      !noted)
    return noted.error();
  return stamp;
}

Status RemoveProject(WriteContext& context, std::string_view id, Revision expected,
                     std::string_view caller) {
  const Result<std::optional<ProjectTable::Facts>> found = context.tables.projects.Find(id);
  if (!found) return found.error();
  if (!*found) return NoProject(id);
  const ProjectTable::Facts& before = **found;
  if (const Status fits = CheckRevision(before.revision, expected, "project " + std::string(id));
      !fits)
    return fits.error();
  if (const Status removed = context.tables.projects.Remove(id); !removed) return removed.error();
  if (const Status buried =
          context.tables.buried.Bury(BuriedTable::Kind::kProject, "", id, before.revision);
      !buried)
    return buried.error();
  context.garbage = true;
  if (const Status noted = NoteRecord(context, ProjectName(id), kDeleted, caller); !noted)
    return noted.error();
  return context.tables.blobs.Drop(before.body_blob);
}

}  // namespace

Status CheckRevision(std::optional<Revision> current, Revision expected, const std::string& what,
                     ErrorCode when_missing) {
  if (expected == kAnyRevision) return {};
  if (expected < 0) return InvalidArgument("expected revision " + std::to_string(expected));
  if (expected == 0) {
    if (!current) return {};
    return Error{
        ErrorCode::kCellAlreadyExists, what + " has revision " + std::to_string(*current), {}};
  }
  if (!current) return Error{when_missing, what, {}};
  if (*current == expected) return {};
  return Error{
      ErrorCode::kCellEtagMismatch,
      what + " has revision " + std::to_string(*current) + ", expected " + std::to_string(expected),
      {}};
}

Result<std::vector<MachineRecord>> SqliteStore::ListMachines() {
  return readers_->Read([](Tables& tables) { return tables.machines.List(); });
}

Result<MachineRecord> SqliteStore::GetMachine(std::string_view id) {
  return readers_->Read([&](Tables& tables) -> Result<MachineRecord> {
    Result<std::optional<MachineRecord>> machine = tables.machines.Get(id);
    if (!machine) return machine.error();
    if (!*machine) return Error{ErrorCode::kCellUnknownMachine, std::string(id), {}};
    return **std::move(machine);
  });
}

Result<MachineRecord> SqliteStore::PutMachine(const MachineRecord& machine, Revision expected,
                                              std::string_view caller) {
  if (machine.id.empty()) return InvalidArgument("a machine needs an id");
  const Result<Stamp> stamp = writer_.Do(
      [&](WriteContext& context) { return PutMachineRow(context, machine, expected, caller); });
  if (!stamp) return stamp.error();
  MachineRecord put = machine;
  SetStamp(put, *stamp);
  return put;
}

Status SqliteStore::DeleteMachine(std::string_view id, Revision expected, std::string_view caller) {
  return writer_.Do(
      [&](WriteContext& context) { return RemoveMachine(context, id, expected, caller); });
}

Result<MachineLease> SqliteStore::TakeMachine(const MachineClaim& claim) {
  return writer_.Do([&](WriteContext& context) { return sqlite::TakeMachine(context, claim); });
}

Result<MachineLease> SqliteStore::RenewMachine(const MachineLease& lease, std::string_view server) {
  return writer_.Do(
      [&](WriteContext& context) { return sqlite::RenewMachine(context, lease, server); });
}

Status SqliteStore::ReleaseMachine(const MachineLease& lease) {
  return writer_.Do([&](WriteContext& context) { return sqlite::ReleaseMachine(context, lease); });
}

Result<std::vector<MachineLease>> SqliteStore::MachineLeases() {
  return readers_->Read([](Tables& tables) { return tables.hosts.List(); });
}

Status SqliteStore::AppendMachine(const MachineLease& lease, const MachineWrite& write) {
  return writer_.Do([&](WriteContext& context) -> Status {
    if (const Status written = WriteMachine(context, lease, write); !written)
      return written.error();
    if (!write.job) return {};
    const Result<std::int64_t> told = AppendEvents(context, *write.job, write.job_events);
    return told ? Status() : Status(told.error());
  });
}

Result<std::optional<MachineMark>> SqliteStore::GetMachineMark(std::string_view machine) {
  return readers_->Read([&](Tables& tables) -> Result<std::optional<MachineMark>> {
    const auto known = tables.machines.Find(machine);
    if (!known) return known.error();
    if (!*known) return Error{ErrorCode::kCellUnknownMachine, std::string(machine), {}};
    return tables.hosts.Mark(machine);
  });
}

Result<std::int64_t> SqliteStore::AddTeachRecord(const TeachRecord& record) {
  return writer_.Do([&](WriteContext& context) -> Result<std::int64_t> {
    Tables& tables = context.tables;
    const auto known = tables.machines.Find(record.machine);
    if (!known) return known.error();
    if (!*known) return Error{ErrorCode::kCellUnknownMachine, record.machine, {}};
    const Result<std::int64_t> last = tables.taught.Last(record.machine);
    if (!last) return last.error();
    TeachRecord added = record;
    added.number = *last + 1;
    if (const Status done = tables.taught.Add(added); !done) return done.error();
    if (const Status removed =
            tables.taught.RemoveUpTo(record.machine, added.number - kTeachRecordsKept);
        !removed)
      return removed.error();
    return added.number;
  });
}

Result<std::vector<TeachRecord>> SqliteStore::ListTeachRecords(std::string_view machine,
                                                               int program, std::int64_t before,
                                                               int limit) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<TeachRecord>> {
    const auto known = tables.machines.Find(machine);
    if (!known) return known.error();
    if (!*known) return Error{ErrorCode::kCellUnknownMachine, std::string(machine), {}};
    return tables.taught.List(machine, program, before, std::max(limit, 0));
  });
}

Result<std::vector<ProjectRecord>> SqliteStore::ListProjects(std::string_view after_id, int limit) {
  return readers_->Read(
      [&](Tables& tables) { return tables.projects.List(after_id, std::max(limit, 0)); });
}

Result<ProjectRecord> SqliteStore::GetProject(std::string_view id) {
  return readers_->Read([&](Tables& tables) -> Result<ProjectRecord> {
    Result<std::optional<ProjectRecord>> project = tables.projects.Get(id);
    if (!project) return project.error();
    if (!*project) return NoProject(id);
    return **std::move(project);
  });
}

Result<ProjectRecord> SqliteStore::PutProject(const ProjectRecord& project, Revision expected,
                                              std::string_view caller) {
  if (project.id.empty()) return InvalidArgument("a project needs an id");
  const Result<StagedContent> body =
      StagedContent::Make(writer_, project.body, StagedContent::Place::kRecordWhenSmall);
  if (!body) return body.error();
  const Result<Stamp> stamp = writer_.Do([&](WriteContext& context) {
    return PutProjectRow(context, project, expected, body->content(), caller);
  });
  if (!stamp) return stamp.error();
  ProjectRecord put = project;
  SetStamp(put, *stamp);
  return put;
}

Status SqliteStore::DeleteProject(std::string_view id, Revision expected, std::string_view caller) {
  return writer_.Do(
      [&](WriteContext& context) { return RemoveProject(context, id, expected, caller); });
}

}  // namespace rmlcell::storage::sqlite
