#pragma once

#include "rmlcell/v1/program.pb.h"
#include "server/programs/program_book.h"
#include "storage/store.h"

namespace rmlcell::server {

// The off-line tools that look into the program memory of a machine, or at its parameters. Nothing
// is stored. Thread-safe; blocks on the store, on compilation and on trial runs.
//
// Errors everywhere: CellInvalidArgument for a name that is none, CellUnknownMachine,
// ProgramMissing (7102) for a slot that is empty, CellEmptyProgram; those of a method beyond that
// are listed with it.
class MemoryTools {
 public:
  MemoryTools(storage::Store& store, ProgramBook& programs) : store_(store), programs_(programs) {}

  // Errors: CellBadText for what is no text, CellInvalidArgument for a family whose programs are
  // streams.
  Result<v1::FixProgramResponse> Fix(const v1::FixProgramRequest& request);

  // What stops the link is a finding. Errors: ProgramNumber (7101), CellInvalidArgument for a slot
  // twice, CellUnknownFamily for a machine of a later version.
  Result<v1::LinkProgramResponse> Link(const v1::LinkProgramRequest& request);

  // OPT-1.12 to 1.15. A machine without executables has no stale ones.
  Result<v1::ListStaleExecutablesResponse> ListStale(
      const v1::ListStaleExecutablesRequest& request);

  // The programmer's own text while the object is the one that was made of it. Errors:
  // ObjectCorrupt (7034).
  Result<v1::DecompileProgramResponse> Decompile(const v1::DecompileProgramRequest& request);

  // Errors: the first error of a program, ObjectCorrupt (7034), CellPrecondition for another
  // family.
  ProgramResult<v1::DiffProgramsResponse> Diff(const v1::DiffProgramsRequest& request);

 private:
  struct StoredObject {
    std::string file_name;
    std::string object;
  };
  Result<StoredObject> ObjectOf(const std::string& name);

  storage::Store& store_;
  ProgramBook& programs_;
};

}  // namespace rmlcell::server
