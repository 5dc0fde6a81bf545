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

// Of a program or a target: both have a file name and a content.
template <class Text>
Status AddContent(const fs::path& folder, Text& text) {
  if (!text.content().empty() || text.file_name().empty()) return {};
  Result<std::string> bytes = bridge::ReadFile((folder / text.file_name()).string(), kFileBytesMax);
  if (!bytes) return bytes.error();
  text.set_content(*std::move(bytes));
  text.set_file_name(fs::path(text.file_name()).filename().string());
  return {};
}

Status AddContents(const fs::path& folder, v1::Project& project) {
  for (v1::ProjectProgram& program : *project.mutable_programs()) {
    if (const Status added = AddContent(folder, *program.mutable_source()); !added)
      return added.error();
    if (!program.milling().has_target()) continue;
    v1::MillTarget& target = *program.mutable_milling()->mutable_target();
    Status added;
    if (target.has_file()) added = AddContent(folder, *target.mutable_file());
    if (target.has_inline_program()) added = AddContent(folder, *target.mutable_inline_program());
    if (!added) return added;
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
