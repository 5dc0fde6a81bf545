#pragma once

#include "storage/sqlite/content_staging.h"
#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

// Executables are put by a user's compilation and by the end of a job.

// CellTooLarge. `bytes` must outlive the result.
Result<StagedContent> StageExecutable(Writer& writer, std::string_view bytes);

// As Store::PutExecutable.
Result<bool> PutExecutableBlob(WriteContext& context, std::string_view machine, int slot,
                               Revision object_revision, const PreparedContent& executable,
                               std::string_view caller);

}  // namespace rmlcell::storage::sqlite
