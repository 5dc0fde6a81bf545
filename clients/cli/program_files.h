#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clients/cli/machine_choice.h"
#include "engine/simulation/run/rehearsal.h"
#include "proto/bridge/files.h"
#include "proto/bridge/program_stream.h"

namespace rmlcell::cli {

// The largest file that the command reads; the same as a server takes.
inline constexpr std::int64_t kFileBytesMax = std::int64_t{256} << 20;

struct LoadedFiles {
  const machine::MachineFamily* family = nullptr;
  std::vector<simulation::MemoryProgram> programs;
  int main_slot = 0;
  // Of the only program: more of it comes while it runs. Null: all is there.
  std::shared_ptr<const bridge::ProgramStream> stream;
};

// Files and folders given to a local run. Folders bring their numbered programs ("12.S", "44.rml");
// "SLOT=FILE" a program each. The main program is the first file, or `main_slot`.
// An empty file is an error, unless it lies in a folder and only what is needed is read of that:
// the caller tells it when it is. Errors: CellFileUnreadable, CellUnknownFamily,
// CellFamilyUnknownFromName, CellUsage, FamilyInfo::no_slot, CellEmptyProgram.
enum class EmptyInFolders { kRefused, kTaken };
Result<LoadedFiles> LoadFiles(const std::vector<std::string>& files,
                              const std::vector<std::string>& slots, int main_slot,
                              const std::string& family_id,
                              EmptyInFolders empty = EmptyInFolders::kRefused);

// The same of what is run at once: a stream alone is read as it comes; `before_wait` as that of
// ProgramStream.
Result<LoadedFiles> OpenFiles(const std::vector<std::string>& files,
                              const std::vector<std::string>& slots, int main_slot,
                              const std::string& family_id, std::function<void()> before_wait);

// "progs/44.S" -> 44: the name of a program file tells its slot. Nothing: it tells none.
std::optional<int> SlotFromName(const std::filesystem::path& path);

// "44=FILE" -> 44, FILE; "44" -> 44 and nothing. Error: CellUsage.
struct SlotFile {
  std::int64_t number = 0;  // as it is written
  std::string file;

  // Error: FamilyInfo::no_slot unless the number is 1..99.
  Result<int> Slot(const machine::MachineFamily& family) const;

  bool operator==(const SlotFile&) const = default;
};
Result<SlotFile> ParseSlotFile(const std::string& text);

// Without a file what is chosen on the command line. Errors: CellFileUnreadable, CellBadText.
Result<bridge::MachineFile> ReadMachine(const MachineChoice& choice);

// What reports call the machine of that file, and where its figures are from. A file that names
// neither itself nor a profile is called by its own name: nobody said which machine it is.
machine::OwnMachine OwnOf(const MachineChoice& choice, const bridge::MachineFile& machine);

// Who changes parameters of the profile, for people: "mine.toml", "mine.toml and --origin"; empty:
// nobody.
std::string ParametersOf(const MachineChoice& choice);

// The parameters that bring program zero to its place and know of the clamps. Errors: CellUsage for
// a family whose programs set zero themselves or that knows no clamps, and for an origin of other
// than two or three numbers or beyond the travel; those of ReadMachine and of its parameters.
Status PlaceWork(const MachineChoice& choice, const machine::MachineFamily& family,
                 std::map<std::string, std::string>& parameters);

// Writes a file whole or not at all: what stood under this name before is there until the new one
// is on the disk, and keeps its mode. `keeper`: of the bytes, told while they are written. Error:
// CellFileUnwritable.
Status WriteWholeFile(const std::string& path, std::string_view bytes,
                      const machine::BytesKeeper* keeper = nullptr);

// The family by id, or by the file name.
Result<const machine::MachineFamily*> FamilyFor(const std::string& id,
                                                const std::string& file_name);

}  // namespace rmlcell::cli
