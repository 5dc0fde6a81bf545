#pragma once

#include <string>

namespace rmlcell::server {

// "workshop/4711/5f3a09c1": of this process, and of no other one.
std::string NameOfHost();
std::string NameOfComputer();
std::string BootId();  // of the computer, anew with each start of it

}  // namespace rmlcell::server
