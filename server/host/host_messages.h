#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/machine/machine.h"
#include "rmlcell/v1/host.pb.h"

// What a machine that lives is told and tells, as messages of the contract and as engine values.
namespace rmlcell::server {

// Without what is the host's: fence, control, factor, times of sending.
v1::MachineStatus ToProto(const machine::Machine& machine);
v1::RunState RunStateOf(const machine::Machine& machine);
v1::LastRun LastRunOf(const v1::RunOver& over);

// What an order does to a machine, one after the other at one instant; nothing for those that ask
// something or are the host's own. Errors: CellInvalidArgument, CellUnimplemented.
Result<std::vector<machine::MachineInput>> InputsOf(const v1::HostOrder& order,
                                                    const machine::Machine& machine);

// What a client asked with it; null: nothing.
const google::protobuf::Message* RequestOf(const v1::HostOrder& order);
// The text of this field of the request; nothing: it has no such field.
std::optional<std::string> FieldOf(const v1::HostOrder& order, const std::string& name);

// All of them, ranges spread out; each with its error where there is no such variable.
Result<v1::ReadVariablesResponse> ReadVariables(const machine::Machine& machine,
                                                const v1::ReadVariablesRequest& request);

}  // namespace rmlcell::server
