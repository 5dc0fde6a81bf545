#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rmlcell/v1/worker.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

struct Config;

// Everything that a worker needs for a leased job: a snapshot of the machine's program memory as it
// is now, with the programs that the job brought in their slots.
struct AssignmentMessages {
  v1::WorkResponse first;  // the assignment; the lease is not filled in
  std::vector<std::pair<int, std::shared_ptr<const std::string>>>
      programs;  // those too large for it, by slot; 0: its target
};

// Errors: those of the store, CellUnknownMachine.
Result<AssignmentMessages> MakeAssignment(storage::Store& store, const Config& config,
                                          const storage::LeasedJob& leased);

// The program of a job alone, whole. Errors: as above.
Result<v1::AssignedProgram> ProgramOfJob(storage::Store& store, std::int64_t job);
// What it is as it was handed in, settled.
Result<v1::Job> SpecificationOf(storage::Store& store, std::int64_t job);

}  // namespace rmlcell::server
