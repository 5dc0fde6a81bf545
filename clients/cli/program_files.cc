#include "clients/cli/program_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <system_error>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/families/families.h"
#include "engine/machine/shape.h"
#include "proto/bridge/files.h"
#include "proto/bridge/spooled_bytes.h"

namespace rmlcell::cli {
namespace {

namespace fs = std::filesystem;

using bridge::ProgramStream;

Result<simulation::MemoryProgram> ProgramOf(const std::string& file, int slot, bool may_be_empty,
                                            machine::Bytes bytes) {
  if (bytes->empty() && !may_be_empty) return Error{ErrorCode::kCellEmptyProgram, file, {}};
  return simulation::MemoryProgram{.slot = slot,
                                   .name = fs::path(file).stem().string(),
                                   .file_name = file,
                                   .bytes = std::move(bytes),
                                   .is_source = true,
                                   .executable = nullptr};
}

// `before_wait` of nothing: all of it.
Result<ProgramStream::Opened> ReadProgram(const std::string& file,
                                          const std::function<void()>& before_wait) {
  if (before_wait) return ProgramStream::Open(file, kFileBytesMax, before_wait);
  Result<machine::Bytes> bytes = bridge::ReadProgram(file, kFileBytesMax);
  if (!bytes) return bytes.error();
  return ProgramStream::Opened{.bytes = *std::move(bytes)};
}

}  // namespace

std::optional<int> SlotFromName(const fs::path& path) {
  const auto number = ParseInteger(path.stem().string());
  if (!number || !IsSlot(static_cast<int>(std::clamp<long long>(*number, -1, 1000))))
    return std::nullopt;
  return static_cast<int>(*number);
}

Result<bridge::MachineFile> ReadMachine(const MachineChoice& choice) {
  bridge::MachineFile machine;
  if (!choice.file.empty()) {
    const Result<std::string> text = bridge::ReadFile(choice.file, kFileBytesMax);
    if (!text) return text.error();
    Result<bridge::MachineFile> read = bridge::ParseMachineFile(*text, choice.file);
    if (!read) return read.error();
    machine = *std::move(read);
  }
  if (!choice.family.empty()) machine.family = choice.family;
  if (!choice.profile.empty()) machine.profile = choice.profile;
  return machine;
}

machine::OwnMachine OwnOf(const MachineChoice& choice, const bridge::MachineFile& machine) {
  const bool nameless = machine.name.empty() && machine.profile.empty();
  return {.name = nameless ? choice.file : machine.name, .sources = machine.sources};
}

std::string ParametersOf(const MachineChoice& choice) {
  std::string names = choice.file;
  const auto add = [&names](std::string_view name) {
    names += (names.empty() ? "" : " and ") + std::string(name);
  };
  if (!choice.origin.empty()) add("--origin");
  if (choice.clamps_mm) add("--clamps");
  return names;
}

namespace {

Status PlaceOrigin(const std::vector<double>& origin, const machine::MachineFamily& family,
                   std::map<std::string, std::string>& parameters) {
  if (origin.empty()) return {};
  const auto& names = family.info().origin_parameters;
  if (names[0].empty()) {
    return Error{ErrorCode::kCellUsage,
                 "--origin: programs of " + std::string(family.info().title) +
                     " set their work offset themselves",
                 {}};
  }
  if (origin.size() < 2 || origin.size() > names.size())
    return Error{ErrorCode::kCellUsage, "--origin: give X,Y or X,Y,Z in mm", {}};
  for (std::size_t axis = 0; axis < origin.size(); ++axis)
    parameters[std::string(names[axis])] = ShortestText(origin[axis]);
  return {};
}

// Nobody can set it elsewhere on the panel.
Status CheckOnTravel(const MachineChoice& choice, const machine::MachineFamily& family,
                     const std::map<std::string, std::string>& parameters) {
  if (choice.origin.empty()) return {};
  const Result<bridge::MachineFile> machine = ReadMachine(choice);
  if (!machine) return machine.error();
  const auto made = machine::MakeParameters(family, machine->profile, parameters);
  if (!made) return made.error();
  const machine::Box travel = family.Shape(*made).travel;
  if (travel.empty()) return {};
  for (std::size_t axis = 0; axis < choice.origin.size(); ++axis) {
    const auto of_point = static_cast<Eigen::Index>(axis);
    const double low = travel.min[of_point];
    const double high = travel.max[of_point];
    if (choice.origin[axis] >= low && choice.origin[axis] <= high) continue;
    return Error{ErrorCode::kCellUsage,
                 std::string("--origin: ") + "XYZ"[axis] + " " +
                     TrimmedText(choice.origin[axis], 3) + " is beyond the travel, which is from " +
                     TrimmedText(low, 3) + " to " + TrimmedText(high, 3) + " mm",
                 {}};
  }
  return {};
}

}  // namespace

Status PlaceWork(const MachineChoice& choice, const machine::MachineFamily& family,
                 std::map<std::string, std::string>& parameters) {
  if (const Status placed = PlaceOrigin(choice.origin, family, parameters); !placed)
    return placed.error();
  if (const Status on_travel = CheckOnTravel(choice, family, parameters); !on_travel)
    return on_travel.error();
  if (!choice.clamps_mm) return {};
  const std::string_view name = family.info().clamps_parameter;
  if (name.empty()) {
    return Error{ErrorCode::kCellUsage,
                 "--clamps: a " + std::string(family.info().title) + " knows of no clamps",
                 {}};
  }
  parameters[std::string(name)] = ShortestText(*choice.clamps_mm);
  return {};
}

namespace {

// Where a link leads, also to a file that is still to be made.
fs::path TargetOf(fs::path path) {
  constexpr int kLinksMax = 40;
  std::error_code ignored;
  for (int n = 0; n < kLinksMax && fs::is_symlink(path, ignored); ++n)
    path = path.parent_path() / fs::read_symlink(path, ignored);
  return path;
}

}  // namespace

Status WriteWholeFile(const std::string& path, std::string_view bytes,
                      const machine::BytesKeeper* keeper) {
  const auto failed = [&](int error) {
    return Error{
        ErrorCode::kCellFileUnwritable, path + ": " + std::generic_category().message(error), {}};
  };
  std::error_code ignored;
  // Into a pipe or a device as it is; a link stays a link.
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) {
    std::ofstream to(path, std::ios::binary);
    to.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    to.flush();
    return to ? Status() : failed(errno);
  }
  const std::string target = TargetOf(path).string();
  if (fs::is_symlink(target, ignored)) return failed(ELOOP);
  std::string temporary = target + ".XXXXXX";
  const int file = mkstemp(temporary.data());
  if (file < 0) return failed(errno);
  struct stat before {};
  const mode_t mask = umask(0);
  umask(mask);
  const mode_t mode = stat(target.c_str(), &before) == 0 ? before.st_mode & 07777U : 0666U & ~mask;
  bool good = fchmod(file, mode) == 0;
  while (good && !bytes.empty()) {
    const ssize_t written =
        write(file, bytes.data(), std::min(bytes.size(), machine::kReleaseEvery));
    good = written > 0;
    if (keeper != nullptr) keeper->Release();
    if (good) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  good = good && fsync(file) == 0;
  int error = errno;
  good = close(file) == 0 && good;
  if (good && std::rename(temporary.c_str(), target.c_str()) == 0) return {};
  if (good) error = errno;
  unlink(temporary.c_str());
  return failed(error);
}

Result<const machine::MachineFamily*> FamilyFor(const std::string& id,
                                                const std::string& file_name) {
  if (!id.empty()) {
    if (const machine::MachineFamily* family = families::FindFamily(id)) return family;
    return families::UnknownFamily(id);
  }
  if (const machine::MachineFamily* family = families::FamilyOfFileName(file_name)) return family;
  std::error_code ignored;
  if (fs::is_directory(file_name, ignored))
    return Error{ErrorCode::kCellUsage, "'" + file_name + "' is a directory: give its files", {}};
  return Error{ErrorCode::kCellFamilyUnknownFromName, "'" + file_name + "': give --family", {}};
}

Result<int> SlotFile::Slot(const machine::MachineFamily& family) const {
  if (number >= kSlotMin && number <= kSlotMax) return static_cast<int>(number);
  return Error{family.info().no_slot, "program number is " + std::to_string(number), {}};
}

Result<SlotFile> ParseSlotFile(const std::string& text) {
  const std::size_t equals = text.find('=');
  const auto number = ParseInteger(text.substr(0, equals));
  if (!number) return Error{ErrorCode::kCellUsage, "'" + text + "': write 44=FILE", {}};
  return SlotFile{*number, equals == std::string::npos ? std::string() : text.substr(equals + 1)};
}

namespace {

struct FoundFiles {
  std::vector<std::pair<int, std::string>> files;  // slot 0: to be chosen
  std::set<std::string> in_folders;
  const machine::MachineFamily* family = nullptr;  // of the first of them; null: none yet
  std::string first{};                             // file among the arguments
};

// A folder may hold programs of several machines: only those of the family of the first file count.
void AddFolder(const std::string& folder, FoundFiles& found) {
  std::error_code error;
  std::vector<fs::path> inside;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    inside.push_back(entry.path());
  std::ranges::sort(inside);
  for (const fs::path& path : inside) {
    const auto slot = SlotFromName(path);
    const machine::MachineFamily* family = families::FamilyOfFileName(path.string());
    const bool fits = family != nullptr && (found.family == nullptr || family == found.family);
    if (!slot || !fits || !fs::is_regular_file(path, error)) continue;
    found.family = family;
    // The main program may lie in the folder, too.
    const bool again = std::ranges::any_of(found.files, [&](const auto& one) {
      return one.first == *slot && fs::equivalent(one.second, path, error);
    });
    if (again) continue;
    found.files.emplace_back(*slot, path.string());
    found.in_folders.insert(path.string());
  }
}

// What --slot names: 44=FILE.
Status AddNamed(const std::string& text, FoundFiles& found) {
  const Result<SlotFile> named = ParseSlotFile(text);
  if (!named) return named.error();
  if (named->file.empty()) return Error{ErrorCode::kCellUsage, "'" + text + "': write 44=FILE", {}};
  const machine::MachineFamily* family = found.family;
  if (family == nullptr) family = families::FamilyOfFileName(named->file);
  if (family == nullptr)
    family = families::FamilyWithTools({}).value();  // a name that says nothing
  const Result<int> slot = named->Slot(*family);
  if (!slot) return slot.error();
  found.files.emplace_back(*slot, named->file);
  return {};
}

// Each as it is named, in order. Errors: CellUsage; CellUnknownFamily.
Result<FoundFiles> Find(const std::vector<std::string>& files,
                        const std::vector<std::string>& slots, const std::string& family_id) {
  FoundFiles found;
  std::error_code ignored;
  const auto named_file = std::ranges::find_if(
      files, [&](const std::string& file) { return !fs::is_directory(file, ignored); });
  if (!family_id.empty() || named_file != files.end()) {
    const auto family =
        FamilyFor(family_id, named_file != files.end() ? *named_file : std::string());
    if (!family) return family.error();
    found.family = *family;
  }
  for (const std::string& file : files) {
    std::error_code error;
    if (!fs::is_directory(file, error)) {
      if (found.first.empty()) found.first = file;
      found.files.emplace_back(SlotFromName(file).value_or(0), file);
      continue;
    }
    AddFolder(file, found);
  }
  for (const std::string& text : slots) {
    if (const Status added = AddNamed(text, found); !added) return added.error();
  }
  if (found.files.empty())
    return Error{
        ErrorCode::kCellUsage, "no program: give a file, or a folder with files like 12.S", {}};
  return found;
}

Result<LoadedFiles> Load(FoundFiles found, int main_slot, const std::string& family_id,
                         EmptyInFolders empty, std::function<void()> before_wait) {
  std::map<int, std::string> used;
  for (auto& [slot, file] : found.files) {
    if (slot == 0 && file == found.first) slot = main_slot;  // 0: none is asked for
    const auto [row, is_new] = used.emplace(slot, file);
    if (!is_new && slot != 0) {
      return Error{ErrorCode::kCellUsage,
                   "program " + std::to_string(slot) + " comes from two files: " + row->second +
                       " and " + file,
                   {}};
    }
  }
  LoadedFiles loaded;
  if (found.family == nullptr) {
    const auto family = FamilyFor(family_id, found.files.front().second);
    if (!family) return family.error();
    found.family = *family;
  }
  loaded.family = found.family;
  const bool one_stream = found.files.size() == 1 && found.family->tools() == nullptr;
  if (!one_stream) before_wait = nullptr;
  int free_slot = 1;
  for (auto& [slot, file] : found.files) {
    if (slot == 0) {
      while (used.contains(free_slot) || free_slot == main_slot) ++free_slot;
      slot = free_slot++;
    }
    if (!IsSlot(slot))
      return Error{found.family->info().no_slot, "program number is " + std::to_string(slot), {}};
    auto opened = ReadProgram(file, before_wait);
    if (!opened) return opened.error();
    loaded.stream = std::move(opened->stream);
    auto program =
        ProgramOf(file, slot, empty == EmptyInFolders::kTaken && found.in_folders.contains(file),
                  std::move(opened->bytes));
    if (!program) return program.error();
    if (file == found.first) loaded.main_slot = slot;
    loaded.programs.push_back(std::move(*program));
  }
  if (main_slot > 0) loaded.main_slot = main_slot;
  if (loaded.main_slot == 0 && loaded.programs.size() == 1)
    loaded.main_slot = loaded.programs.front().slot;
  if (loaded.main_slot == 0) {
    return Error{
        ErrorCode::kCellUsage, "several programs: say which one is started, such as --main 12", {}};
  }
  return loaded;
}

}  // namespace

Result<LoadedFiles> LoadFiles(const std::vector<std::string>& files,
                              const std::vector<std::string>& slots, int main_slot,
                              const std::string& family_id, EmptyInFolders empty) {
  auto found = Find(files, slots, family_id);
  if (!found) return found.error();
  return Load(*std::move(found), main_slot, family_id, empty, nullptr);
}

Result<LoadedFiles> OpenFiles(const std::vector<std::string>& files,
                              const std::vector<std::string>& slots, int main_slot,
                              const std::string& family_id, std::function<void()> before_wait) {
  auto found = Find(files, slots, family_id);
  if (!found) return found.error();
  return Load(*std::move(found), main_slot, family_id, EmptyInFolders::kRefused,
              std::move(before_wait));
}

}  // namespace rmlcell::cli
