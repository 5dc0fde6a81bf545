#pragma once

#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

// Executables are put by a user's compilation and by the end of a job.

// CellTooLarge. `bytes` must outlive the result.
Result<StagedContent> StageExecutable(Writer& writer, std::string_view bytes);

// As Store::PutExecutable; `without_room` says what becomes of one for which there is no room:
// false is returned, or the error.
enum class WithoutRoom { kDropped, kRefused };
Result<bool> PutExecutableBlob(WriteContext& context, std::string_view machine, int slot,
                               Revision object_revision, const PreparedContent& executable,
                               WithoutRoom without_room, std::string_view caller);

// How full the program memory of a machine is.
struct MemoryUse {
  std::optional<ProgramMemoryLimit> limit{};
  std::int64_t bytes = 0;  // of objects and executables; not counted where there is no limit
};
Result<MemoryUse> UseOfMemory(WriteContext& context, std::string_view machine);

}  // namespace rmlcell::storage::sqlite
