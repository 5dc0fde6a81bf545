#pragma once

#include <cstdint>
#include <string>

#include "rmlcell/v1/host.pb.h"
#include "server/host/host_process.h"

namespace rmlcell::server {

// "workshop/4711/5f3a09c1b06e77d2": of this process, and of no other one.
std::string NameOfHost();
// How it greets a server. `fence`: of the machine that it has; 0: none, it says what its journal
// knows. `had_job`: that of HostBegin, found there or told again.
v1::HostHello HelloOf(const HostOptions& options, const std::string& name, std::int64_t fence,
                      std::string& had_job);

}  // namespace rmlcell::server
