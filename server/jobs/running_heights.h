#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "rmlcell/v1/milling.pb.h"
#include "rmlcell/v1/worker.pb.h"
#include "server/jobs/followed.h"

namespace rmlcell::server {

// What is left of the block of a job that runs: of each tile the latest, for all who follow it.
class RunningHeights final : public Followed {
 public:
  static constexpr int kTilesAtOnce = 16;

  struct Part {
    std::optional<v1::HeightGrid> grid;  // nothing: the worker has not told it yet
    std::vector<v1::HeightTile> tiles;   // at most kTilesAtOnce, the oldest change first
    std::uint64_t seen = 0;              // to be given at the next look
    bool ended = false;                  // no more comes
    bool stored = false;                 // and what was made is in the store
  };
  Part Look(std::uint64_t seen) const;

  // By the dispatcher. What is no part of a grid for a screen is left out: a worker may be wrong,
  // the memory of the server is bounded.
  void Add(const v1::WorkerHeights& heights);

 private:
  struct Known {
    std::uint64_t version = 0;
    v1::HeightTile tile{};
  };
  bool Fits(const v1::HeightTile& tile) const;

  std::optional<v1::HeightGrid> grid_;
  std::map<std::pair<int, int>, Known> tiles_;            // by row and column
  std::map<std::uint64_t, std::pair<int, int>> changes_;  // of each its last one, by version
  std::uint64_t version_ = 0;
};

}  // namespace rmlcell::server
