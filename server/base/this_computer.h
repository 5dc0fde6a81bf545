#pragma once

#include <string>

namespace rmlcell::server {

std::string NameOfComputer();  // empty: it has none
// Eight hexadecimal digits, anew with each start of the computer; empty: not known.
std::string NameOfBoot();

}  // namespace rmlcell::server
