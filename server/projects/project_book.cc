#include "server/projects/project_book.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <set>

#include "engine/core/units.h"
#include "engine/families/families.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/milling.h"
#include "proto/bridge/setup.h"
#include "server/base/names.h"
#include "server/base/readable.h"
#include "server/projects/process_definition.h"
#include "server/records/file_family.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"
#include "server/records/update_mask.h"

namespace rmlcell::server {
namespace {

constexpr PageSizes kProjectPages{.fallback = 100, .max = 1000};
constexpr std::size_t kNotesMax = 64 << 10;
constexpr std::array<std::string_view, 5> kProjectFields = {"title", "notes", "programs",
                                                            "laser_schedules", "processes"};

// Whoever reads the name takes the text for inches: units that say otherwise would be believed by
// nobody.
Status CheckUnits(const v1::ProjectProgram& program) {
  const std::string& name = program.source().file_name();
  if (program.units() != v1::UNITS_METRIC) return {};
  const auto family = families::FamilyWithTools(name);
  if (!family || (*family)->tools()->FormOf(name, program.source().content()) !=
                     machine::FileForm::kInchSource) {
    return {};
  }
  return InvalidArgument("program " + std::to_string(program.slot()) +
                         ": units are UNITS_METRIC, but the name " + Readable(name) +
                         " says inch: leave the units out, or rename the file");
}

// How a project speaks of a program: as the machine that its name is for.
machine::FamilyInfo InfoFor(const std::string& file_name) {
  const machine::MachineFamily* named = families::FamilyOfFileName(file_name);
  if (named == nullptr) named = families::FamilyWithSchedules();
  return named == nullptr ? machine::FamilyInfo{} : named->info();
}

// What can be said without a machine. Languages are checked when the project is transferred.
Status CheckParts(const v1::Project& project) {
  if (const Status good = CheckTitle(project.title(), "title"); !good) return good.error();
  if (project.notes().size() > kNotesMax) return InvalidArgument("notes are longer than 64 KiB");
  std::set<int> slots;
  for (const v1::ProjectProgram& program : project.programs()) {
    const std::string slot = std::to_string(program.slot());
    const machine::FamilyInfo info = InfoFor(program.source().file_name());
    if (!IsSlot(program.slot())) return Error{info.no_slot, "slot is " + slot, {}};
    if (const Status good = CheckTitle(program.title(), "title of program " + slot); !good)
      return good.error();
    if (!slots.insert(program.slot()).second) return Error{info.given_twice, "slot " + slot, {}};
    if (program.source().content().empty()) {
      return Error{info.no_source, "the program of slot " + slot + " has no source", {}};
    }
    if (const Status good = CheckUnits(program); !good) return good.error();
    if (!program.has_milling()) continue;
    if (const auto sound = bridge::FromProto(program.milling()); !sound)
      return InvalidArgument("program " + slot + ": milling." + sound.error().detail);
    if (!program.milling().has_target()) continue;
    const Status sound = bridge::CheckTarget(program.milling().target());
    if (!sound) {
      return Error{sound.error().code, "program " + slot + ": milling." + sound.error().detail, {}};
    }
  }
  const machine::FamilyInfo info = InfoFor({});
  std::set<int> schedules;
  for (const v1::ProjectLaserSchedule& schedule : project.laser_schedules()) {
    const std::string number = std::to_string(schedule.number());
    if (schedule.number() < 1 || schedule.number() > info.schedules) {
      return Error{info.no_schedule, "laser schedule " + number, {}};
    }
    if (const Status good = CheckTitle(schedule.title(), "title of laser schedule " + number);
        !good)
      return good.error();
    if (!schedules.insert(schedule.number()).second)
      return InvalidArgument("laser schedule " + number + " stands twice");
    if (const auto mode = ModeText(schedule.mode()); !mode)
      return InvalidArgument("laser schedule " + number + ": " + mode.error().detail);
    if (!(schedule.power_percent() >= 0.0 && schedule.power_percent() <= 100.0)) {
      return InvalidArgument("laser schedule " + number + ": power_percent: allowed are 0 to 100");
    }
  }
  std::set<std::pair<int, int>> processes;
  for (const v1::ProjectProcess& process : project.processes()) {
    const std::string name =
        std::to_string(process.kind()) + "," + std::to_string(process.process());
    if (!processes.insert({process.kind(), process.process()}).second) {
      return Error{info.given_twice, "process " + name, {}};
    }
  }
  return {};
}

// Whether a program of the project is for a machine of the family, by its name; where no name says
// anything, the family that has processes.
bool IsFor(const v1::Project& project, const machine::MachineFamily& family) {
  bool named = false;
  for (const v1::ProjectProgram& program : project.programs()) {
    const machine::MachineFamily* one = families::FamilyOfFileName(program.source().file_name());
    if (one == &family) return true;
    named = named || one != nullptr;
  }
  return !named && families::FamilyWithSchedules() == &family;
}

// What is wrong with a project by itself: its definitions, to the families that it is for (OPT-3.01
// to 3.08).
std::optional<ProgramError> FindFault(const v1::Project& project) {
  if (const Status good = CheckParts(project); !good) return ProgramError{good.error(), {}, {}};
  std::vector<Diagnostic> found;
  for (const machine::MachineFamily* family : families::Families()) {
    if (!IsFor(project, *family)) continue;
    for (const v1::ProjectProcess& process : project.processes()) {
      std::ranges::move(family->CheckProcess(DefinitionOf(process)), std::back_inserter(found));
    }
  }
  const auto first =
      std::ranges::find_if(found, [](const Diagnostic& d) { return IsError(d.severity); });
  if (first == found.end()) return std::nullopt;
  Error error{first->code, first->detail, {}};
  return ProgramError{std::move(error), std::move(found), {}};
}

Result<v1::Project> ProjectOf(const storage::ProjectRecord& record) {
  v1::Project project;
  if (!project.ParseFromString(record.body)) {
    return Error{ErrorCode::kCellStoreCorrupt, "the body of " + ProjectName(record.id), {}};
  }
  project.set_name(ProjectName(record.id));
  project.set_title(record.title);
  project.set_etag(std::to_string(record.revision));
  *project.mutable_create_time() = ToProto(record.created_at);
  *project.mutable_update_time() = ToProto(record.updated_at);
  return project;
}

ProgramResult<v1::Project> Whole(const storage::ProjectRecord& record) {
  Result<v1::Project> project = ProjectOf(record);
  if (!project) return project.error();
  return *std::move(project);
}

storage::ProjectRecord RecordOf(const std::string& id, v1::Project project) {
  const std::string title = project.title();
  // Kept in columns of their own.
  project.clear_name();
  project.clear_title();
  project.clear_etag();
  project.clear_create_time();
  project.clear_update_time();
  return {.id = id, .title = title, .body = project.SerializeAsString()};
}

}  // namespace

ProgramResult<v1::Project> ProjectBook::Create(const v1::CreateProjectRequest& request,
                                               std::string_view caller) {
  if (const Status id = CheckResourceId(request.project_id(), "project_id"); !id) return id.error();
  if (auto fault = FindFault(request.project())) return *std::move(fault);
  storage::ProjectRecord record = RecordOf(request.project_id(), request.project());
  if (request.validate_only()) {
    const auto there = store_.GetProject(request.project_id());
    if (there) return Error{ErrorCode::kCellAlreadyExists, ProjectName(request.project_id()), {}};
    if (there.error().code != ErrorCode::kCellNotFound) return there.error();
    v1::Project project = request.project();
    project.set_name(ProjectName(request.project_id()));
    return project;
  }
  const auto stored = store_.PutProject(record, 0, caller);
  if (!stored) return stored.error();
  return Whole(*stored);
}

v1::Project WithoutContent(v1::Project project) {
  for (v1::ProjectProgram& program : *project.mutable_programs()) {
    program.mutable_source()->clear_content();
    if (!program.milling().has_target()) continue;
    v1::MillTarget& target = *program.mutable_milling()->mutable_target();
    if (target.has_file()) target.mutable_file()->clear_content();
    if (target.has_inline_program()) target.mutable_inline_program()->clear_content();
  }
  return project;
}

Result<v1::Project> ProjectBook::Get(std::string_view name) {
  const Result<std::string> id = ParseProjectName(name);
  if (!id) return id.error();
  const auto record = store_.GetProject(*id);
  if (!record) return record.error();
  return ProjectOf(*record);
}

Result<v1::ListProjectsResponse> ProjectBook::List(const v1::ListProjectsRequest& request) {
  const Result<int> size = PageSize(request.page_size(), kProjectPages);
  if (!size) return size.error();
  if (!request.page_token().empty() && !CheckResourceId(request.page_token(), "page_token")) {
    return Error{ErrorCode::kCellBadPageToken, {}, {}};
  }
  const auto records = store_.ListProjects(request.page_token(), *size + 1);
  if (!records) return records.error();
  v1::ListProjectsResponse response;
  for (const storage::ProjectRecord& record : *records) {
    if (response.projects_size() == *size) {
      response.set_next_page_token((*records)[static_cast<std::size_t>(*size) - 1].id);
      break;
    }
    Result<v1::Project> project = ProjectOf(record);
    if (!project) return project.error();
    *response.add_projects() = WithoutContent(*std::move(project));
  }
  return response;
}

ProgramResult<v1::Project> ProjectBook::Update(const v1::UpdateProjectRequest& request,
                                               std::string_view caller) {
  const Result<std::string> id = ParseProjectName(request.project().name());
  if (!id) return id.error();
  const Result<storage::Revision> expected = ParseEtag(request.project().etag());
  if (!expected) return expected.error();
  const auto record = store_.GetProject(*id);
  if (!record) return record.error();
  if (*expected != storage::kAnyRevision && *expected != record->revision) {
    return Error{ErrorCode::kCellEtagMismatch, ProjectName(*id), {}};
  }
  Result<v1::Project> kept = ProjectOf(*record);
  if (!kept) return kept.error();
  v1::Project& project = *kept;
  const v1::Project& wanted = request.project();
  const auto named = FieldsToUpdate(request.update_mask(), wanted, kProjectFields);
  if (!named) return named.error();
  if (named->contains("title")) project.set_title(wanted.title());
  if (named->contains("notes")) project.set_notes(wanted.notes());
  if (named->contains("programs")) *project.mutable_programs() = wanted.programs();
  if (named->contains("laser_schedules"))
    *project.mutable_laser_schedules() = wanted.laser_schedules();
  if (named->contains("processes")) *project.mutable_processes() = wanted.processes();
  if (auto fault = FindFault(project)) return *std::move(fault);
  if (request.validate_only()) return project;
  // Another change between the two is not overwritten.
  const auto stored = store_.PutProject(RecordOf(*id, project), record->revision, caller);
  if (!stored) return stored.error();
  return Whole(*stored);
}

Status ProjectBook::Delete(const v1::DeleteProjectRequest& request, std::string_view caller) {
  const Result<std::string> id = ParseProjectName(request.name());
  if (!id) return id.error();
  const Result<storage::Revision> expected = ParseEtag(request.etag());
  if (!expected) return expected.error();
  return store_.DeleteProject(*id, *expected, caller);
}

}  // namespace rmlcell::server
