#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::v1 {
class ScriptedInput;
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

// Input file: one change a line, "SECONDS WHAT [= VALUE]", # begins a comment:
//   0.5 IL[20] = 1      2.0 START      3.25 OVERRIDE = 55      4 DOOR = OPEN
// Appends to options.inputs. `override_max` as CheckInputValue. Errors: CellBadText with line and
// column.
Status ParseInputFile(std::string_view text, const std::string& name, double override_max,
                      v1::SimulationOptions& options);

// Whether the value of an input can be: logical ones and the door are 0 or 1, the override is
// above 0 to that of the family (percent), numbers are finite. Error: CellInvalidArgument.
Status CheckInputValue(const v1::ScriptedInput& input, double override_max);

// Error: CellInvalidArgument, naming what is allowed: above 0 to `override_max`, percent.
Status CheckOverride(double percent, double override_max);

}  // namespace rmlcell::bridge
