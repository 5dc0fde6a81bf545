#include "storage/sqlite/executable_life.h"

namespace rmlcell::storage::sqlite {

Result<StagedContent> StageExecutable(Writer& writer, std::string_view bytes) {
  if (bytes.size() > kProgramBytesMax) {
    return Error{ErrorCode::kCellTooLarge,
                 "the executable has " + std::to_string(bytes.size()) + " bytes",
                 {}};
  }
  return StagedContent::Make(writer, bytes, StagedContent::Place::kBlob);
}

Result<bool> PutExecutableBlob(WriteContext& context, std::string_view machine, int slot,
                               Revision object_revision, const PreparedContent& executable,
                               std::string_view caller) {
  Tables& tables = context.tables;
  const Result<std::optional<ProgramTable::Row>> found = tables.programs.Find(machine, slot);
  if (!found) return found.error();
  if (!*found || (*found)->revision != object_revision) return false;
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
