#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

Status NoteRecord(WriteContext& context, std::string_view resource, std::string_view change,
                  std::string_view caller) {
  context.changed = true;
  context.counters.record_events += 1;
  return context.tables.events.AddOfRecord(++context.counters.position, context.now, resource,
                                           change, caller);
}

}  // namespace rmlcell::storage::sqlite
