#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/editing.h"

// Files beside the one that is edited: "44.S" is program 44 of the same folder, as for `rmlcell
// simulate` (docs/files.md).
namespace rmlcell::lsp {

// As machine::Editing::source_extensions.
using SourceExtensions = std::span<const std::string_view>;

// A called program is a few kilobytes; more is not read to look something up.
inline constexpr std::size_t kProgramBytesMax = std::size_t{4} << 20;
// Names of a folder that are looked at.
inline constexpr std::size_t kFolderEntriesMax = 20'000;

// What the server knows of the disk. Tests and fuzzing bring one of their own.
class ProgramFolder {
 public:
  virtual ~ProgramFolder() = default;
  // Sources with one of these extensions in the folder of `uri` and a name from 1 to 99, by number,
  // those of one number in the order of the extensions. Empty for what is no file.
  virtual std::vector<machine::NumberedFile> Programs(std::string_view uri,
                                                      SourceExtensions extensions) const = 0;
  // Errors: CellFileUnreadable, CellTooLarge.
  virtual Result<std::string> Read(std::string_view uri) const = 0;
};

// The folder on the disk.
class DiskFolder final : public ProgramFolder {
 public:
  std::vector<machine::NumberedFile> Programs(std::string_view uri,
                                              SourceExtensions extensions) const override;
  Result<std::string> Read(std::string_view uri) const override;
};

// "file:///a%20b/12.S" -> "/a b/12.S"; nothing for another scheme or a broken escape.
std::optional<std::string> PathOfUri(std::string_view uri);
std::string UriOfPath(std::string_view path);

// "12.S" of a URI or path, escapes undone; all of it when it has no slash.
std::string FileNameOfUri(std::string_view uri);
// 44 of "dir/44.S" or "044.s"; nothing when the name is no program number.
std::optional<int> ProgramNumberOf(std::string_view uri, SourceExtensions extensions);

}  // namespace rmlcell::lsp
