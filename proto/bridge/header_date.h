#pragma once

#include <string>

namespace rmlcell::bridge {

// "Tue Apr 20 13:37:33 1993": now, in the time zone of this process, as the first lines of the
// off-line tools have it (OPT-8.24, OPT-B.77).
std::string HeaderDate();

}  // namespace rmlcell::bridge
