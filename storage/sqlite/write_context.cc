#include "storage/sqlite/write_context.h"

namespace rmlcell::storage::sqlite {

std::int64_t UnfinishedOf(const WriteContext& context, const std::string& machine) {
  const auto growth = GrowthOf(context.moves);
  const auto found = growth.find(machine);
  return context.machines.Unfinished(machine) + (found == growth.end() ? 0 : found->second);
}

Status NoteRecord(WriteContext& context, std::string_view resource, std::string_view change,
                  std::string_view caller) {
  return NoteEvent(context, resource,
                   {.kind = std::string(change), .payload = {}, .caller = std::string(caller)});
}

Status NoteEvent(WriteContext& context, std::string_view resource, const NewEvent& event) {
  context.changed = true;
  context.counters.record_events += 1;
  return context.tables.events.AddOfRecord(++context.counters.position, context.now, resource,
                                           event);
}

}  // namespace rmlcell::storage::sqlite
