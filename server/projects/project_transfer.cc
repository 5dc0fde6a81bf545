#include "server/projects/project_transfer.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "engine/families/families.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/sha256.h"
#include "server/base/names.h"
#include "server/programs/program_book.h"
#include "server/programs/text_tools.h"
#include "server/projects/process_definition.h"
#include "server/projects/project_archive.h"
#include "server/projects/project_book.h"
#include "server/records/file_family.h"
#include "server/records/machine_messages.h"
#include "server/records/program_memory.h"
#include "server/records/program_place.h"

namespace rmlcell::server {
namespace {

// A machine may be changed while it is read: so often it is read anew.
constexpr int kReadingsMax = 3;

machine::ProjectBundle BundleOf(const v1::Project& project) {
  machine::ProjectBundle bundle;
  for (const v1::ProjectProgram& program : project.programs()) {
    // A name may say inch, too: the family reads it (OPT-8.72).
    bundle.programs.push_back(
        {.slot = program.slot(),
         .file = {.name = program.source().file_name(), .bytes = program.source().content()},
         .inch = program.units() == v1::UNITS_INCH});
  }
  for (const v1::ProjectLaserSchedule& schedule : project.laser_schedules()) {
    bundle.schedules.push_back({.number = schedule.number(),
                                .name = schedule.title(),
                                .mode = *ModeText(schedule.mode()),
                                .power_percent = schedule.power_percent()});
  }
  for (const v1::ProjectProcess& process : project.processes()) {
    bundle.processes.push_back(DefinitionOf(process));
  }
  return bundle;
}

const v1::ProjectProgram* FindProgram(const v1::Project& project, int slot) {
  const auto found = std::ranges::find_if(
      project.programs(),
      [&](const v1::ProjectProgram& program) { return program.slot() == slot; });
  return found == project.programs().end() ? nullptr : &*found;
}

// The first error of a transfer stands for all; its findings go along.
ProgramError Refused(const machine::TransferPlan& plan, const machine::MachineFamily& family) {
  ProgramError wrong{.error = {family.info().no_source, {}, {}},
                     .diagnostics = plan.diagnostics,
                     .dropped = plan.diagnostics_dropped};
  const auto first = std::ranges::find_if(plan.diagnostics,
                                          [](const Diagnostic& d) { return IsError(d.severity); });
  if (first != plan.diagnostics.end()) {
    wrong.error = {first->code, "program " + std::to_string(first->program) + ": " + first->detail,
                   first->where};
  }
  return wrong;
}

// What a machine holds where a project wants to be.
struct HeldBefore {
  std::map<int, storage::ProgramRecord> programs;
  std::map<int, storage::ScheduleRecord> schedules;

  // Another one whenever something of it was changed.
  std::string Etag(const v1::Project& project) const {
    std::string text;
    const auto add = [&text](int number, storage::Revision revision) {
      text += std::to_string(number) + ":" + std::to_string(revision) + ";";
    };
    for (const v1::ProjectProgram& program : project.programs())
      add(program.slot(), RevisionOf(program.slot()));
    text += "/";
    for (const v1::ProjectLaserSchedule& schedule : project.laser_schedules()) {
      const auto held = schedules.find(schedule.number());
      add(schedule.number(), held == schedules.end() ? 0 : held->second.revision);
    }
    return bridge::Sha256Hex(text);
  }

  storage::Revision RevisionOf(int slot) const {
    const auto held = programs.find(slot);
    return held == programs.end() ? 0 : held->second.revision;
  }
};

Result<HeldBefore> ReadHeld(storage::Store& store, const std::string& machine,
                            const v1::Project& project) {
  HeldBefore held;
  for (const v1::ProjectProgram& program : project.programs()) {
    auto found = store.GetProgram(machine, program.slot());
    if (found) held.programs.emplace(program.slot(), *std::move(found));
    if (!found && found.error().code != ErrorCode::kCellNotFound) return found.error();
  }
  if (project.laser_schedules().empty()) return held;
  auto schedules = store.ListSchedules(machine);
  if (!schedules) return schedules.error();
  for (storage::ScheduleRecord& schedule : *schedules)
    held.schedules.emplace(schedule.number, std::move(schedule));
  return held;
}

storage::ProgramSummary SummaryOf(const storage::ProgramRecord& program) {
  return {.slot = program.slot,
          .name = program.name,
          .source_name = program.source_name,
          .object_bytes = static_cast<std::int64_t>(program.object.size()),
          .source_bytes =
              program.source ? static_cast<std::int64_t>(program.source->size()) : std::int64_t{-1},
          .executable_bytes = program.executable
                                  ? static_cast<std::int64_t>(program.executable->size())
                                  : std::int64_t{-1},
          .object_sha256 = bridge::Sha256Hex(program.object),
          .revision = program.revision,
          .created_at = program.created_at,
          .updated_at = program.updated_at};
}

// What is known of it before it is stored.
v1::Program ToBe(const std::string& machine, const storage::ProgramWrite& write) {
  v1::Program program;
  program.set_name(NameOfProgram(machine, write.slot));
  program.set_title(write.name);
  program.set_file_name(write.source_name);
  program.set_object_bytes(static_cast<std::int64_t>(write.object.size()));
  if (write.source) program.set_source_bytes(static_cast<std::int64_t>(write.source->size()));
  program.set_object_sha256(bridge::Sha256Hex(write.object));
  return program;
}

v1::TransferItem ItemOf(const std::string& machine, const storage::ProgramWrite& write,
                        const HeldBefore& held) {
  v1::TransferItem item;
  item.set_name(NameOfProgram(machine, write.slot));
  *item.mutable_program_after() = ToBe(machine, write);
  const auto before = held.programs.find(write.slot);
  item.set_change(v1::TRANSFER_CHANGE_ADD);
  if (before == held.programs.end()) return item;
  const storage::ProgramRecord& program = before->second;
  *item.mutable_program_before() = ToProto(machine, SummaryOf(program));
  const bool same = program.object == write.object && program.source == write.source &&
                    program.name == write.name && program.source_name == write.source_name;
  item.set_change(same ? v1::TRANSFER_CHANGE_SAME : v1::TRANSFER_CHANGE_REPLACE);
  return item;
}

v1::TransferItem ItemOf(const storage::ScheduleRecord& schedule, const HeldBefore& held) {
  v1::TransferItem item;
  item.set_name(NameOfSchedule(schedule.machine, schedule.number));
  *item.mutable_laser_schedule_after() = ToProto(schedule);
  item.mutable_laser_schedule_after()->clear_etag();  // it is not stored yet
  const auto before = held.schedules.find(schedule.number);
  item.set_change(v1::TRANSFER_CHANGE_ADD);
  if (before == held.schedules.end()) return item;
  const storage::ScheduleRecord& there = before->second;
  *item.mutable_laser_schedule_before() = ToProto(there);
  const bool same = there.name == schedule.name && there.mode == schedule.mode &&
                    there.power_percent == schedule.power_percent;
  item.set_change(same ? v1::TRANSFER_CHANGE_SAME : v1::TRANSFER_CHANGE_REPLACE);
  return item;
}

// As the project has it, or as it was made of that.
storage::ProgramWrite WriteOf(machine::TransferPlan::Program program,
                              const v1::ProjectProgram& source,
                              const machine::MachineFamily& family) {
  storage::ProgramWrite write{.slot = program.slot,
                              .name = source.title(),
                              .object = std::move(program.object),
                              .source = {},
                              .source_name = source.source().file_name()};
  if (program.own_text) {
    write.source = source.source().content();  // the programmer's own text, inch where it is inch
  } else if (!program.source.empty() && program.source != write.object) {
    // Another text than that of the project: its name must not say inch, or object.
    if (program.source != source.source().content()) {
      const std::string_view extensions = family.info().extensions;
      write.source_name = std::filesystem::path(write.source_name)
                              .replace_extension(extensions.substr(0, extensions.find(' ')))
                              .string();
    }
    write.source = std::move(program.source);
  }
  return write;
}

// What a project brings to a machine.
struct Load {
  std::vector<storage::ProgramWrite> programs;
  std::vector<storage::ScheduleRecord> schedules;
};

Load LoadOf(machine::TransferPlan plan, const v1::Project& project, const std::string& machine,
            const machine::MachineFamily& family) {
  Load load;
  for (machine::TransferPlan::Program& program : plan.programs) {
    const v1::ProjectProgram* source = FindProgram(project, program.slot);
    if (source != nullptr) load.programs.push_back(WriteOf(std::move(program), *source, family));
  }
  for (const v1::ProjectLaserSchedule& schedule : project.laser_schedules()) {
    load.schedules.push_back({.machine = machine,
                              .number = schedule.number(),
                              .name = schedule.title(),
                              .mode = *ModeText(schedule.mode()),
                              .power_percent = schedule.power_percent()});
  }
  return load;
}

// A stream takes any bytes: by its translation alone no source of another family would be refused.
Status CheckFamilies(const v1::Project& project, const machine::MachineFamily& family) {
  if (project.programs().empty())
    return Error{family.info().no_source, "the project has no program", {}};
  for (const v1::ProjectProgram& program : project.programs()) {
    if (const Status fits = CheckFileFamily(program.source().file_name(), family); !fits) {
      return InvalidArgument("program " + std::to_string(program.slot()) + ": " +
                             fits.error().detail);
    }
  }
  return {};
}

// As it is stored by now.
Status SetStored(storage::Store& store, const std::string& machine,
                 const std::vector<storage::ProgramSummary>& programs, bool schedules,
                 v1::TransferProjectResponse& response) {
  std::map<std::string, storage::ScheduleRecord> stored;
  if (schedules) {
    auto listed = store.ListSchedules(machine);
    if (!listed) return listed.error();
    for (storage::ScheduleRecord& one : *listed)
      stored.emplace(NameOfSchedule(machine, one.number), std::move(one));
  }
  std::size_t next = 0;  // one summary of each program, in the same order
  for (v1::TransferItem& item : *response.mutable_items()) {
    if (item.has_program_after()) {
      *item.mutable_program_after() = ToProto(machine, programs[next++]);
    } else if (const auto found = stored.find(item.name()); found != stored.end()) {
      *item.mutable_laser_schedule_after() = ToProto(found->second);
    }
  }
  return {};
}

}  // namespace

ProgramResult<v1::TransferProjectResponse> ProjectTransfer::ToMachine(
    const v1::TransferProjectRequest& request, std::string_view caller) {
  const Result<v1::Project> project = projects_.Get(request.name());
  if (!project) return project.error();
  const Result<std::string> machine_id = ParseMachineName(request.machine());
  if (!machine_id) return machine_id.error();
  const auto machine = store_.GetMachine(*machine_id);
  if (!machine) return machine.error();
  const machine::MachineFamily* family = families::FindFamily(machine->family);
  if (family == nullptr) return families::UnknownFamily(machine->family);
  const auto parameters = machine::MakeParameters(*family, machine->profile, machine->parameters);
  if (!parameters) return parameters.error();
  if (const Status fits = CheckFamilies(*project, *family); !fits) return fits.error();

  machine::TransferPlan plan =
      family->PlanTransfer(BundleOf(*project), *parameters,
                           {.insert_missing_definitions = request.insert_missing_definitions()});
  if (!plan.ok) return Refused(plan, *family);
  const auto held = ReadHeld(store_, *machine_id, *project);
  if (!held) return held.error();
  v1::TransferProjectResponse response;
  response.set_etag(held->Etag(*project));
  if (!request.etag().empty() && request.etag() != response.etag()) {
    return Error{ErrorCode::kCellEtagMismatch,
                 MachineName(*machine_id) + " holds something else by now",
                 {}};
  }
  *response.mutable_findings() =
      bridge::FindingsOf(true, plan.diagnostics, plan.diagnostics_dropped, {});
  Load load = LoadOf(std::move(plan), *project, *machine_id, *family);
  for (storage::ProgramWrite& write : load.programs) {
    *response.add_items() = ItemOf(*machine_id, write, *held);
    if (!request.etag().empty()) write.expected = held->RevisionOf(write.slot);
  }
  std::ranges::sort(load.schedules, {}, &storage::ScheduleRecord::number);
  for (const storage::ScheduleRecord& schedule : load.schedules)
    *response.add_items() = ItemOf(schedule, *held);
  if (request.validate_only()) {
    if (const Status room = CheckRoomFor(store_, *machine, load.programs); !room)
      return room.error();
    return response;
  }
  const auto stored = store_.PutPrograms(*machine_id, load.programs, load.schedules, caller);
  if (!stored) {
    // Of a slot that was filled or emptied since it was read.
    const ErrorCode code = stored.error().code;
    const bool changed = code == ErrorCode::kCellAlreadyExists || code == ErrorCode::kCellNotFound;
    if (!request.etag().empty() && changed)
      return Error{ErrorCode::kCellEtagMismatch, stored.error().detail, {}};
    return stored.error();
  }
  programs_.TellStored();
  if (const Status told =
          SetStored(store_, *machine_id, *stored, !load.schedules.empty(), response);
      !told)
    return told.error();
  return response;
}

ProgramResult<v1::Project> ProjectTransfer::FromMachine(
    const v1::TransferProjectFromMachineRequest& request, const std::string& now,
    std::string_view caller) {
  const Result<std::string> machine_id = ParseMachineName(request.machine());
  if (!machine_id) return machine_id.error();
  const auto machine = store_.GetMachine(*machine_id);
  if (!machine) return machine.error();
  if (!v1::Units_IsValid(request.units())) return InvalidArgument("units are none that there are");
  Result<v1::Project> project = Gather(*machine, request, now);
  for (int reading = 1; !project && project.error().code == ErrorCode::kCellEtagMismatch;
       ++reading) {
    if (reading == kReadingsMax) break;
    project = Gather(*machine, request, now);
  }
  if (!project) return project.error();
  v1::CreateProjectRequest made;
  made.set_project_id(request.project_id());
  *made.mutable_project() = *std::move(project);
  made.set_validate_only(request.validate_only());
  return projects_.Create(made, caller);
}

Result<v1::Project> ProjectTransfer::Gather(const storage::MachineRecord& machine,
                                            const v1::TransferProjectFromMachineRequest& request,
                                            const std::string& now) {
  const machine::MachineFamily* family = families::FindFamily(machine.family);
  if (family == nullptr) return families::UnknownFamily(machine.family);
  const auto before = store_.ListPrograms(machine.id, 0, kSlotMax);
  if (!before) return before.error();
  std::set<int> slots(request.slots().begin(), request.slots().end());
  if (slots.empty()) {
    for (const storage::ProgramSummary& program : *before) slots.insert(program.slot);
  }
  if (slots.empty()) {
    return Error{family->info().no_source, MachineName(machine.id) + " has no program", {}};
  }
  v1::Project project;
  project.set_title(machine.title);
  std::size_t bytes = 0;
  for (const int slot : slots) {
    if (const Status known = CheckSlot(*family, slot, "slot"); !known) return known.error();
    const auto found = std::ranges::find(*before, slot, &storage::ProgramSummary::slot);
    if (found == before->end()) return EmptySlot(*family, NameOfProgram(machine.id, slot));
    auto source = SourceIn(request.units(), NameOfProgram(machine.id, slot), now);
    if (!source) return source.error();
    bytes += source->content().size();
    if (bytes > kProjectBytesMax) {
      return Error{ErrorCode::kCellTooLarge,
                   "the programs have more than " + std::to_string(kProjectBytesMax) + " bytes",
                   {}};
    }
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(slot);
    program.set_title(found->name);
    *program.mutable_source() = *std::move(source);
  }
  const auto schedules = store_.ListSchedules(machine.id);
  if (!schedules) return schedules.error();
  for (const storage::ScheduleRecord& schedule : *schedules) {
    v1::ProjectLaserSchedule& made = *project.add_laser_schedules();
    made.set_number(schedule.number);
    made.set_title(schedule.name);
    made.set_mode(ModeOf(schedule.mode));
    made.set_power_percent(schedule.power_percent);
  }
  // What was read one by one belongs together when nothing was changed meanwhile.
  const auto after = store_.ListPrograms(machine.id, 0, kSlotMax);
  if (!after) return after.error();
  const auto same = [](const storage::ProgramSummary& one, const storage::ProgramSummary& other) {
    return one.slot == other.slot && one.revision == other.revision;
  };
  if (!std::ranges::equal(*before, *after, same)) {
    return Error{ErrorCode::kCellEtagMismatch,
                 MachineName(machine.id) + " was changed while it was read",
                 {}};
  }
  return project;
}

Result<v1::ProgramText> ProjectTransfer::SourceIn(v1::Units units, const std::string& program,
                                                  const std::string& now) {
  Result<ProgramBook::Content> content = programs_.Read(program, v1::PROGRAM_FORM_SOURCE);
  if (!content) return content.error();
  v1::ProgramText text;
  text.set_file_name(content->file_name);
  text.set_content(std::move(content->bytes));
  if (units == v1::UNITS_UNSPECIFIED) return text;
  const auto family = families::FamilyWithTools(text.file_name());
  if (!family) return text;  // a stream has its own units, and no other ones
  const bool inch = (*family)->tools()->FormOf(text.file_name(), text.content()) ==
                    machine::FileForm::kInchSource;
  if (inch == (units == v1::UNITS_INCH)) return text;
  v1::ConvertProgramRequest convert;
  *convert.mutable_program() = std::move(text);
  convert.set_target(inch ? v1::ConvertProgramRequest::TARGET_METRIC
                          : v1::ConvertProgramRequest::TARGET_INCH);
  auto converted = ConvertText(convert, now);
  if (!converted) return converted.error();
  text = {};
  text.set_file_name(converted->file_name());
  text.set_content(converted->content());
  return text;
}

}  // namespace rmlcell::server
