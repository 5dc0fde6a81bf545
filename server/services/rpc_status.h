#pragma once

#include <grpcpp/support/status.h>

#include <vector>

#include "engine/core/diagnostic.h"

namespace rmlcell::server {

// The status with google.rpc.Status as its details; findings of a program go along.
grpc::Status ToGrpcStatus(const Error& error, const std::vector<Diagnostic>& diagnostics = {},
                          std::uint64_t dropped = 0);

}  // namespace rmlcell::server
