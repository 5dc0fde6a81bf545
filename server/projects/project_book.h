#pragma once

#include <string_view>

#include "rmlcell/v1/project.pb.h"
#include "server/programs/program_book.h"
#include "storage/store.h"

namespace rmlcell::server {

// A project as lists have it: the bytes of its programs may be megabytes.
v1::Project WithoutContent(v1::Project project);

// Projects: kept as one record each. Thread-safe; blocks on the store.
class ProjectBook {
 public:
  explicit ProjectBook(storage::Store& store) : store_(store) {}

  // Errors: ProgramNumber (7101), ProjectDuplicate (7861), ProjectSource (7862), ScheduleRange,
  // those of process definitions (7402, 7403, 7004, 7019; OPT-3.01 to 3.08), CellAlreadyExists;
  // CellInvalidArgument, also for a program in UNITS_METRIC whose name says inch (OPT-8.72); those
  // of bridge::CheckTarget.
  ProgramResult<v1::Project> Create(const v1::CreateProjectRequest& request,
                                    std::string_view caller);
  Result<v1::Project> Get(std::string_view name);
  Result<v1::ListProjectsResponse> List(const v1::ListProjectsRequest& request);
  // Errors: as Create, CellEtagMismatch.
  ProgramResult<v1::Project> Update(const v1::UpdateProjectRequest& request,
                                    std::string_view caller);
  Status Delete(const v1::DeleteProjectRequest& request, std::string_view caller);

 private:
  storage::Store& store_;
};

}  // namespace rmlcell::server
