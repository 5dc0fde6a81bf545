#pragma once

#include <string>

#include "engine/core/result.h"
#include "rmlcell/v1/language.pb.h"
#include "server/programs/program_book.h"
#include "storage/store.h"

namespace rmlcell::server {

// What an editor asks about a program text that a client has. Nothing is stored or run. What lies
// around the text are the programs and schedules of the machine that the request names; without one
// there is nothing. Thread-safe; blocks on the store.
//
// Errors everywhere: CellInvalidArgument for a name or a place that is none; CellUnknownMachine,
// CellUnknownFamily, CellFamilyUnknownFromName, CellEmptyProgram; CellPrecondition for a family
// whose programs are streams, which nobody writes by hand.
class LanguageTools {
 public:
  LanguageTools(storage::Store& store, ProgramBook& programs)
      : store_(store), programs_(programs) {}

  Result<v1::GetLanguageResponse> Words(const v1::GetLanguageRequest& request);
  Result<v1::HoverResponse> Hover(const v1::HoverRequest& request);
  Result<v1::CompleteResponse> Complete(const v1::CompleteRequest& request);
  Result<v1::FindDefinitionResponse> FindDefinition(const v1::FindDefinitionRequest& request);
  Result<v1::FindReferencesResponse> FindReferences(const v1::FindReferencesRequest& request);
  // CellInvalidArgument for a name that would change what the program does, with the reason.
  Result<v1::RenameResponse> Rename(const v1::RenameRequest& request);
  Result<v1::OutlineResponse> Outline(const v1::OutlineRequest& request);

 private:
  storage::Store& store_;
  ProgramBook& programs_;
};

}  // namespace rmlcell::server
