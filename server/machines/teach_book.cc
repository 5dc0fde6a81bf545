#include "server/machines/teach_book.h"

#include <google/protobuf/util/time_util.h>

#include <utility>
#include <vector>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "engine/machine/handbox.h"
#include "proto/bridge/encoding.h"
#include "server/base/names.h"
#include "server/records/program_place.h"

namespace rmlcell::server {
namespace {

using google::protobuf::util::TimeUtil;

constexpr PageSizes kPages{.fallback = 100, .max = 1000};

std::string EtagOf(storage::Revision revision) {
  return revision > 0 ? std::to_string(revision) : std::string();
}

Result<v1::TeachEntry> EntryOf(const storage::TeachRecord& record) {
  v1::TeachEntry entry;
  if (!entry.ParseFromString(record.entry))
    return Error{ErrorCode::kCellStoreCorrupt, "what was taught at " + record.machine, {}};
  entry.set_number(record.number);
  return entry;
}

// `object`: of the program behind it.
machine::ProgramEdit EditOf(const v1::TeachEntry& entry, const std::string& object) {
  using Kind = machine::ProgramEdit::Kind;
  machine::ProgramEdit edit;
  edit.kind = entry.act() == v1::TeachEntry::ACT_CREATE   ? Kind::kCreate
              : entry.act() == v1::TeachEntry::ACT_DELETE ? Kind::kDelete
              : entry.act() == v1::TeachEntry::ACT_REMOVE ? Kind::kRemove
                                                          : Kind::kInsert;
  edit.program = entry.step().program();
  edit.step = entry.step().step();
  edit.place = entry.place();
  edit.text_before = entry.before();
  edit.text_after = entry.after();
  edit.object = object;
  return edit;
}

}  // namespace

Result<v1::TeachEntry> TeachBook::Add(const std::string& machine, v1::TeachEntry entry,
                                      storage::Revision before, storage::Revision after) {
  entry.set_etag_before(EtagOf(before));
  entry.set_etag_after(EtagOf(after));
  const auto number = store_.AddTeachRecord(
      {.machine = machine, .program = entry.step().program(), .entry = bridge::StableBytes(entry)});
  if (!number) return number.error();
  entry.set_number(*number);
  return entry;
}

Result<v1::ListTeachEntriesResponse> TeachBook::List(const v1::ListTeachEntriesRequest& request) {
  const Result<std::string> machine = ParseMachineName(request.machine());
  if (!machine) return machine.error();
  const Result<int> size = PageSize(request.page_size(), kPages);
  if (!size) return size.error();
  if (request.program() < 0 || request.program() > kSlotMax)
    return Error{ErrorCode::kCellInvalidArgument, "program: a slot is 1 to 99, 0 is all", {}};
  std::int64_t before = 0;
  if (!request.page_token().empty()) {
    const auto token = ParseInteger(request.page_token());
    if (!token || *token < 1)
      return Error{ErrorCode::kCellInvalidArgument, "page_token is none of an answer", {}};
    before = *token;
  }
  const auto records = store_.ListTeachRecords(*machine, request.program(), before, *size + 1);
  if (!records) return records.error();
  v1::ListTeachEntriesResponse response;
  for (const storage::TeachRecord& record : *records) {
    if (response.entries_size() == *size) {
      response.set_next_page_token(std::to_string(response.entries(*size - 1).number()));
      break;
    }
    auto entry = EntryOf(record);
    if (!entry) return entry.error();
    *response.add_entries() = *std::move(entry);
  }
  return response;
}

// Backwards, each as it was behind the next; what was taken back already is passed over.
Result<TeachBook::Undo> TeachBook::Prepare(const v1::UndoTeachEntriesRequest& request) {
  const auto name = ParseProgramName(request.program());
  if (!name) return name.error();
  const auto machine = store_.GetMachine(name->machine);
  if (!machine) return machine.error();
  const machine::MachineFamily* family = families::FindFamily(machine->family);
  if (family == nullptr) return families::UnknownFamily(machine->family);
  Undo undo{.machine = name->machine, .program = name->slot, .down_to = request.down_to()};
  const auto program = store_.GetProgram(name->machine, name->slot);
  if (!program && program.error().code != ErrorCode::kCellNotFound) return program.error();
  if (program) {
    undo.object = program->object;
    undo.expected = program->revision;
  }
  const Error none{ErrorCode::kCellNotFound,
                   "entry " + std::to_string(request.down_to()) + " of " + request.program(),
                   {}};
  std::int64_t before = 0;
  bool newest = true;
  std::string stands = EtagOf(undo.expected);  // behind the next older entry; empty: nobody knows
  for (;;) {
    const auto records = store_.ListTeachRecords(name->machine, name->slot, before, kPages.max);
    if (!records) return records.error();
    if (records->empty()) return none;
    for (const storage::TeachRecord& record : *records) {
      if (record.number < request.down_to()) return none;
      const auto entry = EntryOf(record);
      if (!entry) return entry.error();
      const bool is_undone = before != 0 && record.number >= before;
      if (!is_undone && !stands.empty() && entry->etag_after() != stands)
        return Error{ErrorCode::kCellEtagMismatch,
                     request.program() + " was changed otherwise since entry " +
                         std::to_string(record.number),
                     {}};
      if (std::exchange(newest, false)) {
        if (entry->act() == v1::TeachEntry::ACT_UNDO &&
            entry->undone_down_to() == request.down_to()) {
          undo.done = *entry;
          return undo;
        }
      }
      if (is_undone && record.number == before) stands = entry->etag_before();
      if (is_undone) continue;
      before = record.number;
      stands = entry->etag_before();
      if (entry->act() == v1::TeachEntry::ACT_UNDO) {
        if (record.number == request.down_to())
          return Error{ErrorCode::kCellInvalidArgument,
                       "down_to: what was taken back is taught again, not taken back again",
                       {}};
        before = entry->undone_down_to();
        stands.clear();
        continue;
      }
      auto object = family->UndoEdit(EditOf(*entry, undo.object), undo.object);
      if (!object) return object.error();
      undo.object = *std::move(object);
      if (record.number == request.down_to()) return undo;
    }
  }
}

Result<v1::TeachEntry> TeachBook::TakeBack(const v1::UndoTeachEntriesRequest& request,
                                           const std::string& caller) {
  const auto undo = Prepare(request);
  if (!undo) return undo.error();
  if (undo->done) return *undo->done;
  return Carry(*undo, caller);
}

Result<v1::TeachEntry> TeachBook::Carry(const Undo& undo, const std::string& caller) {
  storage::Revision after = 0;
  if (undo.object.empty() && undo.expected == 0) {
    // It was made and removed since: there is nothing to change.
  } else if (undo.object.empty()) {
    if (const Status gone = store_.DeleteProgram(undo.machine, undo.program, undo.expected, caller);
        !gone)
      return gone.error();
  } else {
    const auto put = store_.PutPrograms(
        undo.machine, {{.slot = undo.program, .object = undo.object, .expected = undo.expected}},
        {}, caller);
    if (!put) return put.error();
    after = put->front().revision;
  }
  v1::TeachEntry entry;
  *entry.mutable_time() =
      TimeUtil::MicrosecondsToTimestamp(std::chrono::duration_cast<std::chrono::microseconds>(
                                            std::chrono::system_clock::now().time_since_epoch())
                                            .count());
  entry.set_caller(caller);
  entry.mutable_step()->set_program(undo.program);
  entry.set_act(v1::TeachEntry::ACT_UNDO);
  entry.set_undone_down_to(undo.down_to);
  return Add(undo.machine, std::move(entry), undo.expected, after);
}

}  // namespace rmlcell::server
