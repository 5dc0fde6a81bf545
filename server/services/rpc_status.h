#pragma once

#include <grpcpp/support/status.h>

#include <exception>
#include <string_view>
#include <utility>
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

// CellInternal, for what left the folder of `method` by an exception, which goes to the log alone.
grpc::Status StatusOfThrown(std::string_view method, const std::exception& thrown);

// Runs `work`; what it throws ends the call, by `end(status)`, and nothing else.
template <class Work, class End>
void EndWhereThrown(std::string_view method, Work&& work, End&& end) {
  try {
    work();
  } catch (const std::exception& thrown) {
    end(StatusOfThrown(method, thrown));
  }
}

// The same, to be run later on another thread.
template <class Work, class End>
auto EndingWhereThrown(std::string_view method, Work work, End end) {
  return
      [method, work = std::move(work), end = std::move(end)] { EndWhereThrown(method, work, end); };
}

}  // namespace rmlcell::server
