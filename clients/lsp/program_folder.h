#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"

// Files beside the one that is edited: "44.S" is program 44 of the same folder, as for `rmlcell
// simulate` (docs/files.md).
namespace rmlcell::lsp {

// A file of a folder whose name is a program number.
struct NumberedFile {
  int number = 0;
  std::string uri;

  bool operator==(const NumberedFile&) const = default;
};

// A called program is a few kilobytes; more is not read to look something up.
inline constexpr std::size_t kProgramBytesMax = std::size_t{4} << 20;
// Names of a folder that are looked at.
inline constexpr std::size_t kFolderEntriesMax = 20'000;

// What the server knows of the disk. Tests and fuzzing bring one of their own.
class ProgramFolder {
 public:
  virtual ~ProgramFolder() = default;
  // Sources of the Optimo (.S, .SI, .CMP) in the folder of `uri` with a name from 1 to 99, by
  // number, .S before .SI before .CMP. Empty for what is no file.
  virtual std::vector<NumberedFile> Programs(std::string_view uri) const = 0;
  // Errors: CellFileUnreadable, CellTooLarge.
  virtual Result<std::string> Read(std::string_view uri) const = 0;
};

// The folder on the disk.
class DiskFolder final : public ProgramFolder {
 public:
  std::vector<NumberedFile> Programs(std::string_view uri) const override;
  Result<std::string> Read(std::string_view uri) const override;
};

// "file:///a%20b/12.S" -> "/a b/12.S"; nothing for another scheme or a broken escape.
std::optional<std::string> PathOfUri(std::string_view uri);
std::string UriOfPath(std::string_view path);

// "12.S" of a URI or path, escapes undone; all of it when it has no slash.
std::string FileNameOfUri(std::string_view uri);
// 44 of "dir/44.S" or "044.s"; nothing when the name is no program number.
std::optional<int> ProgramNumberOf(std::string_view uri);

}  // namespace rmlcell::lsp
