#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// How deep the GOSUBs of a program can nest, from which subroutine calls which. Private to the
// folder.
namespace rmlcell::optimo {

inline constexpr int kGosubDepthStandard = 16;  // machine parameter GOSUB_DEPTH, OPT-7.21

// A GOSUB in a subroutine, or on the level of the program itself.
struct GosubCall {
  std::uint32_t at = 0;  // the instruction
  std::size_t to = 0;    // the subroutine that it calls
};

struct GosubNesting {
  // GOSUBs that close a ring: the subroutine can come to itself again. Ascending, each once.
  std::vector<std::uint32_t> recursive;
  // GOSUBs that may come to a level above `levels_max`, rings left out. Ascending, each once.
  std::vector<std::uint32_t> too_deep;
};

// `main`: the GOSUBs outside of subroutines. `calls[s]`: those that subroutine s may come to on its
// own level. Linear in the number of calls; no recursion.
GosubNesting FindNesting(const std::vector<GosubCall>& main,
                         const std::vector<std::vector<GosubCall>>& calls,
                         int levels_max = kGosubDepthStandard);

}  // namespace rmlcell::optimo
