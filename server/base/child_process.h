#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "engine/core/result.h"

namespace rmlcell::server {

// Error: CellConfiguration when the program is not there.
Status CheckProgram(const std::string& program);

// A process in a group of its own: Ctrl-C at the terminal reaches the server, which stops its
// children in order. Sockets of the server stay with it: a copy in a child would keep a port taken,
// or a connection of a client open, after the server closed it. `secrets`: NAME=VALUE into its
// environment, as the command line can be read by every user of the host. `log`: a file that its
// standard error is added to, of one that outlives the server: it keeps no pipe of the server open.
// Error: CellInternal.
Result<pid_t> StartChild(std::vector<std::string> words, std::vector<std::string> secrets,
                         const std::string& log = {});

}  // namespace rmlcell::server
