#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::v1 {
class SimulationOptions;
}  // namespace rmlcell::v1

// Readers of the small files that go with a program. The forms are described in docs/files.md.
namespace rmlcell::bridge {

// A file part by part. Errors: CellFileUnreadable; CellTooLarge above `limit` bytes.
Status ReadParts(const std::string& path, std::int64_t limit,
                 const std::function<void(std::string_view)>& part);

// A whole file. Errors: CellFileUnreadable; CellTooLarge above `limit` bytes.
Result<std::string> ReadFile(const std::string& path, std::int64_t limit);

// Machine file (TOML): family, profile, name (or title, as built-in profiles have it), a table
// [parameters], and a table [sources] with where those are from.
struct MachineFile {
  std::string family;
  std::string profile;
  std::string name;
  std::map<std::string, std::string> parameters;
  std::map<std::string, std::string> sources;
};
Result<MachineFile> ParseMachineFile(std::string_view text, const std::string& name);

}  // namespace rmlcell::bridge
