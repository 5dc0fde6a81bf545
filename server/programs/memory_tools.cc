#include "server/programs/memory_tools.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "proto/bridge/comparison.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "proto/bridge/sha256.h"
#include "server/base/names.h"
#include "server/programs/text_tools.h"
#include "server/records/program_place.h"

namespace rmlcell::server {
namespace {

// A comparison answers a call: its trial runs end before a client thinks that nobody is there.
// Loops that never end are cut off by the steps, long programs by the time.
constexpr std::int64_t kTrialStepsMax = 2'000'000;
constexpr std::chrono::seconds kTrialTimeMax{15};
// The picture goes into the same answer: about 1.5 MiB.
constexpr std::size_t kPictureElementsMax = 60'000;
// The rest of an answer, within 4 MiB, for changes of ordinary length.
constexpr std::size_t kChangesMax = 10'000;

v1::StaleExecutable::Reason ReasonOf(machine::StaleReason reason) {
  switch (reason) {
    case machine::StaleReason::kObjectChanged:
      return v1::StaleExecutable::REASON_OBJECT_CHANGED;
    case machine::StaleReason::kObjectMissing:
      return v1::StaleExecutable::REASON_OBJECT_MISSING;
    case machine::StaleReason::kFunctionChanged:
      return v1::StaleExecutable::REASON_FUNCTION_CHANGED;
    case machine::StaleReason::kFunctionDeleted:
      return v1::StaleExecutable::REASON_FUNCTION_DELETED;
    case machine::StaleReason::kDamaged:
      break;
  }
  return v1::StaleExecutable::REASON_DAMAGED;
}

Error NoSuchSlot(const machine::MachineFamily& family, int number) {
  return {family.info().no_slot, "program number is " + std::to_string(number), {}};
}

// The objects that a link may take, and what was said while they were made.
class LinkMaterial {
 public:
  // Of a family that has tools.
  LinkMaterial(const machine::MachineFamily& family, const machine::Parameters& parameters)
      : family_(family), tools_(*family.tools()), parameters_(parameters) {}

  // Those of the request. Error: as MemoryTools::Link.
  Status Add(const v1::LinkProgramRequest& request) {
    for (const v1::LinkProgramRequest::Part& part : request.programs()) {
      if (!IsSlot(part.slot())) {
        return NoSuchSlot(family_, part.slot());
      }
      if (objects_.contains(part.slot()) || sources_.contains(part.slot()))
        return GivenTwice(part.slot());
      const v1::ProgramText& program = part.program();
      if (program.content().empty())
        return Error{ErrorCode::kCellEmptyProgram, program.file_name(), {}};
      if (IsObject(program)) {
        objects_[part.slot()] = program.content();
        continue;
      }
      sources_.emplace(part.slot(), &program);
    }
    return {};
  }

  // What the request brings goes before what is stored.
  void AddStored(int slot, std::string object) {
    if (!sources_.contains(slot)) objects_.emplace(slot, std::move(object));
  }

  // Findings beyond the usual number are counted.
  void Report(const Error& error) {
    findings_.push_back(
        {.code = error.code, .severity = Lookup(error.code).severity, .detail = error.detail});
  }
  v1::Findings Findings() {
    const bool good = !HasErrors(findings_);
    if (findings_.size() > machine::kDiagnosticsMax) {
      const auto kept = findings_.begin() + machine::kDiagnosticsMax;
      std::for_each(kept, findings_.end(), [this](const Diagnostic& one) { dropped_.Add(one); });
      findings_.erase(kept, findings_.end());
    }
    return bridge::FindingsOf(good, findings_, dropped_, {});
  }
  bool good() const { return !HasErrors(findings_); }

  // Compiles what is asked for, and nothing else (OPT-9.02).
  machine::ObjectLookup Objects() {
    return [this](int slot) -> std::optional<std::string_view> {
      if (const auto source = sources_.find(slot); source != sources_.end()) {
        Compile(slot, *source->second);
        sources_.erase(source);
      }
      const auto found = objects_.find(slot);
      if (found == objects_.end()) return std::nullopt;
      return found->second;
    };
  }

 private:
  static Error GivenTwice(int slot) {
    return InvalidArgument("slot " + std::to_string(slot) + " is given twice");
  }

  void Compile(int slot, const v1::ProgramText& program) {
    const bool inch =
        tools_.FormOf(program.file_name(), program.content()) == machine::FileForm::kInchSource;
    machine::CompiledProgram compiled =
        tools_.Compile({.name = program.file_name(), .bytes = program.content()}, parameters_,
                       {.advice = false, .inch = inch});
    if (compiled.ok) objects_[slot] = std::move(compiled.object);
    dropped_.Add(compiled.diagnostics_dropped);
    for (Diagnostic& finding : compiled.diagnostics) {
      finding.program = slot;
      findings_.push_back(std::move(finding));
    }
  }

  const machine::MachineFamily& family_;
  const machine::Tools& tools_;
  const machine::Parameters& parameters_;
  std::map<int, const v1::ProgramText*> sources_;  // of the request, not compiled yet
  std::map<int, std::string> objects_;
  std::vector<Diagnostic> findings_;
  UntoldFindings dropped_;
};

// Only machines whose programs call each other have executables; a mill's streams are large.
bool WithPrograms(const storage::MachineRecord& machine) {
  const machine::MachineFamily* family = families::FindFamily(machine.family);
  return family != nullptr && family->info().has_executables;
}

}  // namespace

Result<v1::FixProgramResponse> MemoryTools::Fix(const v1::FixProgramRequest& request) {
  const v1::ProgramText& program = request.program();
  // Refuses what names family or machine wrongly before anything is done.
  const auto first =
      programs_.Translate(request.family(), request.machine(), program, !request.errors_only());
  if (!first) return first.error();
  const auto family = families::FamilyWithTools(program.file_name());
  if (!family) return family.error();
  const machine::Tools& tools = *(*family)->tools();
  if (IsObject(program))
    return Error{ErrorCode::kCellBadText, program.file_name() + " is an object, not a source", {}};
  if (const Status good = tools.CheckIsText(program.file_name(), program.content()); !good)
    return good.error();
  const auto check = [&](const machine::SourceFile& file) {
    v1::ProgramText text = program;
    text.set_content(std::string(file.bytes));
    auto checked =
        programs_.Translate(request.family(), request.machine(), text, !request.errors_only());
    return checked ? *std::move(checked) : *first;  // the machine went away meanwhile: as it was
  };
  machine::RepairedText fixing =
      tools.Fix({.name = program.file_name(), .bytes = program.content()}, check);
  v1::FixProgramResponse response;
  response.set_content(std::move(fixing.text));
  for (const Diagnostic& finding : fixing.fixed) *response.add_fixed() = bridge::ToProto(finding);
  *response.mutable_findings() =
      bridge::FindingsOf(fixing.left.ok, fixing.left.diagnostics, fixing.left.diagnostics_dropped,
                         fixing.left.figures);
  return response;
}

Result<v1::LinkProgramResponse> MemoryTools::Link(const v1::LinkProgramRequest& request) {
  const auto named = families::FamilyWithTools(
      request.programs().empty() ? std::string() : request.programs(0).program().file_name());
  if (!named) return named.error();
  const machine::MachineFamily* family = *named;
  machine::Parameters parameters(family->parameters());
  std::vector<storage::ProgramRecord> memory;
  if (!request.machine().empty()) {
    const Result<std::string> id = ParseMachineName(request.machine());
    if (!id) return id.error();
    auto stored = store_.GetMachineMemory(*id, WithPrograms);
    if (!stored) return stored.error();
    const storage::MachineRecord* machine = &stored->machine;
    family = families::FindFamily(machine->family);
    if (family == nullptr) return families::UnknownFamily(machine->family);
    if (family->tools() == nullptr) {
      return Error{
          ErrorCode::kCellPrecondition, "a " + machine->family + " machine has no executables", {}};
    }
    auto made = machine::MakeParameters(*family, machine->profile, machine->parameters);
    if (!made) return made.error();
    parameters = *std::move(made);
    memory = std::move(stored->programs);
  }
  if (!IsSlot(request.slot())) return NoSuchSlot(*family, request.slot());
  LinkMaterial material(*family, parameters);
  if (const Status added = material.Add(request); !added) return added.error();
  for (storage::ProgramRecord& program : memory)
    material.AddStored(program.slot, std::move(program.object));
  v1::LinkProgramResponse response;
  Result<machine::LinkedProgram> linked =
      family->tools()->Link(request.slot(), material.Objects(), parameters);
  if (linked) {
    response.set_executable(std::move(linked->executable));
    for (const int slot : linked->functions) response.add_functions(slot);
  } else if (material.good()) {  // else the program that could not be compiled is reported
    material.Report(linked.error());
  }
  *response.mutable_findings() = material.Findings();
  return response;
}

Result<v1::ListStaleExecutablesResponse> MemoryTools::ListStale(
    const v1::ListStaleExecutablesRequest& request) {
  const Result<std::string> id = ParseMachineName(request.parent());
  if (!id) return id.error();
  auto memory = store_.GetMachineMemory(*id, WithPrograms);
  if (!memory) return memory.error();
  const machine::MachineFamily* family = families::FindFamily(memory->machine.family);
  v1::ListStaleExecutablesResponse response;
  if (family == nullptr || !family->info().has_executables) return response;
  std::map<int, machine::StoredProgram> programs;
  for (storage::ProgramRecord& program : memory->programs) {
    machine::StoredProgram& stored = programs[program.slot];
    stored.object = machine::Bytes::Of(std::move(program.object));
    if (program.executable) stored.executable = machine::Bytes::Of(*std::move(program.executable));
  }
  for (const machine::StaleExecutable& stale :
       family->FindStaleExecutables(programs, {memory->deleted.begin(), memory->deleted.end()})) {
    v1::StaleExecutable& made = *response.add_executables();
    made.set_name(NameOfProgram(*id, stale.slot + kExecutableOffset));
    for (const machine::StalePart& part : stale.parts) {
      v1::StaleExecutable::Part& why = *made.add_parts();
      why.set_program(NameOfProgram(*id, part.slot));
      why.set_reason(ReasonOf(part.reason));
      why.set_text(part.text);
    }
  }
  return response;
}

Result<v1::DecompileProgramResponse> MemoryTools::Decompile(
    const v1::DecompileProgramRequest& request) {
  v1::DecompileProgramResponse response;
  if (!request.name().empty()) {
    const Result<ProgramPlace> place = FindProgramPlace(store_, request.name());
    if (!place) return place.error();
    if (place->executable)
      return InvalidArgument("an executable has no source; its program is " +
                             NameOfProgram(place->machine.id, place->slot));
    // One read of the record: text and object belong together.
    Result<ProgramBook::Content> source = programs_.Read(request.name(), v1::PROGRAM_FORM_SOURCE);
    if (!source) return source.error();
    if (request.object().empty() || source->object_sha256 == bridge::Sha256Hex(request.object())) {
      response.set_content(std::move(source->bytes));
      response.set_own_text(source->own_text);
      response.set_file_name(source->file_name);
      return response;
    }
  } else if (request.object().empty()) {
    return Error{ErrorCode::kCellEmptyProgram, "give an object, or the name of a program", {}};
  }
  const auto family = families::FamilyOfObject(request.object());
  if (!family) return family.error();
  Result<machine::RecoveredSource> source =
      (*family)->tools()->Decompile(request.object(), std::nullopt);
  if (!source) return source.error();
  response.set_content(std::move(source->text));
  return response;
}

Result<MemoryTools::StoredObject> MemoryTools::ObjectOf(const std::string& name) {
  const Result<ProgramPlace> place = FindProgramPlace(store_, name);
  if (!place) return place.error();
  if (place->executable)
    return InvalidArgument("executables are not compared; name the program of its object");
  const machine::Tools* tools = place->family->tools();
  if (tools == nullptr) {
    return Error{ErrorCode::kCellPrecondition,
                 "programs of a " + place->machine.family + " machine are not compared",
                 {}};
  }
  Result<storage::ProgramRecord> program = store_.GetProgram(place->machine.id, place->slot);
  if (!program) {
    if (program.error().code != ErrorCode::kCellNotFound) return program.error();
    return EmptySlot(*place->family, name);
  }
  const std::string title =
      program->source_name.empty() ? std::to_string(place->slot) : program->source_name;
  return StoredObject{
      title.substr(0, title.find_last_of('.')) + std::string(tools->extensions().object),
      std::move(program->object)};
}

ProgramResult<v1::DiffProgramsResponse> MemoryTools::Diff(const v1::DiffProgramsRequest& request) {
  const std::array sides = {&request.before(), &request.after()};
  std::array<bridge::ComparedProgram, 2> programs;
  for (std::size_t i = 0; i < 2; ++i) {
    if (sides[i]->program_case() == v1::DiffProgramsRequest::Side::kName) {
      Result<StoredObject> stored = ObjectOf(sides[i]->name());
      if (!stored) return stored.error();
      programs[i] = {.file_name = stored->file_name,
                     .bytes = machine::Bytes::Of(std::move(stored->object))};
      continue;
    }
    const v1::ProgramText& text = sides[i]->text();
    if (text.content().empty()) return Error{ErrorCode::kCellEmptyProgram, text.file_name(), {}};
    const bool object = text.form() == v1::PROGRAM_FORM_OBJECT;
    programs[i] = {.file_name = text.file_name(),
                   .bytes = machine::Bytes::Of(text.content()),
                   .is_object = object};
  }
  const auto until = std::chrono::steady_clock::now() + kTrialTimeMax;
  Result<bridge::ComparisonOutcome> made = bridge::ComparePrograms(
      programs[0], programs[1],
      {.picture = request.picture(),
       .picture_elements_max = kPictureElementsMax,
       .changes_max = kChangesMax,
       .steps_max = kTrialStepsMax,
       .go_on = [until] { return std::chrono::steady_clock::now() < until; }});
  if (!made) return made.error();
  if (made->ok) return std::move(made->response);
  ProgramError wrong{.error = {ErrorCode::kCellBadText, {}, {}}};
  for (std::size_t i = 0; i < 2; ++i) {
    for (Diagnostic& finding : made->diagnostics[i]) {
      if (IsError(finding.severity) && wrong.error.detail.empty()) {
        wrong.error = {
            finding.code,
            finding.file + " line " + std::to_string(finding.where.line) + ": " + finding.detail,
            finding.where};
      }
      wrong.diagnostics.push_back(std::move(finding));
    }
    wrong.dropped.Add(made->dropped[i]);
  }
  return wrong;
}

}  // namespace rmlcell::server
