#include "server/programs/language_tools.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "engine/core/number_text.h"
#include "engine/families/families.h"
#include "engine/machine/family.h"
#include "server/base/names.h"
#include "server/programs/edited_text.h"

namespace rmlcell::server {
namespace {

// The programs and schedules of a machine around a text.
class MachineSurroundings final : public machine::Surroundings {
 public:
  // `machine` is empty: nothing lies around.
  MachineSurroundings(storage::Store& store, ProgramBook& programs, std::string machine)
      : store_(store), programs_(programs), machine_(std::move(machine)) {}

  const std::string& uri() const override { return uri_; }

  std::vector<machine::NumberedFile> Programs() const override {
    std::vector<machine::NumberedFile> files;
    if (machine_.empty()) return files;
    const auto programs = store_.ListPrograms(machine_, 0, kSlotMax);
    if (!programs) return files;
    for (const storage::ProgramSummary& program : *programs) {
      files.push_back({.number = program.slot,
                       .uri = NameOfProgram(machine_, program.slot),
                       .name = std::to_string(program.slot)});
    }
    return files;
  }

  std::optional<machine::NumberedSource> Read(const machine::NumberedFile& file) const override {
    auto content = programs_.Read(file.uri, v1::PROGRAM_FORM_SOURCE);
    if (!content) return std::nullopt;
    return machine::NumberedSource{file.uri, file.name, std::move(content->bytes)};
  }

  std::string ScheduleNote(int number) const override {
    if (machine_.empty()) return {};
    const auto schedules = store_.ListSchedules(machine_);
    if (!schedules) return {};
    const auto found = std::ranges::find(*schedules, number, &storage::ScheduleRecord::number);
    if (found == schedules->end()) return {};
    std::string note = found->mode + ", " + ShortestText(found->power_percent) + " %";
    if (!found->name.empty()) note += ", " + found->name;
    return note;
  }

  // Process definitions belong to projects.
  std::string ProcessNote(int, int) const override { return {}; }

 private:
  storage::Store& store_;
  ProgramBook& programs_;
  std::string machine_;
  std::string uri_;  // of the text itself, which has none
};

// A text that was looked through, and what lies around it.
struct Look {
  std::unique_ptr<machine::EditedProgram> program;
  TextPlaces places;
  MachineSurroundings around;
};

Result<const machine::MachineFamily*> FamilyOf(storage::Store& store, const v1::EditedText& text,
                                               const std::string& machine) {
  const machine::MachineFamily* family = nullptr;
  if (!text.family().empty()) {
    family = families::FindFamily(text.family());
    if (family == nullptr) return families::UnknownFamily(text.family());
  } else if (!machine.empty()) {
    const auto record = store.GetMachine(machine);
    if (!record) return record.error();
    family = families::FindFamily(record->family);
    if (family == nullptr) return families::UnknownFamily(record->family);
  } else {
    family = families::FamilyOfFileName(text.program().file_name());
  }
  if (family == nullptr)
    return Error{ErrorCode::kCellFamilyUnknownFromName, text.program().file_name(), {}};
  return family;
}

Result<Look> LookAt(storage::Store& store, ProgramBook& programs, const v1::EditedText& text) {
  std::string machine;
  if (!text.machine().empty()) {
    const Result<std::string> id = ParseMachineName(text.machine());
    if (!id) return id.error();
    if (const auto known = store.GetMachine(*id); !known) return known.error();
    machine = *id;
  }
  const auto family = FamilyOf(store, text, machine);
  if (!family) return family.error();
  if (text.program().content().empty())
    return Error{ErrorCode::kCellEmptyProgram, text.program().file_name(), {}};
  const machine::Editing* editing = (*family)->editing();
  if (editing == nullptr) {
    return Error{ErrorCode::kCellPrecondition,
                 "programs of " + std::string((*family)->info().id) +
                     " are streams; GetLanguage has their commands",
                 {}};
  }
  return Look{.program = editing->Look(text.program().content()),
              .places = TextPlaces(text.program().content()),
              .around = MachineSurroundings(store, programs, std::move(machine))};
}

v1::Completion::Kind KindOf(machine::Suggestion::Kind kind) {
  switch (kind) {
    case machine::Suggestion::Kind::kWord:
      return v1::Completion::KIND_WORD;
    case machine::Suggestion::Kind::kFunction:
      return v1::Completion::KIND_FUNCTION;
    case machine::Suggestion::Kind::kVariable:
      return v1::Completion::KIND_VARIABLE;
    case machine::Suggestion::Kind::kConstant:
      return v1::Completion::KIND_CONSTANT;
    case machine::Suggestion::Kind::kSequenceNumber:
      return v1::Completion::KIND_SEQUENCE_NUMBER;
    case machine::Suggestion::Kind::kProgram:
      return v1::Completion::KIND_PROGRAM;
  }
  return v1::Completion::KIND_UNSPECIFIED;
}

v1::OutlinePart::Kind KindOf(machine::OutlinePart::Kind kind) {
  switch (kind) {
    case machine::OutlinePart::Kind::kVariable:
      return v1::OutlinePart::KIND_VARIABLE;
    case machine::OutlinePart::Kind::kConstant:
      return v1::OutlinePart::KIND_CONSTANT;
    case machine::OutlinePart::Kind::kSequenceNumber:
      return v1::OutlinePart::KIND_SEQUENCE_NUMBER;
    case machine::OutlinePart::Kind::kSubroutine:
      return v1::OutlinePart::KIND_SUBROUTINE;
    case machine::OutlinePart::Kind::kStep:
      return v1::OutlinePart::KIND_STEP;
  }
  return v1::OutlinePart::KIND_UNSPECIFIED;
}

void AddParts(const std::vector<machine::OutlinePart>& parts, const TextPlaces& places,
              google::protobuf::RepeatedPtrField<v1::OutlinePart>& to) {
  for (const machine::OutlinePart& part : parts) {
    v1::OutlinePart& made = *to.Add();
    made.set_kind(KindOf(part.kind));
    made.set_name(part.name);
    made.set_detail(part.detail);
    *made.mutable_range() = places.RangeOf(part.whole);
    *made.mutable_name_range() = places.RangeOf(part.name_at);
    AddParts(part.parts, places, *made.mutable_parts());
  }
}

void AddLocations(const machine::Places& found, const TextPlaces& here,
                  google::protobuf::RepeatedPtrField<v1::TextLocation>& to) {
  for (const machine::TextSpan span : found.here) *to.Add()->mutable_range() = here.RangeOf(span);
  for (const machine::PlacesInFile& file : found.elsewhere) {
    const TextPlaces places(file.file.text);
    for (const machine::TextSpan span : file.spans) {
      v1::TextLocation& made = *to.Add();
      made.set_program(file.file.uri);
      *made.mutable_range() = places.RangeOf(span);
    }
  }
}

}  // namespace

Result<v1::GetLanguageResponse> LanguageTools::Words(const v1::GetLanguageRequest& request) {
  const machine::MachineFamily* family = families::FindFamily(request.family());
  if (family == nullptr) return families::UnknownFamily(request.family());
  v1::GetLanguageResponse response;
  for (const machine::LanguageWord& word : family->words()) {
    v1::LanguageWord& made = *response.add_words();
    made.set_name(std::string(word.name));
    made.set_syntax(std::string(word.form));
    made.set_description(std::string(word.text));
    made.set_rule(std::string(word.rule));
  }
  return response;
}

Result<v1::HoverResponse> LanguageTools::Hover(const v1::HoverRequest& request) {
  const Result<Look> look = LookAt(store_, programs_, request.text());
  if (!look) return look.error();
  const Result<std::size_t> offset = look->places.OffsetOf(request.position());
  if (!offset) return offset.error();
  v1::HoverResponse response;
  const auto note = look->program->Hover(*offset, look->around);
  if (!note) return response;
  response.set_text(note->text);
  *response.mutable_range() = look->places.RangeOf(note->of);
  return response;
}

Result<v1::CompleteResponse> LanguageTools::Complete(const v1::CompleteRequest& request) {
  const Result<Look> look = LookAt(store_, programs_, request.text());
  if (!look) return look.error();
  const Result<std::size_t> offset = look->places.OffsetOf(request.position());
  if (!offset) return offset.error();
  const machine::Suggestions found = look->program->Complete(*offset, look->around);
  v1::CompleteResponse response;
  for (const machine::Suggestion& suggestion : found.list) {
    v1::Completion& made = *response.add_completions();
    made.set_kind(KindOf(suggestion.kind));
    made.set_label(suggestion.label);
    made.set_detail(suggestion.detail);
    made.set_description(suggestion.text);
  }
  *response.mutable_typed() = look->places.RangeOf(found.typed);
  response.set_cut(found.cut);
  return response;
}

Result<v1::FindDefinitionResponse> LanguageTools::FindDefinition(
    const v1::FindDefinitionRequest& request) {
  const Result<Look> look = LookAt(store_, programs_, request.text());
  if (!look) return look.error();
  const Result<std::size_t> offset = look->places.OffsetOf(request.position());
  if (!offset) return offset.error();
  v1::FindDefinitionResponse response;
  AddLocations(look->program->Definition(*offset, look->around), look->places,
               *response.mutable_definitions());
  return response;
}

Result<v1::FindReferencesResponse> LanguageTools::FindReferences(
    const v1::FindReferencesRequest& request) {
  const Result<Look> look = LookAt(store_, programs_, request.text());
  if (!look) return look.error();
  const Result<std::size_t> offset = look->places.OffsetOf(request.position());
  if (!offset) return offset.error();
  v1::FindReferencesResponse response;
  AddLocations(look->program->References(*offset, !request.uses_only(), look->around), look->places,
               *response.mutable_references());
  return response;
}

Result<v1::RenameResponse> LanguageTools::Rename(const v1::RenameRequest& request) {
  const Result<Look> look = LookAt(store_, programs_, request.text());
  if (!look) return look.error();
  const Result<std::size_t> offset = look->places.OffsetOf(request.position());
  if (!offset) return offset.error();
  const auto renamed = look->program->Rename(*offset, request.name());
  if (const auto* refusal = std::get_if<machine::Refusal>(&renamed))
    return InvalidArgument(refusal->why);
  v1::RenameResponse response;
  for (const machine::TextSpan span : std::get<std::vector<machine::TextSpan>>(renamed)) {
    v1::TextFix& fix = *response.add_fixes();
    fix.set_byte_offset(static_cast<std::int64_t>(span.begin));
    fix.set_length(static_cast<std::int32_t>(span.end - span.begin));
    fix.set_text(request.name());
  }
  return response;
}

Result<v1::OutlineResponse> LanguageTools::Outline(const v1::OutlineRequest& request) {
  const Result<Look> look = LookAt(store_, programs_, request.text());
  if (!look) return look.error();
  v1::OutlineResponse response;
  AddParts(look->program->Outline(), look->places, *response.mutable_parts());
  return response;
}

}  // namespace rmlcell::server
