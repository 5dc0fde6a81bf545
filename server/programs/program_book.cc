#include "server/programs/program_book.h"

#include <algorithm>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/families/families.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "proto/bridge/sha256.h"
#include "server/base/config.h"
#include "server/base/names.h"
#include "server/programs/text_tools.h"
#include "server/records/file_family.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"
#include "server/records/program_memory.h"
#include "server/records/program_place.h"

namespace rmlcell::server {
namespace {

std::string BaseName(const std::string& file_name) {
  const std::size_t slash = file_name.find_last_of("/\\");
  return slash == std::string::npos ? file_name : file_name.substr(slash + 1);
}

std::string TitleFrom(const std::string& file_name) {
  const std::string base = BaseName(file_name);
  return base.substr(0, base.find_last_of('.'));
}

// ".S" of ".S .SI .CMP .O".
std::string_view FirstExtension(const machine::FamilyInfo& info) {
  return info.extensions.substr(0, info.extensions.find(' '));
}

// The first error of a translation stands for all; its diagnostics go along.
ProgramError FirstError(const machine::Translation& translation) {
  ProgramError wrong{.error = {ErrorCode::kCellBadText, {}, {}},
                     .diagnostics = translation.diagnostics,
                     .dropped = translation.diagnostics_dropped};
  std::size_t errors = 0;
  for (const Diagnostic& diagnostic : translation.diagnostics) {
    if (!IsError(diagnostic.severity)) continue;
    if (errors++ == 0) {
      wrong.error = {diagnostic.code, diagnostic.detail, diagnostic.where};
      if (diagnostic.where.line > 0) {
        wrong.error.detail =
            "line " + std::to_string(diagnostic.where.line) + ": " + diagnostic.detail;
      }
    }
  }
  const std::uint64_t more =
      errors - std::min<std::size_t>(errors, 1) + translation.diagnostics_dropped.count();
  if (more > 0) wrong.error.detail += " (and " + std::to_string(more) + " more)";
  return wrong;
}

// With the verdict of a check, where the text tells all that a check knows: what moves is not run
// to be stored.
v1::Findings FindingsWhenStored(simulation::CheckedProgram& check) {
  if (!check.family->info().checked_by_running)
    return bridge::FindingsOf(check, simulation::JudgeCheck(check));
  const machine::Translation& translation = check.translation;
  return bridge::FindingsOf(true, translation.diagnostics, translation.diagnostics_dropped,
                            translation.figures);
}

v1::Program ProgramToBe(const std::string& name, const storage::ProgramWrite& write,
                        v1::Findings findings) {
  v1::Program program;
  program.set_name(name);
  program.set_title(write.name);
  program.set_file_name(write.source_name);
  program.set_object_bytes(static_cast<std::int64_t>(write.object.size()));
  *program.mutable_findings() = std::move(findings);
  return program;
}

machine::Translation TranslateFor(const machine::MachineFamily& family,
                                  const machine::Parameters& parameters,
                                  const v1::ProgramText& program, bool advice) {
  return simulation::TranslateProgram(family, parameters,
                                      {.file_name = program.file_name(),
                                       .bytes = machine::Bytes::Borrowed(program.content()),
                                       .is_source = program.form() != v1::PROGRAM_FORM_OBJECT},
                                      {.advice = advice});
}

// "44.S" is program 44, other names take the place of no program of the machine when there is room.
int SlotForCheck(const std::string& file_name,
                 const std::vector<simulation::MemoryProgram>& programs) {
  const auto named = ParseInteger(TitleFrom(file_name));
  if (named && *named >= kSlotMin && *named <= kSlotMax) return static_cast<int>(*named);
  for (int slot = kSlotMin; slot < kSlotMax; ++slot) {
    if (std::ranges::find(programs, slot, &simulation::MemoryProgram::slot) == programs.end())
      return slot;
  }
  return kSlotMax;
}

// A program in one of its forms, and the ending of the file that it would be.
struct FormBytes {
  std::string bytes;
  v1::ProgramForm form = v1::PROGRAM_FORM_SOURCE;
  std::string_view extension;
  bool own_text = false;  // as it was stored
};

Result<FormBytes> BytesIn(v1::ProgramForm form, storage::ProgramRecord& program,
                          const ProgramPlace& place, std::string_view name) {
  const machine::MachineFamily& family = *place.family;
  const machine::Tools* tools = family.tools();
  if (form == v1::PROGRAM_FORM_EXECUTABLE) {
    if (!program.executable || tools == nullptr)
      return EmptySlot(family, "executable of " + std::string(name));
    return FormBytes{std::move(*program.executable), form, tools->extensions().executable};
  }
  if (form == v1::PROGRAM_FORM_LISTING) {
    if (tools == nullptr) {
      return Error{ErrorCode::kCellPrecondition,
                   "a " + place.machine.family + " program has no steps to list",
                   {}};
    }
    Result<std::string> listing = tools->List(program.object);
    if (!listing) return listing.error();
    return FormBytes{*std::move(listing), form, tools->extensions().listing};
  }
  const std::string_view source_extension = FirstExtension(family.info());
  if (form != v1::PROGRAM_FORM_OBJECT && (program.source || tools == nullptr)) {
    return FormBytes{program.source ? std::move(*program.source) : std::move(program.object),
                     v1::PROGRAM_FORM_SOURCE, source_extension, true};
  }
  if (form == v1::PROGRAM_FORM_SOURCE) {
    Result<machine::RecoveredSource> source = tools->Decompile(program.object, std::nullopt);
    if (!source) return source.error();
    return FormBytes{std::move(source->text), form, source_extension};
  }
  return FormBytes{std::move(program.object), v1::PROGRAM_FORM_OBJECT,
                   tools == nullptr ? source_extension : tools->extensions().object};
}

bool CheckedByRunning(const storage::MachineRecord& machine) {
  const machine::MachineFamily* family = families::FindFamily(machine.family);
  return family != nullptr && family->info().checked_by_running;
}

// The programs of the machine, its schedules and the state in which it stands.
Status AddMemory(storage::MachineMemory memory, simulation::ProgramMemory& input) {
  Result<std::string> state = StateForRun(memory.machine.id, memory.mark);
  if (!state) return state.error();
  input.machine_state = *std::move(state);
  for (storage::ProgramRecord& program : memory.programs) {
    simulation::MemoryProgram& made = input.programs.emplace_back();
    made.slot = program.slot;
    made.name = std::move(program.name);
    made.bytes = machine::Bytes::Of(std::move(program.object));
    if (program.executable) made.executable = machine::Bytes::Of(*std::move(program.executable));
  }
  input.deleted_programs = std::move(memory.deleted);
  for (const storage::ScheduleRecord& schedule : memory.schedules) {
    input.schedules.push_back({.number = schedule.number,
                               .name = schedule.name,
                               .mode = schedule.mode,
                               .power_percent = schedule.power_percent});
  }
  return {};
}

}  // namespace

Status ProgramBook::CheckSize(std::int64_t bytes) const {
  if (bytes <= config_.limit_program_bytes) return {};
  return Error{ErrorCode::kCellTooLarge,
               "the program has " + std::to_string(bytes) +
                   " bytes; limits.program_bytes of the configuration is " +
                   std::to_string(config_.limit_program_bytes),
               {}};
}

ProgramResult<v1::Program> ProgramBook::Store(Put put) {
  const Result<ProgramPlace> place = FindProgramPlace(store_, put.name);
  if (!place) return place.error();
  const machine::MachineFamily& family = *place->family;
  const storage::MachineRecord& machine = place->machine;
  if (put.bytes.empty()) return Error{ErrorCode::kCellEmptyProgram, put.file_name, {}};
  if (const Status fits = CheckSize(static_cast<std::int64_t>(put.bytes.size())); !fits)
    return fits.error();
  if (const Status good = CheckTitle(put.title, "title"); !good) return good.error();
  if (const Status named = CheckFileName(put.file_name, "file_name"); !named) return named.error();
  if (!v1::ProgramForm_IsValid(put.form)) return InvalidArgument("form is none that there is");
  if (put.form == v1::PROGRAM_FORM_LISTING)
    return InvalidArgument("a listing is made of a program and cannot be stored");
  if (place->executable || put.form == v1::PROGRAM_FORM_EXECUTABLE)
    return StoreExecutable(put, *place);
  if (const Status fits = CheckFileFamily(BaseName(put.file_name), family); !fits)
    return fits.error();
  const Result<storage::Revision> expected = ParseEtag(put.etag);
  if (!expected) return expected.error();
  const Result<machine::Parameters> parameters =
      machine::MakeParameters(family, machine.profile, machine.parameters);
  if (!parameters) return parameters.error();

  const bool is_object =
      put.form == v1::PROGRAM_FORM_OBJECT || families::IsObjectFileName(put.file_name);
  // Not as a rehearsal does: what is said here, of objects, too, is said when they are stored
  // alone.
  machine::Translation translation = family.Translate(
      {.name = BaseName(put.file_name), .bytes = put.bytes, .is_object = is_object}, *parameters,
      {.forced = put.force});
  if (!translation.ok) return FirstError(translation);
  for (Diagnostic& found : family.CheckSlot(place->slot, put.bytes)) {
    found.file = BaseName(put.file_name);
    translation.diagnostics.push_back(std::move(found));
  }
  simulation::CheckedProgram check{.family = &family,
                                   .machine = parameters->Used(),
                                   .slot = place->slot,
                                   .translation = std::move(translation)};
  v1::Findings findings = FindingsWhenStored(check);
  storage::ProgramWrite write{.slot = place->slot,
                              .name = put.title.empty() ? TitleFrom(put.file_name) : put.title,
                              .object = std::move(check.translation.object),
                              .source = {},
                              .source_name = is_object ? std::string() : BaseName(put.file_name),
                              .expected = *expected};
  // A stream is its own object: kept once.
  if (check.translation.as_it_came) {
    write.object = std::move(put.bytes);
  } else if (!is_object && write.object != put.bytes) {
    write.source = std::move(put.bytes);
  }
  if (put.validate_only) {
    if (const auto fits = FindExpected(machine.id, place->slot, *expected); !fits)
      return fits.error();
    if (const Status room = CheckRoomFor(store_, machine, {&write, 1}); !room) return room.error();
    return ProgramToBe(put.name, write, std::move(findings));
  }
  const auto stored = store_.PutPrograms(machine.id, {std::move(write)}, {}, put.caller);
  if (!stored) return stored.error();
  TellStored();
  v1::Program program = ToProto(machine.id, stored->front());
  *program.mutable_findings() = std::move(findings);
  return program;
}

// What the store would say to a change of this slot, before it is made: nothing when the slot is
// empty.
Result<std::optional<storage::ProgramSummary>> ProgramBook::FindExpected(
    const std::string& machine, int slot, storage::Revision expected) {
  auto found = store_.GetProgramSummary(machine, slot);
  const bool there = static_cast<bool>(found);
  if (!there && found.error().code != ErrorCode::kCellNotFound) return found.error();
  if (expected == 0 && there)
    return Error{ErrorCode::kCellAlreadyExists, NameOfProgram(machine, slot), {}};
  if (expected > 0 && !there)
    return Error{ErrorCode::kCellNotFound, NameOfProgram(machine, slot), {}};
  if (expected > 0 && found->revision != expected) {
    return Error{ErrorCode::kCellEtagMismatch, NameOfProgram(machine, slot), {}};
  }
  if (!there) return std::optional<storage::ProgramSummary>();
  return std::optional(*std::move(found));
}

ProgramResult<v1::Program> ProgramBook::StoreExecutable(const Put& put, const ProgramPlace& place) {
  const std::string& machine_id = place.machine.id;
  const int slot = place.slot;
  if (!place.family->info().has_executables)
    return InvalidArgument("this machine has no executables");
  const Result<storage::Revision> expected = ParseEtag(put.etag);
  if (!expected) return expected.error();
  // An etag is that of the object: an executable has none of its own.
  const auto found =
      FindExpected(machine_id, slot, *expected == 0 ? storage::kAnyRevision : *expected);
  if (!found) return found.error();
  if (!*found) {
    return EmptySlot(*place.family,
                     NameOfProgram(machine_id, slot) + ", and an executable needs its object");
  }
  if (*expected == 0 && (*found)->executable_bytes >= 0) {
    return Error{
        ErrorCode::kCellAlreadyExists, "an executable of " + NameOfProgram(machine_id, slot), {}};
  }
  if (const Status good = place.family->CheckExecutable(put.bytes, slot); !good)
    return good.error();
  if (put.validate_only) {
    const auto bytes = static_cast<std::int64_t>(put.bytes.size());
    if (const Status room = CheckRoomForExecutable(store_, place.machine, slot, bytes); !room)
      return room.error();
  } else {
    const auto kept =
        store_.PutExecutable(machine_id, slot, (*found)->revision, put.bytes, put.caller);
    if (!kept) return kept.error();
    if (!*kept)
      return Error{ErrorCode::kCellEtagMismatch, "the object was stored again meanwhile", {}};
    TellStored();
  }
  v1::Program program = ToProto(machine_id, **found);
  program.set_name(NameOfProgram(machine_id, slot + kExecutableOffset));
  program.set_executable_bytes(static_cast<std::int64_t>(put.bytes.size()));
  return program;
}

Result<v1::Program> ProgramBook::Get(std::string_view name) {
  const Result<ProgramPlace> place = FindProgramPlace(store_, name);
  if (!place) return place.error();
  const auto found = store_.GetProgramSummary(place->machine.id, place->slot);
  if (!found && found.error().code != ErrorCode::kCellNotFound) return found.error();
  const bool there = found && (!place->executable || found->executable_bytes >= 0);
  if (!there) return EmptySlot(*place->family, name);
  v1::Program program = ToProto(place->machine.id, *found);
  program.set_name(std::string(name));  // an executable is asked for by its own number
  return program;
}

Result<ProgramBook::Content> ProgramBook::Read(std::string_view name, v1::ProgramForm form) {
  if (!v1::ProgramForm_IsValid(form)) return InvalidArgument("form is none that there is");
  const Result<ProgramPlace> place = FindProgramPlace(store_, name);
  if (!place) return place.error();
  Result<storage::ProgramRecord> program = store_.GetProgram(place->machine.id, place->slot);
  if (!program) {
    if (program.error().code != ErrorCode::kCellNotFound) return program.error();
    return EmptySlot(*place->family, name);
  }
  if (place->executable) form = v1::PROGRAM_FORM_EXECUTABLE;
  const std::string object_sha256 = bridge::Sha256Hex(program->object);
  Result<FormBytes> made = BytesIn(form, *program, *place, name);
  if (!made) return made.error();
  Content content{.bytes = std::move(made->bytes),
                  .form = made->form,
                  .file_name = program->source_name,
                  .sha256 = {},
                  .own_text = made->own_text};
  if (!made->own_text || content.file_name.empty()) {
    const std::string base = program->source_name.empty() ? std::to_string(place->slot)
                                                          : TitleFrom(program->source_name);
    content.file_name = base + std::string(made->extension);
  }
  content.sha256 = bridge::Sha256Hex(content.bytes);
  content.object_sha256 = object_sha256;
  return content;
}

Result<v1::ListProgramsResponse> ProgramBook::List(const v1::ListProgramsRequest& request) {
  const Result<std::string> machine = ParseMachineName(request.parent());
  if (!machine) return machine.error();
  if (const auto known = store_.GetMachine(*machine); !known) return known.error();
  const Result<int> size = PageSize(request.page_size(), {.fallback = kSlotMax, .max = kSlotMax});
  if (!size) return size.error();
  int after = 0;
  if (!request.page_token().empty()) {
    const auto token = ParseInteger(request.page_token());
    if (!token || *token < kSlotMin || *token > kSlotMax)
      return Error{ErrorCode::kCellBadPageToken, {}, {}};
    after = static_cast<int>(*token);
  }
  const auto programs = store_.ListPrograms(*machine, after, *size + 1);
  if (!programs) return programs.error();
  v1::ListProgramsResponse response;
  for (const storage::ProgramSummary& program : *programs) {
    if (response.programs_size() == *size) {
      response.set_next_page_token(
          std::to_string((*programs)[static_cast<std::size_t>(*size) - 1].slot));
      break;
    }
    *response.add_programs() = ToProto(*machine, program);
  }
  return response;
}

Status ProgramBook::Delete(const v1::DeleteProgramRequest& request, std::string_view caller) {
  const Result<ProgramPlace> place = FindProgramPlace(store_, request.name());
  if (!place) return place.error();
  const std::string& machine = place->machine.id;
  const Result<storage::Revision> expected = ParseEtag(request.etag());
  if (!expected) return expected.error();
  if (place->executable) {
    if (const auto fits = FindExpected(machine, place->slot, *expected); !fits) {
      if (fits.error().code != ErrorCode::kCellNotFound) return fits.error();
    }
  }
  if (!place->executable && is_in_use_ && is_in_use_(machine, place->slot))
    return Error{
        place->family->info().in_use, "a run of " + MachineName(machine) + " is in it", {}};
  const Status deleted = place->executable
                             ? store_.DeleteExecutable(machine, place->slot, caller)
                             : store_.DeleteProgram(machine, place->slot, *expected, caller);
  if (!deleted && deleted.error().code == ErrorCode::kCellNotFound)
    return EmptySlot(*place->family, request.name());
  if (deleted) TellStored();
  return deleted;
}

Result<ProgramBook::Subject> ProgramBook::FindSubject(
    const std::string& family_id, const std::string& machine_name, const v1::ProgramText& program,
    const storage::Store::WantsPrograms& wants_programs) {
  Subject subject;
  if (!machine_name.empty()) {
    const Result<std::string> id = ParseMachineName(machine_name);
    if (!id) return id.error();
    auto memory = store_.GetMachineMemory(*id, wants_programs);
    if (!memory) return memory.error();
    subject.family = families::FindFamily(memory->machine.family);
    if (subject.family == nullptr) return families::UnknownFamily(memory->machine.family);
    subject.memory = *std::move(memory);
  } else if (!family_id.empty()) {
    subject.family = families::FindFamily(family_id);
    if (subject.family == nullptr) return families::UnknownFamily(family_id);
  } else {
    subject.family = families::FamilyOfFileName(program.file_name());
  }
  if (subject.family == nullptr)
    return Error{ErrorCode::kCellFamilyUnknownFromName, program.file_name(), {}};
  if (program.content().empty())
    return Error{ErrorCode::kCellEmptyProgram, program.file_name(), {}};
  Result<machine::Parameters> parameters =
      subject.memory ? machine::MakeParameters(*subject.family, subject.memory->machine.profile,
                                               subject.memory->machine.parameters)
                     : machine::MakeParameters(*subject.family, {}, {});
  if (!parameters) return parameters.error();
  subject.parameters = *std::move(parameters);
  return subject;
}

Result<machine::Translation> ProgramBook::Translate(const std::string& family_id,
                                                    const std::string& machine_name,
                                                    const v1::ProgramText& program, bool advice) {
  const Result<Subject> subject = FindSubject(family_id, machine_name, program, {});
  if (!subject) return subject.error();
  return TranslateFor(*subject->family, *subject->parameters, program, advice);
}

Result<ProgramBook::Opened> ProgramBook::Open(std::string_view name) {
  const Result<ProgramPlace> place = FindProgramPlace(store_, name);
  if (!place) return place.error();
  const machine::MachineFamily& family = *place->family;
  if (place->executable)
    return Error{family.info().no_slot, "an executable is looked at by its object", {}};
  Result<storage::MachineMemory> stored =
      store_.GetMachineMemory(place->machine.id, CheckedByRunning);
  if (!stored) return stored.error();
  auto program = std::ranges::find(stored->programs, place->slot, &storage::ProgramRecord::slot);
  if (program == stored->programs.end()) {
    Result<storage::ProgramRecord> alone = store_.GetProgram(place->machine.id, place->slot);
    if (!alone && alone.error().code != ErrorCode::kCellNotFound) return alone.error();
    if (!alone) return EmptySlot(family, name);
    program = stored->programs.insert(program, *std::move(alone));
  }
  Opened opened{.memory = {.family = &family,
                           .profile = stored->machine.profile,
                           .parameters = stored->machine.parameters},
                .slot = place->slot,
                .etag = std::to_string(program->revision)};
  if (const Status added = AddMemory(*std::move(stored), opened.memory); !added)
    return added.error();
  return opened;
}

Result<simulation::CheckedProgram> ProgramBook::Check(const std::string& family_id,
                                                      const std::string& machine_name,
                                                      const v1::ProgramText& program, bool advice) {
  Result<Subject> subject = FindSubject(family_id, machine_name, program, CheckedByRunning);
  if (!subject) return subject.error();
  const machine::MachineFamily& family = *subject->family;
  simulation::ProgramMemory memory{.family = &family};
  if (subject->memory && family.info().checked_by_running) {
    if (const Status added = AddMemory(*std::move(subject->memory), memory); !added)
      return added.error();
    memory.given = simulation::MemoryGiven::kWhole;
  }
  const int slot = SlotForCheck(program.file_name(), memory.programs);
  memory.programs.push_back({.slot = slot,
                             .file_name = program.file_name(),
                             .bytes = machine::Bytes::Borrowed(program.content()),
                             .is_source = program.form() != v1::PROGRAM_FORM_OBJECT});
  Result<simulation::CheckedProgram> check =
      simulation::CheckProgram(memory, *subject->parameters, slot, advice, {});
  if (!check) return check;
  for (Diagnostic& finding : check->motion.findings) {
    if (finding.program == slot) finding.file = program.file_name();
  }
  if (!advice) {
    std::erase_if(check->motion.findings,
                  [](const Diagnostic& finding) { return !IsError(finding.severity); });
  }
  return check;
}

}  // namespace rmlcell::server
