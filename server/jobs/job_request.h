#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/family.h"
#include "rmlcell/v1/job.pb.h"

// What a request for a job may say. Errors everywhere: CellInvalidArgument, naming the field.
namespace rmlcell::server {

std::string_view KindName(v1::JobKind kind);  // "CHECK"; empty: none that there is

// Whether it may be a label of a job: 1 to 63 letters, digits, and - _ . : /
bool IsLabel(std::string_view text);

// What can be said of a request without a look at its machine. CellUnimplemented: a field of a
// later version.
Status CheckRequest(const v1::SubmitJobRequest& request);

// The ids of the jobs that it waits for.
Result<std::vector<std::int64_t>> AwaitedJobs(const v1::Job& job);

// FamilyInfo::no_slot for a slot that is none.
Status CheckSimulation(const v1::SimulationOptions& options, const machine::MachineFamily& family);

// Those of a report can be given (Run::ReadVariable) when the run is over.
Status CheckVariables(const v1::SimulationOptions& options, const machine::MachineFamily& family,
                      const machine::Parameters& parameters);

// Of a program that a job brings: its slot, and its file name, which may be of another family.
Status CheckBrought(const v1::Job& job, const std::string& file_name,
                    const machine::MachineFamily& family);

}  // namespace rmlcell::server
