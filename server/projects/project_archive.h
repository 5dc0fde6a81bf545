#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "rmlcell/v1/project.pb.h"

// A project as one file: a ZIP archive of the folder that the command reads, too (docs/files.md).
// project.json has all but the bytes of programs and targets, which are files beside it.
namespace rmlcell::server {

// Of an archive, and of all that is in one.
inline constexpr std::size_t kProjectBytesMax = std::size_t{64} << 20;

// The name, the etag and the times of the project are left out. Equal projects give equal bytes.
// Errors: CellTooLarge, CellInternal.
Result<std::string> WriteProjectArchive(const v1::Project& project);

// Files that no project names are let be. Errors: CellInvalidArgument for what is no such archive,
// or is damaged; CellTooLarge.
Result<v1::Project> ReadProjectArchive(std::string_view bytes);

}  // namespace rmlcell::server
