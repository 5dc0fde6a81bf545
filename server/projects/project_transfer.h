#pragma once

#include <string>
#include <string_view>

#include "rmlcell/v1/project.pb.h"
#include "server/programs/program_result.h"
#include "storage/store.h"

namespace rmlcell::server {

class ProgramBook;
class ProjectBook;

// Projects on their way to and from machines (optimo.md 8.68 to 8.73). Thread-safe; blocks on the
// store and on compilation.
class ProjectTransfer {
 public:
  ProjectTransfer(storage::Store& store, ProjectBook& projects, ProgramBook& programs)
      : store_(store), projects_(projects), programs_(programs) {}

  // Converts, compiles and checks everything in the engine, then stores all programs and schedules
  // in one transaction; on any error nothing is stored (OPT-8.71). Errors: ProjectDuplicate (7861),
  // ProjectSource (7862), CellInvalidArgument for a file of another family, CellEtagMismatch when
  // the machine holds something else than when the etag was given, the first error of the programs.
  ProgramResult<v1::TransferProjectResponse> ToMachine(const v1::TransferProjectRequest& request,
                                                       std::string_view caller);

  // A project of what a machine holds (OPT-8.70). `now`: for the header lines of converted sources.
  // Errors: FamilyInfo::empty_slot and no_slot, FamilyInfo::no_source for a machine without
  // programs, CellTooLarge, CellEtagMismatch when it was changed meanwhile again and again, those
  // of ProjectBook::Create and of the decompiler.
  ProgramResult<v1::Project> FromMachine(const v1::TransferProjectFromMachineRequest& request,
                                         const std::string& now, std::string_view caller);

 private:
  Result<v1::Project> Gather(const storage::MachineRecord& machine,
                             const v1::TransferProjectFromMachineRequest& request,
                             const std::string& now);

  // In units, where they are given: converted where the text has other ones.
  Result<v1::ProgramText> SourceIn(v1::Units units, const std::string& program,
                                   const std::string& now);

  storage::Store& store_;
  ProjectBook& projects_;
  ProgramBook& programs_;
};

}  // namespace rmlcell::server
