#pragma once

#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

// All programs and schedules of a machine that goes.
Status RemoveMemory(WriteContext& context, std::string_view machine);

}  // namespace rmlcell::storage::sqlite
