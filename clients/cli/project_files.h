#pragma once

#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/project.pb.h"

namespace rmlcell::cli {

// A project from a JSON file (message Project) or from a folder.
//
// A program or target of the JSON file that has a file name and no content is read from that file,
// which lies beside the JSON file. A folder may hold that file as "project.json"; where it names no
// program, the numbered files of the folder ("12.S", "44.SI") are the programs. Errors:
// CellFileUnreadable, CellBadText (not JSON of a project), CellTooLarge, CellEmptyProgram,
// CellUsage.
Result<v1::Project> ReadProject(const std::string& path);

}  // namespace rmlcell::cli
