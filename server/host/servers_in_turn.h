#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "server/host/further_lines.h"

namespace rmlcell::server {

// The servers of a cell: one of them stores what a host tells, and where it is lost the next one is
// tried.
class ServersInTurn {
 public:
  explicit ServersInTurn(std::string first) : servers_{std::move(first)} {}

  const std::string& present() const { return servers_[turn_]; }
  void Next() { turn_ = (turn_ + 1) % servers_.size(); }
  void Add(const std::string& server) {
    if (servers_.size() < FurtherLines::kServersMax &&
        std::ranges::find(servers_, server) == servers_.end())
      servers_.push_back(server);
  }
  std::vector<std::string> others() const {
    std::vector<std::string> others = servers_;
    std::erase(others, present());
    return others;
  }

 private:
  std::vector<std::string> servers_;
  std::size_t turn_ = 0;
};

}  // namespace rmlcell::server
