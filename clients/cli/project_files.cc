#include "clients/cli/project_files.h"

#include <google/protobuf/util/json_util.h>

#include <filesystem>
#include <system_error>

#include "clients/cli/program_files.h"
#include "engine/core/units.h"
#include "proto/bridge/files.h"

namespace rmlcell::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kProjectFile = "project.json";

Result<v1::Project> ParseProject(const std::string& file) {
  const Result<std::string> text = bridge::ReadFile(file, kFileBytesMax);
  if (!text) return text.error();
  v1::Project project;
  const auto parsed = google::protobuf::util::JsonStringToMessage(*text, &project);
  if (!parsed.ok())
    return Error{ErrorCode::kCellBadText, file + ": " + std::string(parsed.message()), {}};
  return project;
}

Status AddContents(const fs::path& folder, v1::Project& project) {
  for (v1::ProjectProgram& program : *project.mutable_programs()) {
    v1::ProgramText& source = *program.mutable_source();
    if (!source.content().empty() || source.file_name().empty()) continue;
    Result<std::string> bytes =
        bridge::ReadFile((folder / source.file_name()).string(), kFileBytesMax);
    if (!bytes) return bytes.error();
    source.set_content(*std::move(bytes));
    source.set_file_name(fs::path(source.file_name()).filename().string());
  }
  return {};
}

Status AddNumberedPrograms(const std::string& folder, v1::Project& project) {
  // A project starts none of its programs: which one is the main program does not matter.
  const Result<LoadedFiles> files = LoadFiles({folder}, {}, kSlotMin, {});
  if (!files) return files.error();
  for (const simulation::MemoryProgram& found : files->programs) {
    v1::ProjectProgram& program = *project.add_programs();
    program.set_slot(found.slot);
    program.mutable_source()->set_file_name(fs::path(found.file_name).filename().string());
    program.mutable_source()->set_content(std::string(*found.bytes));
  }
  return {};
}

}  // namespace

Result<v1::Project> ReadProject(const std::string& path) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  const fs::path folder = is_folder ? fs::path(path) : fs::path(path).parent_path();
  const fs::path file = is_folder ? folder / kProjectFile : fs::path(path);
  Result<v1::Project> project = v1::Project();
  if (!is_folder || fs::exists(file, ignored)) project = ParseProject(file.string());
  if (!project) return project.error();
  if (const Status added = AddContents(folder, *project); !added) return added.error();
  if (is_folder && project->programs().empty()) {
    if (const Status added = AddNumberedPrograms(path, *project); !added) return added.error();
  }
  return project;
}

}  // namespace rmlcell::cli
