#include <unistd.h>

#include <filesystem>

#include "clients/cli/findings_text.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/terminal.h"
#include "clients/cli/verdict_text.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/families/families.h"
#include "proto/bridge/files.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/setup.h"
#include "proto/bridge/sha256.h"
#include "rmlcell/v1/machine.grpc.pb.h"
#include "rmlcell/v1/program.grpc.pb.h"

namespace rmlcell::cli {
namespace {

constexpr std::size_t kUnaryBytes = 3 << 20;
constexpr std::size_t kChunkBytes = 512 << 10;

std::string ProgramName(const std::string& machine, int slot) {
  return FullName("machines", machine) + "/programs/" + std::to_string(slot);
}

int PrintStored(const Remote& remote, const v1::Program& program, bool check_only) {
  if (remote.json) {
    Print(Json(program));
    return kGood;
  }
  PrintProgramFindings(program.findings());
  const auto slot = ParseInteger(program.name().substr(program.name().rfind('/') + 1));
  const bool executable = slot && *slot > kExecutableOffset;
  Print(program.name() + (check_only ? " would be stored: " : " stored: ") +
        (program.title().empty() && slot ? "slot " + std::to_string(*slot)
                                         : Visible(program.title())) +
        (executable ? ", executable " + Bytes(program.executable_bytes())
                    : ", object " + Bytes(program.object_bytes())));
  return kGood;
}

grpc::Status Upload(v1::ProgramService::Stub& stub, const v1::UploadProgramRequest::Header& header,
                    const std::string& bytes, v1::Program& program) {
  grpc::ClientContext context;
  const auto writer = stub.UploadProgram(&context, &program);
  v1::UploadProgramRequest message;
  *message.mutable_header() = header;
  bool open = writer->Write(message);
  for (std::size_t sent = 0; open && sent < bytes.size(); sent += kChunkBytes) {
    message.set_chunk(bytes.substr(sent, kChunkBytes));
    open = writer->Write(message);
  }
  writer->WritesDone();
  return writer->Finish();
}

}  // namespace

int Machines(const Remote& remote) {
  const auto stub = v1::MachineService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::ListMachinesResponse response;
  const grpc::Status status = stub->ListMachines(&context, {}, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    for (const v1::Machine& machine : response.machines()) Print(Json(machine));
    return kGood;
  }
  std::vector<std::vector<std::string>> rows = {{"MACHINE", "FAMILY", "PROFILE", "TITLE"}};
  for (const v1::Machine& machine : response.machines()) {
    rows.push_back({machine.name().substr(9), machine.family(),
                    machine.profile().empty() ? "-" : machine.profile(), machine.title()});
  }
  PrintRaw(Table(rows));
  return kGood;
}

int Programs(const Remote& remote, const std::string& machine) {
  const auto stub = v1::ProgramService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::ListProgramsRequest request;
  request.set_parent(FullName("machines", machine));
  v1::ListProgramsResponse response;
  const grpc::Status status = stub->ListPrograms(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    for (const v1::Program& program : response.programs()) Print(Json(program));
    return kGood;
  }
  std::vector<std::vector<std::string>> rows = {
      {"SLOT", "TITLE", "SOURCE", "OBJECT", "EXECUTABLE", "ETAG"}};
  for (const v1::Program& program : response.programs()) {
    rows.push_back(
        {program.name().substr(program.name().rfind('/') + 1), program.title(),
         program.file_name().empty() ? "-" : program.file_name(), Bytes(program.object_bytes()),
         program.has_executable_bytes() ? Bytes(program.executable_bytes()) : "-", program.etag()});
  }
  PrintRaw(Table(rows));
  return kGood;
}

int PutProgram(const Remote& remote, const std::string& machine, int slot, const std::string& file,
               const PutOptions& options) {
  const Result<std::string> bytes = bridge::ReadFile(file, kFileBytesMax);
  if (!bytes) return Refuse(bytes.error());
  const auto stub = v1::ProgramService::NewStub(Connect(remote));
  const std::string base = std::filesystem::path(file).filename().string();
  v1::Program program;
  grpc::Status status;
  if (bytes->size() <= kUnaryBytes) {
    grpc::ClientContext context;
    Prepare(context);
    v1::PutProgramRequest request;
    request.set_name(ProgramName(machine, slot));
    request.mutable_program()->set_file_name(bridge::Utf8(base));
    request.mutable_program()->set_content(*bytes);
    request.set_etag(options.etag);
    request.set_validate_only(options.check_only);
    request.set_force(options.force);
    status = stub->PutProgram(&context, request, &program);
  } else {
    v1::UploadProgramRequest::Header header;
    header.set_name(ProgramName(machine, slot));
    header.set_file_name(bridge::Utf8(base));
    header.set_etag(options.etag);
    header.set_size(static_cast<std::int64_t>(bytes->size()));
    header.set_sha256(bridge::Sha256Hex(*bytes));
    header.set_validate_only(options.check_only);
    header.set_force(options.force);
    status = Upload(*stub, header, *bytes, program);
  }
  if (!status.ok()) return Refused(status, remote);
  return PrintStored(remote, program, options.check_only);
}

namespace {

// What is asked for: by name, by the extension of the file, else text.
v1::ProgramForm FormOf(const std::string& form, const std::string& output) {
  if (form == "object") return v1::PROGRAM_FORM_OBJECT;
  if (form == "executable") return v1::PROGRAM_FORM_EXECUTABLE;
  if (form == "listing") return v1::PROGRAM_FORM_LISTING;
  if (form.empty() && families::IsObjectFileName(output)) return v1::PROGRAM_FORM_OBJECT;
  return v1::PROGRAM_FORM_SOURCE;
}

bool IsText(v1::ProgramForm form) {
  return form == v1::PROGRAM_FORM_SOURCE || form == v1::PROGRAM_FORM_LISTING;
}

}  // namespace

int GetProgram(const Remote& remote, const std::string& machine, int slot, const std::string& form,
               const std::string& output) {
  const auto stub = v1::ProgramService::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::DownloadProgramRequest request;
  request.set_name(ProgramName(machine, slot));
  request.set_form(FormOf(form, output));
  const auto reader = stub->DownloadProgram(&context, request);
  std::string bytes;
  v1::DownloadProgramResponse part;
  bool text = true;
  while (reader->Read(&part)) {
    if (part.has_header()) text = IsText(part.header().form());
    bytes += part.chunk();
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return Refused(status, remote);
  if (output.empty() && !text && isatty(STDOUT_FILENO) != 0) {
    return Refuse({ErrorCode::kCellUsage,
                   "these bytes are no text for a terminal: give -o FILE, or -o - all the same",
                   {}});
  }
  if (output.empty() || output == "-") {
    PrintRaw(bytes);
    return kGood;
  }
  if (const Status written = WriteWholeFile(output, bytes); !written)
    return Refuse(written.error());
  return kGood;
}

int DeleteProgram(const Remote& remote, const std::string& machine, int slot) {
  const auto stub = v1::ProgramService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::DeleteProgramRequest request;
  request.set_name(ProgramName(machine, slot));
  google::protobuf::Empty response;
  const grpc::Status status = stub->DeleteProgram(&context, request, &response);
  return status.ok() ? int{kGood} : Refused(status, remote);
}

int StaleExecutables(const Remote& remote, const std::string& machine) {
  const auto stub = v1::ProgramService::NewStub(Connect(remote));
  grpc::ClientContext context;
  Prepare(context);
  v1::ListStaleExecutablesRequest request;
  request.set_parent(FullName("machines", machine));
  v1::ListStaleExecutablesResponse response;
  const grpc::Status status = stub->ListStaleExecutables(&context, request, &response);
  if (!status.ok()) return Refused(status, remote);
  if (remote.json) {
    for (const v1::StaleExecutable& stale : response.executables()) Print(Json(stale));
    return kGood;
  }
  if (response.executables().empty()) {
    Print("every executable is what a new link would give");
    return kGood;
  }
  const auto number = [](const std::string& name) { return name.substr(name.rfind('/') + 1); };
  std::vector<std::vector<std::string>> rows = {{"EXECUTABLE", "BECAUSE OF", "WHY"}};
  for (const v1::StaleExecutable& stale : response.executables()) {
    for (const v1::StaleExecutable::Part& part : stale.parts()) {
      rows.push_back({number(stale.name()), number(part.program()), part.text()});
    }
  }
  PrintRaw(Table(rows));
  return kGood;
}

}  // namespace rmlcell::cli
