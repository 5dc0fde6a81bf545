#include "storage/sqlite/executable_life.h"

#include <algorithm>

#include "engine/core/units.h"

namespace rmlcell::storage::sqlite {
namespace {

// Of the executable that is there.
Result<std::int64_t> ExecutableBytes(WriteContext& context, std::string_view machine, int slot) {
  const auto program = context.tables.programs.Summary(machine, slot);
  if (!program) return program.error();
  return *program ? std::max<std::int64_t>((*program)->executable_bytes, 0) : 0;
}

}  // namespace

Result<StagedContent> StageExecutable(Writer& writer, std::string_view bytes) {
  if (bytes.size() > kProgramBytesMax) {
    return Error{ErrorCode::kCellTooLarge,
                 "the executable has " + std::to_string(bytes.size()) + " bytes",
                 {}};
  }
  return StagedContent::Make(writer, bytes, StagedContent::Place::kBlob);
}

Result<MemoryUse> UseOfMemory(WriteContext& context, std::string_view machine) {
  MemoryUse use;
  if (!context.program_memory) return use;
  const Result<std::optional<MachineRecord>> record = context.tables.machines.Get(machine);
  if (!record) return record.error();
  if (*record) use.limit = context.program_memory(**record);
  if (!use.limit) return use;
  const Result<std::vector<ProgramSummary>> programs =
      context.tables.programs.List(machine, 0, kSlotMax);
  if (!programs) return programs.error();
  for (const ProgramSummary& program : *programs)
    use.bytes += program.object_bytes + std::max<std::int64_t>(program.executable_bytes, 0);
  return use;
}

Result<bool> PutExecutableBlob(WriteContext& context, std::string_view machine, int slot,
                               Revision object_revision, const PreparedContent& executable,
                               WithoutRoom without_room, std::string_view caller) {
  Tables& tables = context.tables;
  const Result<std::optional<ProgramTable::Row>> found = tables.programs.Find(machine, slot);
  if (!found) return found.error();
  if (!*found || (*found)->revision != object_revision) return false;
  const Result<MemoryUse> use = UseOfMemory(context, machine);
  if (!use) return use.error();
  const Result<std::int64_t> replaced = ExecutableBytes(context, machine, slot);
  if (!replaced) return replaced.error();
  const auto added = static_cast<std::int64_t>(executable.bytes.size()) - *replaced;
  const Status room = CheckRoom(use->limit, use->bytes, use->bytes + added);
  if (!room && without_room == WithoutRoom::kDropped) return false;
  if (!room) return room.error();
  const Result<std::int64_t> blob = tables.blobs.PutBlob(executable);
  if (!blob) return blob.error();
  if (const Status put = tables.programs.PutExecutable(machine, slot, *blob); !put)
    return put.error();
  context.garbage = true;
  if (const Status dropped = tables.blobs.Drop((*found)->executable_blob); !dropped)
    return dropped.error();
  if (const Status noted = NoteRecord(context, NameOfProgram(machine, slot), kUpdated, caller);
      !noted)
    return noted.error();
  return true;
}

}  // namespace rmlcell::storage::sqlite
