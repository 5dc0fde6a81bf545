#pragma once

#include <string>

#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// "workshop/4711/5f3a09c1": of this process, and of no other one.
std::string NameOfHost();
void AddComputer(v1::HostHello& hello);  // that this process runs on

}  // namespace rmlcell::server
