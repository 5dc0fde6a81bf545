#pragma once

#include <grpcpp/support/status.h>

#include <vector>

#include "engine/core/diagnostic.h"
#include "server/programs/program_result.h"

namespace rmlcell::server {

// The status with google.rpc.Status as its details; findings of a program go along.
grpc::Status ToGrpcStatus(const Error& error, const std::vector<Diagnostic>& diagnostics = {},
                          UntoldFindings dropped = {});
inline grpc::Status ToGrpcStatus(const ProgramError& wrong) {
  return ToGrpcStatus(wrong.error, wrong.diagnostics, wrong.dropped);
}

}  // namespace rmlcell::server
