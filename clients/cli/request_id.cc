#include "clients/cli/request_id.h"

#include <cstdio>
#include <random>

namespace rmlcell::cli {

std::string NewRequestId() {
  std::random_device device;
  std::string id;
  for (int i = 0; i < 4; ++i) {
    char room[16];
    std::snprintf(room, sizeof room, "%08x", device());
    id += room;
  }
  return id;
}

}  // namespace rmlcell::cli
