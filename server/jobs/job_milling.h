#pragma once

#include <string_view>

#include "engine/machine/family.h"
#include "engine/machine/shape.h"
#include "rmlcell/v1/job.pb.h"
#include "storage/store.h"

namespace rmlcell::server {

struct Config;

// Block, tool and target of a job that is submitted. Those of a project are put into the job, so
// that the project may change while it waits; the bytes of a target become an attachment of `made`
// and leave the job. Errors: CellInvalidArgument with the field; those of bridge::CheckTarget;
// CellTooLarge; FamilyInfo::empty_slot; CellNotFound where the project has no block and tool for
// the slot of the job. Precondition: the program of the job has been looked at.
Status SettleMilling(storage::Store& store, const Config& config,
                     const machine::MachineFamily& family, const machine::MachineShape& shape,
                     storage::NewJob& made, v1::Job& job);

// The name under which the target of a job is kept with it.
inline constexpr std::string_view kTargetAttachment = "target";

}  // namespace rmlcell::server
