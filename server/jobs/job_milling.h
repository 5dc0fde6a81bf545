#pragma once

#include "engine/machine/shape.h"
#include "rmlcell/v1/job.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

// Block and tool of a job that is submitted. Those of a project are put into the job, so that the
// project may change while it waits. Errors: CellInvalidArgument with the field; CellNotFound where
// the project has no block and tool for the slot of the job. Precondition: the program of the job
// has been looked at.
Status SettleMilling(storage::Store& store, const machine::MachineShape& shape, v1::Job& job);

}  // namespace rmlcell::server
