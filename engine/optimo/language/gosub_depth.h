#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// How deep the GOSUBs of a program can nest. Private to the folder.
namespace rmlcell::optimo {

inline constexpr int kGosubDepthStandard = 16;  // machine parameter GOSUB_DEPTH, OPT-7.21

// One instruction may follow another; with a GOSUB, one level deeper.
struct LevelEdge {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  bool gosub = false;
};

struct GosubNesting {
  // GOSUBs that close a ring: the subroutine can come to itself again. Ascending, each once.
  std::vector<std::uint32_t> recursive;
  // GOSUBs that may come to a level above `levels_max`, rings left out. Ascending, each once.
  std::vector<std::uint32_t> too_deep;
};

// `edges`: those of what runs, ascending by `from`, between `count` instructions of which `entry`
// is the first. Linear in the number of edges; no recursion.
GosubNesting FindNesting(std::uint32_t count, std::uint32_t entry,
                         const std::vector<LevelEdge>& edges, int levels_max = kGosubDepthStandard);

}  // namespace rmlcell::optimo
