#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/project_files.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/terminal.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "proto/bridge/files.h"
#include "rmlcell/v1/project.grpc.pb.h"

namespace rmlcell::cli {
namespace {

constexpr std::size_t kArchiveChunkBytes = 512 << 10;

std::string ModeText(v1::LaserMode mode) { return mode == v1::LASER_MODE_PULSE ? "PULSE" : "CW"; }

}  // namespace

int Projects(const Remote& remote) {
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  std::vector<std::vector<std::string>> rows = {
      {"PROJECT", "TITLE", "PROGRAMS", "SCHEDULES", "PROCESSES"}};
  v1::ListProjectsRequest request;
  do {
    grpc::ClientContext context;
    Prepare(context);
    v1::ListProjectsResponse response;
    const grpc::Status status = stub->ListProjects(&context, request, &response);
    if (!status.ok()) return Refused(status, remote);
    for (const v1::Project& project : response.projects()) {
      if (remote.json) Print(Json(project));
      rows.push_back({project.name().substr(9), project.title(),
                      std::to_string(project.programs_size()),
                      std::to_string(project.laser_schedules_size()),
                      std::to_string(project.processes_size())});
    }
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  if (!remote.json) PrintRaw(Table(std::move(rows)));
  return kGood;
}

namespace {

// What is in a project; the texts of its programs come with --json.
void PrintProject(const v1::Project& project) {
  Print(project.name() + "  " + Visible(project.title()));
  if (!project.notes().empty()) Print(Visible(project.notes()));
  std::vector<std::vector<std::string>> programs = {{"SLOT", "TITLE", "FILE", "UNITS", "SIZE"}};
  for (const v1::ProjectProgram& program : project.programs()) {
    programs.push_back({std::to_string(program.slot()), program.title(),
                        program.source().file_name(),
                        program.units() == v1::UNITS_UNSPECIFIED
                            ? "-"
                            : LowerCase(v1::Units_Name(program.units()).substr(6)),
                        Bytes(static_cast<std::int64_t>(program.source().content().size()))});
  }
  if (programs.size() > 1) PrintRaw("\n" + Table(std::move(programs)));
  std::vector<std::vector<std::string>> schedules = {{"SCHEDULE", "TITLE", "MODE", "POWER %"}};
  for (const v1::ProjectLaserSchedule& schedule : project.laser_schedules()) {
    schedules.push_back({std::to_string(schedule.number()), schedule.title(),
                         ModeText(schedule.mode()), ShortestText(schedule.power_percent())});
  }
  if (schedules.size() > 1) PrintRaw("\n" + Table(std::move(schedules)));
  std::vector<std::vector<std::string>> processes = {{"WORKDEF", "VALUES", "NOTE"}};
  for (const v1::ProjectProcess& process : project.processes()) {
    std::string values;
    for (const double value : process.values())
      values += (values.empty() ? "" : ", ") + ShortestText(value);
    processes.push_back({std::to_string(process.kind()) + "," + std::to_string(process.process()),
                         std::move(values), process.note()});
  }
  if (processes.size() > 1) PrintRaw("\n" + Table(std::move(processes)));
}

}  // namespace

int GetProject(const Remote& remote, const std::string& project) {
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::GetProjectRequest request;
  request.set_name(FullName("projects", project));
  v1::Project response;
  const grpc::Status status = stub->GetProject(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    Print(Json(response));
    return kGood;
  }
  PrintProject(response);
  return kGood;
}

namespace {

int Stored(const Remote& remote, const grpc::Status& status, const v1::Project& project,
           std::string_view what) {
  if (!status.ok()) return Refused(status, remote);
  Print(remote.json ? Json(project) : project.name() + " " + std::string(what));
  return kGood;
}

}  // namespace

int CreateProject(const Remote& remote, const std::string& project, const std::string& path) {
  Result<v1::Project> made = ReadProject(path);
  if (!made) return Refuse(made.error());
  v1::CreateProjectRequest request;
  request.set_project_id(project);
  *request.mutable_project() = *std::move(made);
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::Project response;
  return Stored(remote, stub->CreateProject(&context, request, &response), response, "made");
}

int UpdateProject(const Remote& remote, const std::string& project, const std::string& path) {
  Result<v1::Project> changed = ReadProject(path);
  if (!changed) return Refuse(changed.error());
  v1::UpdateProjectRequest request;
  *request.mutable_project() = *std::move(changed);
  request.mutable_project()->set_name(FullName("projects", project));
  request.mutable_update_mask()->add_paths(
      "*");  // what the file lacks is not in the project any more
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::Project response;
  return Stored(remote, stub->UpdateProject(&context, request, &response), response, "updated");
}

int DeleteProject(const Remote& remote, const std::string& project) {
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::DeleteProjectRequest request;
  request.set_name(FullName("projects", project));
  google::protobuf::Empty response;
  const grpc::Status status = stub->DeleteProject(&context, request, &response);
  return status.ok() ? int{kGood} : Refused(status, remote);
}

namespace {

std::string_view ChangeText(v1::TransferChange change) {
  switch (change) {
    case v1::TRANSFER_CHANGE_ADD:
      return "new";
    case v1::TRANSFER_CHANGE_REPLACE:
      return "replaced";
    case v1::TRANSFER_CHANGE_SAME:
      return "the same as before";
    default:
      return "stored";
  }
}

// "machines/optimo-1/programs/45 replaced: coaster, object 296 B, was 280 B".
std::string ItemText(const v1::TransferItem& item) {
  std::string text = item.name() + " " + std::string(ChangeText(item.change())) + ": ";
  if (item.has_laser_schedule_after()) {
    const auto schedule = [](const v1::LaserSchedule& one) {
      return (one.title().empty() ? "" : Visible(one.title()) + ", ") + ModeText(one.mode()) + " " +
             ShortestText(one.power_percent()) + " %";
    };
    text += schedule(item.laser_schedule_after());
    if (item.change() == v1::TRANSFER_CHANGE_REPLACE)
      text += ", was " + schedule(item.laser_schedule_before());
    return text;
  }
  const v1::Program& after = item.program_after();
  if (!after.title().empty()) text += Visible(after.title()) + ", ";
  text += "object " + Bytes(after.object_bytes());
  if (item.change() == v1::TRANSFER_CHANGE_REPLACE)
    text += ", was " + Bytes(item.program_before().object_bytes());
  return text;
}

}  // namespace

int TransferProject(const Remote& remote, const std::string& project, const std::string& machine,
                    bool insert, bool check_only) {
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::TransferProjectRequest request;
  request.set_name(FullName("projects", project));
  request.set_machine(FullName("machines", machine));
  request.set_insert_missing_definitions(insert);
  request.set_validate_only(check_only);
  v1::TransferProjectResponse response;
  const grpc::Status status = stub->TransferProject(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    Print(Json(response));
    return kGood;
  }
  PrintProgramFindings(response.findings());
  for (const v1::TransferItem& item : response.items()) Print(ItemText(item));
  Print(check_only ? "nothing was stored: --check-only" : "all of it is stored");
  return kGood;
}

int TakeProject(const Remote& remote, const std::string& project, const std::string& machine,
                const std::vector<int>& slots, bool inch) {
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::TransferProjectFromMachineRequest request;
  request.set_machine(FullName("machines", machine));
  request.set_project_id(project);
  *request.mutable_slots() = {slots.begin(), slots.end()};
  if (inch) request.set_units(v1::UNITS_INCH);
  v1::Project response;
  return Stored(remote, stub->TransferProjectFromMachine(&context, request, &response), response,
                "made of what " + machine + " holds");
}

int ExportProject(const Remote& remote, const std::string& project, const std::string& output) {
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::ExportProjectRequest request;
  request.set_name(FullName("projects", project));
  const auto reader = stub->ExportProject(&context, request);
  std::string archive;
  v1::ExportProjectResponse part;
  while (reader->Read(&part)) archive += part.chunk();
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return Refused(status, remote);
  if (output == "-") {
    PrintRaw(archive);
    return kGood;
  }
  const std::string file =
      output.empty() ? request.name().substr(request.name().rfind('/') + 1) + ".zip" : output;
  if (const Status written = WriteWholeFile(file, archive); !written)
    return Refuse(written.error());
  if (!remote.json) Print(request.name() + " is in " + file);
  return kGood;
}

int ImportProject(const Remote& remote, const std::string& project, const std::string& file) {
  const Result<std::string> archive = bridge::ReadFile(file, kFileBytesMax);
  if (!archive) return Refuse(archive.error());
  const auto stub = v1::ProjectService::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::Project response;
  const auto writer = stub->ImportProject(&context, &response);
  v1::ImportProjectRequest message;
  message.set_project_id(project);
  bool open = writer->Write(message);
  for (std::size_t sent = 0; open && sent < archive->size(); sent += kArchiveChunkBytes) {
    message.set_chunk(archive->substr(sent, kArchiveChunkBytes));
    open = writer->Write(message);
  }
  writer->WritesDone();
  return Stored(remote, writer->Finish(), response, "made");
}

}  // namespace rmlcell::cli
