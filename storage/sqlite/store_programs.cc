// Programs and laser schedules: the program memory of machines.
#include <algorithm>
#include <cmath>
#include <set>

#include "engine/core/units.h"
#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/executable_life.h"
#include "storage/sqlite/sqlite_store_impl.h"

namespace rmlcell::storage::sqlite {
namespace {

std::string SlotText(std::string_view machine, int slot) {
  return "slot " + std::to_string(slot) + " of " + std::string(machine);
}

Error NoProgram(std::string_view machine, int slot) {
  return Error{ErrorCode::kCellNotFound, SlotText(machine, slot) + " is empty", {}};
}

Status CheckMachine(Tables& tables, std::string_view machine) {
  const Result<std::optional<MachineTable::Facts>> found = tables.machines.Find(machine);
  if (!found) return found.error();
  if (!*found) return Error{ErrorCode::kCellUnknownMachine, std::string(machine), {}};
  return {};
}

Status CheckSize(std::size_t bytes, const std::string& what) {
  if (bytes <= kProgramBytesMax) return {};
  return Error{ErrorCode::kCellTooLarge, what + " has " + std::to_string(bytes) + " bytes", {}};
}

Status CheckSchedule(const ScheduleRecord& schedule) {
  if (schedule.number < kScheduleMin || schedule.number > kScheduleMax) {
    return InvalidArgument("laser schedule " + std::to_string(schedule.number));
  }
  // The database would make NULL of a NaN.
  if (!std::isfinite(schedule.power_percent))
    return InvalidArgument("power_percent is not a number");
  return {};
}

Status CheckWrites(const std::vector<ProgramWrite>& programs,
                   const std::vector<ScheduleRecord>& schedules) {
  std::set<int> slots;
  for (const ProgramWrite& program : programs) {
    const std::string slot = "slot " + std::to_string(program.slot);
    if (!IsSlot(program.slot)) return InvalidArgument(slot);
    if (!slots.insert(program.slot).second) return InvalidArgument(slot + " is written twice");
    if (const Status object = CheckSize(program.object.size(), "the object for " + slot); !object)
      return object.error();
    if (const Status source =
            CheckSize(program.source ? program.source->size() : 0, "the source for " + slot);
        !source)
      return source.error();
  }
  std::set<int> numbers;
  for (const ScheduleRecord& schedule : schedules) {
    if (const Status good = CheckSchedule(schedule); !good) return good.error();
    if (!numbers.insert(schedule.number).second) {
      return InvalidArgument("laser schedule " + std::to_string(schedule.number) +
                             " is written twice");
    }
  }
  return {};
}

struct StagedProgram {
  StagedContent object;
  std::optional<StagedContent> source;
};

Result<std::vector<StagedProgram>> StageAll(Writer& writer,
                                            const std::vector<ProgramWrite>& programs) {
  constexpr auto kPlace = StagedContent::Place::kBlob;
  std::vector<StagedProgram> staged;
  for (const ProgramWrite& program : programs) {
    Result<StagedContent> object = StagedContent::Make(writer, program.object, kPlace);
    if (!object) return object.error();
    staged.push_back({.object = *std::move(object), .source = {}});
    if (!program.source) continue;
    Result<StagedContent> source = StagedContent::Make(writer, *program.source, kPlace);
    if (!source) return source.error();
    staged.back().source.emplace(*std::move(source));
  }
  return staged;
}

// One reference less for each blob of a program.
Status DropBlobs(WriteContext& context, const ProgramTable::Row& row) {
  context.garbage = true;
  for (const std::optional<std::int64_t>& blob :
       {std::optional(row.object_blob), row.source_blob, row.executable_blob}) {
    if (const Status dropped = context.tables.blobs.Drop(blob); !dropped) return dropped.error();
  }
  return {};
}

Result<ProgramSummary> PutProgramRow(WriteContext& context, std::string_view machine,
                                     const ProgramWrite& program, const StagedProgram& staged,
                                     std::string_view caller) {
  Tables& tables = context.tables;
  const Result<std::optional<ProgramTable::Row>> found =
      tables.programs.Find(machine, program.slot);
  if (!found) return found.error();
  const std::optional<ProgramTable::Row>& before = *found;
  if (const Status fits = CheckRevision(before ? std::optional(before->revision) : std::nullopt,
                                        program.expected, SlotText(machine, program.slot));
      !fits)
    return fits.error();
  Revision last = before ? before->revision : 0;
  if (!before) {
    const Result<Revision> buried =
        tables.buried.DigUp(BuriedTable::Kind::kProgram, machine, std::to_string(program.slot));
    if (!buried) return buried.error();
    last = *buried;
  }
  // Without executable: altering an object deletes it, OPT-1.12.
  ProgramTable::Row row{.revision = last + 1,
                        .created_at = before ? before->created_at : context.now,
                        .updated_at = context.now,
                        .object_blob = 0,
                        .source_blob = {},
                        .executable_blob = {}};
  const Result<std::int64_t> object = tables.blobs.PutBlob(staged.object.content());
  if (!object) return object.error();
  row.object_blob = *object;
  if (staged.source) {
    const Result<std::int64_t> source = tables.blobs.PutBlob(staged.source->content());
    if (!source) return source.error();
    row.source_blob = *source;
  }
  if (const Status put =
          tables.programs.Put(machine, program.slot, program.name, program.source_name, row);
      !put)
    return put.error();
  if (before) {
    if (const Status dropped = DropBlobs(context, *before); !dropped) return dropped.error();
  }
  if (const Status noted = NoteRecord(context, NameOfProgram(machine, program.slot),
                                      before ? kUpdated : kCreated, caller);
      !noted)
    return noted.error();
  const Result<std::optional<ProgramSummary>> summary =
      tables.programs.Summary(machine, program.slot);
  if (!summary) return summary.error();
  if (!*summary) return NoProgram(machine, program.slot);
  return **summary;
}

Result<ScheduleRecord> PutScheduleRow(WriteContext& context, ScheduleRecord schedule,
                                      Revision expected, std::string_view caller) {
  Tables& tables = context.tables;
  const Result<std::optional<ScheduleRecord>> before =
      tables.schedules.Get(schedule.machine, schedule.number);
  if (!before) return before.error();
  const std::string what =
      "laser schedule " + std::to_string(schedule.number) + " of " + schedule.machine;
  if (const Status fits = CheckRevision(*before ? std::optional((*before)->revision) : std::nullopt,
                                        expected, what);
      !fits)
    return fits.error();
  if (*before) {
    schedule.revision = (*before)->revision + 1;
  } else {
    const Result<Revision> buried = tables.buried.DigUp(
        BuriedTable::Kind::kSchedule, schedule.machine, std::to_string(schedule.number));
    if (!buried) return buried.error();
    schedule.revision = *buried + 1;
  }
  schedule.updated_at = context.now;
  if (const Status put = tables.schedules.Put(schedule); !put) return put.error();
  if (const Status noted = NoteRecord(context, NameOfSchedule(schedule.machine, schedule.number),
                                      *before ? kUpdated : kCreated, caller);
      !noted)
    return noted.error();
  return schedule;
}

Status RemoveProgram(WriteContext& context, std::string_view machine, int slot, Revision expected,
                     std::string_view caller) {
  Tables& tables = context.tables;
  if (const Status known = CheckMachine(tables, machine); !known) return known.error();
  const Result<std::optional<ProgramTable::Row>> found = tables.programs.Find(machine, slot);
  if (!found) return found.error();
  if (!*found) return NoProgram(machine, slot);
  const ProgramTable::Row& row = **found;
  if (const Status fits = CheckRevision(row.revision, expected, SlotText(machine, slot)); !fits)
    return fits.error();
  if (const Status removed = tables.programs.Remove(machine, slot); !removed)
    return removed.error();
  if (const Status buried = tables.buried.Bury(BuriedTable::Kind::kProgram, machine,
                                               std::to_string(slot), row.revision);
      !buried)
    return buried.error();
  if (const Status noted = NoteRecord(context, NameOfProgram(machine, slot), kDeleted, caller);
      !noted)
    return noted.error();
  return DropBlobs(context, row);
}

Status RemoveExecutable(WriteContext& context, std::string_view machine, int slot,
                        std::string_view caller) {
  Tables& tables = context.tables;
  if (const Status known = CheckMachine(tables, machine); !known) return known.error();
  const Result<std::optional<ProgramTable::Row>> found = tables.programs.Find(machine, slot);
  if (!found) return found.error();
  if (!*found) return NoProgram(machine, slot);
  if (!(*found)->executable_blob) {
    return Error{ErrorCode::kCellNotFound, SlotText(machine, slot) + " has no executable", {}};
  }
  if (const Status removed = tables.programs.PutExecutable(machine, slot, {}); !removed)
    return removed.error();
  context.garbage = true;
  if (const Status noted = NoteRecord(context, NameOfProgram(machine, slot), kUpdated, caller);
      !noted)
    return noted.error();
  return tables.blobs.Drop((*found)->executable_blob);
}

Status RemoveSchedule(WriteContext& context, std::string_view machine, int number,
                      std::string_view caller) {
  Tables& tables = context.tables;
  if (const Status known = CheckMachine(tables, machine); !known) return known.error();
  const Result<std::optional<ScheduleRecord>> found = tables.schedules.Get(machine, number);
  if (!found) return found.error();
  if (!*found) {
    return Error{ErrorCode::kCellNotFound,
                 "laser schedule " + std::to_string(number) + " of " + std::string(machine),
                 {}};
  }
  if (const Status removed = tables.schedules.Remove(machine, number); !removed)
    return removed.error();
  if (const Status noted = NoteRecord(context, NameOfSchedule(machine, number), kDeleted, caller);
      !noted)
    return noted.error();
  return tables.buried.Bury(BuriedTable::Kind::kSchedule, machine, std::to_string(number),
                            (*found)->revision);
}

}  // namespace

Status RemoveMemory(WriteContext& context, std::string_view machine, std::string_view caller) {
  const Result<std::vector<ProgramSummary>> programs =
      context.tables.programs.List(machine, 0, kSlotMax);
  if (!programs) return programs.error();
  for (const ProgramSummary& program : *programs) {
    if (const Status gone = RemoveProgram(context, machine, program.slot, kAnyRevision, caller);
        !gone)
      return gone.error();
  }
  const Result<std::vector<ScheduleRecord>> schedules = context.tables.schedules.List(machine);
  if (!schedules) return schedules.error();
  for (const ScheduleRecord& schedule : *schedules) {
    if (const Status gone = RemoveSchedule(context, machine, schedule.number, caller); !gone)
      return gone.error();
  }
  return {};
}

Result<std::vector<ProgramSummary>> SqliteStore::ListPrograms(std::string_view machine,
                                                              int after_slot, int limit) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<ProgramSummary>> {
    if (const Status known = CheckMachine(tables, machine); !known) return known.error();
    return tables.programs.List(machine, after_slot, std::max(limit, 0));
  });
}

Result<ProgramRecord> SqliteStore::GetProgram(std::string_view machine, int slot) {
  return readers_->Read([&](Tables& tables) -> Result<ProgramRecord> {
    if (const Status known = CheckMachine(tables, machine); !known) return known.error();
    Result<std::optional<ProgramRecord>> program = tables.programs.Get(machine, slot);
    if (!program) return program.error();
    if (!*program) return NoProgram(machine, slot);
    return **std::move(program);
  });
}

Result<ProgramSummary> SqliteStore::GetProgramSummary(std::string_view machine, int slot) {
  return readers_->Read([&](Tables& tables) -> Result<ProgramSummary> {
    if (const Status known = CheckMachine(tables, machine); !known) return known.error();
    Result<std::optional<ProgramSummary>> summary = tables.programs.Summary(machine, slot);
    if (!summary) return summary.error();
    if (!*summary) return NoProgram(machine, slot);
    return **std::move(summary);
  });
}

Result<MachineMemory> SqliteStore::GetMachineMemory(std::string_view machine,
                                                    const WantsPrograms& wants_programs) {
  return readers_->Read([&](Tables& tables) -> Result<MachineMemory> {
    Result<std::optional<MachineRecord>> record = tables.machines.Get(machine);
    if (!record) return record.error();
    if (!*record) return Error{ErrorCode::kCellUnknownMachine, std::string(machine), {}};
    MachineMemory memory{.machine = **std::move(record)};
    Result<std::optional<MachineMark>> mark = tables.hosts.Mark(machine);
    if (!mark) return mark.error();
    memory.mark = *std::move(mark);
    auto schedules = tables.schedules.List(machine);
    if (!schedules) return schedules.error();
    memory.schedules = *std::move(schedules);
    if (!wants_programs || !wants_programs(memory.machine)) return memory;
    auto programs = tables.programs.Memory(machine, ProgramTable::Parts::kWithoutSource);
    if (!programs) return programs.error();
    memory.programs = *std::move(programs);
    auto deleted = tables.buried.Numbers(BuriedTable::Kind::kProgram, machine);
    if (!deleted) return deleted.error();
    memory.deleted = *std::move(deleted);
    return memory;
  });
}

Result<std::vector<ProgramSummary>> SqliteStore::PutPrograms(
    std::string_view machine, const std::vector<ProgramWrite>& programs,
    const std::vector<ScheduleRecord>& schedules, std::string_view caller) {
  if (const Status good = CheckWrites(programs, schedules); !good) return good.error();
  const Result<std::vector<StagedProgram>> staged = StageAll(writer_, programs);
  if (!staged) return staged.error();
  return writer_.Do([&](WriteContext& context) -> Result<std::vector<ProgramSummary>> {
    if (const Status known = CheckMachine(context.tables, machine); !known) return known.error();
    const Result<MemoryUse> before = UseOfMemory(context, machine);
    if (!before) return before.error();
    std::vector<ProgramSummary> summaries;
    for (std::size_t i = 0; i < programs.size(); ++i) {
      Result<ProgramSummary> put =
          PutProgramRow(context, machine, programs[i], (*staged)[i], caller);
      if (!put) return put.error();
      summaries.push_back(*std::move(put));
    }
    const Result<MemoryUse> after = UseOfMemory(context, machine);
    if (!after) return after.error();
    if (const Status room = CheckRoom(before->limit, before->bytes, after->bytes); !room)
      return room.error();
    for (ScheduleRecord schedule : schedules) {
      schedule.machine = machine;
      const Result<ScheduleRecord> put =
          PutScheduleRow(context, std::move(schedule), kAnyRevision, caller);
      if (!put) return put.error();
    }
    return summaries;
  });
}

Status SqliteStore::DeleteProgram(std::string_view machine, int slot, Revision expected,
                                  std::string_view caller) {
  return writer_.Do([&](WriteContext& context) {
    return RemoveProgram(context, machine, slot, expected, caller);
  });
}

Result<bool> SqliteStore::PutExecutable(std::string_view machine, int slot,
                                        Revision object_revision, std::string_view executable,
                                        std::string_view caller) {
  const Result<StagedContent> staged = StageExecutable(writer_, executable);
  if (!staged) return staged.error();
  return writer_.Do([&](WriteContext& context) {
    return PutExecutableBlob(context, machine, slot, object_revision, staged->content(),
                             WithoutRoom::kRefused, caller);
  });
}

Status SqliteStore::DeleteExecutable(std::string_view machine, int slot, std::string_view caller) {
  return writer_.Do(
      [&](WriteContext& context) { return RemoveExecutable(context, machine, slot, caller); });
}

Result<std::vector<ScheduleRecord>> SqliteStore::ListSchedules(std::string_view machine) {
  return readers_->Read([&](Tables& tables) -> Result<std::vector<ScheduleRecord>> {
    if (const Status known = CheckMachine(tables, machine); !known) return known.error();
    return tables.schedules.List(machine);
  });
}

Result<ScheduleRecord> SqliteStore::PutSchedule(const ScheduleRecord& schedule, Revision expected,
                                                std::string_view caller) {
  if (const Status good = CheckSchedule(schedule); !good) return good.error();
  return writer_.Do([&](WriteContext& context) -> Result<ScheduleRecord> {
    if (const Status known = CheckMachine(context.tables, schedule.machine); !known)
      return known.error();
    return PutScheduleRow(context, schedule, expected, caller);
  });
}

Status SqliteStore::DeleteSchedule(std::string_view machine, int number, std::string_view caller) {
  return writer_.Do(
      [&](WriteContext& context) { return RemoveSchedule(context, machine, number, caller); });
}

}  // namespace rmlcell::storage::sqlite
